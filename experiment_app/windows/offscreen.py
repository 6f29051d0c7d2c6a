"""An off-screen window: the same pixels without a display, in simulated time, for a simulated participant."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from experiment_app.errors import UsageError
from experiment_app.render.renderer import Renderer
from experiment_app.scene import Scene
from experiment_app.simulated.observer import SimulatedParticipant
from experiment_app.walkers import drawn_walkers, measured_gait, pose_checksum
from experiment_app.windows.driver_memory import keep_freed_memory
from experiment_app.windows.window import Flip
from protocols.events import Event
from protocols.session import Session


def offscreen_context() -> moderngl.Context:
    """An OpenGL 3.3 context without a window; raises UsageError with the way out when there is none."""
    problems = []
    choices: tuple[dict[str, Any], ...] = ({"backend": "egl"}, {})
    for settings in choices:
        try:
            context = moderngl.create_context(standalone=True, require=330, **settings)
        except Exception as error:  # glcontext raises bare Exceptions
            problems.append(str(error))
        else:
            keep_freed_memory(context)
            return context
    raise UsageError(
        f"no OpenGL 3.3 was found ({problems[0]}); on Debian or Ubuntu install it with "
        "`apt-get install libegl1 libgl1 libgl1-mesa-dri`."
    )


class OffscreenWindow:
    """Frames of `size` (width, height) at exactly `frame_rate` Hz of simulated time.

    seen: called with every scene and a function that returns its pixels, (height, width, 3) uint8.
    """

    def __init__(
        self,
        participant: SimulatedParticipant,
        until_saved: Callable[[], None],
        size: tuple[int, int],
        frame_rate: float,
        seen: Callable[[float, Scene, Callable[[], NDArray[np.uint8]]], None],
        samples: int = 4,
    ) -> None:
        self._participant = participant
        self._until_saved = until_saved
        self._seen = seen
        self._context = offscreen_context()
        self._target = self._context.simple_framebuffer(size)
        self._renderer = Renderer(self._context, size, 1.0, samples)
        self._frames = 0
        self.period = 1.0 / frame_rate

    def __enter__(self) -> OffscreenWindow:
        return self

    def __exit__(self, *_: object) -> None:
        self._renderer.release()
        self._context.release()

    def description(self) -> dict[str, Any]:
        """What a journal says about this display."""
        return {
            "window": "off-screen",
            "pixels": list(self._target.size),
            "period_s": self.period,
            "gl_renderer": self._context.info["GL_RENDERER"],
            "gl_version": self._context.info["GL_VERSION"],
            "samples": self._renderer.samples,
        }

    def poll(self, session: Session) -> tuple[float, Sequence[Event]]:
        """The time of the next frame, and what the simulated participant did until then."""
        self._until_saved()
        self._participant.look(session)
        return self._now, self._participant.take(self._now)

    def next_display_time(self) -> float:
        """The time of the frame about to be drawn."""
        return self._now

    def show(self, scene: Scene) -> Flip:
        """Draws the scene; its flip is the frame's simulated time."""
        now, begun = self._now, time.thread_time()
        drawn = drawn_walkers(scene)
        self._renderer.draw(scene, drawn, self._target)
        cpu_ms = 1e3 * (time.thread_time() - begun)
        self._seen(now, scene, lambda: self._renderer.read_pixels(self._target))
        self._frames += 1
        return Flip(now, cpu_ms, pose_checksum(drawn))

    def measure(self, scene: Scene) -> dict[str, float]:
        """The scene's walker measured as it is drawn."""
        return measured_gait(scene)

    @property
    def _now(self) -> float:
        return self._frames * self.period

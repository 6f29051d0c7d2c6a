"""The desktop window: GLFW for window and keys, moderngl for pixels. Knows no trial and no file."""

from __future__ import annotations

import time
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import glfw
import moderngl

from experiment_app.errors import UsageError
from experiment_app.render.renderer import Renderer
from experiment_app.scene import Scene
from experiment_app.walkers import drawn_walkers, measured_gait, pose_checksum
from experiment_app.windows.keys import key_name
from experiment_app.windows.pacing import Pacing, measured
from experiment_app.windows.window import Flip
from protocols.events import Clicked, Closed, Event, FocusLost, KeyDown, KeyUp, Typed
from protocols.session import Session

PROBED_SWAPS = 20
"""Bare buffer swaps timed at the start to learn whether the driver waits for the display."""


class DesktopWindow:
    """A window on a display. Use as a context manager.

    full_screen: cover display number `display` (from 1); otherwise a window of `size` (width, height).
    refresh: Hz, overrides what the display reports. Raises UsageError when there is no display, no such
    display, or no OpenGL 3.3.
    """

    def __init__(
        self,
        *,
        title: str = "gaitlab",
        full_screen: bool = True,
        display: int = 1,
        size: tuple[int, int] = (1280, 720),
        refresh: float = 0.0,
        samples: int = 4,
    ) -> None:
        self._events: list[Event] = []
        self._origin = time.perf_counter()
        self._page_scene: Scene | None = None
        self._cost = 0.004
        self._requested = ""
        self._handle, self._mode = _open(title, full_screen, display, size)
        try:
            glfw.make_context_current(self._handle)
            self._context = moderngl.create_context(require=330)
            width, height = glfw.get_framebuffer_size(self._handle)
            self._renderer = Renderer(self._context, (width, height), self._pixel_ratio(), samples)
        except Exception as error:
            glfw.terminate()
            raise UsageError(f"OpenGL 3.3 is needed and could not be started ({error}).") from None
        self._connect()
        self._pacing = self._probe(refresh)
        self._last_flip = self._now()

    def __enter__(self) -> DesktopWindow:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closes the window and gives the display back."""
        self._renderer.release()
        glfw.terminate()

    @property
    def period(self) -> float:
        """The refresh period, s."""
        return self._pacing.period

    def description(self) -> dict[str, Any]:
        """What a journal says about this display."""
        width, height = glfw.get_framebuffer_size(self._handle)
        return {
            "window": "desktop",
            "pixels": [width, height],
            "pixel_ratio": self._pixel_ratio(),
            "reported_refresh_hz": self._mode.refresh_rate if self._mode else 0,
            "period_s": round(self._pacing.period, 6),
            "swap_waits_for_display": self._pacing.throttled,
            "gl_renderer": self._context.info["GL_RENDERER"],
            "gl_version": self._context.info["GL_VERSION"],
            "samples": self._renderer.samples,
        }

    def request_end(self, reason: str) -> None:
        """Asks the session to end, as a signal handler does; safe to call at any time."""
        self._requested = reason
        glfw.post_empty_event()

    # The three verbs

    def poll(self, session: Session) -> tuple[float, Sequence[Event]]:
        """Waits, handling events as they come, until it is time to draw; then the time and the events since."""
        draw_at = self._pacing.draw_time(self._last_flip, self._cost)
        glfw.poll_events()
        while (left := draw_at - self._now()) > 0.0:
            glfw.wait_events_timeout(left)
        if self._requested:
            self._events.append(Closed(self._now(), self._requested))
            self._requested = ""
        events, self._events = self._events, []
        return self._now(), events

    def next_display_time(self) -> float:
        """The next refresh after now (s)."""
        return self._pacing.display_time(self._now(), self._last_flip)

    def show(self, scene: Scene) -> Flip:
        """Draws the scene, swaps, waits until it is done."""
        began, cpu, walkers = self._now(), time.thread_time(), drawn_walkers(scene)
        self._page_scene = scene
        size = glfw.get_framebuffer_size(self._handle)
        if min(size) > 0:
            self._renderer.resize(size, self._pixel_ratio())
            self._renderer.draw(scene, walkers, self._context.screen)
        self._set_cursor(scene)
        drawn, cpu_ms = self._now(), 1e3 * (time.thread_time() - cpu)
        glfw.swap_buffers(self._handle)
        self._context.finish()
        self._last_flip = self._now()
        self._cost = 0.8 * self._cost + 0.2 * (drawn - began)
        return Flip(self._last_flip, cpu_ms, pose_checksum(walkers))

    def measure(self, scene: Scene) -> dict[str, float]:
        """The scene's walker measured as it is drawn."""
        return measured_gait(scene)

    # Inside

    def _now(self) -> float:
        return time.perf_counter() - self._origin

    def _pixel_ratio(self) -> float:
        return float(glfw.get_window_content_scale(self._handle)[0])

    def _probe(self, refresh: float) -> Pacing:
        """Times bare swaps, because a display's reported rate and a driver's setting are not to be believed."""
        glfw.swap_interval(1)
        times = []
        for _ in range(PROBED_SWAPS):
            self._context.screen.clear(0.0, 0.0, 0.0)
            glfw.swap_buffers(self._handle)
            self._context.finish()
            times.append(self._now())
        intervals = [later - earlier for earlier, later in pairwise(times[2:])]
        reported = refresh or float(self._mode.refresh_rate if self._mode else 0)
        return measured(reported, intervals)

    def _set_cursor(self, scene: Scene) -> None:
        clickable = scene.page is not None and bool(scene.page.rows)
        mode = glfw.CURSOR_NORMAL if clickable else glfw.CURSOR_HIDDEN
        if glfw.get_input_mode(self._handle, glfw.CURSOR) != mode:
            glfw.set_input_mode(self._handle, glfw.CURSOR, mode)

    def _connect(self) -> None:
        """Every callback stamps the time before anything else."""

        def on_key(_: Any, key: int, scancode: int, action: int, modifiers: int) -> None:
            now = self._now()
            if action == glfw.PRESS and key == glfw.KEY_TAB and modifiers & glfw.MOD_SHIFT:
                self._events.append(KeyDown(now, "backtab", "arrival"))
            elif action == glfw.PRESS:
                self._events.append(KeyDown(now, key_name(key, scancode), "arrival"))
            elif action == glfw.RELEASE:
                self._events.append(KeyUp(now, key_name(key, scancode), "arrival"))
            elif key == glfw.KEY_BACKSPACE:  # holding backspace empties a field; no task listens to it
                self._events.append(KeyDown(now, "backspace", "arrival"))

        def on_text(_: Any, code: int) -> None:
            self._events.append(Typed(self._now(), chr(code)))

        def on_button(_: Any, button: int, action: int, __: int) -> None:
            now = self._now()
            if button == glfw.MOUSE_BUTTON_LEFT and action == glfw.PRESS and self._page_scene is not None:
                target = self._hit(self._page_scene)
                if target is not None:
                    self._events.append(Clicked(now, target))

        def on_focus(_: Any, focused: int) -> None:
            if not focused:
                self._events.append(FocusLost(self._now()))

        def on_close(_: Any) -> None:
            self._events.append(Closed(self._now()))

        self._callbacks = (on_key, on_text, on_button, on_focus, on_close)
        glfw.set_key_callback(self._handle, on_key)
        glfw.set_char_callback(self._handle, on_text)
        glfw.set_mouse_button_callback(self._handle, on_button)
        glfw.set_window_focus_callback(self._handle, on_focus)
        glfw.set_window_close_callback(self._handle, on_close)

    def _hit(self, scene: Scene) -> str | None:
        if scene.page is None:
            return None
        x, y = glfw.get_cursor_pos(self._handle)
        width, height = glfw.get_window_size(self._handle)
        pixels = glfw.get_framebuffer_size(self._handle)
        return self._renderer.hit(scene.page, x * pixels[0] / width, y * pixels[1] / height)


def _open(title: str, full_screen: bool, display: int, size: tuple[int, int]) -> tuple[Any, Any]:
    """A GLFW window with an OpenGL 3.3 core context, and the video mode of its display."""
    problems: list[str] = []
    glfw.set_error_callback(lambda code, text: problems.append(text.decode() if isinstance(text, bytes) else str(text)))
    if not glfw.init():
        raise UsageError(
            "no display was found, so no window can be opened; sit at the computer's own screen, or use "
            "`gaitlab demo` and `gaitlab simulate`, which need none."
        )
    monitors = glfw.get_monitors()
    if monitors and not 1 <= display <= len(monitors):
        glfw.terminate()
        raise UsageError(f"--display {display}: this computer has displays 1 to {len(monitors)}.")
    monitor = monitors[display - 1] if monitors else None
    mode = glfw.get_video_mode(monitor) if monitor else None
    for hint, value in (
        (glfw.CONTEXT_VERSION_MAJOR, 3),
        (glfw.CONTEXT_VERSION_MINOR, 3),
        (glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE),
        (glfw.OPENGL_FORWARD_COMPAT, True),
        (glfw.DEPTH_BITS, 0),
        (glfw.SCALE_TO_MONITOR, True),
        (glfw.AUTO_ICONIFY, False),
    ):
        glfw.window_hint(hint, value)
    if full_screen and mode is not None:
        glfw.window_hint(glfw.REFRESH_RATE, mode.refresh_rate)
        handle = glfw.create_window(mode.size.width, mode.size.height, title, monitor, None)
    else:
        handle = glfw.create_window(*size, title, None, None)
        if handle and monitor:
            left, top, width, height = glfw.get_monitor_workarea(monitor)
            glfw.set_window_pos(handle, left + max(width - size[0], 0) // 2, top + max(height - size[1], 0) // 2)
    if not handle:
        reason = problems[-1] if problems else "no reason given"
        glfw.terminate()
        raise UsageError(
            f"no window with OpenGL 3.3 could be opened ({reason}); update the graphics driver, or on Linux "
            "install the system's OpenGL libraries (the README's first command does)."
        )
    return handle, mode

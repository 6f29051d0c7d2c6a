"""`gaitlab doctor`: what this computer's OpenGL, display and keyboard give, measured, as a timing certificate."""

from __future__ import annotations

import platform
import time
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from experiment_app.scene import Scene, Walker
from experiment_app.timing.certificate import methods_paragraph, rows, verdict
from experiment_app.timing.facts import Timing
from experiment_app.timing.frames import LATE

if TYPE_CHECKING:
    from experiment_app.windows.desktop import DesktopWindow

SECONDS = 3.0
SETTLING = 10
"""Frames at the start, which upload and compile, that are left out."""

PRESSES = 40
"""Keys injected to measure how they are stamped, in about five seconds."""


def examine(off_screen: bool, *, display: int = 1, keys: bool = True) -> Timing:
    """Draws a walker for SECONDS full screen, or off-screen where there is no display or none is wanted.

    keys: also presses a key that no study uses (the right Control key), where the X server allows it.
    """
    from experiment_app.windows.screen import has_screen

    return _off_screen() if off_screen or not has_screen() else _on_screen(display, keys)


def lines(timing: Timing) -> list[str]:
    """The certificate in words for a terminal, the verdict last."""
    judged = verdict(timing)
    said = [f"{'Computer':<13}{platform.system()} {platform.release()}, {platform.machine()}"]
    said += [f"{name:<13}{words}" for name, words in rows(timing)]
    said += ["", f"Verdict: {judged.level}.", *judged.reasons]
    return [*said, "", f"For the Methods section: {methods_paragraph(timing)}"]


def _scene(seconds: float) -> Scene:
    return Scene((Walker("F1", 1.2, 105.0, 0.875 * seconds % 1.0, distance=1.2 * seconds),))


def _on_screen(display: int, keys: bool) -> Timing:
    from experiment_app.timing.injected_keys import NOBODY
    from experiment_app.windows.desktop import DesktopWindow

    with DesktopWindow(title="gaitlab doctor", display=display) as window:
        flips: list[float] = []
        errors: list[float] = []
        costs: list[float] = []
        while window.now() < SECONDS or len(flips) < 3 * SETTLING:
            window.poll(NOBODY)
            predicted = window.next_display_time()
            flip = window.show(_scene(predicted))
            flips.append(flip.time)
            errors.append(flip.time - predicted)
            costs.append(flip.cpu_ms)
        intervals = tuple(later - earlier for earlier, later in pairwise(flips[SETTLING:]))
        late = sum(interval > LATE * window.period for interval in intervals)
        return Timing(
            what="computer",
            about=window.description(),
            intervals=intervals,
            period=window.period,
            errors=tuple(errors[SETTLING:]),
            cpu_ms=tuple(costs[SETTLING:]),
            late=(("all", late),) if late else (),
            keys=_injected(window) if keys else None,
        )


def _injected(window: DesktopWindow) -> dict[str, Any] | None:
    """How far the stamps of injected keys were off; None where keys cannot be injected."""
    from experiment_app.timing.injected_keys import measure_keys
    from experiment_app.timing.key_injector import can_inject

    if not can_inject():
        return None
    return measure_keys(window, lambda: window.show(_scene(window.next_display_time())), PRESSES).summary()


def _off_screen() -> Timing:
    from experiment_app.render.renderer import Renderer
    from experiment_app.walkers import drawn_walkers
    from experiment_app.windows.offscreen import offscreen_context

    size = (1280, 720)
    context = offscreen_context()
    target = context.simple_framebuffer(size)
    renderer = Renderer(context, size, 1.0, 4)
    begun, flips = time.perf_counter(), list[float]()
    while (now := time.perf_counter() - begun) < SECONDS or len(flips) < 3 * SETTLING:
        scene = _scene(now)
        renderer.draw(scene, drawn_walkers(scene), target)
        context.finish()
        flips.append(time.perf_counter())
    intervals = tuple(later - earlier for earlier, later in pairwise(flips[SETTLING:]))
    about = {
        "window": "off-screen",
        "pixels": list(size),
        "gl_renderer": context.info["GL_RENDERER"],
        "gl_vendor": context.info["GL_VENDOR"],
        "gl_version": context.info["GL_VERSION"],
        "samples": renderer.samples,
    }
    renderer.release()
    context.release()
    return Timing("computer", about, intervals, 0.0)

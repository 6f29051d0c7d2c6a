"""`gaitlab doctor`: what this computer's OpenGL and display give, measured, and what that means for an experiment."""

from __future__ import annotations

import platform
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import median, pstdev
from typing import Any, cast

from experiment_app.scene import Scene, Walker

SOFTWARE = ("llvmpipe", "softpipe", "swiftshader", "software", "gdi generic", "basic render")
"""Words in a GL renderer's name that mean the processor draws."""

SECONDS = 3.0
BARS = "▁▂▃▄▅▆▇█"


@dataclass(frozen=True)
class Findings:
    """What was found.

    about: what the window says of itself; intervals: s between frames; display: words about size and scale.
    synchronised: whether frames wait for the display; off_screen: there was no display at all.
    """

    about: dict[str, Any]
    intervals: tuple[float, ...]
    display: str
    synchronised: bool
    off_screen: bool


def examine(off_screen: bool) -> Findings:
    """Draws a walker for SECONDS in a window, or off-screen where there is no display or none is wanted."""
    from experiment_app.demo import has_screen

    return _off_screen() if off_screen or not has_screen() else _on_screen()


def lines(found: Findings) -> list[str]:
    """The findings in words, the verdict last."""
    about, intervals = found.about, found.intervals
    wide, tall = about["pixels"]
    said = [
        f"Computer       {platform.system()} {platform.release()}, {platform.machine()}",
        f"GL renderer    {about['gl_renderer']}",
        f"GL version     {about['gl_version']}",
        f"Samples        {about['samples']} per pixel",
        f"Display        {found.display}",
        f"Picture        {wide}x{tall} pixels",
    ]
    if found.off_screen:
        said.append("Refresh        none: drawn off-screen, not synchronised to any display")
    else:
        reported = about["reported_refresh_hz"]
        said.append(f"Refresh        {f'{reported} Hz' if reported else 'nothing'} reported by the display")
    middle, spread = median(intervals), pstdev(intervals)
    said.append(
        f"Frames         {len(intervals)} intervals: median {middle * 1e3:.2f} ms ({1 / middle:.1f}/s), SD "
        f"{spread * 1e3:.2f} ms, shortest {min(intervals) * 1e3:.2f}, longest {max(intervals) * 1e3:.2f} ms"
    )
    said.append(f"Histogram      {histogram(intervals)}")
    return [*said, *verdict(found)]


def verdict(found: Findings) -> list[str]:
    """Plain words about what this computer can be used for."""
    said = []
    renderer = str(found.about["gl_renderer"]).lower()
    if any(word in renderer for word in SOFTWARE):
        said.append(
            "The processor draws, not a graphics card: fine for trying, films and tests, not for participants. "
            "Install the graphics card's driver."
        )
    if found.off_screen:
        said.append("Not synchronised: without a display nothing can be said about when frames are seen.")
        return said
    period = float(found.about["period_s"])
    late = sum(interval > 1.5 * period for interval in found.intervals)
    if not found.synchronised:
        said.append(
            "Not synchronised: swaps do not wait for the display, so frames may tear and their times are estimates. "
            "Switch vertical synchronisation on in the driver's settings, and compositing off."
        )
    if late:
        said.append(f"{late} of {len(found.intervals)} frames were late by half a refresh or more.")
    if found.synchronised and not late and len(said) == 0:
        said.append("Good: every frame was shown for exactly one refresh.")
    return said


def histogram(intervals: Sequence[float], bins: int = 24) -> str:
    """One line: how often each interval occurred, from the shortest to the longest but the rarest 1 %."""
    ordered = sorted(intervals)
    low, high = ordered[0], ordered[min(int(0.99 * len(ordered)), len(ordered) - 1)]
    width = max((high - low) / bins, 1e-5)
    counts = [0] * bins
    for interval in intervals:
        counts[min(int((interval - low) / width), bins - 1)] += 1
    most = max(counts)
    bars = "".join(" " if n == 0 else BARS[min(int(8 * n / most), 7)] for n in counts)
    return f"{low * 1e3:.2f} ms |{bars}| {(low + bins * width) * 1e3:.2f} ms and longer"


def _scene(seconds: float) -> Scene:
    return Scene((Walker("F1", 1.2, 105.0, 0.875 * seconds % 1.0, distance=1.2 * seconds),))


def _timed(show: Callable[[Scene], float]) -> tuple[float, ...]:
    """s between frames; the first ten, which upload and compile, are left out."""
    begun = time.perf_counter()
    flips: list[float] = []
    while (now := time.perf_counter() - begun) < SECONDS or len(flips) < 30:
        flips.append(show(_scene(now)))
    return tuple(later - earlier for earlier, later in pairwise(flips[10:]))


def _on_screen() -> Findings:
    import glfw

    from experiment_app.windows.desktop import DesktopWindow
    from protocols.session import Session

    with DesktopWindow(title="gaitlab doctor") as window:
        monitor = glfw.get_primary_monitor()
        display = "unknown"
        if monitor:
            mode = glfw.get_video_mode(monitor)
            across, down = glfw.get_monitor_physical_size(monitor)
            scale = glfw.get_monitor_content_scale(monitor)[0]
            size = f"{across / 10:.1f} x {down / 10:.1f} cm as it says" if across and down else "size not told"
            name = glfw.get_monitor_name(monitor)
            name = name.decode() if isinstance(name, bytes) else name
            display = f"{name}, {mode.size.width}x{mode.size.height} pixels, {size}, scale {scale:g}"

        def show(scene: Scene) -> float:
            window.poll(cast(Session, None))
            return window.show(scene).time

        intervals = _timed(show)
        about = window.description()
    return Findings(about, intervals, display, bool(about["swap_waits_for_display"]), False)


def _off_screen() -> Findings:
    from experiment_app.render.renderer import Renderer
    from experiment_app.walkers import drawn_walkers
    from experiment_app.windows.offscreen import offscreen_context

    size = (1280, 720)
    context = offscreen_context()
    target = context.simple_framebuffer(size)
    renderer = Renderer(context, size, 1.0, 4)

    def show(scene: Scene) -> float:
        renderer.draw(scene, drawn_walkers(scene), target)
        context.finish()
        return time.perf_counter()

    intervals = _timed(show)
    about = {
        "pixels": list(size),
        "gl_renderer": context.info["GL_RENDERER"],
        "gl_version": context.info["GL_VERSION"],
        "samples": renderer.samples,
    }
    renderer.release()
    context.release()
    return Findings(about, intervals, "none used", False, True)

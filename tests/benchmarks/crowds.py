"""How long crowds take: our own work, and drawing.

A frame is timed from the scene to the finished picture (glFinish); CPU is of all threads of the process. Times of a
shared machine are noisy: the least disturbed tenth of the frames is printed beside the median, and CPU beside both.
"""

from __future__ import annotations

import resource
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from unittest.mock import patch

import moderngl
import numpy as np

from experiment_app.crowds import drawn_crowd
from experiment_app.live import without_collection
from experiment_app.render.renderer import Renderer
from experiment_app.scene import Camera, Crowd, Ground, Scene, Walker
from experiment_app.timing.facts import is_software
from experiment_app.walkers import drawn_walkers
from experiment_app.windows.offscreen import offscreen_context
from stimuli.crowds.poses import many_transforms
from stimuli.crowds.posing import accelerated
from tests.benchmarks.measuring import fastest, row

SIZES = (1, 100, 250, 500, 1000)
CAMERA = Camera("elevated", 30.0, 9.0, 40.0, 180.0)
LEVEL = 2
"""The level of detail that everybody has where levels are off: 1780 triangles."""

FRAMES = 12
RATE = 120  # frames/s that a graphics card must hold


class Timed(dict[str, float]):
    """ms per frame: wall_p10, wall, wall_p90, cpu, poses."""

    def __str__(self) -> str:
        return (
            f"poses {self['poses']:6.2f}   frame {self['wall_p10']:7.1f} (p10) {self['wall']:7.1f} (median)   "
            f"CPU {self['cpu']:7.1f} ms"
        )


def timed_frames(
    renderer: Renderer, target: moderngl.Framebuffer, scenes: Iterator[Scene], frames: int = FRAMES, warm: int = 3
) -> Timed:
    """Frames are timed after so many that warm up, without Python's garbage collector, as in a session."""
    walls, poses = [], []
    used = 0.0
    with without_collection():
        for number, scene in zip(range(frames + warm), scenes, strict=False):
            if number == warm:
                used = _used()
            begun = time.perf_counter()
            drawn = drawn_walkers(scene)
            posed = time.perf_counter()
            renderer.draw(scene, drawn, target)
            target.ctx.finish()
            if number >= warm:
                walls.append(1e3 * (time.perf_counter() - begun))
                poses.append(1e3 * (posed - begun))
        cpu = 1e3 * (_used() - used) / frames
    low, middle, high = (float(value) for value in np.quantile(walls, (0.1, 0.5, 0.9)))
    return Timed(wall_p10=low, wall=middle, wall_p90=high, cpu=cpu, poses=float(np.median(poses)))


def _used() -> float:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def crowd_of(size: int) -> Crowd:
    return Crowd(max(size, 2), "1:1", seed=1, seconds=3.0)


def walking(size: int, ground: Ground, lod: int | None) -> Iterator[Scene]:
    """A crowd frame by frame; one walker is a walker like any, seen as in a study."""
    for number in range(10**6):
        seconds = 3.0 + number / 60.0
        if size == 1:
            camera = replace(CAMERA, view="three_quarter", distance=5.0, height=1.6, heading=None, field_of_view=30.0)
            ground_of_one: Ground = "open_ground" if ground == "street" else ground
            walker = Walker("F1", 1.2, 110.0, seconds * 110.0 / 120.0 % 1.0, 1.2 * seconds)
            yield Scene((walker,), camera, ground_of_one, lod=lod)
        else:
            yield Scene((), CAMERA, ground, crowd=replace(crowd_of(size), seconds=seconds), lod=lod)


def own_work() -> None:
    """Our thread's work for one walker and for 1000 who all walk differently: poses, uploads, calls; no triangles."""
    crowd = Crowd(1000, "1:1", seed=1)
    context = offscreen_context()
    target = context.simple_framebuffer((16, 9))
    renderer = Renderer(context, (16, 9), 1.0, 1)
    one, thousand = walking(1, "open_ground", None), walking(1000, "street", None)

    def draw(scenes: Iterator[Scene] = thousand) -> None:
        scene = next(scenes)
        renderer.draw(scene, drawn_walkers(scene), target)

    draw(one)
    draw()
    with _without_triangles():
        row("our CPU per frame, one walker on open ground", fastest(lambda: draw(one), 7, 20), 1e-3)
    with _without_triangles(), patch("experiment_app.crowds.poser", lambda: many_transforms):
        row("poses and places of 1000 unique walkers, NumPy", fastest(lambda: drawn_crowd(crowd), 7, 10), 5e-3)
        row("our CPU per frame, 1000 unique walkers in a street, NumPy", fastest(draw, 7, 10), 5e-3)
    if accelerated():
        with _without_triangles():
            row("the same with numba", fastest(draw, 7, 10), 5e-3)
    renderer.release()
    context.release()


@contextmanager
def _without_triangles() -> Iterator[None]:
    """Every draw call is made, of no vertices: what is left of a frame is our own work and the calls themselves."""
    render = moderngl.VertexArray.render

    def nothing(array: moderngl.VertexArray, mode: int | None = None, **given: int) -> None:
        render(array, mode, **{**given, "vertices": 0})

    with patch.object(moderngl.VertexArray, "render", nothing):
        yield


def drawing() -> None:
    """Frame times of one walker at 1920 x 1080, and of crowds at 1280 x 720, all with shadows."""
    context = offscreen_context()
    print(f"drawn by {context.info['GL_RENDERER']}, no multisampling")
    for size, pixels in ((1, (1920, 1080)), *((size, (1280, 720)) for size in SIZES)):
        target = context.simple_framebuffer(pixels)
        renderer = Renderer(context, pixels, 1.0, 1)
        for lod in (None,) if size == 1 else (None, LEVEL):
            timed = timed_frames(renderer, target, walking(size, "street", lod))
            detail = "levels of detail" if lod is None else f"level {lod} for all"
            print(f"  {size:5} in {pixels[0]}x{pixels[1]}, {detail:18} {timed}", flush=True)
        renderer.release()
        target.release()
    context.release()


def graphics_card() -> None:
    """Frames per second of 1000 unique walkers at 1920 x 1080 with shadows in a street, where the limit is 120.

    Off-screen through EGL: no display is needed. On a software driver it is measured all the same, and said to be no
    graphics card.
    """
    context = offscreen_context()
    name, software = context.info["GL_RENDERER"], is_software(context.info["GL_RENDERER"])
    print(f"drawn by {name} ({context.info['GL_VERSION']}): {'no graphics card' if software else 'a graphics card'}")
    pixels, frames = (1920, 1080), 12 if software else 600
    target = context.simple_framebuffer(pixels)
    for samples in (4,) if software else (1, 4):
        renderer = Renderer(context, pixels, 1.0, samples)
        for lod, detail in ((None, "levels of detail"), (LEVEL, f"level {LEVEL} for all")):
            timed = timed_frames(renderer, target, walking(1000, "street", lod), frames, warm=3 if software else 60)
            rate = 1e3 / timed["wall"]
            verdict = "no figure for a graphics card" if software else "kept" if rate >= RATE else "MISSED"
            print(
                f"  1000 walkers in {pixels[0]}x{pixels[1]}, {renderer.samples} samples, {detail:18} {timed}   "
                f"{rate:6.1f} frames/s, slowest tenth {1e3 / timed['wall_p90']:6.1f}; limit {RATE}: {verdict}",
                flush=True,
            )
        renderer.release()
    target.release()
    context.release()

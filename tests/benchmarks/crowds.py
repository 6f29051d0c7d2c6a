"""How long crowds take: our own work, drawing, and the same walkers drawn by other programs in the same run.

A frame is timed from the scene to the finished picture (glFinish); CPU is of all threads of the process. Times of a
shared machine are noisy: the least disturbed tenth of the frames is printed beside the median, and CPU beside both.
"""

from __future__ import annotations

import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, nullcontext
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import moderngl
import numpy as np

from experiment_app.crowds import END, drawn_crowd, plan_of
from experiment_app.live import without_collection
from experiment_app.render.crowd_pass import CROWD, FAR, CrowdPass
from experiment_app.render.renderer import Renderer
from experiment_app.render.shadow_map import ShadowMap
from experiment_app.scene import Camera, Crowd, Ground, Scene, Walker
from experiment_app.timing.facts import is_software
from experiment_app.walkers import drawn_walkers
from experiment_app.windows.offscreen import offscreen_context
from stimuli.crowds.poses import many_matrices
from stimuli.crowds.posing import accelerated
from tests.benchmarks.measuring import fastest, row

SIZES = (1, 100, 250, 500, 1000)
CAMERA = Camera("elevated", 30.0, 9.0, 40.0, 180.0)
LEVEL = 2
"""The level of detail that everybody has where levels are off: 1780 triangles."""

FRAMES = 12
RATE = 120  # frames/s that a graphics card must hold
RIVALS = {"raylib": "raylib_crowd.py", "panda3d": "panda3d_crowd.py", "three.js": "three_crowd.mjs"}


class _Timed(dict[str, float]):
    """ms per frame: wall_p10, wall, wall_p90, cpu, poses."""

    def __str__(self) -> str:
        return (
            f"poses {self['poses']:6.2f}   frame {self['wall_p10']:7.1f} (p10) {self['wall']:7.1f} (median)   "
            f"CPU {self['cpu']:7.1f} ms"
        )


def _timed(
    renderer: Renderer, target: moderngl.Framebuffer, scenes: Iterator[Scene], frames: int = FRAMES, warm: int = 3
) -> _Timed:
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
    return _Timed(wall_p10=low, wall=middle, wall_p90=high, cpu=cpu, poses=float(np.median(poses)))


def _used() -> float:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def _crowd(size: int) -> Crowd:
    return Crowd(max(size, 2), "1:1", seed=1, seconds=3.0)


def _walking(size: int, ground: Ground, lod: int | None) -> Iterator[Scene]:
    """A crowd frame by frame; one walker is a walker like any, seen as in a study."""
    for number in range(10**6):
        seconds = 3.0 + number / 60.0
        if size == 1:
            camera = replace(CAMERA, view="three_quarter", distance=5.0, height=1.6, heading=None, field_of_view=30.0)
            ground_of_one: Ground = "open_ground" if ground == "street" else ground
            walker = Walker("F1", 1.2, 110.0, seconds * 110.0 / 120.0 % 1.0, 1.2 * seconds)
            yield Scene((walker,), camera, ground_of_one, lod=lod)
        else:
            yield Scene((), CAMERA, ground, crowd=replace(_crowd(size), seconds=seconds), lod=lod)


def own_work() -> None:
    """Our thread's work for one walker and for 1000 who all walk differently: poses, uploads, calls; no triangles."""
    crowd = Crowd(1000, "1:1", seed=1)
    context = offscreen_context()
    target = context.simple_framebuffer((16, 9))
    renderer = Renderer(context, (16, 9), 1.0, 1)
    one, thousand = _walking(1, "open_ground", None), _walking(1000, "street", None)

    def draw(scenes: Iterator[Scene] = thousand) -> None:
        scene = next(scenes)
        renderer.draw(scene, drawn_walkers(scene), target)

    draw(one)
    draw()
    with _without_triangles():
        row("our CPU per frame, one walker on open ground", fastest(lambda: draw(one), 7, 20), 1e-3)
    with _without_triangles(), patch("experiment_app.crowds.poser", lambda: many_matrices):
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
            timed = _timed(renderer, target, _walking(size, "street", lod))
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
            timed = _timed(renderer, target, _walking(1000, "street", lod), frames, warm=3 if software else 60)
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


def rivals() -> None:
    """1000 walkers, the same mesh, places and camera, drawn by ours and by raylib, Panda3D and three.js if there.

    GAITLAB_RIVALS names a Python that has the first two; GAITLAB_THREE a folder where `npm install three
    puppeteer-core` was run, for Node and Chromium. They need a display, or Xvfb. On plain ground, and ours with its
    shadows, colours, haze and one motion each; theirs with one directional light and one clip.
    """
    python = os.environ.get("GAITLAB_RIVALS", sys.executable)
    with tempfile.TemporaryDirectory() as folder:
        from tests.benchmarks.rivals.walker_file import write_walker

        glb, places = Path(folder) / "walker.glb", Path(folder) / "places.json"
        triangles = write_walker(glb, LEVEL)
        sizes = (100, 250, 500, 1000)
        places.write_text(json.dumps({size: _places(size) for size in sizes}), encoding="utf-8")
        print(f"beside other programs, 1280x720, {triangles} triangles a walker:")
        ours = {
            "levels off": _ours(sizes, LEVEL, shadows=True),
            "levels on": _ours(sizes, None, shadows=True),
            "off, no shadows": _ours(sizes, LEVEL, shadows=False),
            "on, no shadows": _ours(sizes, None, shadows=False),
        }
        for size in sizes:
            for name, times in ours.items():
                print(f"  {size:5} ours, {name:16} {times[size]}", flush=True)
        for name, script in RIVALS.items():
            theirs = _theirs(python, script, glb, places)
            if theirs is None:
                print(f"  {name} was not found; {_missing(name, python)}")
                continue
            for size, timed in theirs.items():
                print(f"  {size:5} {name:22} {timed}", flush=True)
            for kind, times in ours.items():
                against = {key: times[1000][key] / theirs[1000][key] for key in ("wall_p10", "wall", "cpu")}
                shares = ", ".join(f"{key} {value:.2f}" for key, value in against.items())
                print(f"        1000 walkers, ours with {kind} over {name}: {shares}")


def _places(size: int) -> list[tuple[float, float, float]]:
    plan = plan_of(_crowd(size))
    places = plan.places(3.0)
    return [
        (float(x), float(z) + END - plan.length, float(phase))
        for (x, z), phase in zip(places, plan.phases(3.0), strict=True)
    ]


def _ours(sizes: tuple[int, ...], lod: int | None, shadows: bool) -> dict[int, _Timed]:
    context = offscreen_context()
    target = context.simple_framebuffer((1280, 720))
    renderer = Renderer(context, (1280, 720), 1.0, 1)
    with nullcontext() if shadows else _without_shadows():
        found = {size: _timed(renderer, target, _walking(size, "plain", lod)) for size in sizes}
    renderer.release()
    context.release()
    return found


@contextmanager
def _without_shadows() -> Iterator[None]:
    """Nothing of shadows is left, as in the rivals: no map cleared, none drawn into it, none read by a shader."""
    with ExitStack() as patches:
        patches.enter_context(patch.object(ShadowMap, "begin", lambda _: None))
        patches.enter_context(patch.object(CrowdPass, "draw_shadow", lambda *_: None))
        for constants in (CROWD, FAR):
            patches.enter_context(patch.dict(constants, SHADOW_TAPS="0"))
        yield


def _missing(name: str, python: str) -> str:
    if name == "three.js":
        return "set GAITLAB_THREE to a folder where `npm install three puppeteer-core` was run; needs node and chromium"
    return f"{python} does not have it; set GAITLAB_RIVALS to a Python that has"


def _theirs(python: str, script: str, glb: Path, places: Path) -> dict[int, _Timed] | None:
    program = python if script.endswith(".py") else shutil.which("node")
    if program is None:
        return None
    command = [program, script, str(glb), str(places), str(FRAMES)]
    if not os.environ.get("DISPLAY") and shutil.which("xvfb-run"):
        command = ["xvfb-run", "-a", "-s", "-screen 0 1920x1080x24 -noreset", *command]
    folder = Path(__file__).parent / "rivals"
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    lines = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    return {
        line["walkers"]: _Timed({k: line[k] for k in ("wall_p10", "wall", "cpu", "poses")}) for line in lines
    } or None

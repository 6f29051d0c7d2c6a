"""The same walkers drawn by ours and by other programs, in turn."""

from __future__ import annotations

import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections import defaultdict
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, nullcontext
from pathlib import Path
from unittest.mock import patch

from experiment_app.crowds import END, plan_of
from experiment_app.render.crowd_pass import CROWD, FAR, CrowdPass
from experiment_app.render.renderer import Renderer
from experiment_app.render.shadow_map import ShadowMap
from experiment_app.windows.offscreen import offscreen_context
from tests.benchmarks.crowds import FRAMES, LEVEL, Timed, crowd_of, timed_frames, walking
from tests.benchmarks.rivals.walker_file import write_walker

RIVALS = {"raylib": "raylib_crowd.py", "panda3d": "panda3d_crowd.py", "three.js": "three_crowd.mjs"}
SIZES = (100, 250, 500, 1000)
OURS: dict[str, tuple[int | None, bool]] = {
    "levels off, no shadows": (LEVEL, False),
    "levels on, no shadows": (None, False),
    "levels off, with shadows": (LEVEL, True),
    "levels on, with shadows": (None, True),
}
"""The level of detail that is forced, and whether there are shadows; the first is what the others draw."""

ROUNDS = 5


def rivals() -> None:
    """1000 walkers, the same mesh, places and camera, drawn by ours and by raylib, Panda3D and three.js if there.

    GAITLAB_RIVALS names a Python that has the first two; GAITLAB_THREE a folder where `npm install three
    puppeteer-core` was run, for Node and Chromium. They need a display, or Xvfb. On plain ground, and ours with its
    colours, haze and one motion each; theirs with one directional light and one clip. A shared machine is slower at
    some times than at others, so shares are of rounds in which each program draws 1000 walkers in its turn.
    """
    python = os.environ.get("GAITLAB_RIVALS", sys.executable)
    with tempfile.TemporaryDirectory() as folder:
        glb, places, thousand = (Path(folder) / name for name in ("walker.glb", "places.json", "thousand.json"))
        triangles = write_walker(glb, LEVEL)
        places.write_text(json.dumps({size: _places(size) for size in SIZES}), encoding="utf-8")
        thousand.write_text(json.dumps({1000: _places(1000)}), encoding="utf-8")
        print(f"beside other programs, 1280x720, {triangles} triangles a walker:")
        for name, (lod, shadows) in OURS.items():
            for size, timed in _ours(SIZES, lod, shadows).items():
                print(f"  {size:5} ours, {name:24} {timed}", flush=True)
        found = []
        for name, script in RIVALS.items():
            theirs = _theirs(python, script, glb, places)
            if theirs is None:
                print(f"  {name} was not found; {_missing(name, python)}")
                continue
            found.append(name)
            for size, timed in theirs.items():
                print(f"  {size:5} {name:30} {timed}", flush=True)
        if not found:
            return
        shares: dict[tuple[str, str, str], list[float]] = defaultdict(list)
        for _ in range(ROUNDS):
            ours = {kind: _ours((1000,), *how)[1000] for kind, how in OURS.items()}
            for name in found:
                theirs = _theirs(python, RIVALS[name], glb, thousand)
                for kind in OURS if theirs else ():
                    for time in ("cpu", "wall"):
                        shares[name, kind, time].append(ours[kind][time] / theirs[1000][time])
        print(f"  1000 walkers, {ROUNDS} rounds in turn: median share of the other program's time (lowest to highest)")
        for (name, kind, time), values in shares.items():
            spread = f"{statistics.median(values):.2f} ({min(values):.2f} to {max(values):.2f})"
            print(f"    {kind:24} over {name:8} {time:4} {spread}")


def _places(size: int) -> list[tuple[float, float, float]]:
    plan = plan_of(crowd_of(size))
    places = plan.places(3.0)
    return [
        (float(x), float(z) + END - plan.length, float(phase))
        for (x, z), phase in zip(places, plan.phases(3.0), strict=True)
    ]


def _ours(sizes: tuple[int, ...], lod: int | None, shadows: bool) -> dict[int, Timed]:
    context = offscreen_context()
    target = context.simple_framebuffer((1280, 720))
    renderer = Renderer(context, (1280, 720), 1.0, 1)
    with nullcontext() if shadows else _without_shadows():
        found = {size: timed_frames(renderer, target, walking(size, "plain", lod)) for size in sizes}
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


def _theirs(python: str, script: str, glb: Path, places: Path) -> dict[int, Timed] | None:
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
        line["walkers"]: Timed({k: line[k] for k in ("wall_p10", "wall", "cpu", "poses")}) for line in lines
    } or None

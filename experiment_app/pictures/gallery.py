"""`gaitlab gallery`: every picture of docs/gallery.md and README's trial, made anew off-screen, always the same."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from random import Random

import numpy as np
from numpy.typing import NDArray

from experiment_app.pictures.film import condition_of, save_picture, walking
from experiment_app.render.part_map import PartMap
from experiment_app.render.renderer import Renderer
from experiment_app.scene import Camera, Crowd, Marks, Scene, View, Walker
from experiment_app.walkers import drawn_walkers, walk_of
from experiment_app.windows.offscreen import offscreen_context
from protocols.study_file import read_study, shipped_studies
from stimuli.bodies.imported_bodies import imported_names
from stimuli.bodies.known import shipped_names
from stimuli.bodies.point_light import FIGURES
from stimuli.methods.recipe import Making
from stimuli.methods.styles import default_styles
from stimuli.skeleton import JOINTS

Pixels = NDArray[np.uint8]
TILE = (400, 450)
WIDE = (1200, 675)
HALF = (600, 400)
SMALL = (240, 340)
TRIAL = (600, 338)
SCREEN = (1280, 720)
CLOSE = Camera("three_quarter", 5.0, 1.3, 24.0)
PHASES = (0.02, 0.18, 0.34, 0.5)

PART_COLOURS = {"legs": (214, 95, 60), "arms": (70, 130, 190), "torso": (110, 165, 90), "head": (225, 185, 70)}
BUILDS = (
    ("F1", "woman_slim"), ("F1", "woman"), ("F1", "woman_ponytail_stout"),
    ("M1", "man_slim"), ("M1", "man"), ("M1", "man_cropped_stout"),
)  # fmt: skip
"""Actors and bodies in which every build and both haircuts can be seen."""


def make_gallery(folder: Path) -> Iterator[Path]:
    """Draws every picture into the folder, and says which as it goes."""
    folder.mkdir(parents=True, exist_ok=True)
    context = offscreen_context()

    def drawn(scenes: Sequence[Scene], size: tuple[int, int]) -> list[Pixels]:
        target = context.simple_framebuffer(size)
        renderer = Renderer(context, size, 1.0, 4)
        found = []
        for scene in scenes:
            renderer.draw(scene, drawn_walkers(scene), target)
            found.append(renderer.read_pixels(target))
        renderer.release()
        target.release()
        return found

    def row(name: str, scenes: Sequence[Scene], size: tuple[int, int] = TILE) -> Path:
        save_picture(np.hstack(drawn(scenes, size)), folder / name)
        return folder / name

    for body, actor in (("woman", "F1"), ("man", "M1")):
        yield row(f"{body}-views.png", list(_views(actor)))
        yield row(
            f"{body}-walking.png", [_one(actor, phase, camera=Camera("side", 4.6, 1.2, 26.0)) for phase in PHASES]
        )
    yield row("representations.png", [_one("F1", 0.2, body=name, marks=Marks(dot_size=0.3)) for name in FIGURES])
    yield row("treadmill.png", list(_treadmill()), HALF)
    yield row("pair.png", [_pair()], WIDE)
    yield row("street.png", list(_street()), HALF)
    yield row("builds.png", [_one(actor, 0.2, body=body) for actor, body in BUILDS])
    yield row("bodies.png", [_one("M1", 0.2, body=name) for name in (*shipped_names(), *imported_names()[:4])])
    yield row("levels.png", [_one("F1", 0.2, lod=level) for level in (0, 1, 2)])
    styles = drawn([_styled(style) for style in (None, *default_styles())], SMALL)
    save_picture(np.vstack([np.hstack(styles[:6]), np.hstack(styles[6:])]), folder / "styles.png")
    yield folder / "styles.png"
    for size in (250, 500, 1000):
        yield row(f"crowd-{size}.png", [_crowd(size)], WIDE)
    studies = drawn([_trial(name) for name in shipped_studies()], TRIAL)
    across = [np.hstack(studies[i : i + 2]) for i in range(0, len(studies) - len(studies) % 2, 2)]
    rest = [np.hstack([studies[-1], np.zeros_like(studies[-1])])] if len(studies) % 2 else []
    save_picture(np.vstack([*across, *rest]), folder / "studies.png")
    yield folder / "studies.png"
    yield row("trial.png", [_trial("walk_ratio", 0.8)], SCREEN)
    yield _parts(folder / "body-parts.png")
    context.release()


def _one(
    actor: str,
    phase: float,
    *,
    body: str = "",
    camera: Camera = CLOSE,
    marks: Marks | None = None,
    lod: int | None = None,
) -> Scene:
    return Scene((Walker(actor, 1.2, 105.0, phase, body=body),), camera, marks=marks or Marks(), lod=lod)


def _views(actor: str) -> Iterator[Scene]:
    cameras: tuple[tuple[View, float, float, float], ...] = (
        ("three_quarter", 5.0, 1.3, 24.0),
        ("side", 5.0, 1.3, 24.0),
        ("front", 5.0, 1.3, 24.0),
        ("legs", 2.6, 0.55, 26.0),
    )
    return (_one(actor, 0.12, camera=Camera(*camera)) for camera in cameras)


def _styled(style: str | None) -> Scene:
    """M1 at 1.1 m/s in a style, or in his own; named under the picture."""
    making = Making(style=style)
    step_frequency = walk_of("M1", "", making, 1.1).step_frequency
    walker = Walker("M1", 1.1, step_frequency, 0.02, making=making)
    return Scene((walker,), CLOSE, caption=(style or "his own").replace("_", " "))


def _treadmill() -> Iterator[Scene]:
    for actor, camera in (("M1", Camera("side", 4.6, 1.2, 30.0)), ("F1", Camera("three_quarter", 5.0, 1.6, 30.0))):
        yield replace(_one(actor, 0.1, camera=camera), ground="treadmill")


def _pair() -> Scene:
    """Two walkers to compare, as a participant sees them."""
    camera = Camera("three_quarter", 5.5, 1.5, 24.0)
    other = _one("M2", 0.56, camera=camera)
    return replace(_one("F2", 0.06, camera=camera), beside=other, caption="Which walk looks more natural?")


def _street() -> Iterator[Scene]:
    """Somebody who comes towards the viewer, and thirty people from above."""
    approaching = Walker("F4", 1.2, 105.0, 0.1, place=(0.4, -7.5))
    yield Scene((approaching,), Camera("first_person", height=1.62, field_of_view=45.0, place=(0.0, 0.0)), "street")
    rng = Random("thirty people")
    walkers = []
    for x, z in product(range(5), range(6)):
        place = (2.4 * (x - 2) + rng.uniform(-0.7, 0.7), 3.0 * (z - 3) + rng.uniform(-0.9, 0.9))
        actor = rng.choice(("F1", "F2", "F3", "F5", "M1", "M2", "M4", "M6"))
        walkers.append(Walker(actor, 1.2, rng.uniform(98.0, 112.0), rng.random(), place=place))
    yield Scene(tuple(walkers), Camera("elevated", 17.0, 8.0, 32.0, heading=160.0), "street")


def _crowd(size: int) -> Scene:
    return Scene((), Camera("elevated", 34.0, 10.0, 40.0, 180.0), "street", crowd=Crowd(size, seed=6, seconds=2.0))


def _trial(name: str, seconds: float = 1.2) -> Scene:
    """A trial of a shipped study as its participants see it so long after it began: the first condition."""
    study = read_study(name).study
    return walking(study, condition_of(study, []), seconds)


def _parts(path: Path) -> Path:
    """The picture of a walker beside its body-part map, regions in colours, joints in shades."""
    context = offscreen_context()
    target = context.simple_framebuffer(TILE)
    renderer = Renderer(context, TILE, 1.0, 4)
    scene = _one("M1", 0.12)
    renderer.draw(scene, drawn_walkers(scene), target)
    pixels = renderer.read_pixels(target)
    parts = renderer.draw_parts()
    renderer.release()
    context.release()
    assert parts is not None
    save_picture(np.hstack([pixels, coloured(parts)]), path)
    return path


def coloured(parts: PartMap) -> Pixels:
    """(H, W, 3) a body-part map to look at."""
    from experiment_app.render.part_map import part_of

    table = np.full((len(JOINTS) + 1, 3), 32, np.uint8)
    for index, joint in enumerate(JOINTS):
        part = part_of(joint, 0)
        shade = {"left": 1.0, "middle": 0.85, "right": 0.7}.get(part.side, 1.0) * (1.0 - 0.12 * (index % 2))
        table[index + 1] = np.round(np.array(PART_COLOURS[part.region]) * shade)
    return table[parts.codes[..., 0]]

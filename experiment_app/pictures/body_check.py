"""The picture of `gaitlab body check`: a character walking, and any model as its file shows it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from experiment_app.pictures.film import Pixels, save_picture
from experiment_app.render.drawn import DrawnWalker
from experiment_app.render.renderer import Renderer
from experiment_app.scene import Camera, Scene, View, Walker
from experiment_app.windows.offscreen import offscreen_context
from stimuli.actors import load_actor
from stimuli.bodies.known import scaled
from stimuli.bodies.retarget import on_its_own_soles
from stimuli.body_files.imported import import_body
from stimuli.body_files.shown import fitted, looked_at, read_shown
from stimuli.skeleton import JOINTS
from stimuli.walker import drawn_pose, skin_matrices

SIZE = (400, 480)
"""Pixels of each view."""

SPEED, STEP_FREQUENCY = 1.2, 105.0
DISTANCE, HEIGHT, FIELD_OF_VIEW = 4.6, 1.2, 28.0

STILL = np.tile(np.eye(3, 4, dtype=np.float32), (len(JOINTS), 1, 1))

Shot = tuple[Scene, DrawnWalker]


def draw_check(file: Path, path: Path, walking: bool) -> list[str]:
    """Draws a file to `path` (PNG), and says what is seen there.

    walking: also draws it as a walker, frontal, three-quarter, side and legs, in a row above.
    """
    rows = [list(walking_views(file))] if walking else []
    rows.append(list(file_views(file)))
    save_picture(np.vstack([np.hstack(row) for row in drawn(rows)]), path)
    moving = looked_at(read_shown(file))
    seen = "at rest" if moving is None else f"at rest and in {moving[0].name or 'its animation'} at {moving[1]:.2f} s"
    above = "walking as M1, and below " if walking else ""
    return [f"Picture: {path} ({above}as the file shows it, {seen})"]


def drawn(rows: list[list[Shot]]) -> list[list[Pixels]]:
    """Every shot as pixels (height, width, 3)."""
    context = offscreen_context()
    target = context.simple_framebuffer(SIZE)
    renderer = Renderer(context, SIZE, 1.0, 4)
    pictures: list[list[Pixels]] = []
    for row in rows:
        pictures.append([])
        for scene, walker in row:
            renderer.draw(scene, (walker,), target)
            pictures[-1].append(renderer.read_pixels(target))
    renderer.release()
    context.release()
    return pictures


def walking_views(file: Path) -> Iterator[Shot]:
    """The character walking as M1 on its own soles. Raises BodyError for a file that cannot walk."""
    body = import_body(file)
    actor = load_actor("M1", body)
    grown = scaled(body, actor.height)
    actor = on_its_own_soles(actor, grown)
    views: tuple[tuple[View, float], ...] = (("front", 0.0), ("three_quarter", 0.3), ("side", 0.0), ("legs", 0.6))
    for view, phase in views:
        pose = drawn_pose(actor, SPEED, STEP_FREQUENCY, phase)
        yield _scene(view, phase), DrawnWalker(grown, skin_matrices(actor, pose))


def file_views(file: Path) -> Iterator[Shot]:
    """What a file shows, still: front and three-quarter, at rest and in its animation, or else side and back."""
    shown = read_shown(file)
    moving = looked_at(shown)
    rest = DrawnWalker(fitted(shown).body, STILL)
    yield _scene("front", caption="at rest"), rest
    yield _scene("three_quarter"), rest
    if moving is None:
        yield _scene("side"), rest
        yield _scene("front", heading=0.0), rest
        return
    moved = DrawnWalker(fitted(shown, moving).body, STILL)
    yield _scene("front", caption=f"{moving[0].name or 'animation'}, {moving[1]:.2f} s"), moved
    yield _scene("three_quarter"), moved


def _scene(view: View, phase: float = 0.0, heading: float | None = None, caption: str = "") -> Scene:
    camera = Camera(view, DISTANCE, HEIGHT, FIELD_OF_VIEW, heading)
    return Scene((Walker("M1", SPEED, STEP_FREQUENCY, phase),), camera, caption=caption)

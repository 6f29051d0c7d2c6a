"""Any glTF file as it shows itself, person or not: at rest, or at one time of an animation, to be looked at.

Nothing is retargeted: all joints of the file move all its vertices, props included, and what comes out is still.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from stimuli.bodies.body import Body, Surface
from stimuli.body_files.animation import Animation, moved_nodes, read_animations
from stimuli.body_files.container import Container, open_container
from stimuli.body_files.errors import BodyError
from stimuli.body_files.materials import Material, read_materials
from stimuli.body_files.placing import Placed, placed_primitives
from stimuli.body_files.scene import GltfScene, read_scene
from stimuli.body_files.surfaces import MOST_MATERIALS, merged, surface_of
from stimuli.skeleton import JOINTS, Floats, Skeleton

TALLEST, WIDEST = 1.75, 1.6
"""m, into which a model is fitted to be drawn, whatever its unit."""

LOOKED_AT = 0.37
"""Of an animation's length, when it is looked at: half-way many are back where they began, or its mirror image."""

WALKING = "walk"
"""In the name of the animation that is looked at, if the file has one of these; else its first."""


BREAKS = (KeyError, IndexError, TypeError, AttributeError, ValueError, OverflowError)
"""What reading a file that breaks glTF's own rules may raise."""

NOWHERE = np.zeros((len(JOINTS), 3))
NOWHERE[0] = (0.0, 1000.0, 0.0)
"""Places of joints, far above: a model need not have feet, and none shall darken the ground."""


@dataclass(frozen=True, eq=False)
class ShownFile:
    """A file's geometry with how it looks and moves.

    problems: sentences about pictures that are missing and animations that can't be read.
    """

    name: str
    scene: GltfScene
    animations: tuple[Animation, ...]
    materials: dict[int | None, Material]
    problems: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Fitted:
    """A still model to draw, standing on the ground: metres of it = scale * the file's units + shift (3,)."""

    body: Body
    scale: float
    shift: Floats


def read_shown(path: Path) -> ShownFile:
    """The geometry, looks and animations of a file; raises BodyError when there is nothing to be seen."""
    container = open_container(path)
    try:
        return _read(container, path)
    except BodyError:
        raise
    except BREAKS as error:
        raise BodyError(f"{path.name}: the file breaks glTF's own rules ({type(error).__name__})") from error


def _read(container: Container, path: Path) -> ShownFile:
    scene = read_scene(container, path.name)
    if not any(len(placed.primitive.triangles) for placed in placed_primitives(scene)):
        raise BodyError(f"{path.name}: it shows no triangles")
    material = read_materials(container, path)
    materials = {primitive.material: material(primitive.material) for primitive in scene.primitives}
    problems = [m.problem for m in materials.values() if m.problem]
    animations: tuple[Animation, ...] = ()
    try:
        animations = read_animations(container, path.name)
    except (BodyError, *BREAKS) as error:  # what stands still can still be looked at
        problems.append(f"its animations can't be read ({error}); it is shown at rest.")
    return ShownFile(path.name, scene, animations, materials, tuple(dict.fromkeys(problems)))


def looked_at(file: ShownFile) -> tuple[Animation, float] | None:
    """The animation to look at and the time in it (s); None for a file without one."""
    moving = [animation for animation in file.animations if animation.channels]
    if not moving:
        return None
    chosen = next((a for a in moving if WALKING in a.name.lower()), moving[0])
    start = min(float(channel.times[0]) for channel in chosen.channels)
    end = max(float(channel.times[-1]) for channel in chosen.channels)
    return chosen, start + LOOKED_AT * (end - start)


def fitted(file: ShownFile, at: tuple[Animation, float] | None = None) -> Fitted:
    """The file's model at rest, or at a time (s) of an animation, in the size and place in which it is drawn.

    The size is that in which both the model at rest and what is `looked_at` find room.
    """
    scale = min(_room_for(file, moment) for moment in {None, looked_at(file)})
    seen = _seen(file, at)
    low, high = _box(seen)
    shift = -scale * np.array([0.5 * (low[0] + high[0]), low[1], 0.5 * (low[2] + high[2])])
    surfaces = merged(tuple(_still(file, placed, scale * placed.points + shift) for placed in seen))
    body = Body(file.name, Skeleton(NOWHERE), scale * float(high[1] - low[1]), (_few(surfaces),))
    return Fitted(body, scale, shift)


def _seen(file: ShownFile, at: tuple[Animation, float] | None) -> list[Placed]:
    nodes = file.scene.nodes if at is None else moved_nodes(file.scene.nodes, *at)
    return [placed for placed in placed_primitives(replace(file.scene, nodes=nodes)) if len(placed.primitive.triangles)]


def _box(seen: Sequence[Placed]) -> tuple[Floats, Floats]:
    points = np.concatenate([placed.points for placed in seen])
    return points.min(axis=0), points.max(axis=0)


def _room_for(file: ShownFile, at: tuple[Animation, float] | None) -> float:
    """m per unit of the file at which the model fits into TALLEST and WIDEST."""
    low, high = _box(_seen(file, at))
    wide, tall = float(np.hypot(high[0] - low[0], high[2] - low[2])), float(high[1] - low[1])
    if at is None and wide + tall == 0.0:
        raise BodyError(f"{file.name}: all its vertices lie in one place")
    return min(TALLEST / max(tall, 1e-12), WIDEST / max(wide, 1e-12))


def _still(file: ShownFile, placed: Placed, positions: Floats) -> Surface:
    """A primitive, moved to where it is drawn (V, 3), as a surface that one joint holds still."""
    joints = np.zeros((len(positions), 4), np.int64)
    weights = np.tile([1.0, 0.0, 0.0, 0.0], (len(positions), 1))
    return surface_of(file.materials[placed.primitive.material], replace(placed, points=positions), joints, weights)


def _few(surfaces: Sequence[Surface]) -> tuple[Surface, ...]:
    """As many surfaces as can be drawn at once: those beyond look alike, without pictures."""
    first, rest = surfaces[: MOST_MATERIALS - 1], surfaces[MOST_MATERIALS - 1 :]
    if len(rest) < 2:
        return tuple(surfaces)
    alike = [
        replace(s, name="others", colour=rest[0].colour, roughness=1.0, picture=None, picture_at=None, alpha="opaque",
                alpha_cutoff=0.5, alpha_factor=1.0, double_sided=True)
        for s in rest
    ]  # fmt: skip
    return (*first, *merged(tuple(alike)))

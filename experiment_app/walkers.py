"""A scene's walkers to bodies and joint matrices, ready for the renderer, and what they measure as drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from zlib import crc32

import numpy as np

from experiment_app.crowds import drawn_crowd, measured_crowd
from experiment_app.render.drawn import Drawn, DrawnCrowd, DrawnWalker
from experiment_app.scene import Scene, Walker
from stimuli.actors import Actor, load_actor, person_of, tree_of
from stimuli.bodies.body import Body
from stimuli.bodies.imported_bodies import OWN_BUILD
from stimuli.bodies.known import body_for, comes_with_gaitlab, in_the_build_of, load_body, scaled
from stimuli.bodies.point_light import FIGURES, figure_lines, resting
from stimuli.bodies.retarget import on_its_own_soles
from stimuli.measure import delivered_gait
from stimuli.methods.actor_walks import step_frequency_of
from stimuli.methods.delivery import delivered
from stimuli.methods.made import MadeWalk, made_walk
from stimuli.methods.recipe import Making
from stimuli.skeleton import Floats
from stimuli.walker import drawn_pose, skin_matrices


@cache
def cast(actor: str, body: str) -> tuple[Actor, Body]:
    """The actor, and the body at the actor's height that wears the motion; body "" is the actor's own.

    matched and mismatched are the shipped bodies of the actor's sex and of the other, own_build is the matched one in
    the actor's build. A figure without a body (point_light, stick_figure, ...) moves on the joints of the actor's own
    body. Raises ActorError or BodyError for a name that is not known.
    """
    if not body or body in FIGURES:
        chosen = load_actor(actor)
        return chosen, scaled(load_body(chosen.body), chosen.height)
    name = body_for(person_of(actor).sex, body)
    worn = load_body(name)
    chosen = load_actor(actor, worn)
    grown = scaled(worn, chosen.height)
    if body == OWN_BUILD:
        return chosen, in_the_build_of(grown, chosen.sex, chosen.weight, chosen.height)
    return (chosen if comes_with_gaitlab(name) else on_its_own_soles(chosen, grown)), grown


@cache
def _resting_markers(actor: str) -> Floats:
    chosen, body = cast(actor, "")
    return resting(body.skeleton, chosen.height)


def drawn_walkers(scene: Scene) -> tuple[Drawn, ...]:
    """Every walker of the scene and its crowd, then those of the scene beside it, posed and in place."""
    drawn: tuple[Drawn, ...] = tuple(
        _drawn(walker, scene.ground == "treadmill", scene.marks.seed) for walker in scene.walkers
    )
    if scene.crowd is not None:
        drawn += (drawn_crowd(scene.crowd),)
    return drawn + (drawn_walkers(scene.beside) if scene.beside is not None else ())


def _drawn(walker: Walker, on_the_spot: bool, seed: int) -> DrawnWalker:
    actor, body = cast(walker.actor, walker.body)
    x, z = walker.place
    matrices = _matrices(actor, walker)
    lines = None
    if walker.body in FIGURES:
        lines = figure_lines(walker.body, _resting_markers(walker.actor), matrices, actor.height, seed)
    return DrawnWalker(body, matrices, (x, 0.0, z if on_the_spot else z + walker.distance), lines)


def _matrices(actor: Actor, walker: Walker) -> Floats:
    """(21, 3, 4) float32 of the walker's pose, as captured or as made; a walk of a larger person is drawn larger."""
    if walker.making is None:
        return skin_matrices(actor, drawn_pose(actor, walker.speed, walker.step_frequency, walker.phase))
    walk = made_walk(actor, walker.making, walker.speed)
    return np.float32(walk.size) * skin_matrices(actor, walk.pose(walker.phase))


def walk_of(actor: str, body: str, making: Making, speed: float) -> MadeWalk:
    """The walk a making gives this actor at a speed (m/s); made once, so that a trial can begin without waiting.

    Raises MethodError or CoverageError, with a sentence, where it cannot be made.
    """
    return made_walk(cast(actor, body)[0], making, speed)


def pose_checksum(drawn: Sequence[Drawn]) -> str:
    """8 hexadecimal digits that tell whether the same poses were drawn at the same places; "" without walkers.

    CRC-32 of matrices and places in whole units of 1e-4 (0.1 mm for places), so that two computers whose
    processors round differently in the last digit agree.
    """
    if not drawn:
        return ""
    checksum = 0
    for each in drawn:
        values = each.rows if isinstance(each, DrawnCrowd) else np.append(each.matrices.ravel(), each.place)
        checksum = crc32(np.rint(values * 1e4).astype("<i4").tobytes(), checksum)
    return f"{checksum:08x}"


@cache
def own_step_frequency(actor: str, body: str, making: Making | None, speed: float) -> float:
    """steps/min that a walk has by itself at a speed (m/s), as captured or as made."""
    if making is None:
        return step_frequency_of(tree_of(actor), person_of(actor).walk_ratio, speed)
    return walk_of(actor, body, making, speed).step_frequency


def measured_gait(scene: Scene) -> dict[str, float]:
    """Speed (m/s), step frequency (steps/min), step length (m), walk ratio (m·min) and foot slide (mm) as drawn.

    Of the scene's first walker, or what measured_crowd says of its crowd; empty without either. Those of the
    scene beside it are called beside_speed and so on.
    """
    if scene.beside is not None:
        beside = {f"beside_{name}": value for name, value in measured_gait(scene.beside).items()}
        return measured_gait(replace(scene, beside=None)) | beside
    if scene.crowd is not None:
        return measured_crowd(scene.crowd)
    if not scene.walkers:
        return {}
    walker = scene.walkers[0]
    actor = cast(walker.actor, walker.body)[0]
    if walker.making is not None:
        return _measured_making(actor, walker, walker.making)
    gait = delivered_gait(actor, walker.speed, walker.step_frequency)
    return {
        "speed": gait.speed,
        "step_frequency": gait.step_frequency,
        "step_length": gait.step_length,
        "walk_ratio": gait.walk_ratio,
        "slide_mean_mm": gait.slide_mean,
        "slide_peak_mm": gait.slide_peak,
    }


def _measured_making(actor: Actor, walker: Walker, making: Making) -> dict[str, float]:
    gait = delivered(made_walk(actor, making, walker.speed).at_gait(walker.speed, walker.step_frequency))
    step_length = 60.0 * gait.speed / gait.step_frequency
    return {
        "speed": gait.speed,
        "step_frequency": gait.step_frequency,
        "step_length": step_length,
        "walk_ratio": step_length / gait.step_frequency,
        "slide_mean_mm": gait.slide,
        "slide_peak_mm": gait.slide_peak,
    }

"""An actor's walk at a speed, made by the method that a `Making` names, ready to be drawn at any phase.

The actor is any, default or imported, on any body. What a method starts from are the actor's own captured walks, never
the one at the speed asked for unless `source_speed` says so. Knows no clock and no GPU.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from stimuli.actors import Actor
from stimuli.blend_tree import Branch, Tree, coverage
from stimuli.cycle import Cycle
from stimuli.kinematics import world_matrices
from stimuli.measure import sole_points
from stimuli.methods.actor_walks import actor_speeds, actor_walk, natural_step_frequency
from stimuli.methods.blend import blend_to_speed
from stimuli.methods.errors import MethodError
from stimuli.methods.fourier import between, fourier_to_speed, fourier_walk, synthesised
from stimuli.methods.making import hips_at, leg_length, rotations_at
from stimuli.methods.pca import PcaWalk, pca_walk
from stimuli.methods.recipe import Making
from stimuli.methods.styles import style_named, styled
from stimuli.methods.timewarp import timewarp
from stimuli.poulaine.regression import Change
from stimuli.poulaine.walking import poulaine_to_speed, poulaine_to_walk_ratio, poulaine_walk
from stimuli.skeleton import Pose

SAME_SPEED = 0.05
"""m/s: a captured walk this near to the speed asked for counts as the walk at that speed."""


@dataclass(frozen=True, eq=False)
class MadeWalk:
    """A walk that a method made, on the skeleton of the actor it was made of.

    cycle: the walk, its hips placed so that the soles meet the ground; on a skeleton `size` times the actor's.
    """

    cycle: Cycle
    size: float

    @property
    def step_frequency(self) -> float:
        """steps/min at which it walks at its speed without sliding more than the method makes it; 0 for standing."""
        return self.cycle.gait.step_frequency

    def pose(self, phase: float) -> Pose:
        """The pose at any phase, on the actor's own skeleton: what is drawn is `size` times as large."""
        at = np.array([phase])
        return Pose(hips_at(self.cycle, at)[0] / self.size, rotations_at(self.cycle, at)[0])

    def at_gait(self, speed: float, step_frequency: float) -> Cycle:
        """The cycle as it is shown when moved at a speed (m/s) and played at a positive step frequency (steps/min)."""
        return replace(self.cycle, stride_length=120.0 * speed / step_frequency, stride_time=120.0 / step_frequency)


@lru_cache(maxsize=1024)
def made_walk(actor: Actor, making: Making, speed: float) -> MadeWalk:
    """The walk of an actor at a speed (m/s), by a method.

    Raises MethodError or CoverageError, with a sentence, for a walk that cannot be made.
    """
    cycle = _MAKERS[making.method](actor, making, speed)
    size = leg_length(cycle) / actor.figure.leg_length
    return MadeWalk(cycle if making.method == "captured" else _grounded(actor, cycle, size), size)


def captured_speeds(actor: Actor) -> tuple[float, ...]:
    """m/s of the cycles that the actor's blend tree is made of, increasing."""
    return tuple(sorted(_speeds(actor.tree)))


def _speeds(tree: Tree) -> set[float]:
    if not isinstance(tree, Branch):
        return set()
    own = set(tree.places) if tree.parameter == "speed" else set()
    return own.union(*(_speeds(child) for child in tree.children))


def _others(actor: Actor, speed: float) -> list[float]:
    others = [other for other in captured_speeds(actor) if abs(other - speed) > SAME_SPEED]
    if not others:
        raise MethodError(f"{actor.name} was captured at no other speed than {speed:.2f} m/s to make a walk from")
    return others


def _source(actor: Actor, making: Making, speed: float) -> Cycle:
    """The captured walk a method starts from: at `source_speed`, or at the nearest other captured speed."""
    chosen = making.source_speed
    if chosen is None:
        chosen = min(_others(actor, speed), key=lambda other: abs(other - speed))
    return _walk(actor, making, chosen)


def _around(actor: Actor, making: Making, speed: float) -> tuple[Cycle, Cycle]:
    """The captured walks just below and above a speed; `source_speed` takes the place of the one on its side."""
    others = _others(actor, speed)
    below, above = [s for s in others if s < speed], [s for s in others if s > speed]
    given = making.source_speed
    if given is not None:
        below, above = ([given], above) if given < speed else (below, [given])
    if not below or not above:
        known = ", ".join(f"{s:.2f}" for s in captured_speeds(actor))
        raise MethodError(
            f"{actor.name} at {speed:.2f} m/s by {making.method}: it needs captured walks below and above that speed, "
            f"and there are {known} m/s"
        )
    slower, faster = (_walk(actor, making, s) for s in (max(below), min(above)))
    return slower, faster


def _walk(actor: Actor, making: Making, speed: float) -> Cycle:
    """The actor's captured walk at a speed (m/s), in the making's style."""
    if making.style is None:
        return _drawn(actor, speed, making.step_frequency)
    return _drawn(styled(actor, making.style), speed, making.step_frequency or _tempo(actor, making.style, speed))


def _tempo(actor: Actor, style: str, speed: float) -> float:
    """steps/min of a style at a speed (m/s): the actor's own times the style's, within what the actor covers."""
    own = natural_step_frequency(actor, speed)
    low, high = coverage(actor.tree).get("step_frequency", (own, own))
    return min(max(own * style_named(style).step_frequency, low), high)


@lru_cache(maxsize=512)
def _drawn(actor: Actor, speed: float, step_frequency: float | None) -> Cycle:
    return actor_walk(actor, speed, step_frequency)


@lru_cache(maxsize=64)
def _engine(walks: tuple[Cycle, ...]) -> PcaWalk:
    return pca_walk(walks)


def _captured(actor: Actor, making: Making, speed: float) -> Cycle:
    if making.source_speed not in (None, speed):
        raise MethodError(f"a captured walk at {speed:.2f} m/s is not made from one at {making.source_speed:g} m/s")
    return _walk(actor, making, speed)


def _blend(actor: Actor, making: Making, speed: float) -> Cycle:
    return blend_to_speed(_around(actor, making, speed), speed)


def _timewarp(actor: Actor, making: Making, speed: float) -> Cycle:
    return timewarp(_source(actor, making, speed), speed)


def _fourier(actor: Actor, making: Making, speed: float) -> Cycle:
    if making.style is not None or making.source_speed == speed:
        walk = fourier_walk(_walk(actor, making, speed), making.harmonics)
        if making.share != 1.0:
            own = fourier_walk(_walk(actor, replace(making, style=None, share=1.0), speed), making.harmonics)
            walk = between(own, walk, making.share)
        return replace(made := synthesised(walk), stride_time=made.stride_length / speed)
    return fourier_to_speed(*_around(actor, making, speed), speed, making.harmonics)


def _pca(actor: Actor, making: Making, speed: float) -> Cycle:
    speeds: Sequence[float] = _others(actor, speed)
    if len(speeds) < 3:
        speeds = [float(s) for s in actor_speeds(actor) if abs(s - speed) > SAME_SPEED]
    engine = _engine(tuple(_walk(actor, making, s) for s in speeds))
    leg = None if making.height is None else engine.leg_length * making.height / actor.height
    return engine.cycle(speed, leg)


def _poulaine(actor: Actor, making: Making, speed: float) -> Cycle:
    if making.walk_ratio is not None:
        source = _walk(actor, making, speed)
        return poulaine_to_walk_ratio(source, making.walk_ratio, making.table, making.points)
    change = _change(actor, making)
    if making.source_speed == speed and change == Change():
        return poulaine_walk(_source(actor, making, speed), making.points, making.interpolation)
    source = _source(actor, making, speed)
    return poulaine_to_speed(source, speed, making.table, change, making.points, interpolation=making.interpolation)


def _change(actor: Actor, making: Making) -> Change:
    """What the poulaine's regression is to change about the person; woman is coded 1 (see docs/methods.md)."""
    taller = 0.0 if making.height is None else making.height - actor.height
    gender = 0.0 if making.sex in (None, actor.sex) else (1.0 if making.sex == "F" else -1.0)
    return Change(height=taller, gender=gender)


_MAKERS = {
    "captured": _captured,
    "blend": _blend,
    "timewarp": _timewarp,
    "fourier": _fourier,
    "pca": _pca,
    "poulaine": _poulaine,
}


def _grounded(actor: Actor, cycle: Cycle, size: float) -> Cycle:
    """The walk raised or lowered by a constant, so that the lower foot's sole is at the ground half of the time.

    A method moves ankles without looking at the soles; a constant keeps everything else it made.
    """
    world = world_matrices(actor.skeleton, Pose(cycle.hips / size, cycle.rotations))
    lowest = sole_points(actor.skeleton, actor.figure.sole, world)[..., 1].min(axis=(1, 2))
    return replace(cycle, hips=cycle.hips - [0.0, size * float(np.median(lowest)), 0.0])

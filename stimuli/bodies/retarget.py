"""An actor's motion on a character of somebody else: the feet roll on that character's own soles.

World rotations, the alignment of the rest pose and the two-bone legs are those of every body (retarget.py, legs.py).
What differs between characters is the shoe: `sole_of` takes heel, ball and tip from the mesh, so that the foot's
contact (contact.py), which places the ankle for the leg's inverse kinematics, touches the ground with the vertices
that are drawn.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from stimuli.actors import CYCLE_SPEEDS, METRONOME, Actor
from stimuli.blend import SIDES
from stimuli.bodies.body import Body, Surface
from stimuli.bodies.skinning import skin
from stimuli.legs.contact import Sole
from stimuli.measure import delivered_gait
from stimuli.retarget import Figure
from stimuli.skeleton import JOINTS, Floats, Skeleton
from stimuli.walker import drawn_pose, skin_matrices, standing

SLIDES = 5.0
"""mm, drift of a standing foot from which it is said to slide."""

ROLLS = np.radians(np.linspace(4.0, 32.0, 15))
"""Pitches of a foot from heel strike until it stands flat (20 to 30 degrees and less, Winter 1991), and of toes as they
leave the ground."""

STIFF_ROLLS = np.radians(np.linspace(4.0, 64.0, 31))
"""Pitches, heel up, of a foot without toes that bend, which rolls over its tip as far as a heel rises."""

PIVOTS_TRIED = 201

_TOES = [JOINTS.index("leftToes"), JOINTS.index("rightToes")]


@dataclass(frozen=True, eq=False)
class FittedFigure(Figure):
    """A skeleton whose soles are known from its mesh."""

    fitted: Sole

    @cached_property
    def sole(self) -> Sole:
        """The sole (m) fitted to the body's own shoes."""
        return self.fitted


def on_its_own_soles(actor: Actor, body: Body) -> Actor:
    """The actor walking on the soles of the body it wears, which is already at the actor's height."""
    sole, skeleton = sole_of(body), actor.figure.skeleton
    if len(_carried(body, "rightToes")) == 0:  # the joint of toes that move nothing is where such a foot rolls
        offsets = np.array(skeleton.offsets)
        offsets[_TOES, 1], offsets[_TOES, 2] = sole.ball_height - sole.ankle_height, sole.ball
        skeleton = Skeleton(offsets)
    return replace(actor, figure=FittedFigure(skeleton, sole))


def sole_of(body: Body) -> Sole:
    """Heel, ball and tip of the right foot as drawn; a foot whose toes move nothing rolls over its tip.

    Heel and tip are where a foot turned by ROLLS about them would touch: for a rounded shoe a little beyond its flat
    part, so that what is round neither sinks nor floats much.
    """
    foot, toes = _carried(body, "rightFoot"), _carried(body, "rightToes")
    places = body.skeleton.positions
    ankle, joint = places[JOINTS.index("rightFoot")], places[JOINTS.index("rightToes")]
    everything = np.concatenate([foot, toes])
    if len(everything) == 0:
        return Sole.of(body.skeleton)
    ground = float(everything[:, 1].min())
    height = float(ankle[1]) - ground
    heel = max(_pivot(everything - ankle, height, ROLLS), 0.01)
    ball, ball_height = float(joint[2] - ankle[2]), max(float(joint[1]) - ground, 0.0)
    if len(toes) >= 3 and ball > 0.02:
        ahead = _pivot(toes - joint, ball_height, -ROLLS)
        if ahead > 0.0:
            return Sole(height, heel, ball, ball_height, ball + ahead)
    tip = max(_pivot(everything - ankle, height, -STIFF_ROLLS), 0.02)
    return Sole(height, heel, tip, 0.0, tip)


def _pivot(points: Floats, height: float, pitches: Floats) -> float:
    """m along the ground from a joint to the point it rolls on when turned by pitches (P,) rad, toes-up positive.

    points: (N, 3) m from the joint, which stands `height` above the ground. A sharp edge has one such point; of a round
    one it moves, and the one is chosen whose largest height above or below the ground is least.
    """
    up = points[:, 1:2] * np.cos(pitches) + points[:, 2:3] * np.sin(pitches)
    sizes = np.sin(np.abs(pitches))
    exact = (-up.min(axis=0) - height * np.cos(pitches)) / sizes
    tried = np.linspace(float(exact.min()), float(exact.max()), PIVOTS_TRIED)
    return float(tried[np.argmin(np.max(np.abs(tried[:, None] - exact) * sizes, axis=1))])


def sole_gaps(
    actor: Actor, body: Body, gait: tuple[float, float] | None = None, phases: int = 48
) -> tuple[float, float]:
    """mm: lowest place of any drawn sole vertex over a cycle, and highest place of the lowest one of a standing foot.

    Both would be 0 for a perfect sole; negative is below the ground. gait: speed (m/s) and step frequency (steps/min),
    the actor's comfort if left out.
    """
    speed, step_frequency = gait or (actor.comfort_speed, actor.comfort_step_frequency)
    feet = [_foot_alone(body, side) for side in SIDES]
    lowest, highest = 0.0, 0.0
    for number in range(phases):
        phase = number / phases
        matrices = skin_matrices(actor, drawn_pose(actor, speed, step_frequency, phase))
        for foot, stands in zip(feet, standing(actor, speed, step_frequency, phase), strict=True):
            if foot:
                up = min(float(skin(part, matrices)[0][:, 1].min()) for part in foot)
                lowest = min(lowest, up)
                highest = max(highest, up) if stands else highest
    return 1000.0 * lowest, 1000.0 * highest


def longest_step(actor: Actor) -> tuple[float, float]:
    """m: the longest step that the actor's legs make without a slide, and the longest it is asked for.

    Looked for at the slowest step frequency the default actors walk at, over their speeds; what slides by more than
    SLIDES is a leg too short for the step (walker.py).
    """
    slowest = METRONOME[0]
    made = 0.0
    for speed in np.linspace(CYCLE_SPEEDS[0], CYCLE_SPEEDS[-1], 25):
        try:
            slide = delivered_gait(actor, float(speed), slowest, samples=120).slide_peak
        except ValueError:  # a foot that drags so much strikes twice or never
            break
        if slide > SLIDES:
            break
        made = 60.0 * float(speed) / slowest
    return made, 60.0 * CYCLE_SPEEDS[-1] / slowest


def _foot_alone(body: Body, side: str) -> list[Surface]:
    """The parts of the finest level that a foot or its toes carry most."""
    indices = [JOINTS.index(f"{side}Foot"), JOINTS.index(f"{side}Toes")]
    parts = []
    for s in body.levels[0]:
        own = np.isin(s.joints[np.arange(len(s.joints)), np.argmax(s.weights, axis=1)], indices)
        if own.any():
            parts.append(
                replace(s, positions=s.positions[own], normals=s.normals[own], joints=s.joints[own],
                        weights=s.weights[own])
            )  # fmt: skip
    return parts


def _carried(body: Body, joint: str) -> Floats:
    """(N, 3) m: vertices of the finest level that a joint carries most."""
    index = JOINTS.index(joint)
    parts = []
    for surface in body.levels[0]:
        heaviest = surface.joints[np.arange(len(surface.joints)), np.argmax(surface.weights, axis=1)]
        parts.append(surface.positions[heaviest == index])
    return np.concatenate(parts)

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

from stimuli.actors import Actor
from stimuli.bodies.body import Body
from stimuli.bodies.skinning import skin
from stimuli.legs.contact import Sole
from stimuli.retarget import Figure
from stimuli.skeleton import JOINTS, Floats
from stimuli.walker import drawn_pose, skin_matrices

_FEET = [index for index, name in enumerate(JOINTS) if name.endswith(("Foot", "Toes"))]

ROLL = np.radians(20.0)
"""About the pitch of a foot at heel strike (Winter 1991), and of toes as they leave the ground."""


@dataclass(frozen=True, eq=False)
class FittedFigure(Figure):
    """A skeleton whose soles are known from its mesh."""

    fitted: Sole

    @cached_property
    def sole(self) -> Sole:
        return self.fitted


def on_its_own_soles(actor: Actor, body: Body) -> Actor:
    """The actor walking on the soles of the body it wears, which is already at the actor's height."""
    return replace(actor, figure=FittedFigure(actor.figure.skeleton, sole_of(body)))


def sole_of(body: Body) -> Sole:
    """Heel, ball and tip of the right foot as drawn; a foot whose toes move nothing rolls over its tip.

    Heel and tip are where a foot turned by ROLL about them would touch: for a rounded shoe a little beyond its flat
    part, so that what is round does not sink.
    """
    foot, toes = _carried(body, "rightFoot"), _carried(body, "rightToes")
    places = body.skeleton.positions
    ankle, joint = places[JOINTS.index("rightFoot")], places[JOINTS.index("rightToes")]
    everything = np.concatenate([foot, toes])
    if len(everything) == 0:
        return Sole.of(body.skeleton)
    ground = float(everything[:, 1].min())
    height = float(ankle[1]) - ground
    heel = max(_pivot(everything - ankle, height, ROLL), 0.01)
    ball, ball_height = float(joint[2] - ankle[2]), max(float(joint[1]) - ground, 0.0)
    if len(toes) >= 3 and ball > 0.02:
        ahead = _pivot(toes - joint, ball_height, -ROLL)
        if ahead > 0.0:
            return Sole(height, heel, ball, ball_height, ball + ahead)
    tip = max(_pivot(everything - ankle, height, -ROLL), 0.02)
    return Sole(height, heel, tip, 0.0, tip)


def _pivot(points: Floats, height: float, pitch: float) -> float:
    """m along the ground from a joint to the point it rolls on when turned toes-up by pitch; height: of the joint."""
    up = points[:, 1] * np.cos(pitch) + points[:, 2] * np.sin(pitch)
    return float((-up.min() - height * np.cos(pitch)) / np.sin(abs(pitch)))


def sole_gaps(actor: Actor, body: Body, phases: int = 48) -> tuple[float, float]:
    """mm: lowest and highest place of the lowest drawn sole vertex over a cycle at the actor's comfort.

    One foot always stands when walking, so both would be 0 for a perfect sole; negative is below the ground.
    """
    feet = [
        replace(s, positions=s.positions[low], normals=s.normals[low], joints=s.joints[low], weights=s.weights[low])
        for s in body.levels[0]
        if (low := np.isin(s.joints[np.arange(len(s.joints)), np.argmax(s.weights, axis=1)], _FEET)).any()
    ]
    if not feet:
        return 0.0, 0.0
    lowest = []
    for number in range(phases):
        pose = drawn_pose(actor, actor.comfort_speed, actor.comfort_step_frequency, number / phases)
        matrices = skin_matrices(actor, pose)
        lowest.append(min(float(skin(foot, matrices)[0][:, 1].min()) for foot in feet))
    return 1000.0 * min(lowest), 1000.0 * max(lowest)


def _carried(body: Body, joint: str) -> Floats:
    """(N, 3) m: vertices of the finest level that a joint carries most."""
    index = JOINTS.index(joint)
    parts = []
    for surface in body.levels[0]:
        heaviest = surface.joints[np.arange(len(surface.joints)), np.argmax(surface.weights, axis=1)]
        parts.append(surface.positions[heaviest == index])
    return np.concatenate(parts)

"""The walker as drawn: a pose at any speed, step frequency and phase, with feet that do not slide. Knows no clock.

`drawn_pose` blends the actor's cycles at one phase, places both feet by their footprints (contact.py) at exactly the
wanted stride, and bends the legs to them (legs.py). The caller advances phase by step_frequency / 120 per second and
the walker by speed per second along +Z.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from stimuli.blend import SIDES, UPPER, blend_body, blend_contacts, blend_foot
from stimuli.blend_tree import blend_weights
from stimuli.kinematics import skinning_matrices
from stimuli.kinematics import world_joints as world_joints
from stimuli.legs import contact, one_foot
from stimuli.legs.contact import Sole
from stimuli.legs.two_bone import FURTHEST, STRAIGHTEST, Leg, solve
from stimuli.one_rotation import Turn, Vector, heading, inverse, multiply, rotate, toes_up, w_not_negative
from stimuli.skeleton import JOINTS, Floats, Pose

if TYPE_CHECKING:
    from stimuli.actors import Actor

UPPER_INDICES = np.array([JOINTS.index(name) for name in UPPER])
LEG_INDICES = np.array(
    [JOINTS.index(f"{side}{part}") for side in SIDES for part in ("UpperLeg", "LowerLeg", "Foot", "Toes")]
)

LOWERING_SOFTNESS = 0.0003
"""m, within which the hips give way before a leg is at its straightest."""


def drawn_pose(actor: Actor, speed: float, step_frequency: float, phase: float) -> Pose:
    """The actor's pose as it is drawn.

    speed m/s, step_frequency steps/min, phase of the gait cycle (any number; 0 is the right heel strike).
    Raises CoverageError when speed and step frequency are outside the actor's blend tree.
    """
    weighted = blend_weights(actor.tree, {"speed": speed, "step_frequency": step_frequency})
    phase = phase - math.floor(phase)
    (x, y, z), upper = blend_body(actor.table, weighted, phase)
    pelvis: Turn = tuple(upper[0].tolist())
    hips = (float(x), float(y), float(z))
    *stances_and_aheads, left_strike = blend_contacts(actor.table, weighted).tolist()
    stride = 120.0 * speed / step_frequency
    legs = actor.figure.legs
    sockets = [rotate(pelvis, leg.socket) for leg in legs]
    feet = []
    for side in (0, 1):
        own = phase if side == 1 else (phase - left_strike) % 1.0
        stance, ahead = stances_and_aheads[side], stances_and_aheads[2 + side]
        clock = one_foot.clock(own, stance)
        channels = blend_foot(actor.table, side, weighted, clock)
        place = ahead + stride * one_foot.footprint_travel(own, stance)
        feet.append(_placed_foot(actor.figure.sole, channels, clock, place, stride))
    feet = [_nearer(leg, _sum(hips, socket), foot) for leg, socket, foot in zip(legs, sockets, feet, strict=True)]
    hips = (hips[0], hips[1] - _lowering(legs, hips, sockets, feet), hips[2])
    turns: list[Turn] = []
    for leg, socket, foot in zip(legs, sockets, feet, strict=True):
        thigh, shank = solve(leg, _sum(hips, socket), foot.ankle, foot.knee_yaw)
        turns += [
            multiply(inverse(pelvis), thigh),
            multiply(inverse(thigh), shank),
            multiply(inverse(shank), foot.turn),
            toes_up(foot.bend),
        ]
    rotations = np.empty((len(JOINTS), 4))
    rotations[UPPER_INDICES] = upper
    rotations[LEG_INDICES] = [w_not_negative(turn) for turn in turns]
    return Pose(hips=np.array(hips), rotations=rotations)


def standing(actor: Actor, speed: float, step_frequency: float, phase: float) -> tuple[bool, bool]:
    """Whether the left and the right foot stand at this phase of the drawn walk; arguments as for `drawn_pose`."""
    weighted = blend_weights(actor.tree, {"speed": speed, "step_frequency": step_frequency})
    contacts = blend_contacts(actor.table, weighted).tolist()
    own = ((phase - contacts[4]) % 1.0, phase % 1.0)
    return own[0] < contacts[0], own[1] < contacts[1]


@dataclass(frozen=True, eq=False)
class _Foot:
    """ankle m in the walker's frame; turn in the world; bend of the toes, yaw of the knee rad; clearance m."""

    ankle: Vector
    turn: Turn
    bend: float
    knee_yaw: float
    clearance: float


def _placed_foot(sole: Sole, channels: Floats, clock: float, place: float, stride: float) -> _Foot:
    """The foot over its footprint; channels as in blend.FOOT_CHANNELS, place of the footprint in m forward."""
    pitch, clearance, travel, side, yaw, knee_yaw = channels.tolist()
    pitch = contact.flattened(pitch)
    bend = one_foot.toe_bend(pitch, one_foot.swing_progress(clock))
    forward, up = one_foot.planted(sole, pitch, bend)
    ankle = (side + math.sin(yaw) * forward, up + clearance, place + stride * travel + math.cos(yaw) * forward)
    return _Foot(ankle, multiply(heading(yaw), toes_up(pitch)), bend, knee_yaw, clearance)


def _nearer(leg: Leg, hip: Vector, foot: _Foot) -> _Foot:
    """The foot, brought along the ground to where its leg reaches if the step is too long for it.

    It keeps its height, so that the sole neither sinks nor floats; what gives way is its place, and it slides.
    """
    x, up, z = foot.ankle
    aside, ahead = x - hip[0], z - hip[2]
    far, furthest = math.hypot(aside, ahead), FURTHEST * leg.length
    if far <= furthest:
        return foot
    share = furthest / far
    return replace(foot, ankle=(hip[0] + share * aside, up, hip[2] + share * ahead))


def _lowering(legs: Sequence[Leg], hips: Vector, sockets: Sequence[Vector], feet: Sequence[_Foot]) -> float:
    """m by which the hips come down so that both legs reach their feet; a soft maximum, so without a kink.

    Cycles are built so that legs reach; this takes up the last millimetres between them. A foot in the air may hang
    higher instead, by its clearance.
    """
    lowering = 0.0
    for leg, socket, foot in zip(legs, sockets, feet, strict=True):
        x, y, z = _sum(hips, socket)
        room = (STRAIGHTEST * leg.length) ** 2 - (foot.ankle[0] - x) ** 2 - (foot.ankle[2] - z) ** 2
        excess = (y - foot.ankle[1] - math.sqrt(max(room, 0.0)) - foot.clearance) / LOWERING_SOFTNESS
        lowering += LOWERING_SOFTNESS * one_foot.softly_positive(excess)
    return lowering


def _sum(first: Vector, second: Vector) -> Vector:
    return first[0] + second[0], first[1] + second[1], first[2] + second[2]


def skin_matrices(actor: Actor, pose: Pose) -> Floats:
    """(21, 3, 4) float32: bind-pose vertices of the actor's scaled body -> the walker's frame."""
    return skinning_matrices(actor.skeleton, pose)

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

from stimuli.blend import SIDES, UPPER, blend_body, blend_foot
from stimuli.blend_tree import blend_weights
from stimuli.kinematics import rotation_matrices, skinning_matrices
from stimuli.kinematics import world_joints as world_joints
from stimuli.legs import contact
from stimuli.legs.contact import Sole
from stimuli.legs.two_bone import FURTHEST, STRAIGHTEST, Leg, solve
from stimuli.rotations import from_matrix
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
    cycles = np.fromiter(weighted, dtype=np.intp)
    weights = np.fromiter(weighted.values(), dtype=np.float64)
    phase = phase - math.floor(phase)
    hips, upper = blend_body(actor.table, cycles, weights, phase)
    turn = rotation_matrices(upper[0])
    contacts = weights @ actor.table.contacts[cycles]
    stride = 120.0 * speed / step_frequency
    feet = []
    for side in (0, 1):
        own = phase if side == 1 else (phase - float(contacts[4])) % 1.0
        stance, ahead = float(contacts[side]), float(contacts[2 + side])
        clock = float(contact.clock(own, stance))
        channels = blend_foot(actor.table, side, cycles, weights, clock)
        place = ahead + stride * float(contact.footprint_travel(own, stance))
        feet.append(_placed_foot(actor.figure.sole, channels, clock, place, stride))
    sockets = [turn @ leg.hip for leg in actor.figure.legs]
    feet = [_nearer(*each) for each in zip(actor.figure.legs, (hips + socket for socket in sockets), feet, strict=True)]
    hips[1] -= _lowering(actor.figure.legs, hips, sockets, feet)
    turns = np.empty((8, 3, 3))
    for side, (leg, socket, foot) in enumerate(zip(actor.figure.legs, sockets, feet, strict=True)):
        x, y, z = (hips + socket).tolist()
        thigh, shank = solve(leg, (x, y, z), foot.ankle, foot.knee_yaw)
        turns[4 * side] = turn.T @ thigh
        turns[4 * side + 1] = thigh.T @ shank
        turns[4 * side + 2] = shank.T @ foot.turn
        turns[4 * side + 3] = _toes_up(foot.bend)
    rotations = np.empty((len(JOINTS), 4))
    rotations[UPPER_INDICES] = upper
    rotations[LEG_INDICES] = from_matrix(turns)
    return Pose(hips=hips, rotations=rotations)


def standing(actor: Actor, speed: float, step_frequency: float, phase: float) -> tuple[bool, bool]:
    """Whether the left and the right foot stand at this phase of the drawn walk; arguments as for `drawn_pose`."""
    weighted = blend_weights(actor.tree, {"speed": speed, "step_frequency": step_frequency})
    contacts = np.fromiter(weighted.values(), dtype=np.float64) @ actor.table.contacts[list(weighted)]
    own = ((phase - float(contacts[4])) % 1.0, phase % 1.0)
    return own[0] < float(contacts[0]), own[1] < float(contacts[1])


@dataclass(frozen=True, eq=False)
class _Foot:
    """ankle m in the walker's frame; turn (3, 3) world rotation; bend of the toes, yaw of the knee rad; clearance m."""

    ankle: tuple[float, float, float]
    turn: Floats
    bend: float
    knee_yaw: float
    clearance: float


def _placed_foot(sole: Sole, channels: Floats, clock: float, place: float, stride: float) -> _Foot:
    """The foot over its footprint; channels as in blend.FOOT_CHANNELS, place of the footprint in m forward."""
    pitch, clearance, travel, side, yaw, knee_yaw = channels.tolist()
    pitch = contact.flattened(pitch)
    bend = float(contact.toe_bend(pitch, contact.swing_progress(clock)))
    forward, up = (float(value) for value in contact.planted(sole, pitch, bend))
    cosine, sine = math.cos(yaw), math.sin(yaw)
    ankle = (side + sine * forward, up + clearance, place + stride * travel + cosine * forward)
    heading = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
    return _Foot(ankle, heading @ _toes_up(pitch), bend, knee_yaw, clearance)


def _nearer(leg: Leg, hip: Floats, foot: _Foot) -> _Foot:
    """The foot, brought along the ground to where its leg reaches if the step is too long for it.

    It keeps its height, so that the sole neither sinks nor floats; what gives way is its place, and it slides.
    """
    x, up, z = foot.ankle
    aside, ahead = x - float(hip[0]), z - float(hip[2])
    far, furthest = math.hypot(aside, ahead), FURTHEST * leg.length
    if far <= furthest:
        return foot
    share = furthest / far
    return replace(foot, ankle=(float(hip[0]) + share * aside, up, float(hip[2]) + share * ahead))


def _lowering(legs: Sequence[Leg], hips: Floats, sockets: Sequence[Floats], feet: Sequence[_Foot]) -> float:
    """m by which the hips come down so that both legs reach their feet; a soft maximum, so without a kink.

    Cycles are built so that legs reach; this takes up the last millimetres between them. A foot in the air may hang
    higher instead, by its clearance.
    """
    lowering = 0.0
    for leg, socket, foot in zip(legs, sockets, feet, strict=True):
        x, y, z = (hips + socket).tolist()
        room = (STRAIGHTEST * leg.length) ** 2 - (foot.ankle[0] - x) ** 2 - (foot.ankle[2] - z) ** 2
        excess = (y - foot.ankle[1] - math.sqrt(max(room, 0.0)) - foot.clearance) / LOWERING_SOFTNESS
        lowering += LOWERING_SOFTNESS * (math.log1p(math.exp(excess)) if excess < 30.0 else excess)
    return lowering


def skin_matrices(actor: Actor, pose: Pose) -> Floats:
    """(21, 3, 4) float32: bind-pose vertices of the actor's scaled body -> the walker's frame."""
    return skinning_matrices(actor.skeleton, pose)


def _toes_up(pitch: float) -> Floats:
    """(3, 3): rotation about the sideways axis that lifts the toes by pitch (rad)."""
    cosine, sine = math.cos(pitch), math.sin(pitch)
    return np.array([[1.0, 0.0, 0.0], [0.0, cosine, sine], [0.0, -sine, cosine]])

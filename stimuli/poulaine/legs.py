"""Legs bent to wanted ankle places: two-bone inverse kinematics over whole cycles, the feet's orientation kept.

The knee bends in the plane it bent in before. Knows world rotations and places; no regression, no interpolation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stimuli.rotations import inverse, multiply, rotate, shortest_arc
from stimuli.skeleton import Floats

STRAIGHTEST = 0.9996
"""Largest hip-ankle distance over the length of the leg."""

FOLDED = 0.35
"""Least hip-ankle distance over the length of the leg."""

AHEAD = 0.02
"""m that the thigh's own forward direction counts for in the knee's: a leg that was straight, or bent a degree the
wrong way, so bends forward, and a bent knee stays in its plane."""


@dataclass(frozen=True, eq=False)
class BentLeg:
    """World rotations (..., 4) of thigh and shank; beyond: (...,) m that the ankle is out of reach."""

    thigh: Floats
    shank: Floats
    beyond: Floats


def bent(hip: Floats, ankle: Floats, thigh: Floats, shank: Floats, thigh_bone: Floats, shank_bone: Floats) -> BentLeg:
    """Thigh and shank turned as little as possible from `thigh` and `shank` so that the ankle comes to its place.

    hip, ankle: (..., 3) m wanted; thigh, shank: (..., 4) world rotations before; thigh_bone, shank_bone: (3,) m in the
    rest pose, hip to knee and knee to ankle. Out of reach, the leg points at the ankle and stays at its limit.
    """
    upper, lower = float(np.linalg.norm(thigh_bone)), float(np.linalg.norm(shank_bone))
    before_knee, before_shank = rotate(thigh, thigh_bone), rotate(shank, shank_bone)
    before = before_knee + before_shank
    wanted = ankle - hip
    length = np.linalg.norm(wanted, axis=-1)
    distance = np.clip(length, FOLDED * (upper + lower), STRAIGHTEST * (upper + lower))
    swing = shortest_arc(before, wanted)
    along = wanted / length[..., None]
    knee = rotate(swing, before_knee)
    forward = knee + AHEAD * rotate(swing, rotate(thigh, _FORWARD))
    forward = forward - np.sum(forward * along, axis=-1, keepdims=True) * along
    forward = forward / np.linalg.norm(forward, axis=-1, keepdims=True)
    cosine = np.clip((upper**2 + distance**2 - lower**2) / (2 * upper * distance), -1.0, 1.0)
    sine = np.sqrt(1.0 - cosine**2)
    to_knee = upper * (cosine[..., None] * along + sine[..., None] * forward)
    to_ankle = distance[..., None] * along - to_knee
    turned_thigh, turned_shank = multiply(swing, thigh), multiply(swing, shank)
    return BentLeg(
        thigh=multiply(shortest_arc(rotate(turned_thigh, thigh_bone), to_knee), turned_thigh),
        shank=multiply(shortest_arc(rotate(turned_shank, shank_bone), to_ankle), turned_shank),
        beyond=np.abs(distance - length),
    )


def local(parent: Floats, world: Floats) -> Floats:
    """(..., 4) rotation of a joint in its parent, from both world rotations."""
    return multiply(inverse(parent), world)


_FORWARD = np.array([0.0, 0.0, 1.0])

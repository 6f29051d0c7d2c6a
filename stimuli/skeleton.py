"""The walker's skeleton: named joints in a rest pose, and forward kinematics. Knows no file, body or clock."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating]

JOINTS: tuple[str, ...] = (
    "hips",
    "spine",
    "chest",
    "neck",
    "head",
    "leftShoulder",
    "leftUpperArm",
    "leftLowerArm",
    "leftHand",
    "rightShoulder",
    "rightUpperArm",
    "rightLowerArm",
    "rightHand",
    "leftUpperLeg",
    "leftLowerLeg",
    "leftFoot",
    "leftToes",
    "rightUpperLeg",
    "rightLowerLeg",
    "rightFoot",
    "rightToes",
)
"""Names of the VRM 1.0 humanoid, parents before children; every walker in gaitlab has exactly these."""

PARENTS: tuple[int, ...] = (-1, 0, 1, 2, 3, 2, 5, 6, 7, 2, 9, 10, 11, 0, 13, 14, 15, 0, 17, 18, 19)
"""Index of each joint's parent in JOINTS; -1 for the root."""


def role_parents(joints: tuple[str, ...]) -> tuple[int, ...]:
    """Index of each joint's nearest present parent; -1 for the first."""
    parents = []
    for joint in joints:
        above = PARENTS[JOINTS.index(joint)]
        while above >= 0 and JOINTS[above] not in joints:
            above = PARENTS[above]
        parents.append(joints.index(JOINTS[above]) if above >= 0 else -1)
    return tuple(parents)


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Joint offsets of one person in the rest pose, in which every joint's local rotation is the identity.

    offsets: (21, 3) m, from the parent joint to the joint, world axes (Y up, +Z forward, +X left);
             the root's offset is its position above the ground point (0, 0, 0).
    """

    offsets: Floats

    @cached_property
    def positions(self) -> Floats:
        """(21, 3) m: rest positions of all joints; not to be written to."""
        positions = np.array(self.offsets, dtype=np.float64)
        for joint, parent in enumerate(PARENTS):
            if parent >= 0:
                positions[joint] += positions[parent]
        positions.flags.writeable = False
        return positions


@dataclass(frozen=True, eq=False)
class Pose:
    """All joints at one instant.

    hips:      (3,) m, position of the hips in the walker's frame: origin on the ground below the walker's
               mean position, +Z the walking direction; travel is not included.
    rotations: (21, 4) local rotations x y z w, relative to the skeleton's rest pose, unit length.
    """

    hips: Floats
    rotations: Floats

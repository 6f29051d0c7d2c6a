"""Forward kinematics: from a pose to joint positions, world rotations and skinning matrices. Pure arithmetic.

Joints are turned one depth level at a time (rendering notes, section 3), so a pose costs seven small products.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stimuli.skeleton import JOINTS, PARENTS, Floats, Pose, Skeleton

Indices = NDArray[np.intp]


def _levels() -> tuple[tuple[Indices, Indices], ...]:
    depth = [0] * len(JOINTS)
    for joint, parent in enumerate(PARENTS):
        depth[joint] = 0 if parent < 0 else depth[parent] + 1
    return tuple(
        (np.array(joints), np.array([PARENTS[joint] for joint in joints]))
        for joints in ([j for j, d in enumerate(depth) if d == level] for level in range(1, max(depth) + 1))
    )


LEVELS = _levels()
"""Per depth below the root: indices of the joints, and of their parents."""


def rotation_matrices(rotations: Floats) -> Floats:
    """(..., 4) unit quaternions x y z w -> (..., 3, 3)."""
    x, y, z, w = (rotations[..., component] for component in range(4))
    matrices = np.empty((*rotations.shape[:-1], 3, 3))
    x2, y2, z2 = x + x, y + y, z + z
    xx, yy, zz, xy, xz, yz = x * x2, y * y2, z * z2, x * y2, x * z2, y * z2
    wx, wy, wz = w * x2, w * y2, w * z2
    matrices[..., 0, 0] = 1.0 - yy - zz
    matrices[..., 0, 1] = xy - wz
    matrices[..., 0, 2] = xz + wy
    matrices[..., 1, 0] = xy + wz
    matrices[..., 1, 1] = 1.0 - xx - zz
    matrices[..., 1, 2] = yz - wx
    matrices[..., 2, 0] = xz - wy
    matrices[..., 2, 1] = yz + wx
    matrices[..., 2, 2] = 1.0 - xx - yy
    return matrices


def world_matrices(skeleton: Skeleton, pose: Pose) -> Floats:
    """(..., 21, 4, 4): joint frame -> walker's frame. Poses may be batched: rotations (..., 21, 4), hips (..., 3)."""
    rotations = np.asarray(pose.rotations)
    matrices = np.zeros((*rotations.shape[:-1], 4, 4))
    matrices[..., :3, :3] = rotation_matrices(rotations)
    matrices[..., :3, 3] = skeleton.offsets
    matrices[..., 0, :3, 3] = pose.hips
    matrices[..., 3, 3] = 1.0
    for joints, parents in LEVELS:
        matrices[..., joints, :, :] = matrices.take(parents, axis=-3) @ matrices.take(joints, axis=-3)
    return matrices


def world_joints(skeleton: Skeleton, pose: Pose) -> Floats:
    """(..., 21, 3) m: joint positions in the walker's frame."""
    return np.ascontiguousarray(world_matrices(skeleton, pose)[..., :3, 3])


def skinning_matrices(skeleton: Skeleton, pose: Pose) -> Floats:
    """(..., 21, 3, 4) float32: bind-pose vertices of the skeleton's body -> walker's frame.

    The bind pose has no rotations, so its inverse only takes the joint's rest position away.
    """
    world = world_matrices(skeleton, pose)
    matrices = np.empty((*world.shape[:-2], 3, 4), dtype=np.float32)
    turn = world[..., :3, :3]
    matrices[..., :3] = turn
    matrices[..., 3] = world[..., :3, 3] - (turn @ skeleton.positions[..., None])[..., 0]
    return matrices

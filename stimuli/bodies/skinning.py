"""Linear blend skinning in NumPy: the reference which the GPU's skinning is compared with. Knows no file."""

from __future__ import annotations

import numpy as np

from stimuli.bodies.body import Surface
from stimuli.skeleton import Floats


def skin(surface: Surface, matrices: Floats) -> tuple[Floats, Floats]:
    """The surface moved by its joints.

    matrices: (21, 3, 4) per joint, from the bind pose (m) to where the vertex is in the pose:
              pose world matrix times the inverse of the bind world matrix.
    returns:  positions (V, 3) m and normals (V, 3), unit length. Normals are turned by the same blended matrix,
              which is exact for rotations and uniform scale.
    """
    blended = np.einsum("vk,vkij->vij", surface.weights, np.asarray(matrices)[surface.joints])
    positions = np.einsum("vij,vj->vi", blended[:, :, :3], surface.positions) + blended[:, :, 3]
    normals = np.einsum("vij,vj->vi", blended[:, :, :3], surface.normals)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return positions, normals / np.maximum(length, 1e-12)

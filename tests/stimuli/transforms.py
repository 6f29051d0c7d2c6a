"""A crowd's transforms as matrices, by SciPy: what the quaternions are compared by."""

import numpy as np
from scipy.spatial.transform import Rotation


def as_matrices(transforms):
    """(..., 3, 4) of transforms (..., 2, 4): quaternions x y z w as long as the root of a size, and translations."""
    turn, moved = transforms[..., 0, :].astype(float), transforms[..., 1, :3]
    turned = Rotation.from_quat(turn.reshape(-1, 4)).as_matrix().reshape(*turn.shape[:-1], 3, 3)
    size = np.sum(turn * turn, axis=-1)
    return np.concatenate([turned * size[..., None, None], moved[..., None]], axis=-1)

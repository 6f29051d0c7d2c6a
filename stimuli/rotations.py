"""Unit quaternions x y z w, many at a time: the arithmetic of rotations. Knows no joint, file or clock.

Every function broadcasts over leading axes and keeps float64. A quaternion and its negative are the same rotation;
functions that could answer with either say which they choose. Formulas: K. Shoemake, Animating rotation with
quaternion curves, SIGGRAPH 1985; F. S. Grassia, Practical parameterization of rotations using the exponential
map, J. Graphics Tools 3, 1998.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.floating]

IDENTITY: Floats = np.array([0.0, 0.0, 0.0, 1.0])
"""(4,) the rotation that turns nothing."""

AXES = {"X": 0, "Y": 1, "Z": 2}
"""Column of each axis letter used in an Euler order."""


def normalise(rotations: ArrayLike) -> Floats:
    """(..., 4) of any length but zero -> (..., 4) unit length."""
    rotations = np.asarray(rotations, dtype=np.float64)
    return rotations / np.linalg.norm(rotations, axis=-1, keepdims=True)


def multiply(first: ArrayLike, second: ArrayLike) -> Floats:
    """The rotation that turns by `second` and then by `first` (Hamilton's product).

    first, second: (..., 4); returns (..., 4).
    """
    a, b = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    ax, ay, az, aw = a[..., 0], a[..., 1], a[..., 2], a[..., 3]
    bx, by, bz, bw = b[..., 0], b[..., 1], b[..., 2], b[..., 3]
    product = np.empty(np.broadcast_shapes(a.shape, b.shape))
    product[..., 0] = aw * bx + ax * bw + ay * bz - az * by
    product[..., 1] = aw * by - ax * bz + ay * bw + az * bx
    product[..., 2] = aw * bz + ax * by - ay * bx + az * bw
    product[..., 3] = aw * bw - ax * bx - ay * by - az * bz
    return product


def inverse(rotations: ArrayLike) -> Floats:
    """The opposite rotation of unit quaternions (..., 4)."""
    return np.asarray(rotations, dtype=np.float64) * np.array([-1.0, -1.0, -1.0, 1.0])


def rotate(rotations: ArrayLike, vectors: ArrayLike) -> Floats:
    """Vectors (..., 3) turned by unit quaternions (..., 4); returns (..., 3) in the unit of the vectors."""
    q, v = np.asarray(rotations, dtype=np.float64), np.asarray(vectors, dtype=np.float64)
    x, y, z, w = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    vx, vy, vz = v[..., 0], v[..., 1], v[..., 2]
    tx, ty, tz = 2 * (y * vz - z * vy), 2 * (z * vx - x * vz), 2 * (x * vy - y * vx)
    turned = (
        vx + w * tx + y * tz - z * ty,
        vy + w * ty + z * tx - x * tz,
        vz + w * tz + x * ty - y * tx,
    )
    return np.stack(np.broadcast_arrays(*turned), axis=-1)


def to_matrix(rotations: ArrayLike) -> Floats:
    """(..., 4) unit quaternions -> (..., 3, 3) rotation matrices that turn column vectors."""
    q = np.asarray(rotations, dtype=np.float64)
    columns = [rotate(q, axis) for axis in np.eye(3)]
    return np.stack(columns, axis=-1)


def from_matrix(matrices: ArrayLike) -> Floats:
    """(..., 3, 3) rotation matrices -> (..., 4) unit quaternions, w not negative.

    Takes the largest of the four possible pivots, so no angle loses precision (Shepperd, J. Guidance and
    Control 1, 1978).
    """
    m = np.asarray(matrices, dtype=np.float64)
    xx, yy, zz = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    outer = np.empty((*m.shape[:-2], 4, 4))  # 4 times the outer product of the quaternion with itself
    outer[..., 0, 0] = 1 + xx - yy - zz
    outer[..., 1, 1] = 1 - xx + yy - zz
    outer[..., 2, 2] = 1 - xx - yy + zz
    outer[..., 3, 3] = 1 + xx + yy + zz
    outer[..., 0, 1] = outer[..., 1, 0] = m[..., 0, 1] + m[..., 1, 0]
    outer[..., 0, 2] = outer[..., 2, 0] = m[..., 0, 2] + m[..., 2, 0]
    outer[..., 1, 2] = outer[..., 2, 1] = m[..., 1, 2] + m[..., 2, 1]
    outer[..., 0, 3] = outer[..., 3, 0] = m[..., 2, 1] - m[..., 1, 2]
    outer[..., 1, 3] = outer[..., 3, 1] = m[..., 0, 2] - m[..., 2, 0]
    outer[..., 2, 3] = outer[..., 3, 2] = m[..., 1, 0] - m[..., 0, 1]
    pivot = np.argmax(np.diagonal(outer, axis1=-2, axis2=-1), axis=-1)
    row = np.take_along_axis(outer, pivot[..., None, None], axis=-2)[..., 0, :]
    return _w_not_negative(normalise(row))


def about_axis(axis: ArrayLike, angles: ArrayLike) -> Floats:
    """Rotations about one unit axis (..., 3) by angles (...) in radians; returns (..., 4)."""
    half = 0.5 * np.asarray(angles, dtype=np.float64)[..., None]
    axis = np.asarray(axis, dtype=np.float64)
    shape = np.broadcast_shapes(axis.shape, (*half.shape[:-1], 3))
    return np.concatenate([np.broadcast_to(np.sin(half) * axis, shape), np.cos(half + 0 * axis[..., :1])], axis=-1)


def from_euler(order: str, angles: ArrayLike) -> Floats:
    """Rotations about the moving axes, in the order written (as a BVH file lists its channels).

    order:   letters of X, Y and Z, any number of them, e.g. "ZXY": the matrix is Rz Rx Ry
    angles:  (..., len(order)) rad
    returns: (..., 4)
    """
    angles = np.asarray(angles, dtype=np.float64)
    total = np.broadcast_to(IDENTITY, (*angles.shape[:-1], 4))
    for column, letter in enumerate(order.upper()):
        total = multiply(total, about_axis(np.eye(3)[AXES[letter]], angles[..., column]))
    return total


def to_exponential(rotations: ArrayLike) -> Floats:
    """(..., 4) unit quaternions -> (..., 3) axis times angle, rad, the angle in [0, pi] (the logarithm)."""
    q = _w_not_negative(np.asarray(rotations, dtype=np.float64))
    sine = np.linalg.norm(q[..., :3], axis=-1, keepdims=True)
    angle = 2 * np.arctan2(sine, q[..., 3:])
    scale = np.where(sine > 1e-12, angle / np.where(sine > 1e-12, sine, 1.0), 2.0)
    return q[..., :3] * scale


def from_exponential(vectors: ArrayLike) -> Floats:
    """(..., 3) axis times angle, rad -> (..., 4) unit quaternions (the exponential map)."""
    vectors = np.asarray(vectors, dtype=np.float64)
    angle = np.linalg.norm(vectors, axis=-1, keepdims=True)
    scale = 0.5 * np.sinc(angle / (2 * np.pi))  # sin(angle / 2) / angle, also at zero
    return np.concatenate([vectors * scale, np.cos(0.5 * angle)], axis=-1)


def angle_between(first: ArrayLike, second: ArrayLike) -> Floats:
    """The smallest angle (...) in rad, 0 to pi, that turns one rotation (..., 4) into the other."""
    return np.linalg.norm(to_exponential(multiply(inverse(first), second)), axis=-1)


def slerp(first: ArrayLike, second: ArrayLike, share: ArrayLike) -> Floats:
    """Constant-speed turn from `first` (share 0) to `second` (share 1) along the shorter way (Shoemake 1985).

    first, second: (..., 4); share: (...), also outside 0 to 1; returns (..., 4).
    """
    step = to_exponential(multiply(inverse(first), second))
    return multiply(first, from_exponential(step * np.asarray(share, dtype=np.float64)[..., None]))


def mean_rotation(rotations: ArrayLike, weights: ArrayLike | None = None) -> Floats:
    """Weighted mean over the first axis by normalised linear blending.

    rotations: (N, ..., 4); weights: (N,) not negative, or None for equal ones; returns (..., 4).
    Each is first turned to the hemisphere of the heaviest, so q and -q count as the same rotation.
    """
    rotations = np.asarray(rotations, dtype=np.float64)
    shares = np.full(len(rotations), 1.0) if weights is None else np.asarray(weights, dtype=np.float64)
    heaviest = rotations[np.argmax(shares)]
    opposite = np.sum(rotations * heaviest, axis=-1, keepdims=True) < 0
    return normalise(np.tensordot(shares, np.where(opposite, -rotations, rotations), axes=1))


def continuous(rotations: ArrayLike) -> Floats:
    """The same rotations (T, ..., 4), with signs chosen so that neighbours along the first axis are close."""
    rotations = np.array(rotations, dtype=np.float64)
    flips = np.sum(rotations[1:] * rotations[:-1], axis=-1, keepdims=True) < 0
    signs = np.where(np.cumsum(flips, axis=0) % 2 == 1, -1.0, 1.0)
    rotations[1:] *= signs
    return rotations


def shortest_arc(start: ArrayLike, end: ArrayLike) -> Floats:
    """The smallest rotation that turns direction `start` into direction `end`.

    start, end: (..., 3) of any length but zero; returns (..., 4). Opposite directions turn half round an
    axis perpendicular to `start`, any one of them being equally short.
    """
    start, end = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    start = start / np.linalg.norm(start, axis=-1, keepdims=True)
    end = end / np.linalg.norm(end, axis=-1, keepdims=True)
    start, end = np.broadcast_arrays(start, end)
    cosine = np.sum(start * end, axis=-1, keepdims=True)
    arc = np.concatenate([np.cross(start, end), 1.0 + cosine], axis=-1)
    least = np.eye(3)[np.argmin(np.abs(start), axis=-1)]
    half_turn = np.concatenate([np.cross(start, least), np.zeros_like(cosine)], axis=-1)
    return normalise(np.where(cosine < -1.0 + 1e-12, half_turn, arc))


def yaw(rotations: ArrayLike) -> Floats:
    """Heading (...) in rad of the turned +Z axis: 0 along +Z, positive towards +X (left)."""
    forward = rotate(rotations, np.array([0.0, 0.0, 1.0]))
    return np.arctan2(forward[..., 0], forward[..., 2])


def _w_not_negative(rotations: Floats) -> Floats:
    return np.where(rotations[..., 3:] < 0, -rotations, rotations)

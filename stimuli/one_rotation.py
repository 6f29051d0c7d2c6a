"""One unit quaternion x y z w in plain numbers: what rotations.py does for many, without NumPy's cost per call.

A walker is posed anew every frame; on so few numbers a call to NumPy costs more than the arithmetic.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import cos, sin, sqrt
from typing import Any, TypeVar

Vector = tuple[float, float, float]
Turn = tuple[float, float, float, float]
"""x y z w, unit length."""

Number = TypeVar("Number", float, Any)


def multiply(first: Iterable[Number], second: Iterable[Number]) -> tuple[Number, Number, Number, Number]:
    """The rotation that turns by `second` and then by `first` (Hamilton's product), x y z w.

    Also of planes: arrays (4, ...) of many rotations.
    """
    ax, ay, az, aw = first
    bx, by, bz, bw = second
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def inverse(rotation: Turn) -> Turn:
    """The opposite rotation."""
    x, y, z, w = rotation
    return -x, -y, -z, w


def rotate(rotation: Turn, vector: Vector) -> Vector:
    """The vector turned, in its own unit."""
    x, y, z, w = rotation
    vx, vy, vz = vector
    tx, ty, tz = 2.0 * (y * vz - z * vy), 2.0 * (z * vx - x * vz), 2.0 * (x * vy - y * vx)
    return vx + w * tx + y * tz - z * ty, vy + w * ty + z * tx - x * tz, vz + w * tz + x * ty - y * tx


def w_not_negative(rotation: Turn) -> Turn:
    """Of the two quaternions that are this rotation, the one rotations.from_matrix answers with."""
    x, y, z, w = rotation
    return (-x, -y, -z, -w) if w < 0.0 else rotation


def toes_up(pitch: float) -> Turn:
    """The rotation about the sideways axis that lifts the toes by pitch (rad)."""
    return -sin(0.5 * pitch), 0.0, 0.0, cos(0.5 * pitch)


def heading(yaw: float) -> Turn:
    """The rotation about the upward axis that turns +Z towards +X, to the left, by yaw (rad)."""
    return 0.0, sin(0.5 * yaw), 0.0, cos(0.5 * yaw)


def from_columns(first: Vector, second: Vector, third: Vector) -> Turn:
    """The rotation that turns the axes into three orthonormal vectors, the columns of its matrix.

    As rotations.from_matrix, by the largest of the four possible pivots, so no angle loses precision.
    """
    (xx, yx, zx), (xy, yy, zy), (xz, yz, zz) = first, second, third
    x, y, z, w = 1.0 + xx - yy - zz, 1.0 - xx + yy - zz, 1.0 - xx - yy + zz, 1.0 + xx + yy + zz
    pivot = max(x, y, z, w)
    if pivot == w:
        row = (zy - yz, xz - zx, yx - xy, w)
    elif pivot == x:
        row = (x, yx + xy, xz + zx, zy - yz)
    elif pivot == y:
        row = (yx + xy, y, zy + yz, xz - zx)
    else:
        row = (xz + zx, zy + yz, z, yx - xy)
    size = 0.5 / sqrt(pivot)  # the pivot is 4 times its square; row is 4 times the quaternion times it
    return row[0] * size, row[1] * size, row[2] * size, row[3] * size

"""A thousand walkers posed at once: `walker.drawn_pose` and `skin_matrices` as arithmetic on planes of float32.

Every number of a walker is a plane over all walkers (structure of arrays), so an operation is one pass over
contiguous memory; joints are turned one level of depth at a time, as quaternions. Gives the matrices of drawn_pose
within 1e-4. Knows no clock; `crowd_poses_compiled` does the same with numba.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stimuli.blend import FOOT_CHANNELS
from stimuli.crowds.table import PLANES, UPPER_COUNT, Constants, Mix, Singles
from stimuli.legs import contact
from stimuli.legs.two_bone import FURTHEST, STRAIGHTEST
from stimuli.skeleton import JOINTS, Floats
from stimuli.walker import LOWERING_SOFTNESS

Components = Any
"""The components of vectors (3), quaternions (4) or matrices (9, row by row), each a plane (..., N) float32."""

UPPER_LEVELS = (
    (slice(1, 2), slice(0, 1)),
    (slice(2, 3), slice(1, 2)),
    (slice(3, 6), slice(2, 3)),
    (slice(6, 9), slice(3, 6)),
    (slice(9, 11), slice(7, 9)),
    (slice(11, 13), slice(9, 11)),
)
"""Per depth below the hips: the joints of crowd_table.DEPTH_ORDER, and their parents."""

LEG_LEVELS = ((slice(15, 17), slice(13, 15)), (slice(17, 19), slice(15, 17)), (slice(19, 21), slice(17, 19)))
"""The same of the legs, below the hip joints."""


def many_matrices(mix: Mix, phases: Floats, out: Singles | None = None) -> Singles:
    """(N, 21, 3, 4) float32: bind-pose vertices -> each walker's frame, at phases (N,) of the gait cycle.

    out: where to write; a view of a larger array will do.
    """
    if out is None:
        out = np.empty((len(mix), len(JOINTS), 3, 4), np.float32)
    phase = np.asarray(phases, np.float64)
    phase = phase - np.floor(phase)
    constants = mix.constants
    body = _blended(mix.table.body, mix, phase)
    hips = body[4 * UPPER_COUNT :]
    turn = np.empty((9, len(JOINTS), len(mix)), np.float32)
    turn[:, :UPPER_COUNT] = _matrices(_world_turns(body[: 4 * UPPER_COUNT].reshape(4, UPPER_COUNT, -1)))
    _pose_legs(mix, phase, hips, turn)
    places = _places(constants, hips, turn)
    places -= _turned(turn, constants.rest)
    for plane, joint in enumerate(PLANES):
        out[:, joint, :, :3] = turn[:, plane].reshape(3, 3, -1).transpose(2, 0, 1)
        out[:, joint, :, 3] = places[:, plane].T
    return out


def _blended(table: Singles, mix: Mix, place: Floats) -> Singles:
    """(columns, N): weighted mean over each walker's cycles at a place in the cycle, linear between samples."""
    position = place * mix.samples
    sample = np.minimum(position.astype(np.intp), mix.samples - 1)
    share = (position - sample).astype(np.float32)
    total = np.zeros((len(mix), table.shape[1]), np.float32)
    rows = np.empty_like(total)
    for first_row, weight in zip(mix.rows.T, mix.weights.T, strict=True):
        for step, part in ((0, weight * (1.0 - share)), (1, weight * share)):
            np.take(table, first_row + (sample + step), axis=0, out=rows, mode="clip")
            rows *= part[:, None]
            total += rows
    return np.ascontiguousarray(total.T)


def _world_turns(local: Singles) -> Singles:
    """(4, 13, N) world rotations x y z w of the upper body by depth, from local ones of any length."""
    local = local / np.sqrt(np.einsum("kjn,kjn->jn", local, local))
    for joints, parents in UPPER_LEVELS:
        ax, ay, az, aw = local[:, parents]
        bx, by, bz, bw = local[:, joints]
        local[:, joints] = (
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        )
    return local


def _matrices(turns: Singles) -> Components:
    """Nine planes of the rotation matrices of unit quaternions (4, ..., N)."""
    x, y, z, w = turns
    x2, y2, z2 = x + x, y + y, z + z
    xx, yy, zz, xy, xz, yz = x * x2, y * y2, z * z2, x * y2, x * z2, y * z2
    wx, wy, wz = w * x2, w * y2, w * z2
    return (1 - yy - zz, xy - wz, xz + wy, xy + wz, 1 - xx - zz, yz - wx, xz - wy, yz + wx, 1 - xx - yy)


def _turned(turn: Components, vector: Components) -> Singles:
    """Three planes: vectors turned by matrices."""
    x, y, z = vector
    return np.stack([turn[k] * x + turn[k + 1] * y + turn[k + 2] * z for k in (0, 3, 6)])


def _places(constants: Constants, hips: Singles, turn: Singles) -> Singles:
    """(3, 21, N) m: the joints, by depth."""
    places = np.empty((3, len(JOINTS), hips.shape[-1]), np.float32)
    places[:, 0] = hips
    for joints, parents in (*UPPER_LEVELS, (slice(13, 15), slice(0, 1)), *LEG_LEVELS):
        places[:, joints] = places[:, parents] + _turned(turn[:, parents], constants.offsets[:, joints])
    return places


def _pose_legs(mix: Mix, phase: Floats, hips: Singles, turn: Singles) -> None:
    """Writes the legs' world rotations into turn, and lowers the hips (3, N) where a leg would not reach."""
    legs = mix.constants
    own = np.stack([phase - mix.left_strike, phase])
    own -= np.floor(own)
    clock = contact.clock(own, mix.stance.T)
    channels = np.stack([_blended(mix.table.feet[side], mix, clock[side]) for side in (0, 1)], axis=1)
    pitch, clearance, travel, aside, yaw, knee_yaw = (channels[i] for i in range(len(FOOT_CHANNELS)))
    place = mix.ahead.T + mix.stride * contact.footprint_travel(own, mix.stance.T)
    pitch = contact.flattened(pitch)
    bend = contact.toe_bend(pitch, contact.swing_progress(clock).astype(np.float32))
    forward, up = contact.planted(legs.sole, pitch, bend)
    cosine, sine = np.cos(yaw), np.sin(yaw)
    stride = mix.stride.astype(np.float32)
    ankle = (aside + sine * forward, up + clearance, place.astype(np.float32) + stride * travel + cosine * forward)
    socket = _turned(turn[:, :1], legs.hip)
    dx, dy, dz = (ankle[axis] - (hips[axis] + socket[axis]) for axis in range(3))
    far = np.sqrt(dx * dx + dz * dz)
    nearer = np.minimum(1.0, np.float32(FURTHEST) * (legs.thigh + legs.shank) / np.maximum(far, np.float32(1e-6)))
    dx, dz = nearer * dx, nearer * dz
    reach = STRAIGHTEST * (legs.thigh + legs.shank)
    room = np.sqrt(np.maximum(reach * reach - dx * dx - dz * dz, 0.0))
    excess = (-dy - room - clearance) * np.float32(1.0 / LOWERING_SOFTNESS)
    lowering = np.float32(LOWERING_SOFTNESS) * np.logaddexp(np.float32(0.0), excess).sum(axis=0)
    hips[1] -= lowering
    thigh, shank = _solved(legs, (dx, dy + lowering, dz), reach, knee_yaw)
    turn[:, 13:15] = _product(thigh, legs.thigh_rest)
    turn[:, 15:17] = _product(shank, legs.shank_rest)
    turn[:, 17:19] = _foot(cosine, sine, pitch)
    turn[:, 19:21] = _foot(cosine, sine, pitch + bend)


def _solved(legs: Constants, to_ankle: Components, reach: Singles, knee_yaw: Singles) -> tuple[Components, Components]:
    """World frames (columns bone, hinge, their product) of thigh and shank, as legs.solve without its arc cosines."""
    dx, dy, dz = to_ankle
    far = np.sqrt(dx * dx + dy * dy + dz * dz)
    dx, dy, dz = dx / far, dy / far, dz / far
    far = np.minimum(far, reach)
    fx, fz = np.sin(knee_yaw), np.cos(knee_yaw)
    along = fx * dx + fz * dz
    fx, fy, fz = fx - along * dx, -along * dy, fz - along * dz
    size = np.sqrt(fx * fx + fy * fy + fz * fz)
    fx, fy, fz = fx / size, fy / size, fz / size
    normal = (fy * dz - fz * dy, fz * dx - fx * dz, fx * dy - fy * dx)
    frames = []
    for near, other, sign in ((legs.thigh, legs.shank, 1.0), (legs.shank, legs.thigh, -1.0)):
        c = np.clip((near * near + far * far - other * other) / (2.0 * near * far), -1.0, 1.0)
        s = np.float32(sign) * np.sqrt(1.0 - c * c)
        frames.append(_frame((c * dx + s * fx, c * dy + s * fy, c * dz + s * fz), normal))
    return frames[0], frames[1]


def _frame(along: Components, hinge: Components) -> Components:
    """Nine planes, row by row: columns bone, hinge, their product."""
    (ax, ay, az), (hx, hy, hz) = along, hinge
    return (ax, hx, hy * az - hz * ay, ay, hy, hz * ax - hx * az, az, hz, hx * ay - hy * ax)


def _product(first: Components, second: Components) -> Components:
    """Nine planes of the product of two matrices."""
    return [
        first[3 * row] * second[column]
        + first[3 * row + 1] * second[3 + column]
        + first[3 * row + 2] * second[6 + column]
        for row in range(3)
        for column in range(3)
    ]


def _foot(cosine: Singles, sine: Singles, pitch: Singles) -> Components:
    """Nine planes: toes up by pitch, then headed to a yaw given by its cosine and sine."""
    up, level = np.sin(pitch), np.cos(pitch)
    nothing = np.zeros_like(up)
    return (cosine, -sine * up, sine * level, nothing, level, up, -sine, -cosine * up, cosine * level)

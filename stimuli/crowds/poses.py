"""A thousand walkers posed at once: `walker.drawn_pose` and `skin_matrices` as arithmetic on planes of float32.

Every number of a walker is a plane over all walkers (structure of arrays), so an operation is one pass over
contiguous memory; joints are turned one level of depth at a time, as quaternions. Gives the matrices of drawn_pose
within 1e-4. Knows no clock; `compiled_poses` does the same with numba.
"""

from __future__ import annotations

import numpy as np

from stimuli.crowds.table import PLANES, UPPER_COUNT, Constants, Mix, Singles
from stimuli.legs import contact
from stimuli.legs.two_bone import FURTHEST, STRAIGHTEST
from stimuli.skeleton import JOINTS, Floats
from stimuli.walker import LOWERING_SOFTNESS

UPPER_LEVELS = (
    (slice(1, 2), slice(0, 1)),
    (slice(2, 3), slice(1, 2)),
    (slice(3, 6), slice(2, 3)),
    (slice(6, 9), slice(3, 6)),
    (slice(9, 11), slice(7, 9)),
    (slice(11, 13), slice(9, 11)),
)
"""Per depth below the hips: the joints of table.DEPTH_ORDER, and their parents."""

LEG_LEVELS = ((slice(15, 17), slice(13, 15)), (slice(17, 19), slice(15, 17)), (slice(19, 21), slice(17, 19)))
"""The same of the legs, below the hip joints."""

LEVELS = (*UPPER_LEVELS, (slice(13, 15), slice(0, 1)), *LEG_LEVELS)


def many_matrices(mix: Mix, phases: Floats, out: Singles | None = None) -> Singles:
    """(N, 21, 3, 4) float32: bind-pose vertices -> each walker's frame, at phases (N,) of the gait cycle.

    out: where to write; a view of a larger array will do.
    """
    if out is None:
        out = np.empty((len(mix), len(JOINTS), 3, 4), np.float32)
    phase = np.asarray(phases, np.float64)
    phase = phase - np.floor(phase)
    body = _blended(mix.table.body[None], mix, phase[None])[:, 0]
    hips = body[4 * UPPER_COUNT :]
    frames = np.empty((3, 4, len(JOINTS), len(mix)), np.float32)
    turn = frames[:, :3]
    _write_turns(turn[:, :, :UPPER_COUNT], _world_turns(body[: 4 * UPPER_COUNT].reshape(4, UPPER_COUNT, -1)))
    _pose_legs(mix, phase, hips, turn)
    _move(frames[:, 3], turn, hips, mix.constants.rest)
    for plane, joint in enumerate(PLANES):
        out[:, joint] = frames[:, :, plane].transpose(2, 0, 1)
    return out


def _blended(tables: Singles, mix: Mix, place: Floats) -> Singles:
    """(columns, T, N): weighted mean over each walker's cycles at places (T, N) in the cycle, linear between samples.

    tables: (T, rows, columns)
    """
    count, rows, columns = tables.shape
    position = place * mix.samples
    sample = np.minimum(position.astype(np.intp), mix.samples - 1)
    share = (position - sample).astype(np.float32)
    first = sample + rows * np.arange(count)[:, None]
    chosen = np.array([first, first + 1])[:, None] + mix.rows.T[:, None]  # (2, M, T, N)
    parts = np.array([1.0 - share, share])[:, None] * mix.weights.T[:, None]
    summed = 2 * mix.rows.shape[1]
    found = tables.reshape(-1, columns).take(chosen.reshape(summed, -1).T, axis=0, mode="clip")
    means = np.ascontiguousarray(parts.reshape(summed, -1).T)[:, None] @ found
    return np.ascontiguousarray(means[:, 0].T).reshape(columns, count, -1)


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


def _write_turns(turn: Singles, rotations: Singles) -> None:
    """Writes the matrices (3, 3, ..., N) of unit quaternions (4, ..., N)."""
    x, y, z, w = rotations
    x2, y2, z2 = x + x, y + y, z + z
    xx, yy, zz, xy, xz, yz = x * x2, y * y2, z * z2, x * y2, x * z2, y * z2
    wx, wy, wz = w * x2, w * y2, w * z2
    turn[0, 0], turn[0, 1], turn[0, 2] = 1.0 - yy - zz, xy - wz, xz + wy
    turn[1, 0], turn[1, 1], turn[1, 2] = xy + wz, 1.0 - xx - zz, yz - wx
    turn[2, 0], turn[2, 1], turn[2, 2] = xz - wy, yz + wx, 1.0 - xx - yy


def _turned(turn: Singles, vector: Singles) -> Singles:
    """(3, ..., N): vectors (3, ..., N) turned by matrices (3, 3, ..., N)."""
    return np.asarray(np.einsum("rk...,k...->r...", turn, vector))


def _move(moved: Singles, turn: Singles, hips: Singles, rest: Singles) -> None:
    """Writes how far each joint's vertices are moved (3, 21, N) m, once they are turned about the ground point.

    A joint is where its parent's vertices would put it, so from parent to child only the difference of their turns
    counts, at the child's place at rest (3, 21, N).
    """
    moved[:, 0] = hips - _turned(turn[:, :, 0], rest[:, 0])
    for joints, parents in LEVELS:
        bend = turn[:, :, parents] - turn[:, :, joints]
        moved[:, joints] = moved[:, parents] + _turned(bend, rest[:, joints])


def _pose_legs(mix: Mix, phase: Floats, hips: Singles, turn: Singles) -> None:
    """Writes the legs' world rotations into turn, and lowers the hips (3, N) where a leg would not reach.

    Where the ankle is and how far the hips come down is worked out in float64: see `_solved`.
    """
    legs = mix.constants
    own = np.array([phase - mix.left_strike, phase])
    own -= np.floor(own)
    stance = mix.stance.T
    clock = contact.clock(own, stance)
    pitch, clearance, travel, aside, yaw, knee_yaw = _blended(mix.table.feet, mix, clock)
    place = mix.ahead.T + mix.stride * (contact.footprint_travel(own, stance) + travel)
    pitch = contact.flattened(pitch)
    bend = contact.toe_bend(pitch, contact.swing_progress(clock).astype(np.float32))
    forward, up = contact.planted(legs.sole, pitch, bend)
    cosine, sine = np.cos(yaw), np.sin(yaw)
    ankle = np.array([aside + sine * forward, up + clearance, place + cosine * forward])
    way = ankle - hips[:, None] - _turned(turn[:, :, :1], legs.hip)
    length = legs.bones.sum(axis=0)
    far = np.sqrt(way[0] * way[0] + way[2] * way[2])
    way[::2] *= np.minimum(1.0, FURTHEST * length / np.maximum(far, 1e-6))
    reach = STRAIGHTEST * length
    room = np.sqrt(np.maximum(reach * reach - way[0] * way[0] - way[2] * way[2], 0.0))
    excess = (-way[1] - room - clearance) / LOWERING_SOFTNESS
    lowering = LOWERING_SOFTNESS * contact.softly_positive(excess).sum(axis=0)
    hips[1] -= lowering
    way[1] += lowering
    turn[:, :, 13:17] = _solved(legs, way, reach, knee_yaw).reshape(3, 3, 4, -1)
    _write_feet(turn[:, :, 17:21].reshape(3, 3, 2, 2, -1), cosine, sine, np.array([pitch, pitch + bend]))


def _solved(legs: Constants, way: Floats, reach: Floats, knee_yaw: Singles) -> Singles:
    """World rotations (3, 3, 2, 2, N) of thighs and shanks, as two_bone.solve without its arc cosines.

    way: (3, 2, N) m from hip to ankle, float64: near a straight leg the knee is a hundred times as sensitive. The
    angles' sines come from the triangle's area (Heron's formula).
    """
    far = np.sqrt(np.einsum("k...,k...->...", way, way))
    down = (way / far).astype(np.float32)
    far = np.minimum(far, reach)
    ahead = np.array([np.sin(knee_yaw), np.zeros_like(knee_yaw), np.cos(knee_yaw)])
    ahead -= (ahead[0] * down[0] + ahead[2] * down[2]) * down
    ahead /= np.sqrt(np.einsum("k...,k...->...", ahead, ahead))
    hinge = _cross(ahead, down)
    near, other = legs.bones, legs.bones[::-1]
    cosine = ((near * near + far * far - other * other) / (2.0 * near * far)).astype(np.float32)
    bent = (near + other - far) * (near + other + far) * (far - near + other) * (far + near - other)
    sine = (np.sqrt(np.maximum(bent, 0.0)) / (2.0 * near * far)).astype(np.float32)
    sine[1] *= -1.0
    bone = cosine * down[:, None] + sine * ahead[:, None]
    hinge = np.broadcast_to(hinge[:, None], bone.shape)
    frame = np.array([bone, hinge, _cross(hinge, bone)])
    return np.asarray(np.einsum("kr...,kc...->rc...", frame, legs.bones_at_rest))


def _cross(first: Singles, second: Singles) -> Singles:
    """The vector product of vectors (3, ..., N)."""
    (ax, ay, az), (bx, by, bz) = first, second
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def _write_feet(turn: Singles, cosine: Singles, sine: Singles, pitch: Singles) -> None:
    """Writes (3, 3, ..., N): toes up by pitch, then headed to a yaw given by its cosine and sine."""
    up, level = np.sin(pitch), np.cos(pitch)
    turn[0, 0], turn[0, 1], turn[0, 2] = cosine, -sine * up, sine * level
    turn[1, 0], turn[1, 1], turn[1, 2] = 0.0, level, up
    turn[2, 0], turn[2, 1], turn[2, 2] = -sine, -cosine * up, cosine * level

"""A thousand walkers posed at once: `walker.drawn_pose` and `skin_matrices` as arithmetic on planes of float32.

Every number of a walker is a plane over all walkers (structure of arrays), so an operation is one pass over
contiguous memory; joints are turned one level of depth at a time. What comes out are quaternions and translations,
eight numbers a joint where a matrix has twelve, which is what a GPU reads fastest; they are the matrices of drawn_pose
within 1e-4. Knows no clock; `compiled_poses` does the same with numba.
"""

from __future__ import annotations

import numpy as np

from stimuli.crowds.table import PLANES, UPPER_COUNT, Constants, Mix, Singles
from stimuli.legs import contact
from stimuli.legs.two_bone import FURTHEST, STRAIGHTEST
from stimuli.one_rotation import multiply
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

_BY_NUMBER = np.argsort(PLANES)
"""Of each joint of JOINTS, its plane."""

LEVELS = (*UPPER_LEVELS, (slice(13, 15), slice(0, 1)), *LEG_LEVELS)


def many_transforms(
    mix: Mix,
    phases: Floats,
    out: Singles | None = None,
    sizes: Floats | None = None,
    places: Floats | None = None,
) -> Singles:
    """(N, 21, 2, 4) float32: bind-pose vertices -> the world, at phases (N,) of the gait cycle.

    Of each joint the quaternion x y z w that turns the vertices, as long as the square root of the walker's size, then
    the x y z (m) they are moved by, and 0.
    out:    where to write; a view of a larger array will do.
    sizes:  (N,) how many times as large as the figure each walker is, 1 if left out.
    places: (N, 2) x and z (m) of each walker on the ground, the origin if left out: the walkers' own frames.
    """
    if out is None:
        out = np.empty((len(mix), len(JOINTS), 2, 4), np.float32)
    phase = np.asarray(phases, np.float64)
    phase = phase - np.floor(phase)
    body = _blended(mix.table.body[None], mix, phase[None])[:, 0]
    hips = body[4 * UPPER_COUNT :]
    frames = np.zeros((2, 4, len(JOINTS), len(mix)), np.float32)
    rotations = frames[0]
    _turn_upper_body(body[: 4 * UPPER_COUNT].reshape(4, UPPER_COUNT, -1), rotations)
    _pose_legs(mix, phase, hips, rotations)
    _move(frames[1, :3], _matrices(rotations), hips, mix.constants.rest)
    if sizes is not None:
        frames[0] *= np.sqrt(sizes, dtype=np.float32)
        frames[1] *= sizes.astype(np.float32)
    if places is not None:
        frames[1, :3:2] += places.T.astype(np.float32)[:, None]
    out[...] = frames.transpose(3, 2, 0, 1)[:, _BY_NUMBER]
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


def _turn_upper_body(local: Singles, rotations: Singles) -> None:
    """Writes the world rotations x y z w of the upper body by depth, from local ones (4, 13, N) of any length."""
    turned = rotations[:, :UPPER_COUNT]
    np.divide(local, np.sqrt(np.einsum("kjn,kjn->jn", local, local)), out=turned)
    for joints, parents in UPPER_LEVELS:
        turned[:, joints] = multiply(turned[:, parents], turned[:, joints])


def _matrices(rotations: Singles) -> Singles:
    """(3, 3, ..., N): the matrices of unit quaternions (4, ..., N)."""
    x, y, z, w = rotations
    x2, y2, z2 = x + x, y + y, z + z
    xx, yy, zz, xy, xz, yz = x * x2, y * y2, z * z2, x * y2, x * z2, y * z2
    wx, wy, wz = w * x2, w * y2, w * z2
    turn = np.empty((3, 3, *x.shape), np.float32)
    turn[0, 0], turn[0, 1], turn[0, 2] = 1.0 - yy - zz, xy - wz, xz + wy
    turn[1, 0], turn[1, 1], turn[1, 2] = xy + wz, 1.0 - xx - zz, yz - wx
    turn[2, 0], turn[2, 1], turn[2, 2] = xz - wy, yz + wx, 1.0 - xx - yy
    return turn


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


def _pose_legs(mix: Mix, phase: Floats, hips: Singles, rotations: Singles) -> None:
    """Writes the legs' world rotations, and lowers the hips (3, N) where a leg would not reach.

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
    half = np.array([np.sin(0.5 * yaw), np.cos(0.5 * yaw)])
    sine, cosine = 2.0 * half[0] * half[1], half[1] * half[1] - half[0] * half[0]
    ankle = np.array([aside + sine * forward, up + clearance, place + cosine * forward])
    way = ankle - hips[:, None] - _turned(_matrices(rotations[:, :1]), legs.hip)
    length = legs.bones.sum(axis=0)
    far = np.sqrt(way[0] * way[0] + way[2] * way[2])
    way[::2] *= np.minimum(1.0, FURTHEST * length / np.maximum(far, 1e-6))
    reach = STRAIGHTEST * length
    room = np.sqrt(np.maximum(reach * reach - way[0] * way[0] - way[2] * way[2], 0.0))
    excess = (-way[1] - room - clearance) / LOWERING_SOFTNESS
    lowering = LOWERING_SOFTNESS * contact.softly_positive(excess).sum(axis=0)
    hips[1] -= lowering
    way[1] += lowering
    both = rotations[:, 13:].reshape(4, 4, 2, -1)
    both[:, :2] = _solved(legs, way, reach, knee_yaw)
    both[:, 2:] = _feet(half, np.array([pitch, pitch + bend]))


def _solved(legs: Constants, way: Floats, reach: Floats, knee_yaw: Singles) -> tuple[Singles, ...]:
    """World rotations x y z w, each (2, 2, N), of thighs and shanks, as two_bone.solve without its arc cosines.

    way: (3, 2, N) m from hip to ankle, float64: near a straight leg the knee is a hundred times as sensitive. The
    angles' sines come from the triangle's area (Heron's formula). The plane of the leg is turned first (from the
    ground's axes, so by less than half a turn), then each bone in it about the hinge.
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
    w = 0.5 * np.sqrt(np.maximum(1.0 + hinge[0] - down[1] + ahead[2], 1e-6))
    x, y, z = np.array([-down[2] - ahead[1], ahead[0] - hinge[2], hinge[1] + down[0]]) * (0.25 / w)
    half_cosine = np.sqrt(np.maximum(0.5 + 0.5 * cosine, 1e-6))
    half_sine = -0.5 * sine / half_cosine
    in_plane = (
        w * half_sine + x * half_cosine,
        y * half_cosine + z * half_sine,
        z * half_cosine - y * half_sine,
        w * half_cosine - x * half_sine,
    )
    return multiply(in_plane, legs.bones_from_rest)


def _cross(first: Singles, second: Singles) -> Singles:
    """The vector product of vectors (3, ..., N)."""
    (ax, ay, az), (bx, by, bz) = first, second
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def _feet(yaw: Singles, pitch: Singles) -> tuple[Singles, ...]:
    """World rotations x y z w, each (2, 2, N): toes up by pitches, then headed to a yaw.

    yaw: (2, 2, N) sine and cosine of half of it.
    """
    up, level = np.sin(-0.5 * pitch), np.cos(0.5 * pitch)
    return yaw[1] * up, yaw[0] * level, -yaw[0] * up, yaw[1] * level

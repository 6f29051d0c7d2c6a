"""crowds/poses.py with numba: one walker after the other, one thread. Importing it needs the extra `fast`.

The same arithmetic, which is explained there; a test holds the two together.
"""

from __future__ import annotations

from math import cos, exp, floor, log1p, sin, sqrt
from typing import Any

import numpy as np
from numba import njit

from stimuli.blend import FOOT_CHANNELS
from stimuli.crowds.table import COLUMNS, DEPTH_ORDER, PLANES, UPPER_COUNT, Mix, Singles
from stimuli.legs.contact import ARRIVAL, FLAT_ZONE, STANCE_END, TOE_BEND_LIMIT, TOE_BEND_SOFTNESS
from stimuli.legs.two_bone import FURTHEST, STRAIGHTEST
from stimuli.skeleton import JOINTS, PARENTS, Floats
from stimuli.walker import LOWERING_SOFTNESS

_PLANES = PLANES.astype(np.int64)
_ABOVE = np.array([max(PARENTS[joint], 0) for joint in PLANES.tolist()], np.int64)
_ABOVE_BY_DEPTH = np.array([DEPTH_ORDER.index(JOINTS[joint]) for joint in _ABOVE.tolist()], np.int64)
_LEGS = PLANES[13:].reshape(4, 2).T.astype(np.int64)
_HIPS = int(PLANES[0])
_CHANNELS = len(FOOT_CHANNELS)

_part = njit(inline="always", error_model="numpy")
"""A part of _pose_all, put in its place: handing a view of an array to a function costs as much as the arithmetic."""


def many_matrices(mix: Mix, phases: Floats, out: Singles | None = None) -> Singles:
    """As poses.many_matrices."""
    if out is None:
        out = np.empty((len(mix), len(JOINTS), 3, 4), np.float32)
    table = mix.table
    phases = np.ascontiguousarray(phases, np.float64)
    figures = (table.rest, table.legs, table.soles)
    steps = (mix.who, mix.rows, mix.weights, mix.samples, mix.stance, mix.ahead, mix.left_strike, mix.stride)
    _pose_all(table.body, table.feet, *figures, *steps, phases, out)
    return out


@njit(cache=True, error_model="numpy")
def _pose_all(
    body: Any,
    feet: Any,
    rest: Any,
    legs: Any,
    soles: Any,
    who: Any,
    rows: Any,
    weights: Any,
    samples: Any,
    stance: Any,
    ahead: Any,
    left_strike: Any,
    stride: Any,
    phases: Any,
    out: Any,
) -> None:
    columns = np.empty(COLUMNS, np.float32)
    channels = np.empty(_CHANNELS, np.float32)
    turns = np.empty((UPPER_COUNT, 4))
    marks = np.empty((2, 11))
    for n in range(len(who)):
        person, frames = who[n], out[n]
        phase = phases[n] - floor(phases[n])
        _blend(body, rows[n], weights[n], samples[n], phase, COLUMNS, columns)
        _turn_upper_body(columns, turns, frames)
        hips = columns[4 * UPPER_COUNT :]
        for side in range(2):
            own = phase if side == 1 else (phase - left_strike[n]) % 1.0
            clock = _clock(own, stance[n, side])
            _blend(feet[side], rows[n], weights[n], samples[n], clock, _CHANNELS, channels)
            place = ahead[n, side] + stride[n] * _footprint_travel(own, stance[n, side])
            _place_foot(soles[person], channels, clock, place, stride[n], marks[side])
        _pose_legs(legs[person], marks, hips, frames)
        _move(rest[person], hips, frames)


@_part
def _blend(table: Any, rows: Any, weights: Any, samples: int, place: float, columns: int, total: Any) -> None:
    position = place * samples
    sample = min(int(position), samples - 1)
    share = position - sample
    total[:] = 0.0
    for m in range(len(rows)):
        if weights[m] == 0.0:
            continue
        here, there = np.float32(weights[m] * (1.0 - share)), np.float32(weights[m] * share)
        first, second = table[rows[m] + sample], table[rows[m] + sample + 1]
        for column in range(columns):
            total[column] += here * first[column] + there * second[column]


@_part
def _turn_upper_body(columns: Any, turns: Any, frames: Any) -> None:
    for joint in range(UPPER_COUNT):
        x, y, z, w = (
            columns[joint],
            columns[UPPER_COUNT + joint],
            columns[2 * UPPER_COUNT + joint],
            columns[3 * UPPER_COUNT + joint],
        )
        size = np.float32(1.0) / sqrt(x * x + y * y + z * z + w * w)
        turns[joint, 0], turns[joint, 1], turns[joint, 2], turns[joint, 3] = x * size, y * size, z * size, w * size
    for joint in range(UPPER_COUNT):
        bx, by, bz, bw = turns[joint, 0], turns[joint, 1], turns[joint, 2], turns[joint, 3]
        if joint > 0:
            above = _ABOVE_BY_DEPTH[joint]
            ax, ay, az, aw = turns[above, 0], turns[above, 1], turns[above, 2], turns[above, 3]
            bx, by, bz, bw = (
                aw * bx + ax * bw + ay * bz - az * by,
                aw * by - ax * bz + ay * bw + az * bx,
                aw * bz + ax * by - ay * bx + az * bw,
                aw * bw - ax * bx - ay * by - az * bz,
            )
            turns[joint, 0], turns[joint, 1], turns[joint, 2], turns[joint, 3] = bx, by, bz, bw
        first, second, third = frames[_PLANES[joint]]
        first[0], first[1], first[2] = 1 - 2 * (by * by + bz * bz), 2 * (bx * by - bz * bw), 2 * (bx * bz + by * bw)
        second[0], second[1], second[2] = 2 * (bx * by + bz * bw), 1 - 2 * (bx * bx + bz * bz), 2 * (by * bz - bx * bw)
        third[0], third[1], third[2] = 2 * (bx * bz - by * bw), 2 * (by * bz + bx * bw), 1 - 2 * (bx * bx + by * by)


@_part
def _clock(phase: float, stance: float) -> float:
    if phase < stance:
        return phase * (STANCE_END / stance)
    return STANCE_END + (phase - stance) * ((1.0 - STANCE_END) / (1.0 - stance))


@_part
def _smooth_step(x: float) -> float:
    x = min(max(x, 0.0), 1.0)
    return x * x * x * (10.0 + x * (-15.0 + 6.0 * x))


@_part
def _softly_positive(x: float) -> float:
    if abs(x) > 40.0:  # the rest is less than the last digit
        return max(x, 0.0)
    return max(x, 0.0) + log1p(exp(-abs(x)))


@_part
def _footprint_travel(phase: float, stance: float) -> float:
    if phase < stance:
        return -phase
    return -phase + _smooth_step((phase - stance) / ((1.0 - stance) * ARRIVAL))


@_part
def _toe_bend(heel_up: float, swing: float) -> float:
    over = TOE_BEND_SOFTNESS * _softly_positive((heel_up - TOE_BEND_LIMIT) / TOE_BEND_SOFTNESS)
    return max(heel_up - over, 0.0) * (1.0 - _smooth_step(2.0 * swing))


@_part
def _place_foot(sole: Any, channels: Any, clock: float, place: float, stride: float, marks: Any) -> None:
    """marks: ankle (3), clearance, yaw of the knee; cosines and sines of the foot's yaw, its pitch, and the toes'."""
    ankle_height, heel, ball, ball_height, tip = sole[0], sole[1], sole[2], sole[3], sole[4]
    pitch, clearance, travel, aside, yaw, knee_yaw = channels
    pitch = pitch * pitch * pitch / (pitch * pitch + FLAT_ZONE * FLAT_ZONE)
    c, s, cy, sy = cos(pitch), sin(pitch), cos(yaw), sin(yaw)
    if pitch >= 0.0:  # the toes are straight
        ct, st = c, s
        forward, up = heel * c - ankle_height * s - heel, ankle_height * c + heel * s
    else:
        toes = pitch + _toe_bend(-pitch, max(clock - STANCE_END, 0.0) / (1.0 - STANCE_END))
        ct, st = cos(toes), sin(toes)
        back, rise = ball - tip, ankle_height - ball_height
        forward = tip + back * ct - ball_height * st - ball * c - rise * s
        up = ball_height * ct + back * st + rise * c - ball * s
    marks[0], marks[1], marks[2] = aside + sy * forward, up + clearance, place + stride * travel + cy * forward
    marks[3], marks[4] = clearance, knee_yaw
    marks[5], marks[6], marks[7], marks[8], marks[9], marks[10] = cy, sy, c, s, ct, st


@_part
def _pose_legs(legs: Any, marks: Any, hips: Any, frames: Any) -> None:
    """Turns the legs, and lowers the hips where a leg would not reach."""
    pelvis = frames[_HIPS]
    lowering = 0.0
    ways = np.empty((2, 3))
    for side in range(2):
        leg, mark, way = legs[side], marks[side], ways[side]
        for row in range(3):
            socket = pelvis[row, 0] * leg[2] + pelvis[row, 1] * leg[3] + pelvis[row, 2] * leg[4]
            way[row] = mark[row] - hips[row] - socket
        far = sqrt(way[0] * way[0] + way[2] * way[2])
        if far > FURTHEST * (leg[0] + leg[1]):
            way[0] *= FURTHEST * (leg[0] + leg[1]) / far
            way[2] *= FURTHEST * (leg[0] + leg[1]) / far
        reach = STRAIGHTEST * (leg[0] + leg[1])
        room = sqrt(max(reach * reach - way[0] * way[0] - way[2] * way[2], 0.0))
        lowering += LOWERING_SOFTNESS * _softly_positive((-way[1] - room - mark[3]) / LOWERING_SOFTNESS)
    hips[1] -= lowering
    for side in range(2):
        ways[side, 1] += lowering
        mark, own = marks[side], _LEGS[side]
        _solve(legs[side], ways[side], mark[4], frames[own[0]], frames[own[1]])
        _turn_foot(mark[5], mark[6], mark[7], mark[8], frames[own[2]])
        _turn_foot(mark[5], mark[6], mark[9], mark[10], frames[own[3]])


@_part
def _solve(leg: Any, way: Any, knee_yaw: float, thigh: Any, shank: Any) -> None:
    dx, dy, dz = way[0], way[1], way[2]
    far = sqrt(dx * dx + dy * dy + dz * dz)
    dx, dy, dz = dx / far, dy / far, dz / far
    far = min(far, STRAIGHTEST * (leg[0] + leg[1]))
    fx, fz = sin(knee_yaw), cos(knee_yaw)
    along = fx * dx + fz * dz
    fx, fy, fz = fx - along * dx, -along * dy, fz - along * dz
    size = sqrt(fx * fx + fy * fy + fz * fz)
    fx, fy, fz = fx / size, fy / size, fz / size
    hx, hy, hz = fy * dz - fz * dy, fz * dx - fx * dz, fx * dy - fy * dx
    for bone in range(2):
        near, other = leg[bone], leg[1 - bone]
        c = min(max((near * near + far * far - other * other) / (2.0 * near * far), -1.0), 1.0)
        s = sqrt(1.0 - c * c)
        if bone == 1:
            s = -s
        ax, ay, az = c * dx + s * fx, c * dy + s * fy, c * dz + s * fz
        rest = leg[5 + 9 * bone : 14 + 9 * bone]
        frame = shank if bone == 1 else thigh
        _times_rest(ax, hx, hy * az - hz * ay, rest, frame[0])
        _times_rest(ay, hy, hz * ax - hx * az, rest, frame[1])
        _times_rest(az, hz, hx * ay - hy * ax, rest, frame[2])


@_part
def _times_rest(a: float, b: float, c: float, rest: Any, row: Any) -> None:
    for column in range(3):
        row[column] = a * rest[column] + b * rest[3 + column] + c * rest[6 + column]


@_part
def _turn_foot(c: float, s: float, level: float, up: float, frame: Any) -> None:
    """Toes up by a pitch (cosine level, sine up), then headed to a yaw (cosine c, sine s)."""
    frame[0, 0], frame[0, 1], frame[0, 2] = c, -s * up, s * level
    frame[1, 0], frame[1, 1], frame[1, 2] = 0.0, level, up
    frame[2, 0], frame[2, 1], frame[2, 2] = -s, -c * up, c * level


@_part
def _move(rest: Any, hips: Any, frames: Any) -> None:
    """As poses._move: from parent to child only the difference of their turns counts."""
    for joint in range(len(_PLANES)):
        own, above = frames[_PLANES[joint]], frames[_ABOVE[joint]]
        x, y, z = rest[joint, 0], rest[joint, 1], rest[joint, 2]
        for row in range(3):
            if joint == 0:
                own[row, 3] = hips[row] - (own[row, 0] * x + own[row, 1] * y + own[row, 2] * z)
            else:
                own[row, 3] = (
                    above[row, 3]
                    + (above[row, 0] - own[row, 0]) * x
                    + (above[row, 1] - own[row, 1]) * y
                    + (above[row, 2] - own[row, 2]) * z
                )

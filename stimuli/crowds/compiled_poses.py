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


def many_transforms(
    mix: Mix,
    phases: Floats,
    out: Singles | None = None,
    sizes: Floats | None = None,
    places: Floats | None = None,
) -> Singles:
    """As poses.many_transforms."""
    if out is None:
        out = np.empty((len(mix), len(JOINTS), 2, 4), np.float32)
    table = mix.table
    phases = np.ascontiguousarray(phases, np.float64)
    figures = (table.rest, table.legs, table.soles)
    steps = (mix.who, mix.rows, mix.weights, mix.samples, mix.stance, mix.ahead, mix.left_strike, mix.stride)
    sizes = np.ones(len(mix)) if sizes is None else np.ascontiguousarray(sizes, np.float64)
    places = np.zeros((len(mix), 2)) if places is None else np.ascontiguousarray(places, np.float64)
    _pose_all(table.body, table.feet, *figures, *steps, phases, sizes, places, out)
    return out


@_part
def _write_matrix(rotation: Any, turn: Any) -> None:
    x, y, z, w = rotation
    turn[0, 0], turn[0, 1], turn[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)
    turn[1, 0], turn[1, 1], turn[1, 2] = 2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)
    turn[2, 0], turn[2, 1], turn[2, 2] = 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)


@njit(cache=True, error_model="numpy")
def matrices_of_one(transforms: Any) -> Any:
    """(21, 3, 4): bind-pose vertices -> the walker's frame, of transforms (21, 2, 4) with unit quaternions."""
    matrices = np.empty((transforms.shape[0], 3, 4), np.float32)
    for joint in range(transforms.shape[0]):
        _write_matrix(transforms[joint, 0], matrices[joint])
        matrices[joint, :, 3] = transforms[joint, 1, :3]
    return matrices


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
    sizes: Any,
    places: Any,
    out: Any,
) -> None:
    columns = np.empty(COLUMNS, np.float32)
    channels = np.empty(_CHANNELS, np.float32)
    turns = np.empty((UPPER_COUNT, 4))
    turn = np.empty((len(_PLANES), 3, 3))
    marks = np.empty((2, 11))
    for n in range(len(who)):
        person, frames = who[n], out[n]
        phase = phases[n] - floor(phases[n])
        _blend(body, rows[n], weights[n], samples[n], phase, COLUMNS, columns)
        _turn_upper_body(columns, turns, frames)
        _write_matrix(frames[_HIPS, 0], turn[_HIPS])
        hips = columns[4 * UPPER_COUNT :]
        for side in range(2):
            own = phase if side == 1 else (phase - left_strike[n]) % 1.0
            clock = _clock(own, stance[n, side])
            _blend(feet[side], rows[n], weights[n], samples[n], clock, _CHANNELS, channels)
            place = ahead[n, side] + stride[n] * _footprint_travel(own, stance[n, side])
            _place_foot(soles[person], channels, clock, place, stride[n], marks[side])
        _pose_legs(legs[person], marks, hips, turn[_HIPS], frames)
        _move(rest[person], hips, turn, frames)
        _put(sizes[n], places[n], frames)


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
        frames[_PLANES[joint], 0, 0], frames[_PLANES[joint], 0, 1] = bx, by
        frames[_PLANES[joint], 0, 2], frames[_PLANES[joint], 0, 3] = bz, bw


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
    """marks: ankle (3), clearance, yaw of the knee; cosines and sines of half the foot's yaw, pitch, and the toes'."""
    ankle_height, heel, ball, ball_height, tip = sole[0], sole[1], sole[2], sole[3], sole[4]
    pitch, clearance, travel, aside, yaw, knee_yaw = channels
    pitch = pitch * pitch * pitch / (pitch * pitch + FLAT_ZONE * FLAT_ZONE)
    level, lift, cy, sy = cos(0.5 * pitch), sin(0.5 * pitch), cos(0.5 * yaw), sin(0.5 * yaw)
    c, s = level * level - lift * lift, 2.0 * level * lift
    if pitch >= 0.0:  # the toes are straight
        toe_level, toe_lift = level, lift
        forward, up = heel * c - ankle_height * s - heel, ankle_height * c + heel * s
    else:
        toes = pitch + _toe_bend(-pitch, max(clock - STANCE_END, 0.0) / (1.0 - STANCE_END))
        toe_level, toe_lift = cos(0.5 * toes), sin(0.5 * toes)
        ct, st = toe_level * toe_level - toe_lift * toe_lift, 2.0 * toe_level * toe_lift
        back, rise = ball - tip, ankle_height - ball_height
        forward = tip + back * ct - ball_height * st - ball * c - rise * s
        up = ball_height * ct + back * st + rise * c - ball * s
    aside += 2.0 * sy * cy * forward
    ahead = place + stride * travel + (cy * cy - sy * sy) * forward
    marks[0], marks[1], marks[2], marks[3], marks[4] = aside, up + clearance, ahead, clearance, knee_yaw
    marks[5], marks[6], marks[7], marks[8], marks[9], marks[10] = cy, sy, level, lift, toe_level, toe_lift


@_part
def _pose_legs(legs: Any, marks: Any, hips: Any, pelvis: Any, frames: Any) -> None:
    """Turns the legs, and lowers the hips where a leg would not reach."""
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
        _solve(legs[side], ways[side], mark[4], frames[own[0], 0], frames[own[1], 0])
        _turn_foot(mark[5], mark[6], mark[7], mark[8], frames[own[2], 0])
        _turn_foot(mark[5], mark[6], mark[9], mark[10], frames[own[3], 0])


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
    w = 0.5 * sqrt(max(1.0 + hx - dy + fz, 1e-6))
    x, y, z = 0.25 * (-dz - fy) / w, 0.25 * (fx - hz) / w, 0.25 * (hy + dx) / w
    for bone in range(2):
        near, other = leg[bone], leg[1 - bone]
        c = min(max((near * near + far * far - other * other) / (2.0 * near * far), -1.0), 1.0)
        half_cosine = sqrt(max(0.5 + 0.5 * c, 1e-6))
        half_sine = -0.5 * sqrt(1.0 - c * c) / half_cosine
        if bone == 1:
            half_sine = -half_sine
        ax, ay = w * half_sine + x * half_cosine, y * half_cosine + z * half_sine
        az, aw = z * half_cosine - y * half_sine, w * half_cosine - x * half_sine
        first = 5 + 4 * bone
        bx, by, bz, bw = leg[first], leg[first + 1], leg[first + 2], leg[first + 3]
        turn = shank if bone == 1 else thigh
        turn[0], turn[1] = aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx
        turn[2], turn[3] = aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz


@_part
def _turn_foot(cy: float, sy: float, level: float, lift: float, turn: Any) -> None:
    """Toes up by a pitch, then headed to a yaw, of both the cosine and the sine of half."""
    turn[0], turn[1], turn[2], turn[3] = -cy * lift, sy * level, sy * lift, cy * level


@_part
def _move(rest: Any, hips: Any, turn: Any, frames: Any) -> None:
    """As poses._move: from parent to child only the difference of their turns counts."""
    for joint in range(len(_PLANES)):
        number, above = _PLANES[joint], _ABOVE[joint]
        own, outer, moved = turn[number], turn[above], frames[number, 1]
        x, y, z = rest[joint, 0], rest[joint, 1], rest[joint, 2]
        _write_matrix(frames[number, 0], own)
        for row in range(3):
            if joint == 0:
                moved[row] = hips[row] - (own[row, 0] * x + own[row, 1] * y + own[row, 2] * z)
            else:
                moved[row] = (
                    frames[above, 1, row]
                    + (outer[row, 0] - own[row, 0]) * x
                    + (outer[row, 1] - own[row, 1]) * y
                    + (outer[row, 2] - own[row, 2]) * z
                )
        moved[3] = 0.0


@_part
def _put(size: float, place: Any, frames: Any) -> None:
    """Makes a walker as large as wanted and puts it on its place on the ground."""
    length, times, x, z = np.float32(sqrt(size)), np.float32(size), np.float32(place[0]), np.float32(place[1])
    for joint in range(len(frames)):
        for number in range(4):
            frames[joint, 0, number] *= length
        frames[joint, 1, 0] = frames[joint, 1, 0] * times + x
        frames[joint, 1, 1] *= times
        frames[joint, 1, 2] = frames[joint, 1, 2] * times + z

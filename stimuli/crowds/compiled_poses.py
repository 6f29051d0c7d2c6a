"""crowd_poses with numba: one walker after the other, one thread. Importing it needs the extra `fast`.

The same arithmetic as crowd_poses, which says what it means; a test holds the two together.
"""

from __future__ import annotations

from math import cos, exp, floor, log1p, sin, sqrt
from typing import Any

import numpy as np
from numba import njit

from stimuli.crowds.table import DEPTH_ORDER, PLANES, UPPER_COUNT, Mix, Singles
from stimuli.legs.contact import ARRIVAL, FLAT_ZONE, STANCE_END, TOE_BEND_LIMIT, TOE_BEND_SOFTNESS
from stimuli.legs.two_bone import FURTHEST, STRAIGHTEST
from stimuli.skeleton import JOINTS, PARENTS, Floats
from stimuli.walker import LOWERING_SOFTNESS

_ABOVE = np.array([DEPTH_ORDER.index(JOINTS[PARENTS[j]]) if PARENTS[j] >= 0 else 0 for j in PLANES.tolist()])
_PLANES = PLANES.astype(np.int64)
_FLAT = float(FLAT_ZONE)
_BEND_LIMIT, _BEND_SOFTNESS = float(TOE_BEND_LIMIT), float(TOE_BEND_SOFTNESS)


def many_matrices(mix: Mix, phases: Floats, out: Singles | None = None) -> Singles:
    """As crowd_poses.many_matrices."""
    if out is None:
        out = np.empty((len(mix), len(JOINTS), 3, 4), np.float32)
    table = mix.table
    phases = np.ascontiguousarray(phases, np.float64)
    figures = (table.offsets, table.rest, table.legs, table.soles)
    steps = (mix.who, mix.rows, mix.weights, mix.samples, mix.stance, mix.ahead, mix.left_strike, mix.stride)
    _pose_all(table.body, table.feet, *figures, *steps, phases, out)
    return out


@njit(cache=True)
def _pose_all(
    body: Any,
    feet: Any,
    offsets: Any,
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
    columns = np.empty(body.shape[1], np.float32)
    channels = np.empty((2, feet.shape[2]), np.float32)
    turns = np.empty((4, UPPER_COUNT))
    turn = np.empty((len(_ABOVE), 9))
    places = np.empty((len(_ABOVE), 3))
    marks = np.empty((2, 8))
    for n in range(len(who)):
        person = who[n]
        phase = phases[n] - floor(phases[n])
        _blend(body, rows[n], weights[n], samples[n], phase, columns)
        _turn_upper_body(columns, turns, turn)
        places[0] = columns[4 * UPPER_COUNT :]
        for side in range(2):
            own = phase if side == 1 else (phase - left_strike[n]) % 1.0
            clock = _clock(own, stance[n, side])
            _blend(feet[side], rows[n], weights[n], samples[n], clock, channels[side])
            place = ahead[n, side] + stride[n] * _footprint_travel(own, stance[n, side])
            _place_foot(soles[person], channels[side], clock, place, stride[n], marks[side])
        _pose_legs(legs[person], marks, places, turn)
        _write(offsets[person], rest[person], turn, places, out[n])


@njit(cache=True)
def _blend(table: Any, rows: Any, weights: Any, samples: int, place: float, total: Any) -> None:
    position = place * samples
    sample = min(int(position), samples - 1)
    share = position - sample
    total[:] = 0.0
    for m in range(len(rows)):
        if weights[m] == 0.0:
            continue
        here, there = np.float32(weights[m] * (1.0 - share)), np.float32(weights[m] * share)
        first, second = table[rows[m] + sample], table[rows[m] + sample + 1]
        for column in range(len(total)):
            total[column] += here * first[column] + there * second[column]


@njit(cache=True)
def _turn_upper_body(columns: Any, turns: Any, turn: Any) -> None:
    for joint in range(UPPER_COUNT):
        bx, by, bz, bw = (
            columns[joint],
            columns[UPPER_COUNT + joint],
            columns[2 * UPPER_COUNT + joint],
            columns[3 * UPPER_COUNT + joint],
        )
        size = 1.0 / sqrt(bx * bx + by * by + bz * bz + bw * bw)
        bx, by, bz, bw = bx * size, by * size, bz * size, bw * size
        if joint > 0:
            above = _ABOVE[joint]
            ax, ay, az, aw = turns[0, above], turns[1, above], turns[2, above], turns[3, above]
            bx, by, bz, bw = (
                aw * bx + ax * bw + ay * bz - az * by,
                aw * by - ax * bz + ay * bw + az * bx,
                aw * bz + ax * by - ay * bx + az * bw,
                aw * bw - ax * bx - ay * by - az * bz,
            )
        turns[0, joint], turns[1, joint], turns[2, joint], turns[3, joint] = bx, by, bz, bw
        matrix = turn[joint]
        matrix[0], matrix[1], matrix[2] = 1 - 2 * (by * by + bz * bz), 2 * (bx * by - bz * bw), 2 * (bx * bz + by * bw)
        matrix[3], matrix[4], matrix[5] = 2 * (bx * by + bz * bw), 1 - 2 * (bx * bx + bz * bz), 2 * (by * bz - bx * bw)
        matrix[6], matrix[7], matrix[8] = 2 * (bx * bz - by * bw), 2 * (by * bz + bx * bw), 1 - 2 * (bx * bx + by * by)


@njit(cache=True)
def _clock(phase: float, stance: float) -> float:
    if phase < stance:
        return phase * (STANCE_END / stance)
    return STANCE_END + (phase - stance) * ((1.0 - STANCE_END) / (1.0 - stance))


@njit(cache=True)
def _smooth_step(x: float) -> float:
    x = min(max(x, 0.0), 1.0)
    return x * x * x * (10.0 + x * (-15.0 + 6.0 * x))


@njit(cache=True)
def _softly_positive(x: float) -> float:
    return max(x, 0.0) + log1p(exp(-abs(x)))


@njit(cache=True)
def _footprint_travel(phase: float, stance: float) -> float:
    if phase < stance:
        return -phase
    return -phase + _smooth_step((phase - stance) / ((1.0 - stance) * ARRIVAL))


@njit(cache=True)
def _place_foot(sole: Any, channels: Any, clock: float, place: float, stride: float, marks: Any) -> None:
    """marks: ankle (3), pitch, bend, yaw, knee yaw, clearance."""
    ankle_height, heel, ball, ball_height, tip = sole[0], sole[1], sole[2], sole[3], sole[4]
    pitch, clearance, travel, aside, yaw, knee_yaw = channels
    pitch = pitch * pitch * pitch / (pitch * pitch + _FLAT * _FLAT)
    heel_up = max(-pitch, 0.0)
    over = _BEND_SOFTNESS * _softly_positive((heel_up - _BEND_LIMIT) / _BEND_SOFTNESS)
    swing = max(clock - STANCE_END, 0.0) / (1.0 - STANCE_END)
    bend = max(heel_up - over, 0.0) * (1.0 - _smooth_step(2.0 * swing))
    c, s = cos(pitch), sin(pitch)
    if pitch >= 0.0:
        forward, up = heel * c - ankle_height * s - heel, ankle_height * c + heel * s
    else:
        toes = min(pitch + bend, 0.0)
        ct, st = cos(toes), sin(toes)
        back, rise = ball - tip, ankle_height - ball_height
        forward = tip + back * ct - ball_height * st - ball * c - rise * s
        up = ball_height * ct + back * st + rise * c - ball * s
    marks[0] = aside + sin(yaw) * forward
    marks[1] = up + clearance
    marks[2] = place + stride * travel + cos(yaw) * forward
    marks[3], marks[4], marks[5], marks[6], marks[7] = pitch, bend, yaw, knee_yaw, clearance


@njit(cache=True)
def _pose_legs(legs: Any, marks: Any, places: Any, turn: Any) -> None:
    hips, hips_turn = places[0], turn[0]
    lowering = 0.0
    ways = np.empty((2, 3))
    for side in range(2):
        leg, mark, way = legs[side], marks[side], ways[side]
        for row in range(3):
            socket = hips_turn[3 * row] * leg[2] + hips_turn[3 * row + 1] * leg[3] + hips_turn[3 * row + 2] * leg[4]
            way[row] = mark[row] - hips[row] - socket
        far = sqrt(way[0] * way[0] + way[2] * way[2])
        if far > FURTHEST * (leg[0] + leg[1]):
            way[0] *= FURTHEST * (leg[0] + leg[1]) / far
            way[2] *= FURTHEST * (leg[0] + leg[1]) / far
        reach = STRAIGHTEST * (leg[0] + leg[1])
        room = sqrt(max(reach * reach - way[0] * way[0] - way[2] * way[2], 0.0))
        lowering += LOWERING_SOFTNESS * _softly_positive((-way[1] - room - mark[7]) / LOWERING_SOFTNESS)
    hips[1] -= lowering
    for side in range(2):
        ways[side, 1] += lowering
        _solve(legs[side], ways[side], marks[side, 6], turn[13 + side], turn[15 + side])
        _turn_foot(marks[side, 5], marks[side, 3], turn[17 + side])
        _turn_foot(marks[side, 5], marks[side, 3] + marks[side, 4], turn[19 + side])


@njit(cache=True)
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
        target = shank if bone == 1 else thigh
        _times_rest(ax, hx, hy * az - hz * ay, rest, target[0:3])
        _times_rest(ay, hy, hz * ax - hx * az, rest, target[3:6])
        _times_rest(az, hz, hx * ay - hy * ax, rest, target[6:9])


@njit(cache=True)
def _times_rest(a: float, b: float, c: float, rest: Any, row: Any) -> None:
    for column in range(3):
        row[column] = a * rest[column] + b * rest[3 + column] + c * rest[6 + column]


@njit(cache=True)
def _turn_foot(yaw: float, pitch: float, matrix: Any) -> None:
    c, s, up, level = cos(yaw), sin(yaw), sin(pitch), cos(pitch)
    matrix[0], matrix[1], matrix[2] = c, -s * up, s * level
    matrix[3], matrix[4], matrix[5] = 0.0, level, up
    matrix[6], matrix[7], matrix[8] = -s, -c * up, c * level


@njit(cache=True)
def _write(offsets: Any, rest: Any, turn: Any, places: Any, out: Any) -> None:
    for joint in range(len(_ABOVE)):
        above = turn[_ABOVE[joint]]
        own, matrix, bound = turn[joint], out[_PLANES[joint]], rest[joint]
        for row in range(3):
            first = 3 * row
            if joint > 0:
                places[joint, row] = (
                    places[_ABOVE[joint], row]
                    + above[first] * offsets[joint, 0]
                    + above[first + 1] * offsets[joint, 1]
                    + above[first + 2] * offsets[joint, 2]
                )
            moved = own[first] * bound[0] + own[first + 1] * bound[1] + own[first + 2] * bound[2]
            matrix[row, 0], matrix[row, 1], matrix[row, 2] = own[first], own[first + 1], own[first + 2]
            matrix[row, 3] = places[joint, row] - moved

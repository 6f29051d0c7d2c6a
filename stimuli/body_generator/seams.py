"""Seams of clothes: narrow dark ribbons along lines on the cloth, laid on to its triangles.

Hems, armholes, side seams and pockets are what tells cloth that was sewn from a skin of rubber. They are finer than the
triangles of a garment, so they are ribbons of their own, in the garment's material.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from stimuli.body_generator.fields import Field
from stimuli.body_generator.figure import ARM_ANGLE, Figure
from stimuli.body_generator.polygons import Mesh, settled
from stimuli.skeleton import Floats

WIDTH = 0.28  # cm
LIFT = 0.13  # cm above the cloth
DARK = 0.52  # of the light that the cloth beside it gets
STEP = 0.5  # cm between points of a line before those that lie straight are dropped
STRAIGHT = 0.035  # cm
_CANDIDATES = 64  # triangles near a point that it may lie on

Line = Floats
"""(N, 3) cm, points of a seam."""


def shirt_seams(figure: Figure, cloth: Field, collar: Field) -> tuple[Line, ...]:
    """Armholes, stitches of hem and sleeves, and the lower edge of the collar's band (`collar` = 0) of a T-shirt."""
    x, y, _ = figure.shoulder
    hem, end = figure.shirt[0][0] + 2.2, figure.sleeve[-1][0] - 1.9
    thick = 0.82 if figure.female else 1.0
    armhole = [
        (x - 1.6, y - 10.2, 4.6 * thick),
        (x - 2.4, y - 5.0, 7.5 * thick),
        (x - 1.8, y - 0.5, 5.2 * thick),
        (x - 1.2, y + 4.5, -1.4),
        (x - 1.6, y - 0.5, -8.0 * thick),
        (x - 2.0, y - 5.0, -9.5 * thick),
        (x - 1.2, y - 10.2, -7.0 * thick),
    ]
    across = np.array([np.cos(ARM_ANGLE), np.sin(ARM_ANGLE), 0.0])
    cuff = np.array(figure.shoulder) + end * figure.arm_direction
    turn = np.linspace(0, 2 * np.pi, 90)[:, None]
    sleeve = cuff + 6.2 * thick * (np.cos(turn) * across + np.sin(turn) * np.array([0.0, 0, 1]))
    waist = np.column_stack([17.5 * np.cos(turn), np.full(len(turn), hem), 12.5 * np.sin(turn)])
    neck = np.column_stack([9 * np.sin(turn), np.full(len(turn), figure.neck[1] - 3), 9 * np.cos(turn) - 2])
    for _ in range(12):
        neck = settled(collar, _on(cloth, neck), 2.0)
    lines = [waist, neck, *_both(sleeve), *_both(_through(armhole))]
    return tuple(_on(cloth, line) for line in lines)


def trouser_seams(figure: Figure, cloth: Field, ends: Field) -> tuple[Line, ...]:
    """Outer seams, pockets, fly, the seam behind and the stitches of the leg ends."""
    top, hip, ankle = figure.shirt[0][0] + 0.8, np.array(figure.hip), np.array(figure.ankle)

    def at(y: float, turn: float, radius: float = 9.0) -> tuple[float, float, float]:
        """On the left leg: turn 0 outside, a quarter turn in front."""
        x = np.interp(y, (ankle[1], hip[1]), (ankle[0], hip[0]))
        return float(x + radius * np.cos(turn)), y, float(radius * np.sin(turn))

    behind = -np.pi / 2
    outer = _through([at(y, -0.05, 8.0) for y in np.linspace(top, ankle[1] - 2.0, 14)])
    pocket = _through([at(top, 1.0, 10.5), at(top - 6, 0.66, 10.5), at(top - 11, 0.16, 9.5)])
    low = top - 9.5
    back = [
        _through([at(top, behind - 0.50, 11), at(low, behind - 0.44, 11)]),
        _through([at(low, behind - 0.44, 11), at(low - 1.6, behind, 11), at(low, behind + 0.44, 11)]),
        _through([at(low, behind + 0.44, 11), at(top, behind + 0.50, 11)]),
    ]
    turn = np.linspace(0, 2 * np.pi, 80)
    cuff = np.array([at(ankle[1] + 1, a, 7.0) for a in turn])
    for _ in range(3):
        cuff[:, 1] += ends(cuff) + 2.2
        cuff = _on(cloth, cuff)
    fly = _through([(0.2, top, 11), (0.2, top - 5, 10.5), (0.0, hip[1] - 8.0, 8.5)])
    seat = _through([(0.0, top, -12.5), (0.0, top - 5, -12), (0.0, hip[1] - 11.0, -7)])
    lines = [fly, seat]
    for line in (outer, pocket, *back, cuff):
        lines += _both(line)
    return tuple(_on(cloth, line) for line in lines)


def sewn(mesh: Mesh, normals: Floats, shade: Floats, lines: Sequence[Line]) -> tuple[Mesh, Floats, Floats]:
    """Ribbons along the lines on a garment's mesh, with their normals and shade; front and back make them closed.

    normals (V, 3), shade (V,): of the mesh.
    """
    positions: list[Floats] = []
    triangles, found_normals, found_shade = [], [], []
    count = 0
    for line in lines:
        place, facing, light = _laid(mesh, normals, shade, line)
        kept = _bends(place)
        place, facing, light = place[kept], facing[kept], light[kept]
        across = np.cross(np.gradient(place, axis=0), facing)
        across *= 0.5 * WIDTH / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-9)
        middle = place + LIFT * facing
        positions.append(np.stack([middle + across, middle - across], axis=1).reshape(-1, 3))
        i = count + 2 * np.arange(len(place) - 1)
        front = np.concatenate([np.stack([i, i + 2, i + 1], 1), np.stack([i + 1, i + 2, i + 3], 1)])
        triangles += [front, front[:, ::-1]]
        found_normals.append(np.repeat(facing, 2, axis=0))
        found_shade.append(np.repeat(DARK * light, 2))
        count += 2 * len(place)
    ribbons = Mesh(np.concatenate(positions), np.concatenate(triangles))
    return ribbons, np.concatenate(found_normals), np.concatenate(found_shade)


def _through(points: Sequence[Sequence[float]]) -> Line:
    """A smooth curve through points, STEP apart."""
    p = np.asarray(points, dtype=np.float64)
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1))])
    found: Line = CubicSpline(along, p)(np.linspace(0, along[-1], max(round(along[-1] / STEP), 3)))
    return found


def _both(line: Line) -> tuple[Line, Line]:
    return line, line * (-1, 1, 1)


def _on(cloth: Field, line: Line) -> Line:
    for _ in range(6):
        line = settled(cloth, line, 3.0)
    return line


def _laid(mesh: Mesh, normals: Floats, shade: Floats, line: Line) -> tuple[Floats, Floats, Floats]:
    """The line's points on the nearest triangles, with the normals and the shade there."""
    corners = mesh.positions[mesh.triangles]
    _, near = cKDTree(corners.mean(axis=1)).query(line, k=_CANDIDATES)
    a, b, c = (corners[near][:, :, i] for i in range(3))
    u, v, w = b - a, c - a, line[:, None, :] - a
    uu, uv, vv = (np.sum(p * q, axis=2) for p, q in ((u, u), (u, v), (v, v)))
    wu, wv = np.sum(w * u, axis=2), np.sum(w * v, axis=2)
    area = np.maximum(uu * vv - uv * uv, 1e-12)
    s, t = (vv * wu - uv * wv) / area, (uu * wv - uv * wu) / area
    shares = np.clip(np.stack([1 - s - t, s, t], axis=2), 0, None)
    shares /= shares.sum(axis=2, keepdims=True)
    there = np.einsum("nks,nksd->nkd", shares, np.stack([a, b, c], axis=2))
    best = np.argmin(np.linalg.norm(there - line[:, None, :], axis=2), axis=1)
    rows = np.arange(len(line))
    share, triangle = shares[rows, best], mesh.triangles[near[rows, best]]
    facing = np.einsum("ns,nsd->nd", share, normals[triangle])
    facing /= np.maximum(np.linalg.norm(facing, axis=1, keepdims=True), 1e-9)
    return there[rows, best], facing, np.einsum("ns,ns->n", share, shade[triangle])


def _bends(line: Line) -> np.ndarray:
    """Indices of the points that the line needs (Douglas & Peucker 1973)."""
    kept = {0, len(line) - 1}
    parts = [(0, len(line) - 1)]
    if np.allclose(line[0], line[-1], atol=0.2):  # a ring has no chord to measure from
        middle = len(line) // 2
        kept, parts = kept | {middle}, [(0, middle), (middle, len(line) - 1)]
    while parts:
        first, last = parts.pop()
        if last - first < 2:
            continue
        chord = line[last] - line[first]
        off = line[first + 1 : last] - line[first]
        along = np.clip(off @ chord / max(float(chord @ chord), 1e-9), 0, 1)
        far = np.linalg.norm(off - along[:, None] * chord, axis=1)
        if far.max() > STRAIGHT:
            middle = first + 1 + int(np.argmax(far))
            kept.add(middle)
            parts += [(first, middle), (middle, last)]
    return np.array(sorted(kept))

"""The treadmill as triangles: a flat laboratory machine without rails or console, which would hide the legs.

Its frame: origin on the belt's middle, x to the walker's left, y up from the belt's surface, +z ahead.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from stimuli.skeleton import Floats

BELT_WIDTH, BELT_LENGTH, ROLLER = 0.60, 1.84, 0.045  # m; ROLLER: radius of the belt's turn at each end
FLOOR = -0.20  # y of the floor the machine stands on, m
HALF_WIDTH, FRONT, BACK = 0.42, 1.08, -0.98  # m, of the whole machine

FRAME_PAINT = (0.150, 0.155, 0.160, 0.45)
RAIL_PAINT = (0.345, 0.350, 0.350, 0.55)
HOOD_PAINT = (0.235, 0.240, 0.245, 0.45)
FOOT_PAINT = (0.030, 0.030, 0.032, 0.80)
BELT_PAINT = (0.060, 0.061, 0.064, 0.85)
"""Linear red, green, blue and roughness."""

VERTEX = np.dtype([("position", "3f4"), ("normal", "3f4"), ("paint", "4f4"), ("belt", "2f4")])
Vertices = NDArray[np.void]


def rounded_box(
    low: Sequence[float], high: Sequence[float], radius: float, paint: tuple[float, ...], steps: int = 1
) -> Vertices:
    """(N,) of VERTEX, three per triangle: a box between two corners (m) with edges rounded by a radius (m).

    steps: flat pieces per rounded eighth of a turn; one is enough where the eye does not come near.
    """
    middle, half = (np.add(low, high)) / 2.0, np.subtract(high, low) / 2.0
    arc = radius * (1.0 - np.tan(math.pi / 4.0 - np.linspace(0.0, math.pi / 4.0, steps + 1)))
    triangles = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            ticks = [np.concatenate([arc - half[a], (half[a] - arc)[::-1]]) for a in (u, v)]
            grid = np.empty((len(ticks[0]), len(ticks[1]), 3))
            grid[..., axis] = sign * half[axis]
            grid[..., u] = ticks[0][:, None]
            grid[..., v] = ticks[1][None, :]
            triangles.append(_two_triangles(grid, sign < 0.0))
    points = np.concatenate(triangles)
    inner = np.clip(points, radius - half, half - radius)
    normals = points - inner
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    vertices = np.zeros(len(points), VERTEX)
    vertices["position"] = middle + inner + radius * normals
    vertices["normal"] = normals
    vertices["paint"] = paint
    return vertices


def belt() -> Vertices:
    """(N,) of VERTEX: the belt's upper side and its turn round both rollers."""
    straight = BELT_LENGTH / 2.0 - ROLLER
    angles = np.linspace(0.0, math.pi, 13)
    along, up, outward = [], [], []
    for end in (-1.0, 1.0):
        order = angles[::-1] if end < 0 else angles
        for angle in order:
            along.append(end * (straight + ROLLER * math.sin(angle)))
            up.append(ROLLER * (math.cos(angle) - 1.0))
            outward.append((math.cos(angle), end * math.sin(angle)))
    profile = np.column_stack([along, up])
    run = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(profile, axis=0), axis=1))])
    run -= run[-1] / 2.0
    grid = np.empty((len(profile), 2, 8))  # position, normal, run, 1
    for column, x in enumerate((-BELT_WIDTH / 2.0, BELT_WIDTH / 2.0)):
        grid[:, column, 0] = x
        grid[:, column, 1:3] = profile[:, ::-1]
        grid[:, column, 3] = 0.0
        grid[:, column, 4:6] = outward
        grid[:, column, 6] = run
        grid[:, column, 7] = 1.0
    flat = _two_triangles(grid, False)
    vertices = np.zeros(len(flat), VERTEX)
    vertices["position"], vertices["normal"] = flat[:, :3], flat[:, 3:6]
    vertices["belt"] = flat[:, 6:]
    vertices["paint"] = BELT_PAINT
    return vertices


def treadmill() -> Vertices:
    """(N,) of VERTEX: the whole machine."""
    inner = BELT_WIDTH / 2.0 + 0.006
    parts = [belt()]
    for side in (-1.0, 1.0):
        x = sorted((side * inner, side * HALF_WIDTH))
        parts.append(rounded_box((x[0], -0.085, BACK), (x[1], 0.014, FRONT - 0.30), 0.012, RAIL_PAINT, 2))
        x = sorted((side * (inner + 0.02), side * (HALF_WIDTH - 0.012)))
        parts.append(rounded_box((x[0], FLOOR + 0.03, BACK + 0.03), (x[1], -0.08, FRONT - 0.1), 0.01, FRAME_PAINT))
        for z in (BACK + 0.14, FRONT - 0.24):
            x = sorted((side * (HALF_WIDTH - 0.13), side * (HALF_WIDTH - 0.03)))
            parts.append(rounded_box((x[0], FLOOR, z - 0.06), (x[1], FLOOR + 0.05, z + 0.06), 0.012, FOOT_PAINT))
    hood = ((-HALF_WIDTH, FLOOR + 0.045, FRONT - 0.32), (HALF_WIDTH, 0.045, FRONT))
    parts.append(rounded_box(*hood, 0.035, HOOD_PAINT, 3))
    parts.append(rounded_box((-inner, FLOOR + 0.035, BACK + 0.01), (inner, -0.025, BACK + 0.055), 0.01, FRAME_PAINT))
    parts.append(rounded_box((-inner, -0.12, BACK + 0.12), (inner, -0.03, FRONT - 0.3), 0.01, FRAME_PAINT))
    return np.concatenate(parts)


def _two_triangles(grid: Floats, flip: bool) -> Floats:
    """(rows, columns, K) corners to (6 (rows-1) (columns-1), K), two triangles for each cell."""
    a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    corners = (a, c, b, a, d, c) if flip else (a, b, c, a, c, d)
    return np.stack(corners, axis=2).reshape(-1, grid.shape[-1])

"""Hair that grows out of the skin: a hairline round the head, a cap from there to the crown, wisps along its edge.

Knows no particular haircut. Coordinates as in `head`: y up with the crown at 175, z forwards, x to the left, cm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.spatial import cKDTree

from stimuli.body_generator.fields import Field
from stimuli.body_generator.head import MIDDLE
from stimuli.body_generator.polygons import Mesh, normals_of
from stimuli.skeleton import Floats

CROWDED = 1.4  # rows of a cap are so much closer together at the hairline than further up
CHORDS = 0.14  # cm, how much deeper than a round crown the middle of a triangle lies with some 8 rows
EAR = (72.0, 114.0)  # degrees round the head within which the hairline is hidden by the ear
BESIDE_EAR = 1.2  # so much denser are a cap's columns there
UNDER_SKIN = 0.06  # cm, where the cap begins


@dataclass(frozen=True, eq=False)
class Hairline:
    """Where hair begins, on the left from the forehead to the nape; the right is its mirror image.

    skull:  what it lies on.
    edge:   (N, 3) closely spaced places on the skull.
    height: (M, 2) its corners: degrees round the head (0 front, 180 nape), and y.
    """

    skull: Field
    edge: Floats
    corners: Floats

    def above(self, points: Floats) -> Floats:
        """(N,) cm from the hairline to below the points on the skull, positive in the hair."""
        local = points - MIDDLE
        length = np.maximum(np.linalg.norm(local, axis=1, keepdims=True), 1e-6)
        root = points - local / length * self.skull(points)[:, None]
        left = np.abs(root) * (1, 0, 0) + root * (0, 1, 1)
        distance, _ = self._near.query(left)
        return distance * np.sign(root[:, 1] - self._height(round_the_head(root)))

    @cached_property
    def _near(self) -> cKDTree:
        return cKDTree(self.edge)

    def _height(self, angle: Floats) -> Floats:
        return np.asarray(np.interp(np.degrees(angle), self.corners[:, 0], self.corners[:, 1]))


def hairline(skull: Field, corners: tuple[tuple[float, float], ...]) -> Hairline:
    """The hairline through corners of (degrees round the head, y)."""
    rough = np.array(corners, dtype=np.float64)
    sampled = np.linspace(0, 180, 1441)
    smooth = np.column_stack([sampled, PchipInterpolator(rough[:, 0], rough[:, 1])(sampled)])
    return Hairline(skull, _at_heights(skull, np.radians(smooth[:, 0]), smooth[:, 1]), smooth)


def round_the_head(points: Floats) -> Floats:
    """(N,) radians from the front, 0, to the nape, pi."""
    return np.asarray(np.abs(np.arctan2(points[:, 0], points[:, 2] - MIDDLE[2])))


def _at_heights(skull: Field, azimuth: Floats, height: Floats) -> Floats:
    """(N, 3) places on the skull of that azimuth (radians) and y."""
    low, high = np.full(len(azimuth), -1.2), np.full(len(azimuth), 1.5)
    for _ in range(40):
        half = 0.5 * (low + high)
        over = _out_to(skull, azimuth, half)[:, 1] > height
        low, high = np.where(over, low, half), np.where(over, half, high)
    return _out_to(skull, azimuth, low)


def _out_to(surface: Field, azimuth: Floats, elevation: Floats) -> Floats:
    """(N, 3) on the surface in these directions from the head's middle; its field measures along them."""
    flat = np.cos(elevation)
    ray = np.column_stack([flat * np.sin(azimuth), np.sin(elevation), flat * np.cos(azimuth)])
    place = np.array(MIDDLE) + 10.0 * ray
    for _ in range(12):
        place = place - ray * surface(place)[:, None]
    return place


def _over_the_ear(edge: Floats) -> NDArray[np.bool_]:
    angle = np.degrees(round_the_head(edge))
    return np.asarray((angle > EAR[0]) & (angle < EAR[1]))


def grown_cap(line: Hairline, volume: Field, columns: int, rows: int, lift: float = 0.0) -> Mesh:
    """The cap from the hairline, a little under the skin, to the crown: an open mesh, its columns spaced along the
    hairline, closest where it turns round the ear, its rows closest together at the hairline. Head coordinates.

    lift: cm further out, so that a coarse cap does not cut into a coarse head.
    """
    edge = np.concatenate([line.edge, line.edge[-2:0:-1] * (-1, 1, 1)])
    steps = np.linalg.norm(np.diff(edge, axis=0, append=edge[:1]), axis=1) * (1 + BESIDE_EAR * _over_the_ear(edge))
    length = np.concatenate([[0], np.cumsum(steps)])
    closed = np.concatenate([edge, edge[:1]])
    at = length[-1] * np.arange(columns) / columns
    start = np.column_stack([np.interp(at, length, closed[:, i]) for i in range(3)])
    local = start - MIDDLE
    azimuth = np.arctan2(local[:, 0], local[:, 2])
    elevation = np.arctan2(local[:, 1], np.hypot(local[:, 0], local[:, 2]))
    t = np.linspace(0, 1, rows + 1)[1:] ** CROWDED
    up = elevation[:, None] + t * (0.5 * np.pi - elevation[:, None])
    grid = _out_to(volume, np.repeat(azimuth, rows), up.ravel()).reshape(columns, rows, 3)
    away = (grid - MIDDLE) / np.linalg.norm(grid - MIDDLE, axis=2, keepdims=True)
    grid += (lift + CHORDS * t[:, None]) * away
    outwards = local / np.linalg.norm(local, axis=1, keepdims=True)
    grid = np.concatenate([(start + (0.5 * lift - UNDER_SKIN) * outwards)[:, None], grid], axis=1)
    i = np.arange(columns * (rows + 1)).reshape(columns, rows + 1)
    j = np.roll(i, -1, axis=0)
    a, b, c, d = (k.ravel() for k in (i[:, :-1], j[:, :-1], j[:, 1:], i[:, 1:]))
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return Mesh(grid.reshape(-1, 3), triangles)


def wisps(
    line: Hairline, flow: Callable[[Floats, Floats], Floats], count: int, length: float, seed: int = 5
) -> tuple[Mesh, Floats, Floats]:
    """Roots and ends of single hairs that lie over the skin along the hairline, so that it is no edge of a cap.

    flow: points (N, 3), normals (N, 3) -> direction (N, 3) in which the hair lies; length: cm, the mean.
    Returns their mesh (head coordinates), normals and shade.
    """
    rng = np.random.default_rng(seed)
    edge = np.concatenate([line.edge, line.edge[-2:0:-1] * (-1, 1, 1)])
    along = np.gradient(edge, axis=0)
    steps = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(edge, axis=0), axis=1))])
    bare = _over_the_ear(edge)
    at = np.interp(np.arange(count) + rng.uniform(0, 1, count), count * np.cumsum(~bare) / np.sum(~bare), steps)
    place, tangent = (np.column_stack([np.interp(at, steps, v[:, i]) for i in range(3)]) for v in (edge, along))
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-9)
    normal = normals_of(line.skull, place, 0.4)
    outwards = np.cross(tangent, normal)
    off = place + 0.2 * outwards
    outwards *= np.where(line.above(off) > 0, -1, 1)[:, None]
    lie = flow(place, normal)
    lie = lie / np.maximum(np.linalg.norm(lie, axis=1, keepdims=True), 1e-9)
    lie = lie * np.where(np.sum(lie * outwards, axis=1) < 0, -1, 1)[:, None] + 0.2 * outwards
    way = lie + rng.normal(0, 0.25, count)[:, None] * tangent
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    tip = place + way * np.minimum(length * rng.gamma(2.0, 0.5, count), 2.2 * length)[:, None]
    half = 0.042 * np.sqrt(300 / count) * rng.uniform(0.6, 1.4, count)[:, None] * tangent
    root = place - 0.30 * outwards - 0.15 * way
    corners = np.stack([root - half, root + half, tip], axis=1)
    flat = corners.reshape(-1, 3)
    flat = flat - normals_of(line.skull, flat, 0.4) * (line.skull(flat) - 0.04)[:, None]
    triangles = np.arange(3 * count).reshape(count, 3)
    normals = normals_of(line.skull, flat, 0.4)
    a, b, c = (flat[triangles[:, k]] for k in range(3))
    wrong = np.sum(np.cross(b - a, c - a) * normals[triangles[:, 0]], axis=1) < 0
    triangles = np.where(wrong[:, None], triangles[:, ::-1], triangles)
    shade = np.repeat(rng.uniform(0.55, 1.0, count), 3)
    return Mesh(flat, triangles), normals, shade

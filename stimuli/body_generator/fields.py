"""Signed distance fields of simple solids, and smooth ways to join them. Knows nothing of people.

A field maps points (N, 3) to values (N,): negative inside, positive outside, about the distance in the
points' own unit (cm in the tables of this package). Smooth minimum and ellipsoid bound after the public
articles of Inigo Quilez; the generalised cylinder is our own.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.interpolate import PchipInterpolator

from stimuli.skeleton import Floats

Field = Callable[[Floats], Floats]
Vector = Sequence[float] | Floats

_TINY = 1e-9


def smooth_min(a: Floats, b: Floats, k: float) -> Floats:
    """Union of two fields whose edge is rounded over about `k`; k = 0 is the plain union."""
    if k <= 0:
        return np.minimum(a, b)
    overlap = np.maximum(k - np.abs(a - b), 0) / k
    return np.minimum(a, b) - overlap * overlap * k * 0.25


def smooth_max(a: Floats, b: Floats, k: float) -> Floats:
    """Intersection of two fields whose edge is rounded over about `k`."""
    return -smooth_min(-a, -b, k)


def join(first: Field, *others: tuple[Field, float]) -> Field:
    """Smooth union, one after the other; each further field brings its own blend width."""

    def field(points: Floats) -> Floats:
        value = first(points)
        for other, k in others:
            value = smooth_min(value, other(points), k)
        return value

    return field


def cut(solid: Field, tool: Field, k: float) -> Field:
    """`solid` without `tool`, the edge rounded over about `k`."""
    return lambda points: smooth_max(solid(points), -tool(points), k)


def mirrored(field: Field) -> Field:
    """The left-hand field used on both sides: right when it never crosses x = 0, else it leaves a crease."""
    return lambda points: field(np.abs(points) * (1, 0, 0) + points * (0, 1, 1))


def both_sides(field: Field, k: float) -> Field:
    """The field and its mirror image joined over `k`: for shapes which cross x = 0."""
    return lambda points: smooth_min(field(points), field(points * (-1, 1, 1)), k)


def moved(field: Field, offset: Vector) -> Field:
    """The field displaced by `offset` (3,)."""
    shift = np.asarray(offset, dtype=np.float64)
    return lambda points: field(points - shift)


def grown(field: Field, by: float) -> Field:
    """The solid thickened by `by`; negative makes it thinner."""
    return lambda points: field(points) - by


def half_space(normal: Vector, through: Vector) -> Field:
    """Everything behind the plane through a point; `normal` (3,) points out of the solid."""
    n = np.asarray(normal, dtype=np.float64)
    n = n / np.linalg.norm(n)
    offset = float(n @ np.asarray(through, dtype=np.float64))
    return lambda points: points @ n - offset


def ellipsoid(centre: Vector, radii: Vector, turned: Floats | None = None) -> Field:
    """Ellipsoid with half axes `radii` (3,); `turned` (3, 3) holds its axes as rows."""
    c = np.asarray(centre, dtype=np.float64)
    r = np.asarray(radii, dtype=np.float64)

    def field(points: Floats) -> Floats:
        local = points - c
        if turned is not None:
            local = local @ turned.T
        k0 = np.sqrt(np.sum((local / r) ** 2, axis=1))
        k1 = np.sqrt(np.sum((local / (r * r)) ** 2, axis=1))
        return k0 * (k0 - 1) / np.maximum(k1, _TINY)

    return field


def capsule(start: Vector, end: Vector, start_radius: float, end_radius: float) -> Field:
    """Rod with round ends whose radius changes linearly from `start_radius` to `end_radius`."""
    a = np.asarray(start, dtype=np.float64)
    d = np.asarray(end, dtype=np.float64) - a
    length2 = float(d @ d)

    def field(points: Floats) -> Floats:
        local = points - a
        t = np.clip(local @ d / length2, 0, 1)
        return np.linalg.norm(local - t[:, None] * d, axis=1) - (start_radius + t * (end_radius - start_radius))

    return field


def generalised_cylinder(
    origin: Vector, along: Vector, u: Vector, stations: Vector | Sequence[Sequence[float]], rounding: float = 0.9
) -> Field:
    """A limb or trunk: super-ellipses of changing size strung along a straight axis.

    origin, along, u: (3,) start of the axis, its direction, and the direction of the first radius; the second is
              w = along x u.
    stations: (S, 8) rows s, cu, cw, u+, u-, w+, w-, n: place on the axis, centre offset, the four radii and the
              exponent (2 = ellipse, more = boxier), joined by monotone cubic curves (PCHIP).
    rounding: of the flat ends.
    """
    o = np.asarray(origin, dtype=np.float64)
    d = np.asarray(along, dtype=np.float64)
    d = d / np.linalg.norm(d)
    uu = np.asarray(u, dtype=np.float64)
    uu = uu - d * (uu @ d)
    uu /= np.linalg.norm(uu)
    ww = np.cross(d, uu)
    table = np.asarray(stations, dtype=np.float64)
    first, last = table[0, 0], table[-1, 0]
    samples = 256
    dense = PchipInterpolator(table[:, 0], table[:, 1:], axis=0)(np.linspace(first, last, samples))

    def field(points: Floats) -> Floats:
        local = points - o
        s = local @ d
        place = np.clip((s - first) / (last - first), 0, 1) * (samples - 1)
        index = np.minimum(place.astype(np.int64), samples - 2)
        part = (place - index)[:, None]
        row = dense[index] * (1 - part) + dense[index + 1] * part
        x = local @ uu - row[:, 0]
        y = local @ ww - row[:, 1]
        a = np.where(x > 0, row[:, 2], row[:, 3])
        b = np.where(y > 0, row[:, 4], row[:, 5])
        n = row[:, 6]
        rho = np.maximum((np.abs(x / a) ** n + np.abs(y / b) ** n) ** (1 / n), 0.15)
        radius = np.maximum(np.hypot(x, y), 0.15 * np.minimum(a, b))
        side = radius * (1 - 1 / rho)
        return smooth_max(side, np.maximum(first - s, s - last), rounding)

    return field

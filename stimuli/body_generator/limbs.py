"""Bare arms with relaxed hands, and shoes: left-hand fields; the right is their mirror image."""

from __future__ import annotations

import numpy as np

from stimuli.body_generator.fields import (
    Field,
    capsule,
    cut,
    ellipsoid,
    generalised_cylinder,
    half_space,
    join,
    smooth_max,
)
from stimuli.body_generator.figure import Figure
from stimuli.body_generator.polygons import settled
from stimuli.skeleton import Floats

# place across the palm (towards the thumb), phalanges, radius, bend at the knuckle in degrees; index to little finger.
# Lengths of the phalanges after Buryanov & Kotiuk (Int. J. Morphol. 28, 2010), who measured them on radiographs.
_FINGERS = (
    (3.08, (3.98, 2.24, 1.58), 0.96, 17.0),
    (1.03, (4.46, 2.63, 1.74), 0.97, 21.0),
    (-1.02, (4.14, 2.57, 1.73), 0.92, 26.0),
    (-2.92, (3.27, 1.81, 1.60), 0.81, 32.0),
)
_CURL = (0.0, 30.0, 16.0)  # degrees added at each finger joint


def arm(figure: Figure) -> Field:
    """The left arm from just inside the sleeve to the finger tips."""
    shoulder, along = np.array(figure.shoulder), figure.arm_direction
    start = figure.sleeve[-1][0] - 3.2
    stations = tuple(row for row in figure.arm if row[0] > start + 1)
    first = figure.arm[0]
    stations = ((start, *first[1:]), *stations)
    limb = generalised_cylinder(shoulder, along, (0, 0, -1), stations, rounding=0.8)
    elbow = shoulder + figure.upper_arm * along
    thin = figure.arm[3][3]
    point = ellipsoid(elbow - np.array([0, 0, 0.72 * thin]), (thin * 0.42, thin * 0.62, thin * 0.42))
    return join(limb, (point, 1.6), (hand(figure), 1.3))


def hand(figure: Figure) -> Field:
    """Palm, four fingers and a thumb hanging relaxed, the palm towards the thigh."""
    along = figure.arm_direction
    wrist = np.array(figure.shoulder) + (figure.upper_arm + figure.forearm) * along
    thumb_side = np.array([0.0, 0.0, 1.0])
    inwards = np.array([-np.cos(np.radians(30)), -np.sin(np.radians(30)), 0.0])
    k = figure.hand_scale
    slim = 0.94 if figure.female else 1.0

    def at(s: float, t: float, m: float) -> Floats:
        return wrist + k * (s * along + t * thumb_side + m * inwards)

    palm_rows = [
        (-2.4, 0.0, 0, 1.9, 1.9, 1.1, 1.1, 2.2),
        (0.0, 0.0, 0, 2.45, 2.35, 1.45, 1.5, 2.3),
        (2.5, 0.0, 0, 3.25, 3.15, 1.45, 1.55, 2.4),
        (5.5, 0.05, 0, 3.95, 3.7, 1.25, 1.3, 2.5),
        (8.0, 0.1, 0, 4.1, 3.85, 1.05, 1.1, 2.5),
        (9.6, 0.1, 0, 3.8, 3.6, 0.8, 0.8, 2.4),
        (10.2, 0.1, 0, 3.35, 3.15, 0.5, 0.5, 2.4),
    ]
    rows = [
        (s * k, cu * k, 0, a * k * slim, b * k * slim, c * k * slim, d * k * slim, n)
        for s, cu, _, a, b, c, d, n in palm_rows
    ]
    parts: list[tuple[Field, float]] = [
        (ellipsoid(at(3.6, 2.3, 1.0), (1.5 * k, 2.9 * k, 1.4 * k)), 1.2),  # ball of the thumb
        (ellipsoid(at(4.6, -2.2, 0.7), (1.2 * k, 2.8 * k, 1.2 * k)), 1.0),
    ]
    palm = generalised_cylinder(wrist, along, thumb_side, rows, rounding=0.9)
    for place, phalanges, radius, bend in _FINGERS:
        base = at(9.2 - 0.14 * abs(place - 0.9) ** 1.3, place * slim, 0.0)
        angle, tip = np.radians(bend), base
        r = radius * k * slim
        fan = -0.025 * place  # towards each other, as in a hand at rest
        for i, (length, curl) in enumerate(zip(phalanges, _CURL, strict=True)):
            angle += np.radians(curl)
            direction = np.cos(angle) * along + np.sin(angle) * inwards + fan * thumb_side
            end = tip + k * length * direction
            parts.append((capsule(tip, end, r * (1.0, 0.96, 0.88)[i], r * (0.92, 0.88, 0.72)[i]), 0.25 if i else 0.55))
            tip = end
    thumb = [at(2.4, 2.6, 0.9), at(5.7, 4.2, 2.0), at(8.6, 4.9, 2.6), at(10.8, 5.0, 2.7)]
    for i in range(3):
        radius = (1.2, 1.0, 0.92)[i] * k * slim
        parts.append((capsule(thumb[i], thumb[i + 1], radius, radius * (0.86, 0.92, 0.76)[i]), 1.2 if i == 0 else 0.3))
    return join(palm, *parts)


def ankle(figure: Figure) -> Field:
    """The left ankle and the start of the calf, from inside the shoe up into the trousers."""
    x, y, z = figure.ankle
    k = figure.foot_scale
    rows = (
        (-4.0, 0, 0, 3.2 * k, 3.2 * k, 4.0 * k, 3.8 * k, 2.0),
        (1.0, 0, 0, 3.3 * k, 3.3 * k, 3.7 * k, 4.0 * k, 2.0),
        (5.0, 0, 0, 3.3 * k, 3.3 * k, 3.5 * k, 4.1 * k, 2.0),
        (10.5, 0, 0, 3.9 * k, 3.9 * k, 3.9 * k, 4.7 * k, 2.0),
    )
    limb = generalised_cylinder((x, y, z + 0.6), (0, 1, 0), (1, 0, 0), rows, rounding=0.6)
    bone = ellipsoid((x, y + 0.8, z + 0.4), (3.9 * k, 1.5, 1.6))
    return join(limb, (bone, 1.2))


def _shoe_frame(figure: Figure) -> tuple[Floats, Floats, Floats]:
    """Origin on the floor below the ankle, forward direction (a little outwards) and the direction outwards."""
    x, _, z = figure.ankle
    forward = np.array([0.085, 0.0, 1.0])
    forward /= np.linalg.norm(forward)
    return np.array([x, 0.0, z]), forward, np.array([forward[2], 0.0, -forward[0]])


# distance from the ankle; centre outwards and height of the centre; outer, inner; up, down; exponent (cm, foot 27.1)
_UPPER = (
    (-7.0, 0.0, 4.2, 2.2, 2.2, 3.0, 4.2, 2.2),
    (-5.8, 0.0, 4.2, 3.3, 3.2, 3.9, 4.2, 2.3),
    (-3.0, 0.0, 4.2, 3.9, 3.7, 4.9, 4.2, 2.3),
    (1.0, 0.0, 4.0, 4.0, 3.6, 5.3, 4.0, 2.3),
    (4.5, 0.1, 3.6, 4.2, 3.6, 4.5, 3.6, 2.3),
    (8.0, 0.2, 3.0, 4.5, 4.0, 3.7, 3.0, 2.3),
    (12.5, 0.3, 2.6, 4.8, 4.5, 2.8, 2.6, 2.4),
    (16.5, 0.1, 2.4, 4.4, 4.5, 2.2, 2.4, 2.4),
    (19.0, -0.3, 2.3, 3.3, 3.8, 1.8, 2.3, 2.3),
    (20.5, -0.6, 2.2, 1.8, 2.3, 1.3, 2.2, 2.2),
)
_OUTLINE = (
    (-7.4, 0.0, 1.2, 2.0, 2.0, 1.4, 1.4, 3),
    (-6.2, 0.0, 1.2, 3.4, 3.3, 1.5, 1.4, 4),
    (-3.0, 0.0, 1.2, 4.0, 3.8, 1.5, 1.4, 4),
    (3.0, 0.1, 1.1, 4.0, 3.3, 1.4, 1.4, 4),
    (8.0, 0.2, 1.1, 4.5, 3.8, 1.3, 1.4, 4),
    (12.5, 0.3, 1.1, 4.95, 4.6, 1.2, 1.4, 4),
    (16.5, 0.1, 1.1, 4.6, 4.65, 1.2, 1.4, 4),
    (19.4, -0.3, 1.3, 3.4, 3.9, 1.2, 1.4, 3.5),
    (20.9, -0.6, 1.5, 1.9, 2.4, 1.1, 1.3, 3),
)


_HEEL = 6.3  # cm, from the ankle back to where a landing foot turns (Sole.of in stimuli/legs/contact.py)
_BEVEL = np.radians(30.0)


def _scaled_rows(figure: Figure, rows: tuple[tuple[float, ...], ...]) -> list[tuple[float, ...]]:
    k = figure.foot_scale
    wide = 0.93 if figure.female else 1.0
    return [(s * k, cu * k, cw * k, a * k * wide, b * k * wide, c * k, d * k, n) for s, cu, cw, a, b, c, d, n in rows]


def shoe(figure: Figure) -> Field:
    """Upper of the left shoe with tongue, collar and eyelet stays."""
    origin, forward, outwards = _shoe_frame(figure)
    k = figure.foot_scale
    upper = generalised_cylinder(origin, forward, outwards, _scaled_rows(figure, _UPPER), rounding=1.2)

    def at(s: float, o: float, y: float) -> Floats:
        return origin + k * (s * forward + o * outwards + y * np.array([0, 1.0, 0]))

    shaft = capsule(at(-1.3, 0, 5.5), at(-1.0, 0, 9.2), 4.1 * k, 3.7 * k)
    tongue = capsule(at(3.3, 0, 8.6), at(9.0, 0.2, 5.6), 1.5 * k, 1.7 * k)
    collar_hole = capsule(at(-1.0, 0, 8.8), at(-0.8, 0, 13), 3.0 * k, 3.6 * k)
    top = half_space((0, 1, -0.28), at(-1, 0, 9.6))
    body = join(upper, (shaft, 2.2), (tongue, 1.2))
    toe_cap = capsule(at(15.2, -4.2, 3.4), at(15.2, 4.2, 3.4), 0.12 * k, 0.12 * k)
    shaped = cut(lambda p: smooth_max(body(p), top(p), 0.8), collar_hole, 0.5)
    on_sole = half_space((0, -1, 0), (0, 0.9 * k, 0))
    above = lambda p: smooth_max(shaped(p), on_sole(p), 0.2)  # noqa: E731
    return cut(above, toe_cap, 0.3)


def sole(figure: Figure) -> Field:
    """The sole, a little wider than the upper and flat on the floor, toe and end of the heel lifted slightly."""
    origin, forward, outwards = _shoe_frame(figure)
    k = figure.foot_scale
    slab = generalised_cylinder(origin, forward, outwards, _scaled_rows(figure, _OUTLINE), rounding=0.8)
    waist = ellipsoid(origin + k * (4.0 * forward), (8.0, 0.5, 3.2))
    floor = half_space((0, -1, 0), (0, 0.0, 0))
    # a foot lands on its heel and turns about there, toes up by 30 degrees and less: what is behind would sink
    heel = half_space(-np.cos(_BEVEL) * np.array([0, 1.0, 0]) - np.sin(_BEVEL) * forward, origin - _HEEL * k * forward)
    flat = lambda p: smooth_max(floor(p), heel(p), 0.25)  # noqa: E731
    return cut(lambda p: smooth_max(slab(p), flat(p), 0.25), waist, 0.3)


def laces(figure: Figure) -> Field:
    """Five laces across the instep, on the shoe, and a small bow."""
    origin, forward, outwards = _shoe_frame(figure)
    upper, k = shoe(figure), figure.foot_scale

    def on(s: float, o: float, lift: float = 0.1) -> Floats:
        """A point of the shoe `s` before the ankle and `o` outwards, seen from above."""
        point = (origin + k * (s * forward + o * outwards) + (0, 11.0 * k, 0))[None]
        for _ in range(40):
            point[:, 1] -= 0.7 * np.clip(upper(point), -0.5, 1.0)
        found: Floats = point[0] + (0, lift, 0)
        return found

    rods: list[tuple[Field, float]] = []
    for i in range(5):
        s, wide = 4.9 + 1.35 * i, 1.75 + 0.1 * i
        for side in (1, -1):
            rods.append((capsule(on(s, 0, 0.16), on(s - 0.15, side * wide, 0.02), 0.22 * k, 0.2 * k), 0.05))
    knot = on(4.3, 0, 0.3)
    for side in (1, -1):
        loop = on(4.6, side * 1.7, 0.3)
        rods.append((capsule(knot, loop, 0.26 * k, 0.24 * k), 0.1))
        rods.append((capsule(knot, on(6.0, side * 0.9, 0.25), 0.2 * k, 0.18 * k), 0.1))
    first, *rest = rods
    return join(first[0], *rest)


def shoe_seams(figure: Figure) -> tuple[Floats, ...]:
    """Lines (N, 3) on the left shoe: where quarters meet the vamp, and round the heel."""
    origin, forward, outwards = _shoe_frame(figure)
    upper, k = shoe(figure), figure.foot_scale

    def line(*points: tuple[float, float, float]) -> Floats:
        """Through points given by distance before the ankle, outwards and height."""
        s, o, y = np.array(points).T
        t = np.linspace(0, 1, 24)
        s, o, y = (np.interp(t, np.linspace(0, 1, len(points)), each) for each in (s, o, y))
        found = origin + k * (s[:, None] * forward + o[:, None] * outwards + y[:, None] * np.array([0.0, 1, 0]))
        for _ in range(6):
            found = settled(upper, found, 2.0)
        return found

    lines = [line((9.6, -3.6, 6.5), (11.4, 0, 7.0), (9.6, 3.6, 6.5))]
    for side in (1, -1):
        lines.append(line((9.6, side * 3.4, 6.3), (10.6, side * 4.6, 3.8), (8.6, side * 5.0, 2.0)))
        lines.append(line((-2.6, side * 4.4, 7.6), (-2.2, side * 4.6, 4.6), (-4.2, side * 4.6, 2.0)))
    return tuple(lines)

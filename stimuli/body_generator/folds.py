"""Cloth folds: soft ridges and creases along short curves, raised from a garment's field where cloth bunches.

Where folds go is anatomy of clothing: they radiate from the arm-pit, stack behind the knee and in the elbow,
pull from the crotch over the thigh, hang at the waist and break over the shoe.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stimuli.body_generator.fields import Field
from stimuli.body_generator.figure import Figure
from stimuli.body_generator.polygons import settled
from stimuli.skeleton import Floats

SEED = 20


@dataclass(frozen=True)
class Fold:
    """A ridge along a quadratic curve: start, middle, end (3,) cm; width (one sigma) and height in cm."""

    start: tuple[float, float, float]
    middle: tuple[float, float, float]
    end: tuple[float, float, float]
    width: float
    height: float


def folded(cloth: Field, folds: list[Fold]) -> Field:
    """The cloth raised by its folds."""
    curves = [(_on_cloth(cloth, _curve(f)), f.width, f.height) for f in folds]

    def field(points: Floats) -> Floats:
        value = cloth(points)
        near = np.flatnonzero(np.abs(value) < 6)
        p = points[near]
        raised = np.zeros(len(near))
        for curve, width, height in curves:
            reach = 3.0 * width
            low, high = curve.min(axis=0) - reach, curve.max(axis=0) + reach
            inside = np.flatnonzero(np.all((p > low) & (p < high), axis=1))
            if len(inside):
                raised[inside] += height * _profile(p[inside], curve, width)
        value[near] -= 0.9 * np.tanh(raised / 0.9)
        return value

    return field


def _curve(fold: Fold) -> Floats:
    t = np.linspace(0, 1, 9)[:, None]
    a, b, c = (np.asarray(x, dtype=np.float64) for x in (fold.start, fold.middle, fold.end))
    return (1 - t) ** 2 * a + 2 * t * (1 - t) * b + t * t * c


def _on_cloth(cloth: Field, curve: Floats) -> Floats:
    """The curve moved on to the cloth's surface."""
    for _ in range(4):
        curve = settled(cloth, curve, 4.0)
    return curve


def _profile(points: Floats, curve: Floats, width: float) -> Floats:
    """1 on the curve's middle, fading to both ends and sideways, with a shallow valley beside the ridge."""
    best = np.full(len(points), np.inf)
    place = np.zeros(len(points))
    for i in range(len(curve) - 1):
        a, d = curve[i], curve[i + 1] - curve[i]
        t = np.clip((points - a) @ d / max(float(d @ d), 1e-9), 0, 1)
        distance2 = np.sum((points - a - t[:, None] * d) ** 2, axis=1)
        closer = distance2 < best
        best[closer] = distance2[closer]
        place[closer] = (i + t[closer]) / (len(curve) - 1)
    x2 = best / width**2
    taper = np.sin(np.pi * np.clip(0.08 + 0.84 * place, 0, 1)) ** 0.8
    return taper * (1.12 * np.exp(-x2) - 0.24 * np.exp(-x2 / 3.2))


def shirt_folds(figure: Figure, cloth: Field) -> Field:
    """Folds of a T-shirt: from the arm-pits, over the waist, flutes above the hem, on the sleeves."""
    rng = np.random.default_rng(SEED)
    sx, sy, _ = figure.shoulder
    hem = figure.shirt[0][0]
    waist = figure.trunk_heights[1]
    strength = 1.05 if figure.female else 1.3
    folds: list[Fold] = []

    def add(start: Floats, middle: Floats, end: Floats, width: float, height: float) -> None:
        wobble = rng.normal(0, 0.7, (3, 3))
        a, b, c = (tuple(float(v) for v in np.asarray(p) + w) for p, w in zip((start, middle, end), wobble, strict=True))
        scale = 1 + 0.15 * rng.normal()
        folds.append(Fold(a, b, c, width, strength * height * scale))

    for side in (1, -1):
        pit = np.array([side * (sx - 1.0), sy - 9.5, 0.0])
        for front in (1, -1):
            depth = 8.5 * front
            for drop, run in ((-1, 0.42), (-6, 0.5), (-12, 0.62)):
                end = (side * sx * run, sy - 8 + drop, depth + 1.5 * front)
                add(pit + (0, 0, 4 * front), (side * sx * 0.8, sy - 10 + drop * 0.7, depth), end, 1.3, 0.38)
            add((side * (sx + 2), sy - 5, 5 * front), (side * sx * 0.82, sy - 5, 8 * front),
                (side * sx * 0.6, sy - 2.5, 8.5 * front), 1.2, 0.4)
        for k, y in enumerate((waist + 9, waist + 4.5, waist - 0.5, waist - 5)):
            reach = 0.25 + 0.2 * rng.random()
            wide = 15.5 if figure.female else 17.5
            add((side * wide * 0.98, y + 1.5, -2 + k), (side * wide * 0.8, y - 1, 8), (side * wide * reach, y - 2.5, 11.0), 1.25, 0.5)
            add((side * wide * 0.98, y + 1.5, -3 - k), (side * wide * 0.75, y, -9), (side * wide * reach, y - 1.5, -11), 1.3, 0.6)
        for x, z in ((17.5, 4), (14, 9.5), (8, 11.5), (16.5, -6), (11.5, -11.5), (5, -12.5)):
            add((side * x * 0.96, hem + 13, z * 0.95), (side * x * 1.0, hem + 6, z), (side * x * 1.03, hem - 2, z * 1.04), 1.5, 0.5)
        along = figure.arm_direction * (side, 1, 1)
        shoulder = np.array([side * sx, sy, figure.shoulder[2]])
        across = np.array([side * np.cos(np.radians(30)), np.sin(np.radians(30)), 0])
        length = figure.sleeve[-1][0]
        radius = 5.3 if figure.female else 6.6
        for s, turn in ((0.45, 0.6), (0.7, 2.4), (0.8, -0.9), (0.6, 3.9), (0.85, 1.3), (0.9, 3.2)):
            ring = lambda a, s=s, drop=0.0: (  # noqa: E731
                shoulder + (s * length + drop) * along + radius * (np.cos(a) * across + np.sin(a) * np.array([0, 0, 1.0]))
            )
            add(ring(turn - 0.7), ring(turn, drop=1.6), ring(turn + 0.8, drop=4.0), 1.1, 0.42)
    return folded(cloth, folds)


def trouser_folds(figure: Figure, cloth: Field) -> Field:
    """Folds of trousers: from the crotch, behind and above the knee, stacked above the shoe."""
    rng = np.random.default_rng(SEED + 1)
    hip, knee, ankle = (np.array(p) for p in (figure.hip, figure.knee, figure.ankle))
    strength = 1.0 if figure.female else 1.35
    thick = 0.86 if figure.female else 1.0
    folds: list[Fold] = []

    def ring(y: float, turn: float, radius: float, side: int) -> Floats:
        """A point on the leg at height y; turn 0 = outside, pi/2 = front."""
        part = np.clip((hip[1] - y) / (hip[1] - ankle[1]), 0, 1)
        centre = hip + part * (ankle - hip)
        return np.array([side * (centre[0] + radius * np.cos(turn)), y, centre[2] * 0.5 + radius * np.sin(turn)])

    def add(points: tuple[Floats, Floats, Floats], width: float, height: float) -> None:
        a, b, c = (tuple(float(v) for v in p + rng.normal(0, 0.6, 3)) for p in points)
        folds.append(Fold(a, b, c, width, strength * height * (1 + 0.2 * rng.normal())))

    for side in (1, -1):
        for spread, drop in ((0.5, -3.0), (1.0, -7.0), (1.5, -12.0)):
            y = hip[1] - 8
            add((ring(y, np.pi - 0.5, 8 * thick, side), ring(y + 1.5 + drop * 0.4, np.pi - 1.2, 9 * thick, side),
                 ring(y + 4 + drop, np.pi - 1.2 - spread, 9.3 * thick, side)), 1.3, 0.5)
            add((ring(y, np.pi + 0.5, 8 * thick, side), ring(y + drop * 0.6, np.pi + 1.2, 9.5 * thick, side),
                 ring(y + 2 + drop, np.pi + 1.4 + spread * 0.6, 10 * thick, side)), 1.3, 0.5)
        for k, up in enumerate((7.5, 3.5, -0.5, -4.5)):
            y, r = knee[1] + up, 7.2 * thick
            lean = 1.5 if k % 2 else -1.5
            add((ring(y + lean, -0.5, r, side), ring(y - 1.0, -np.pi / 2, r, side), ring(y - lean, -np.pi + 0.5, r, side)), 1.1, 0.55)
            add((ring(y + 2 + lean, 0.1, r, side), ring(y + 1, 0.6, r, side), ring(y + 2, 1.15, r, side)), 1.1, 0.3)
            add((ring(y + 2 - lean, np.pi - 0.1, r, side), ring(y + 1, np.pi - 0.6, r, side), ring(y + 2, np.pi - 1.1, r, side)), 1.1, 0.3)
        low = ankle[1] + (1.0 if figure.female else -1.0)
        for k, up in enumerate((0.8, 3.9, 7.4, 11.5, 16.0)):
            y, r = low + up, 6.8 * thick
            height = 0.75 - 0.11 * k
            turn = (0.4, 1.9, 0.9, 2.4, 1.2)[k] + 0.3 * rng.normal()
            add((ring(y + 1.0, turn - 1.3, r, side), ring(y - 0.8, turn, r + 0.6, side), ring(y + 1.4, turn + 1.3, r, side)), 1.05, height)
            add((ring(y + 2.4, turn + 2.0, r, side), ring(y + 1.2, turn + 3.1, r, side), ring(y + 2.2, turn + 4.2, r, side)), 1.1, height * 0.85)
    return folded(cloth, folds)

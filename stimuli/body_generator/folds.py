"""Cloth folds: soft ridges and creases along short curves, raised from a garment's field where cloth bunches.

Where they lie on a shirt or on trousers is in `creases`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stimuli.body_generator.fields import Field
from stimuli.body_generator.polygons import settled
from stimuli.skeleton import Floats


@dataclass(frozen=True, eq=False)
class Fold:
    """A ridge along a quadratic curve: start, middle, end (3,) cm; width (one sigma) and height in cm."""

    start: Floats
    middle: Floats
    end: Floats
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
    a, b, c = fold.start, fold.middle, fold.end
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

"""Balls that stand for feet, legs and trunk when the ground under a walker is darkened. Pure arithmetic."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from experiment_app.render.drawn import DrawnWalker
from stimuli.body import Body
from stimuli.skeleton import JOINTS, Floats

BALLS: tuple[tuple[str, tuple[float, float, float], float], ...] = (
    ("Foot", (0.0, -0.016, -0.018), 0.021),
    ("Foot", (0.0, -0.018, 0.012), 0.021),
    ("Foot", (0.0, -0.020, 0.042), 0.021),
    ("Toes", (0.0, 0.004, 0.006), 0.021),
    ("Toes", (0.0, 0.002, 0.030), 0.017),
    ("LowerLeg", (0.0, -0.16, 0.0), 0.030),
    ("LowerLeg", (0.0, -0.06, 0.0), 0.036),
    ("UpperLeg", (0.0, -0.16, 0.0), 0.050),
)
"""Of each leg: joint, offset from it in the bind pose and radius, all per stature."""

TRUNK: tuple[tuple[str, tuple[float, float, float], float], ...] = (
    ("hips", (0.0, 0.0, 0.0), 0.085),
    ("chest", (0.0, 0.03, 0.0), 0.085),
)

_NAMED = [(f"{side}{part}", offset, radius) for side in ("left", "right") for part, offset, radius in BALLS]
_ALL = [*_NAMED, *TRUNK]
_JOINTS = np.array([JOINTS.index(name) for name, _, _ in _ALL])
_OFFSETS = np.array([offset for _, offset, _ in _ALL])
_RADII = np.array([radius for _, _, radius in _ALL])

TEXELS = 1 + len(_ALL)
HALF_SIZE = 0.58  # of the darkened square, per stature


def fill_occluders(rows: Floats, walkers: Sequence[DrawnWalker]) -> None:
    """Writes one row per walker: (x, y, z of the place, half size), then (x, y, z, radius) of each ball, m.

    rows: (walkers or more, TEXELS, 4) float32, changed in place.
    """
    for row, walker in zip(rows, walkers, strict=False):
        stature = walker.body.stature
        matrices = walker.matrices[_JOINTS]
        row[0] = (*walker.place, HALF_SIZE * stature)
        row[1:, :3] = (matrices @ _balls(walker.body))[..., 0] + walker.place
        row[1:, 3] = _RADII * stature


@lru_cache(maxsize=2048)
def _balls(body: Body) -> Floats:
    """(balls, 4, 1) float32: x, y, z (m) of the balls' middles in the bind pose, and 1."""
    points = body.skeleton.positions[_JOINTS] + _OFFSETS * body.stature
    return np.column_stack([points, np.ones(len(points))])[..., None].astype(np.float32)

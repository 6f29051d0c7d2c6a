"""Balls that stand for feet, legs and trunk when the ground under a walker is darkened. Pure arithmetic."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from experiment_app.render.drawn import PLACE, CrowdLook, DrawnCrowd, DrawnWalker
from stimuli.bodies.body import Body
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

_OF_CROWDS = np.array([1, 3, 6, 9, 11, 14, 16])
"""The balls that are left of a walker in a crowd: a foot, toes and shank of each leg, and the hips."""

CROWD_TEXELS = 1 + len(_OF_CROWDS)
CROWD_HALF_SIZE = 0.36


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


def crowd_occluders(crowd: DrawnCrowd, there: NDArray[np.intp]) -> Floats:
    """(K, CROWD_TEXELS, 4) float32, as fill_occluders writes them, of the walkers `there` (K,) of a crowd."""
    rows = np.empty((len(there), CROWD_TEXELS, 4), np.float32)
    places = crowd.rows[there, PLACE, :3]
    statures = crowd.cast.statures[there]
    rows[:, 0, :3], rows[:, 0, 3] = places, CROWD_HALF_SIZE * statures
    joints = 2 * _JOINTS[_OF_CROWDS] + np.arange(2)[:, None]
    chosen = crowd.rows[there].take(joints, axis=1)  # half of the time of both indices at once
    turn, moved = np.ascontiguousarray(chosen.transpose(1, 3, 2, 0))
    ball = _crowd_balls(crowd.cast)[..., there]
    rows[:, 1:, :3] = (_turned(turn, ball) + moved[:3]).transpose(2, 1, 0)
    rows[:, 1:, 3] = _RADII[_OF_CROWDS] * statures[:, None]
    return rows


def _turned(turn: Floats, vector: Floats) -> Floats:
    """(3, ...): vectors turned by quaternions (4, ...) and made as many times longer as these are in square."""
    x, y, z, w = turn
    a, b, c = vector
    u = w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a
    square = x * x + y * y + z * z + w * w
    x, y, z = x + x, y + y, z + z
    return np.array(
        [square * a + y * u[2] - z * u[1], square * b + z * u[0] - x * u[2], square * c + x * u[1] - y * u[0]]
    )


@lru_cache(maxsize=8)
def _crowd_balls(cast: CrowdLook) -> Floats:
    """(3, balls, N) float32 m: middles of the balls of each walker's body in the bind pose."""
    balls = np.stack([_balls(body)[_OF_CROWDS, :3, 0] for body in cast.bodies])[cast.body]
    return np.ascontiguousarray(balls.transpose(2, 1, 0))


@lru_cache(maxsize=2048)
def _balls(body: Body) -> Floats:
    """(balls, 4, 1) float32: x, y, z (m) of the balls' middles in the bind pose, and 1."""
    points = body.skeleton.positions[_JOINTS] + _OFFSETS * body.stature
    return np.column_stack([points, np.ones(len(points))])[..., None].astype(np.float32)

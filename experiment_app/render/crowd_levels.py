"""Which level of detail every walker of a crowd is drawn in, and who is drawn together. Pure arithmetic, no state.

Nobody changes level at once: near a threshold both levels are drawn, each in its share of the pixels, told by a
number every pixel has (a dither). It follows from the scene alone, so the same scene gives the same pixels.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from experiment_app.render.cameras import NEAR, Viewpoint
from stimuli.skeleton import Floats

HEIGHTS = np.array([500.0, 230.0, 110.0, 62.0, 38.0])
"""Pixels of stature below which the next coarser level is drawn."""

MIDDLE = 0.9  # m above the ground, about the middle of a person

BAND = 0.03
"""Share of a threshold on either side of it within which both levels are drawn."""

FAR_LEVEL = 3
"""Finest of the levels made for crowds, which are lit at their vertices."""

FAR_HEIGHT = 150.0
"""Pixels of stature below which the bodies' own coarsest level is lit at its vertices as well: it has a vertex for
every few pixels."""


@dataclass(frozen=True)
class Batch:
    """Instances drawn together: count of them from first, of one body and level.

    far: small on the screen, so lit at their vertices; faded: in a share of their pixels only.
    """

    body: int
    level: int
    far: bool
    faded: bool
    first: int
    count: int


@dataclass(frozen=True, eq=False)
class Instances:
    """What is drawn, in consecutive batches; table: (K, 4) float32 row, lowest and highest noise, look."""

    table: NDArray[np.float32]
    batches: tuple[Batch, ...]


def distances(viewpoint: Viewpoint, places: Floats) -> Floats:
    """(N,) m from the eye to places (N, 3) m."""
    away = places - viewpoint.eye
    return np.asarray(np.sqrt(np.einsum("nk,nk->n", away, away)))


def heights_on_screen(viewpoint: Viewpoint, distance: Floats, statures: Floats, picture_height: int) -> Floats:
    """(N,) pixels, roughly, of walkers so far (N,) and so tall (N,), in m."""
    return 0.5 * picture_height * statures / (viewpoint.half_height * np.maximum(distance, NEAR))


def within_picture(viewpoint: Viewpoint, places: Floats, reach: Floats) -> NDArray[np.bool_]:
    """(N,) whether anything within reach (N,) m of the middle of a person at places (N, 3) m can be in the picture."""
    clip = places @ viewpoint.matrix[:, :3].T + (viewpoint.matrix[:, 3] + viewpoint.matrix[:, 1] * MIDDLE)
    side = clip[:, 3] + reach * np.abs(viewpoint.matrix[:2, :3]).sum(axis=1).max()
    return (np.abs(clip[:, 0]) <= side) & (np.abs(clip[:, 1]) <= side) & (clip[:, 3] > -reach)


def levels_of(heights: Floats, levels: int) -> tuple[NDArray[np.intp], Floats]:
    """Level (N,) of walkers so tall, and the share (N,) it is drawn in; the rest is drawn in the next coarser one."""
    thresholds = HEIGHTS[: levels - 1]
    level = np.sum(heights[:, None] < thresholds * (1.0 - BAND), axis=1)
    bound = np.append(thresholds, 0.0)[level]
    share = np.where(bound > 0.0, (heights / np.maximum(bound, 1e-9) - (1.0 - BAND)) / (2.0 * BAND), 1.0)
    return level, np.minimum(share, 1.0)


def seen_instances(
    heights: Floats, shown: Floats, body: NDArray[np.intp], look: NDArray[np.intp], levels: int, forced: int | None
) -> Instances:
    """Everybody in the picture; heights: (N,) pixels, 0 for nobody; forced: a level for all, None by height."""
    there = np.flatnonzero((heights > 0.0) & (shown > 0.0))
    if forced is None:
        level, share = levels_of(heights[there], levels)
    else:
        level, share = np.full(len(there), min(max(forced, 0), levels - 1)), np.ones(len(there))
    both = np.flatnonzero(share < 1.0)
    rows = np.concatenate([there, there[both]])
    level = np.concatenate([level, level[both] + 1])
    low = np.concatenate([np.zeros(len(there)), share[both]])
    high = np.minimum(np.concatenate([share, np.ones(len(both))]), shown[rows])
    faded = (low > 0.0) | (high < 1.0)
    far = (heights[rows] < FAR_HEIGHT) & (level >= 2) | (level >= FAR_LEVEL)
    key = (body[rows] * levels + level) * 4 + 2 * far + faded
    order = np.argsort(key, kind="stable")
    table = np.column_stack([rows, low, high, look[rows]])[order].astype(np.float32)
    batches = (
        Batch(value // 4 // levels, value // 4 % levels, value % 4 >= 2, value % 2 == 1, first, count)
        for value, first, count in _runs(key[order])
    )
    return Instances(table, tuple(batches))


def shadow_instances(heights: Floats, casting: NDArray[np.bool_], body: NDArray[np.intp], levels: int) -> Instances:
    """Whose shadow may be seen, in the coarse levels that do for a shadow map with texels of some centimetres."""
    rows = np.flatnonzero(casting)
    level = np.minimum(FAR_LEVEL + (heights[rows][:, None] < HEIGHTS[1:FAR_LEVEL]).sum(axis=1), levels - 1)
    key = body[rows] * levels + level
    order = np.argsort(key, kind="stable")
    table = np.zeros((len(rows), 4), np.float32)
    table[:, 0] = rows[order]
    batches = (Batch(v // levels, v % levels, True, False, first, count) for v, first, count in _runs(key[order]))
    return Instances(table, tuple(batches))


def _runs(keys: NDArray[np.intp]) -> list[tuple[int, int, int]]:
    """Value, first index and length of every run of equal keys."""
    if not len(keys):
        return []
    starts = np.concatenate([[0], np.flatnonzero(np.diff(keys)) + 1, [len(keys)]]).tolist()
    return [(int(keys[a]), a, b - a) for a, b in pairwise(starts)]

"""A body of rigid segments that carry markers, and how far it is from where the markers were seen.

Many frames at a time, which are the last axis of every array but those of Body. Knows joints and points; no label.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating]

CENTRE_WEIGHT = 1.0  # a joint centre counts like one marker
HOLD = 1e-3  # m²: how weakly a segment is held to its first guess, which decides only what no marker tells


@dataclass(frozen=True, eq=False)
class Body:
    """Joints with their markers, parents before children.

    offsets: (J, 3) m from the parent; local[j]: (m, 3) m, markers in the joint's axes
    """

    parents: tuple[int, ...]
    offsets: Floats
    local: tuple[Floats, ...]

    @cached_property
    def levels(self) -> tuple[NDArray[np.intp], ...]:
        """Joints by their depth below the root, the root first."""
        depth: list[int] = []
        for parent in self.parents:
            depth.append(0 if parent < 0 else depth[parent] + 1)
        return tuple(np.flatnonzero(np.equal(depth, level)) for level in range(max(depth) + 1))

    def sorted(self) -> tuple[Body, NDArray[np.intp]]:
        """The same body with its joints level by level, and their order."""
        order = np.concatenate(self.levels)
        rank = np.argsort(order)
        parents = tuple(-1 if self.parents[joint] < 0 else int(rank[self.parents[joint]]) for joint in order)
        return Body(parents, self.offsets[order], tuple(self.local[joint] for joint in order)), order

    def places(self, rotations: Floats, root: Floats) -> Floats:
        """(J, 3, T) m: joints by forward kinematics from world rotations (J, 3, 3, T) and the root's path (3, T) m."""
        there = np.empty((len(self.parents), *root.shape))
        for joint, parent in enumerate(self.parents):
            if parent < 0:
                there[joint] = root
            else:
                there[joint] = there[parent] + np.einsum("ijt,j->it", rotations[parent], self.offsets[joint])
        return there


@dataclass(frozen=True, eq=False)
class Wanted:
    """Where a body's parts should be, over T frames: sums over a joint's seen markers, its centre being one of them.

    weight:  (J, T) their number
    target:  (J, 3, T) m, their places in the world
    place:   (J, 3, T) m, their places in the joint's axes
    product: (J, 3, 3, T) m², the one times the other, and a little of the first guess
    """

    weight: Floats
    target: Floats
    place: Floats
    product: Floats

    @classmethod
    def of(cls, body: Body, targets: Sequence[Floats | None], centres: Floats, guess: Floats) -> Wanted:
        """targets: per joint (T, m, 3) m, NaN where not seen; centres (T, J, 3) m; guess (T, J, 3, 3), axes."""
        sums: tuple[list[Floats], ...] = ([], [], [], [])
        for joint, (local, target) in enumerate(zip(body.local, targets, strict=True)):
            points = np.zeros((len(centres), 0, 3)) if target is None else target
            seen = np.asarray(np.all(np.isfinite(points), axis=-1), dtype=float)
            points = np.where(seen[..., None] > 0, points, 0.0)
            sums[0].append(CENTRE_WEIGHT + seen.sum(axis=1))
            sums[1].append(CENTRE_WEIGHT * centres[:, joint].T + points.sum(axis=1).T)
            sums[2].append(np.einsum("tm,mi->it", seen, local))
            sums[3].append(HOLD * np.moveaxis(guess[:, joint], 0, -1) + np.einsum("tmi,mj->ijt", points, local))
        return cls(*(np.array(values) for values in sums))

    def frames(self, chosen: NDArray[np.bool_]) -> Wanted:
        """Of some of the frames."""
        return Wanted(*(np.compress(chosen, getattr(self, field.name), axis=-1) for field in fields(self)))

    def cost(self, turns: Floats, there: Floats) -> Floats:
        """(T,) m²: half the squared distances of a pose (J, 3, 3, T), (J, 3, T) m, but for what no pose changes."""
        arm = 0.5 * self.weight[:, None] * there - self.target + np.einsum("jikt,jkt->jit", turns, self.place)
        return np.einsum("jit,jit->t", there, arm) - np.einsum("jikt,jikt->t", turns, self.product)

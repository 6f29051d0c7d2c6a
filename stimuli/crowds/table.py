"""Many people's cycles in one float32 table, and which of them each walker of a crowd mixes. Knows no clock.

The layout is that of the rendering notes, section 3: one row per (cycle, sample), columns component-major with joints
ordered by depth, so that a thousand walkers are blended by plain sums of gathered rows and turned level by level.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stimuli.blend import UPPER, CycleTable
from stimuli.blend_tree import Tree, many_weights
from stimuli.one_rotation import Turn, multiply
from stimuli.retarget import Figure
from stimuli.skeleton import JOINTS, Floats

Singles = NDArray[np.float32]
Indices = NDArray[np.intp]

DEPTH_ORDER: tuple[str, ...] = (
    *("hips", "spine", "chest"),
    *("neck", "leftShoulder", "rightShoulder"),
    *("head", "leftUpperArm", "rightUpperArm"),
    *("leftLowerArm", "rightLowerArm", "leftHand", "rightHand"),
    *(f"{side}{part}" for part in ("UpperLeg", "LowerLeg", "Foot", "Toes") for side in ("left", "right")),
)
"""The joints by depth below the root, legs last: every level is a slice, and so are its parents."""

UPPER_COUNT = len(UPPER)
COLUMNS = 4 * UPPER_COUNT + 3
PLANES = np.array([JOINTS.index(name) for name in DEPTH_ORDER])

_X_TO_DOWN: Turn = (0.0, 0.0, -math.sqrt(0.5), math.sqrt(0.5))
"""Turns a bone along +X (two_bone.Leg.thigh_to_axes) straight down, and its hinge from +Y to +X."""


@dataclass(frozen=True, eq=False)
class WalkTable:
    """P people with their cycles, one after the other.

    body:      (rows, 55) x of the 13 UPPER joints by depth, then y, z, w, then the hips' x, y, z (m)
    feet:      (2, rows, 6) blend.FOOT_CHANNELS, left and right
    contacts:  (cycles, 5) as CycleTable.contacts
    first_row: (cycles,) row of a cycle's first sample; the last of its samples + 1 rows repeats the first
    samples:   (cycles,) samples per cycle
    trees:     of each person, and first_cycle of each in the table
    rest:      (P, 21, 3) m, from the ground, in the rest pose, joints by depth
    legs:      (P, 2, 13) thigh, shank (m), hip (m), then x y z w of the rotations that turn thigh and shank at rest
               straight down, their hinge along +X
    soles:     (P, 5) ankle height, heel, ball, ball height, tip (m) as in contact.Sole
    """

    body: Singles
    feet: Singles
    contacts: Floats
    first_row: Indices
    samples: Indices
    trees: tuple[Tree, ...]
    first_cycle: Indices
    rest: Singles
    legs: Singles
    soles: Singles

    @classmethod
    def of(cls, people: Sequence[tuple[Figure, CycleTable, Tree]]) -> WalkTable:
        """The table of people given by their figure, their cycles and the tree over these."""
        by_depth = [UPPER.index(name) for name in DEPTH_ORDER[:UPPER_COUNT]]
        bodies, feet = [], []
        for _, table, _ in people:
            turns = table.body[..., 3:].reshape(*table.body.shape[:2], UPPER_COUNT, 4)[:, :, by_depth]
            planes = turns.swapaxes(2, 3).reshape(*table.body.shape[:2], -1)
            bodies.append(np.concatenate([planes, table.body[..., :3]], axis=2).reshape(-1, COLUMNS))
            feet.append(table.feet.reshape(2, -1, table.feet.shape[-1]))
        counts = [len(table.contacts) for _, table, _ in people]
        samples = np.repeat([table.samples for _, table, _ in people], counts)
        return cls(
            body=np.concatenate(bodies).astype(np.float32),
            feet=np.concatenate(feet, axis=1).astype(np.float32),
            contacts=np.concatenate([table.contacts for _, table, _ in people]),
            first_row=np.concatenate([[0], np.cumsum(samples + 1)[:-1]]).astype(np.intp),
            samples=samples.astype(np.intp),
            trees=tuple(tree for _, _, tree in people),
            first_cycle=np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.intp),
            rest=np.array([f.skeleton.positions for f, _, _ in people], np.float32)[:, PLANES],
            legs=np.array([[_leg_row(leg) for leg in f.legs] for f, _, _ in people], np.float32),
            soles=np.array([_sole_row(f.sole) for f, _, _ in people], np.float32),
        )

    @cached_property
    def different_trees(self) -> tuple[tuple[Tree, ...], Indices]:
        """Each tree once, and which of them each person has: people whose trees are alike are weighed together."""
        numbers: dict[Tree, int] = {}
        own = [numbers.setdefault(tree, len(numbers)) for tree in self.trees]
        return tuple(numbers), np.array(own, np.intp)


@dataclass(frozen=True, eq=False)
class Constants:
    """The figures of N walkers as planes, float32.

    rest:         (3, 21, N) m, as in WalkTable
    hip:          (3, 2, N) m, from the hips to the left and the right hip joint
    bones:        (2, 2, N) m, lengths of both thighs and of both shanks, float64
    bones_from_rest: (4, 2, 2, N) rotations of both thighs and both shanks as in WalkTable.legs
    sole:         lengths (N,) m
    """

    rest: Singles
    hip: Singles
    bones: Floats
    bones_from_rest: Singles
    sole: Any

    @classmethod
    def of(cls, table: WalkTable, who: Indices) -> Constants:
        """The figures of walkers, each a person of the table."""
        legs = np.ascontiguousarray(table.legs[who].transpose(2, 1, 0))
        return cls(
            rest=np.ascontiguousarray(table.rest[who].transpose(2, 1, 0)),
            hip=legs[2:5],
            bones=legs[:2].astype(np.float64),
            bones_from_rest=np.ascontiguousarray(legs[5:].reshape(2, 4, 2, -1).swapaxes(0, 1)),
            sole=Soles(*np.ascontiguousarray(table.soles[who].T)),
        )


@dataclass(frozen=True, eq=False)
class Soles:
    """contact.Sole of N walkers, each length (N,) m."""

    ankle_height: Singles
    heel: Singles
    ball: Singles
    ball_height: Singles
    tip: Singles


@dataclass(frozen=True, eq=False)
class Mix:
    """What N walkers walk: set once for constant speeds, anew when they change.

    who:     (N,) person of each walker
    rows:    (N, M) first row of each cycle mixed; weights (N, M) not negative, summing to 1
    samples: (N,) samples per cycle
    stance:  (N, 2) share of the cycle that the left and the right foot are on the ground
    ahead:   (N, 2) m, footprints ahead at heel strike; stride (N,) m
    left_strike: (N,) phase of the left heel strike
    """

    table: WalkTable
    who: Indices
    rows: Indices
    weights: Singles
    samples: Indices
    stance: Floats
    ahead: Floats
    left_strike: Floats
    stride: Floats

    def __len__(self) -> int:
        return len(self.who)

    @cached_property
    def constants(self) -> Constants:
        """What of the walkers' figures a pose needs, as planes."""
        return Constants.of(self.table, self.who)

    def part(self, walkers: Any) -> Mix:
        """The mix of some of the walkers, chosen by a slice, a mask or numbers."""
        names = ("who", "rows", "weights", "samples", "stance", "ahead", "left_strike", "stride")
        return replace(self, **{name: getattr(self, name)[walkers] for name in names})


def mixed(table: WalkTable, who: Indices, speed: Floats, step_frequency: Floats) -> Mix:
    """The mix of N walkers at their speeds (m/s) and step frequencies (steps/min), all (N,).

    Raises CoverageError when one is outside its person's blend tree.
    """
    trees, numbers = table.different_trees
    found = []
    for number, tree in enumerate(trees):
        own = np.flatnonzero(numbers[who] == number)
        if len(own):
            wanted = {"speed": speed[own], "step_frequency": step_frequency[own]}
            found.append((own, *many_weights(tree, wanted)))
    width = max((chosen.shape[1] for _, chosen, _ in found), default=1)
    cycles, weights = np.zeros((len(who), width), np.intp), np.zeros((len(who), width))
    for own, chosen, shares in found:
        cycles[own, : chosen.shape[1]] = chosen
        weights[own, : chosen.shape[1]] = shares
    cycles += table.first_cycle[who][:, None]
    contacts = np.einsum("nm,nmc->nc", weights, table.contacts.take(cycles, axis=0))
    return Mix(
        table=table,
        who=np.asarray(who, np.intp),
        rows=table.first_row[cycles],
        weights=weights.astype(np.float32),
        samples=table.samples[cycles[:, 0]],
        stance=contacts[:, :2],
        ahead=contacts[:, 2:4],
        left_strike=contacts[:, 4],
        stride=120.0 * speed / step_frequency,
    )


def _leg_row(leg: Any) -> Floats:
    turns = [multiply(_X_TO_DOWN, leg.thigh_to_axes), multiply(_X_TO_DOWN, leg.shank_to_axes)]
    return np.concatenate([[leg.thigh, leg.shank], leg.hip, *turns])


def _sole_row(sole: Any) -> tuple[float, ...]:
    return sole.ankle_height, sole.heel, sole.ball, sole.ball_height, sole.tip

"""Poulaine walks of many walkers at once: speed and leg length may change from frame to frame. Knows no clock."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stimuli.cycle import Cycle, cycle_pose
from stimuli.methods.blend import mixed
from stimuli.methods.making import MethodError, leg_length
from stimuli.poulaine.curve import FIVE, ControlPoints, characteristic_points, poulaine_of
from stimuli.poulaine.legs import bent, local
from stimuli.poulaine.regression import Change, regression_table
from stimuli.poulaine.walking import SIDES, SPEEDS, poulaine_to_speed
from stimuli.skeleton import Floats

STEPS = 9
"""Speeds at which the sinking of the hips is tabulated."""


@dataclass(frozen=True, eq=False)
class PoulaineEngine:
    """One captured walk ready to be edited to any speed of its range, many walkers at a time.

    points:  left and right foot's, sorted by phase
    moved:   (2, 5, 2) m per m/s, how each of them moves with speed
    range:   m/s, slowest and fastest walk it can be edited to
    sinking: (STEPS,) m that the hips sink at speeds over the range
    world:   (N, R, 4), positions (N, R, 3) m of the captured walk
    """

    cycle: Cycle
    points: tuple[ControlPoints, ControlPoints]
    moved: Floats
    range: tuple[float, float]
    sinking: Floats
    world: Floats
    positions: Floats

    def poses(self, speeds: Floats, phases: Floats, legs: Floats | None = None) -> tuple[Floats, Floats]:
        """Local rotations (W, R, 4) and hips (W, 3) m of W walkers.

        speeds: (W,) m/s, kept within `range`; phases: (W,); legs: (W,) m leg lengths, by default as captured: a
        longer leg walks as the captured one at the same speed over sqrt(g l0).
        """
        size = np.ones(len(phases)) if legs is None else np.asarray(legs) / leg_length(self.cycle)
        speed = np.clip(np.asarray(speeds) / np.sqrt(size), *self.range)
        phase = np.mod(phases, 1.0)
        place = phase * len(self.world)
        below = place.astype(int) % len(self.world)
        above, share = (below + 1) % len(self.world), place - np.floor(place)
        rotations = mixed(self.cycle.rotations[below], self.cycle.rotations[above], share[:, None, None])
        part = share[:, None]
        for side, name in enumerate(SIDES):
            hip, knee, ankle = (self.cycle.joints.index(f"{name}{joint}") for joint in _LEG)
            parent = self.cycle.parents[hip]
            used = [parent, hip, knee, ankle]
            chain = mixed(self.world[below][:, used], self.world[above][:, used], part[..., None])
            start = (1 - part) * self.positions[below, hip] + part * self.positions[above, hip]
            aside = (1 - share) * self.positions[below, ankle, 0] + share * self.positions[above, ankle, 0]
            path = self._path(side, speed, phase)
            target = np.stack([aside, start[:, 1] + path[:, 1], start[:, 2] + path[:, 0]], axis=-1)
            offsets = self.cycle.offsets
            leg = bent(start, target, chain[:, 1], chain[:, 2], offsets[knee], offsets[ankle])
            rotations[:, hip] = local(chain[:, 0], leg.thigh)
            rotations[:, knee] = local(leg.thigh, leg.shank)
            rotations[:, ankle] = local(leg.shank, chain[:, 3])
        hips = (1 - part) * self.cycle.hips[below] + part * self.cycle.hips[above]
        hips[:, 1] -= np.interp(speed, np.linspace(*self.range, STEPS), self.sinking)
        return rotations, hips * size[:, None]

    def _path(self, side: int, speed: Floats, phase: Floats) -> Floats:
        """(W, 2) m: the Hermite curve through each walker's own points."""
        points = self.points[side]
        shift = (speed - self.cycle.gait.speed)[:, None, None] * self.moved[side]
        places = points.places + shift
        growth = np.ptp(places, axis=1) / np.ptp(points.places, axis=0)
        knots = points.phases
        segment = np.searchsorted(knots, phase, side="right") - 1  # -1: before the first, after the last
        first, second = segment % len(knots), (segment + 1) % len(knots)
        width = (knots[second] - knots[first]) % 1.0
        t = (((phase - knots[first]) % 1.0) / width)[:, None]
        walkers = np.arange(len(phase))
        v0, v1 = points.velocities[first] * growth * width[:, None], points.velocities[second] * growth * width[:, None]
        p0, p1 = places[walkers, first], places[walkers, second]
        s = 1.0 - t
        return np.asarray(
            s * s * (1 + 2 * t) * p0 + t * t * (3 - 2 * t) * p1 + t * s * s * v0 - t * t * s * v1,
        )


_LEG = ("UpperLeg", "LowerLeg", "Foot")


def poulaine_engine(cycle: Cycle, table: str = "normalised", reach: float = 0.5) -> PoulaineEngine:
    """The engine of a captured walk, for speeds of 1 - reach to 1 + reach times its own.

    Raises MethodError where even a fifth of that range cannot be walked.
    """
    legs = leg_length(cycle)
    per_speed = regression_table(table).moved(Change(speed=1.0), legs)
    found, moved = [], []
    for side in SIDES:
        points = characteristic_points(poulaine_of(cycle, side))
        order = np.argsort(points.phases)
        names = tuple(points.names[index] for index in order)
        found.append(ControlPoints(names, points.phases[order], points.places[order], points.velocities[order]))
        rows = per_speed[[FIVE.index(name) for name in names]].copy()
        rows[names.index("V"), 0] = 0.0
        moved.append(rows)
    low, high = (_furthest(cycle, table, sign * reach) for sign in (-1.0, 1.0))
    speeds = np.linspace(low, high, STEPS)
    made = [poulaine_to_speed(cycle, float(speed), table) for speed in speeds]
    sinking = np.array([cycle.hips[0, 1] - walk.hips[0, 1] for walk in made])
    world, positions = cycle_pose(cycle)
    return PoulaineEngine(cycle, (found[0], found[1]), np.array(moved), (low, high), sinking, world, positions)


def _furthest(cycle: Cycle, table: str, reach: float) -> float:
    """m/s: the largest part of `reach` (of the walk's own speed) to which the walk can be edited."""
    own = cycle.gait.speed
    for part in (1.0, 0.8, 0.6, 0.4, 0.2):
        speed = min(max(own * (1.0 + reach * part), SPEEDS[0]), SPEEDS[1])
        try:
            poulaine_to_speed(cycle, speed, table)
        except MethodError:
            continue
        return speed
    raise MethodError(f"{cycle.provenance.clip}: its poulaine cannot be edited to any other speed")

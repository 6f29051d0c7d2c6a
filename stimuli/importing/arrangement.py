"""Which cycles an actor gets and how they are arranged: captured walks on a grid or a path, the rest modelled.

A grid is a branch over step frequency whose children are branches over speed. Captures that make no grid lie on a
path: a branch over speed alone, step frequency following. With `complete` the gait model fills the grid around the
person: what each captured walk does differently from the model counts wherever a wanted walk is near it, and its
mean, shrunk as in a mixed model, everywhere else. Knows no file and no skeleton.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stimuli.actors import CYCLE_SPEEDS, EARLIER_OFF, METRONOME, Person, walk_coefficients
from stimuli.gait_model import SIGNALS, WalkCurves, load_gait_model
from stimuli.importing.signals import evened
from stimuli.importing.skeleton_bias import skeleton_bias
from stimuli.importing.walks import CapturedWalk
from stimuli.skeleton import Floats

PERSON_RATIO = 3.0
"""Variance between people over variance between walks of one person, as the gait model was fitted with."""

BELIEVED = 0.4
"""Share of the difference from the average person's posture that is believed where it hangs on a rest pose's zero."""

TRUNK = ("hips_x", "spine_x", "chest_x", "neck_x", "head_x")
LEGS = ("thigh", "shank", "foot_yaw", "knee_yaw")
STANCE = (0.52, 0.74)
"""Least and largest drawn share of the cycle on one foot: a slow limp's good leg stands for some 0.72."""

NEAR_SPEED, NEAR_FREQUENCY = 0.20, 8.0
"""m/s and steps/min within which a modelled walk is like a captured one."""

REPEATED = 0.1
"""Variance between two walks at one speed and step frequency over that between all walks of one person."""

SAME_ROW = 3.0
"""steps/min: walks to one beat of the metronome lie this near to their mean."""

ROW_GAP = 5.0
"""steps/min: between rows, half the metronome's interval."""

SAME_SPEED = 0.04
"""m/s: walks of one row nearer than this are averaged."""

CROWDED = 0.08
"""m/s: no modelled cycle is put this near to a captured one."""


@dataclass(frozen=True, eq=False)
class ArrangedCycle:
    """One cycle of an actor. files: the clips it was captured from; empty if it is modelled."""

    speed: float  # m/s
    step_frequency: float  # steps/min
    walk: WalkCurves
    files: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Arrangement:
    """Rows of cycles, each (step frequency, cycles in order of speed); one path if `follows`."""

    rows: tuple[tuple[float, tuple[ArrangedCycle, ...]], ...]
    follows: bool

    @property
    def cycles(self) -> tuple[ArrangedCycle, ...]:
        """All cycles, row by row."""
        return tuple(cycle for _, row in self.rows for cycle in row)


def arrange(
    walks: Sequence[CapturedWalk], person: Person, leg_length: float, complete: bool, symmetric: bool = False
) -> Arrangement:
    """The cycles of a person. leg_length: m, of the body that will be drawn; symmetric: both sides are averaged."""
    captured = [_captured(walk, person, symmetric) for walk in walks]
    if complete:
        return _completed(captured, walks, person, leg_length)
    groups = _groups(captured, ROW_GAP)
    if _is_grid(groups):
        return Arrangement(tuple((_mean_frequency(group), tuple(_row(group))) for group in groups), False)
    return Arrangement(((0.0, tuple(_row(captured, own_frequency=True))),), True)


def _is_grid(groups: list[list[ArrangedCycle]]) -> bool:
    """Two rows or more, each at one beat, whose speeds have a stretch in common."""
    if len(groups) < 2 or any(np.ptp([cycle.step_frequency for cycle in group]) > 2 * SAME_ROW for group in groups):
        return False
    low = max(min(cycle.speed for cycle in group) for group in groups)
    high = min(max(cycle.speed for cycle in group) for group in groups)
    return high - low > SAME_SPEED


def _groups(cycles: Sequence[ArrangedCycle], gap: float) -> list[list[ArrangedCycle]]:
    """Cycles parted wherever neighbouring step frequencies lie `gap` steps/min apart."""
    groups: list[list[ArrangedCycle]] = []
    for cycle in sorted(cycles, key=lambda cycle: cycle.step_frequency):
        if groups and cycle.step_frequency - groups[-1][-1].step_frequency < gap:
            groups[-1].append(cycle)
        else:
            groups.append([cycle])
    return groups


def _beats(cycles: Sequence[ArrangedCycle]) -> list[list[ArrangedCycle]]:
    """Cycles of nearly one step frequency together, within twice SAME_ROW of each other.

    Freely chosen step frequencies may follow each other without a gap over a wide range; that is cut into equal parts.
    """
    beats: list[list[ArrangedCycle]] = []
    for group in _groups(cycles, SAME_ROW):
        low, high = group[0].step_frequency, group[-1].step_frequency
        parts = max(int(np.ceil((high - low) / (2 * SAME_ROW))), 1)
        edges = np.linspace(low, high, parts + 1)[1:-1]
        cut = np.searchsorted(edges, [cycle.step_frequency for cycle in group], side="right")
        beats += [[cycle for cycle, part in zip(group, cut, strict=True) if part == n] for n in range(parts)]
    return [beat for beat in beats if beat]


def _row(cycles: Sequence[ArrangedCycle], own_frequency: bool = False) -> list[ArrangedCycle]:
    """Cycles in order of speed at their mean step frequency, those of nearly one speed averaged."""
    merged: list[list[ArrangedCycle]] = []
    for cycle in sorted(cycles, key=lambda cycle: cycle.speed):
        if merged and cycle.speed - merged[-1][0].speed < SAME_SPEED:
            merged[-1].append(cycle)
        else:
            merged.append([cycle])
    frequency = _mean_frequency(cycles)
    return [_mean(group, None if own_frequency else frequency) for group in merged]


def _mean(cycles: list[ArrangedCycle], step_frequency: float | None) -> ArrangedCycle:
    return ArrangedCycle(
        speed=float(np.mean([cycle.speed for cycle in cycles])),
        step_frequency=_mean_frequency(cycles) if step_frequency is None else step_frequency,
        walk=WalkCurves(
            np.mean([cycle.walk.sides for cycle in cycles], axis=0),
            np.mean([cycle.walk.stance for cycle in cycles], axis=0),
            float(np.mean([cycle.walk.left_strike for cycle in cycles])),
        ),
        files=tuple(file for cycle in cycles for file in cycle.files),
    )


def _mean_frequency(cycles: Sequence[ArrangedCycle]) -> float:
    return float(np.mean([cycle.step_frequency for cycle in cycles]))


def _captured(walk: CapturedWalk, person: Person, symmetric: bool) -> ArrangedCycle:
    """The walk as captured, its posture's zero and what it does not hold taken from the gait model.

    Where zero hangs on a rest pose only the mean of both sides is drawn to the average person's: what one leg does
    differently from the other stays as captured.
    """
    model, captured = load_gait_model(), walk.curves
    none = np.zeros(captured.sides.shape[1:])
    average, stance = walk_coefficients(model, person, none, walk.leg_length, walk.gait.speed, walk.gait.step_frequency)
    sides = np.where(np.isnan(captured.sides), average, captured.sides - skeleton_bias(walk.names))
    for name in TRUNK + (() if walk.marker_based else LEGS):
        index = SIGNALS.index(name)
        share = 0.0 if name == "hips_x" and walk.marker_based else BELIEVED
        sides[:, index, 0] += (1.0 - share) * (average[index, 0] - np.mean(sides[:, index, 0]))
    shares = np.where(np.isfinite(captured.stance), captured.stance - EARLIER_OFF, np.nan)
    shares = np.where(np.isfinite(shares), shares, np.nanmean([*shares, stance][: 3 if np.isnan(shares).all() else 2]))
    curves = WalkCurves(sides, np.clip(shares, *STANCE), captured.left_strike)
    if symmetric:
        curves = WalkCurves(evened(curves.sides), np.full(2, np.mean(curves.stance)))
    return ArrangedCycle(walk.gait.speed, walk.gait.step_frequency, curves, (walk.file,))


def _completed(
    captured: list[ArrangedCycle], walks: Sequence[CapturedWalk], person: Person, leg_length: float
) -> Arrangement:
    """The metronome's grid with the captured walks in it: at their own speed, those of one beat at its mean."""
    own = _Manner.of(captured, walks, person)
    rows: dict[float, list[ArrangedCycle]] = {}
    for group in _beats(captured):
        rows[_mean_frequency(group)] = _row(group)
    for beat in METRONOME:
        if all(abs(beat - frequency) > SAME_ROW for frequency in rows):
            rows[beat] = []
    arranged = {frequency: _filled(row, own, frequency, leg_length) for frequency, row in rows.items()}
    for beat, end in ((METRONOME[0], min(rows)), (METRONOME[-1], max(rows))):
        if not min(rows) <= beat <= max(rows):
            arranged[beat] = [own.moved(cycle, beat, leg_length) for cycle in arranged[end]]
    return Arrangement(tuple((frequency, tuple(arranged[frequency])) for frequency in sorted(arranged)), False)


def _filled(row: list[ArrangedCycle], own: _Manner, frequency: float, leg_length: float) -> list[ArrangedCycle]:
    """A row with modelled cycles wherever no captured one is near, in order of speed."""
    there = list(row)
    for speed in CYCLE_SPEEDS:
        inside = speed not in (CYCLE_SPEEDS[0], CYCLE_SPEEDS[-1])
        if all(abs(speed - cycle.speed) > (CROWDED if inside else 0.02) for cycle in row):
            there.append(own.cycle(speed, frequency, leg_length))
    return sorted(there, key=lambda cycle: cycle.speed)


@dataclass(frozen=True, eq=False)
class _Manner:
    """What a person does differently from the gait model at each captured walk.

    residuals: (n, 2, S, C); stances: (n, 2) share of the cycle; strikes: (n,) phase of the left heel strike less 0.5
    """

    person: Person
    places: Floats  # (n, 2) speed, step frequency
    residuals: Floats
    stances: Floats
    strikes: Floats

    @classmethod
    def of(cls, captured: list[ArrangedCycle], walks: Sequence[CapturedWalk], person: Person) -> _Manner:
        residuals, stances = [], []
        for cycle, walk in zip(captured, walks, strict=True):
            none = np.zeros(cycle.walk.sides.shape[1:])
            average, stance = walk_coefficients(
                load_gait_model(), person, none, walk.leg_length, cycle.speed, cycle.step_frequency
            )
            residuals.append(cycle.walk.sides - average)
            stances.append(cycle.walk.stance - stance)
        places = np.array([[cycle.speed, cycle.step_frequency] for cycle in captured])
        strikes = np.array([cycle.walk.left_strike - 0.5 for cycle in captured])
        return cls(person, places, np.array(residuals), np.array(stances), strikes)

    def cycle(self, speed: float, step_frequency: float, leg_length: float) -> ArrangedCycle:
        """The modelled cycle of this person at a speed (m/s) and step frequency (steps/min)."""
        weights = self._weights(speed, step_frequency)
        none = np.zeros(self.residuals.shape[2:])
        average, stance = walk_coefficients(load_gait_model(), self.person, none, leg_length, speed, step_frequency)
        walk = WalkCurves(
            average + np.tensordot(weights, self.residuals, axes=1),
            np.clip(stance + weights @ self.stances, *STANCE),
            0.5 + float(weights @ self.strikes),
        )
        return ArrangedCycle(speed, step_frequency, walk)

    def moved(self, cycle: ArrangedCycle, step_frequency: float, leg_length: float) -> ArrangedCycle:
        """A cycle as it is at a step frequency (steps/min) close by: what it does differently from the model is kept.

        So a grid reaches its end beat from captures a little inside without a bend, however close they are.
        """
        none = np.zeros(self.residuals.shape[2:])
        (here, stance_here), (there, stance_there) = (
            walk_coefficients(load_gait_model(), self.person, none, leg_length, cycle.speed, frequency)
            for frequency in (cycle.step_frequency, step_frequency)
        )
        walk = WalkCurves(
            cycle.walk.sides + there - here,
            np.clip(cycle.walk.stance + stance_there - stance_here, *STANCE),
            cycle.walk.left_strike,
        )
        return ArrangedCycle(cycle.speed, step_frequency, walk)

    def _weights(self, speed: float, step_frequency: float) -> Floats:
        """(n,) how much of each captured walk's difference there is at a speed and step frequency.

        Kriging (Rasmussen & Williams 2006, eq. 2.19, 2.25): differences vary between people PERSON_RATIO times as much
        as between walks of one person, whose likeness falls with their distance. So a captured walk's own difference
        is met where it was captured, without a step to the modelled walks beside it; far from all captures what is
        left is their mean, shrunk as in a mixed model.
        """
        places = np.vstack([self.places, (speed, step_frequency)]) / (NEAR_SPEED, NEAR_FREQUENCY)
        apart = np.sum((places[:, None] - places) ** 2, axis=-1)
        alike = PERSON_RATIO + np.exp(-0.5 * apart)
        between = alike[:-1, :-1] + REPEATED * np.eye(len(self.places))
        return np.asarray(np.linalg.solve(between, alike[:-1, -1]))

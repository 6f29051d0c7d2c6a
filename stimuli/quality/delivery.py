"""What an actor delivers over everything it covers: the quality table, and the table over all actors.

Every figure is measured on the drawn skeleton (measure.delivered_gait), none read from the blend tree.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stimuli.actors import Actor, load_actor
from stimuli.blend_tree import Branch, CoverageError, coverage, followed_step_frequency
from stimuli.gait import Gait
from stimuli.measure import DeliveredGait, delivered_gait

STUDY_SPEEDS = (0.8, 1.2)  # m/s
STUDY_FREQUENCIES = (80.0, 120.0)  # steps/min
"""What every actor of the studies has to cover (Niay 2022, section 3.1.2)."""

TABLE_SPEEDS = (0.8, 0.9, 1.0, 1.1, 1.2)
TABLE_FREQUENCIES = (80.0, 90.0, 100.0, 110.0, 120.0)

SPEED_ERROR, SLIDE_MEAN, SLIDE_PEAK, SOLE_BELOW = 0.1, 5.0, 10.0, 3.0
"""Limits: % of speed and step frequency; mm of mean and largest slide per stance; mm of a sole below the ground."""


@dataclass(frozen=True)
class QualityRow:
    """Wanted against delivered at one place; errors in %."""

    wanted: Gait
    delivered: DeliveredGait

    @property
    def speed_error(self) -> float:
        """Delivered over wanted speed, in % above it."""
        return 100.0 * (self.delivered.speed / self.wanted.speed - 1.0)

    @property
    def frequency_error(self) -> float:
        """Delivered over wanted step frequency, in % above it."""
        return 100.0 * (self.delivered.step_frequency / self.wanted.step_frequency - 1.0)

    @property
    def faults(self) -> tuple[str, ...]:
        """What is beyond the limits; empty when all is well."""
        checks = (
            ("speed", abs(self.speed_error) > SPEED_ERROR),
            ("step frequency", abs(self.frequency_error) > SPEED_ERROR),
            ("mean slide", self.delivered.slide_mean > SLIDE_MEAN),
            ("peak slide", self.delivered.slide_peak > SLIDE_PEAK),
            ("sole", self.delivered.sole_lowest < -SOLE_BELOW),
            ("knee", self.delivered.knee_least < 0.0),
        )
        return tuple(name for name, wrong in checks if wrong)


def quality_table(actor: Actor, speeds: int = 5, frequencies: int = 5) -> list[QualityRow]:
    """Rows over the actor's coverage, within the studies' range where the actor has it; a path where SF follows."""
    return [QualityRow(gait, delivered_gait(actor, gait.speed, gait.step_frequency)) for gait in places(
        actor, speeds, frequencies
    )]  # fmt: skip


def places(actor: Actor, speeds: int, frequencies: int) -> list[Gait]:
    """Evenly spread gaits that an actor covers, step frequency by step frequency."""
    ranges = coverage(actor.tree)
    slow, fast = _within(ranges["speed"], STUDY_SPEEDS)
    if follows(actor):
        slow, fast = ranges["speed"]
        wanted = np.unique(np.linspace(slow, fast, max(speeds, 9)))
        return [Gait.at_speed(float(v), followed_step_frequency(actor.tree, float(v)) or 0.0) for v in wanted]
    low, high = _within(ranges["step_frequency"], STUDY_FREQUENCIES)
    return [
        Gait.at_speed(float(speed), float(frequency))
        for frequency in np.unique(np.linspace(low, high, frequencies))
        for speed in np.unique(np.linspace(slow, fast, speeds))
    ]


def follows(actor: Actor) -> bool:
    """True when the actor's step frequency follows its speed, for want of captures."""
    return isinstance(actor.tree, Branch) and bool(actor.tree.follows)


def comfort(actor: Actor) -> Gait:
    """The gait at which an actor is looked at: comfort speed and captured walk ratio, or the nearest it covers."""
    ranges = coverage(actor.tree)
    speed = float(np.clip(actor.comfort_speed, *ranges["speed"]))
    frequency = followed_step_frequency(actor.tree, speed)
    if frequency is None:
        frequency = float(np.clip(actor.comfort_step_frequency, *ranges["step_frequency"]))
    return Gait.at_speed(speed, frequency)


@dataclass(frozen=True)
class TableCell:
    """One target: delivered speed (m/s), step frequency (steps/min) and mean slide (mm), mean and SD over actors."""

    target: Gait
    speed: tuple[float, float]
    step_frequency: tuple[float, float]
    slide: tuple[float, float]
    actors: int


def delivered_table(
    names: Sequence[str], speeds: Sequence[float] = TABLE_SPEEDS, frequencies: Sequence[float] = TABLE_FREQUENCIES
) -> list[TableCell]:
    """What actors deliver at each target, as in table 3.2 of Niay (2022): step frequencies, in each all speeds.

    Raises CoverageError, which names the actor, when one does not cover a target.
    """
    actors = [load_actor(name) for name in names]
    cells = []
    for frequency in frequencies:
        for speed in speeds:
            measured = [_delivered(actor, speed, frequency) for actor in actors]
            cells.append(
                TableCell(
                    target=Gait.at_speed(speed, frequency),
                    speed=_mean_and_deviation([gait.speed for gait in measured]),
                    step_frequency=_mean_and_deviation([gait.step_frequency for gait in measured]),
                    slide=_mean_and_deviation([gait.slide_mean for gait in measured]),
                    actors=len(actors),
                )
            )
    return cells


def _delivered(actor: Actor, speed: float, step_frequency: float) -> DeliveredGait:
    try:
        return delivered_gait(actor, speed, step_frequency)
    except CoverageError as error:
        raise error.of(actor.name) from None


def _mean_and_deviation(values: list[float]) -> tuple[float, float]:
    return float(np.mean(values)), float(np.std(values, ddof=1)) if len(values) > 1 else 0.0


def _within(covered: tuple[float, float], asked: tuple[float, float]) -> tuple[float, float]:
    """The part of a range that is asked for, or all of it where there is none."""
    low, high = max(covered[0], asked[0]), min(covered[1], asked[1])
    return (low, high) if low <= high else covered

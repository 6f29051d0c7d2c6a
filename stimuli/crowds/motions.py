"""Walks of people nobody captured, for crowds: style and manner drawn at random, put on the body of the sex.

As Ma, Xia, Hodgins, Yang, Li & Wang (2010), whom Niay (2022, section 6.1) followed, in two steps: style parameters
(sex, step length), then what else varies between people given the style. Here the second is the gait model's own
account of people: what the captured people do differently from the average, mixed with normal weights, so that a
made person differs from the average as much, and in the same coefficients together, as captured people do.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np

from stimuli.blend import CycleTable, WalkCycle
from stimuli.bodies.known import load_body
from stimuli.gait_model import GRAVITY, GaitModel, Step, WalkCurves, load_gait_model
from stimuli.retarget import Figure, walk_cycle
from stimuli.skeleton import Floats

Sex = Literal["F", "M"]
SEXES: tuple[Sex, Sex] = ("F", "M")
BODIES: dict[Sex, str] = {"F": "woman", "M": "man"}

STEP_LENGTH = (0.77, 0.06)
"""m, mean and SD of the step lengths of Niay's crowds (2022, section 6.1.1)."""

SHORTEST, LONGEST = 0.60, 0.94
"""m; draws beyond (2.8 SD) are drawn again."""

UNREMARKABLE = 3
"""Of each crowd with one motion per sex, that motion is one of so many least distinctive captured ones."""


@dataclass(frozen=True)
class Style:
    """Which walk of the pool of a sex: `number` counts from 0; -1, -2, -3 are the least distinctive captured people."""

    sex: Sex
    number: int
    pool: int = 0


@dataclass(frozen=True, eq=False)
class Motion:
    """A walk on the unscaled body of its sex.

    step_length: m; step_frequency: steps/min, of its own accord; table: its one cycle, in single precision, so that a
    thousand walks are 70 MB.
    """

    style: Style
    step_length: float
    step_frequency: float
    table: CycleTable

    @property
    def speed(self) -> float:
        """m/s, of its own accord on the unscaled body."""
        return self.step_length * self.step_frequency / 60.0


def figure_of(sex: Sex) -> Figure:
    """The unscaled body's figure."""
    return _figures()[sex]


@lru_cache(maxsize=1)
def _figures() -> dict[Sex, Figure]:
    return {sex: Figure(load_body(BODIES[sex]).skeleton) for sex in SEXES}


@lru_cache(maxsize=4096)
def motion_of(style: Style) -> Motion:
    """The walk of a style; the same style is the same walk."""
    model, figure = load_gait_model(), figure_of(style.sex)
    rng = np.random.default_rng([style.pool, SEXES.index(style.sex), style.number + UNREMARKABLE])
    length = float(STEP_LENGTH[0])
    if style.number < 0:
        manner = model.offsets[least_distinctive(model)[-1 - style.number]]
    else:
        length = drawn_step_length(rng)
        manner = drawn_manner(model, rng)
    frequency = expected_step_frequency(model, length, figure.leg_length)
    speed = length * frequency / 60.0
    step = Step.of(speed, frequency, figure.leg_length)
    sex = 0.5 if style.sex == "F" else -0.5
    coefficients = model.coefficients(step, sex, manner)
    curves = WalkCurves.symmetric(coefficients, model.stance_share(step, sex))
    cycle = walk_cycle(figure, curves, speed, frequency)
    return Motion(style, length, frequency, CycleTable.of([_single(cycle)]))


def _single(cycle: WalkCycle) -> WalkCycle:
    hips, rotations, feet = (values.astype(np.float32) for values in (cycle.hips, cycle.rotations, cycle.feet))
    return replace(cycle, hips=hips, rotations=rotations, feet=feet)


def drawn_step_length(rng: np.random.Generator) -> float:
    """m, normal (STEP_LENGTH) between SHORTEST and LONGEST."""
    while True:
        length = float(rng.normal(*STEP_LENGTH))
        if SHORTEST <= length <= LONGEST:
            return length


def drawn_manner(model: GaitModel, rng: np.random.Generator) -> Floats:
    """(S, C) what a made person does differently: captured people's offsets with normal weights.

    The weights' variance is 1 over the number of people, so that the offset has the captured ones' covariance; none
    beyond 2.5 of its SDs, so that nobody walks like a caricature.
    """
    count = len(model.people)
    weights = np.clip(rng.standard_normal(count), -2.5, 2.5) / np.sqrt(count)
    return np.asarray(np.tensordot(weights, model.offsets, axes=1))


def expected_step_frequency(model: GaitModel, step_length: float, leg_length: float) -> float:
    """steps/min at which the captured people take steps of this length (m), by their leg length (m)."""
    frequency = model.centre[1] + model.cadence_slope * (step_length / leg_length - model.centre[0])
    return float(60.0 * frequency / np.sqrt(leg_length / GRAVITY))


def least_distinctive(model: GaitModel) -> list[int]:
    """The captured people, the one nearest to the average first: root mean square over coefficients in their SDs."""
    spread = np.maximum(model.offsets.std(axis=0), 1e-9)
    return [int(person) for person in np.argsort(np.mean((model.offsets / spread) ** 2, axis=(1, 2)))]

"""Simulated observers choosing and rating, by the thousand and without a session.

The same model as the observers of `gaitlab simulate`: shares, means and times by condition, with spread between
participants and from trial to trial.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import special

from analysis.planned.plan import AnalysisPlan
from analysis.planned.setting_values import values_of
from protocols.limited_scale import latent_mean
from protocols.study import Simulation

QUICKEST = 0.2  # s, the shortest response time of a simulated observer


@dataclass(frozen=True)
class Choosers:
    """A population that chooses one of two, and the trials it does.

    confusion: (trials,) probability of choosing another than the original; seconds: (trials,) median response time;
    spread: s.d. between participants, logit; pace_spread, time_spread: s.d. of log time between people and trials.
    """

    measure: str
    confusion: np.ndarray
    seconds: np.ndarray
    spread: float
    pace_spread: float
    time_spread: float

    def values(self, rng: np.random.Generator, people: int) -> np.ndarray:
        """(people, trials) the measure: confusion_rate (0 or 100 %), correct (0 or 1) or response_time (s)."""
        leaning, pace = rng.standard_normal((people, 1)), rng.standard_normal((people, 1))
        size = (people, len(self.confusion))
        if self.measure == "response_time":
            log = self.pace_spread * pace + self.time_spread * rng.standard_normal(size)
            return np.maximum(self.seconds * np.exp(log), QUICKEST)
        share = special.expit(special.logit(self.confusion) + self.spread * leaning)
        confused = rng.random(size) < share
        return 100.0 * confused if self.measure == "confusion_rate" else 1.0 - confused


@dataclass(frozen=True)
class Raters:
    """A population that rates on a scale, and the trials it does.

    rating: (trials,) mean before it is kept on the scale; spread, noise: s.d. between participants and from trial to
    trial; lowest, highest, step: of the scale, step None where it is continuous.
    """

    rating: np.ndarray
    spread: float
    noise: float
    lowest: float
    highest: float
    step: float | None

    def values(self, rng: np.random.Generator, people: int) -> np.ndarray:
        """(people, trials) ratings."""
        leaning = rng.standard_normal((people, 1))
        wanted = self.rating + self.spread * leaning + self.noise * rng.standard_normal((people, len(self.rating)))
        wanted = np.clip(wanted, self.lowest, self.highest)
        return wanted if self.step is None else self.lowest + self.step * np.round((wanted - self.lowest) / self.step)


def choosers(plan: AnalysisPlan, conditions: Sequence[Mapping[str, Any]], simulation: Simulation) -> Choosers:
    """The population and the trials of a choice study."""
    part = simulation.choice
    confusion, seconds = (
        np.tile(np.array(values_of(setting, conditions), dtype=float), plan.repetitions)
        for setting in (part.confusion, part.response_time)
    )
    return Choosers(plan.measure, confusion, seconds, part.spread, part.pace_spread, part.time_spread)


def raters(
    study: Mapping[str, Any], plan: AnalysisPlan, conditions: Sequence[Mapping[str, Any]], simulation: Simulation
) -> Raters:
    """The population and the trials of a rating study (as a plain dict)."""
    part, scale = simulation.rating, (study.get("task") or {}).get("scale") or {}
    step, low, high = scale.get("step", 1.0), float(scale.get("minimum", 0.0)), float(scale.get("maximum", 4.0))
    means = [(low + high) / 2.0] * len(conditions) if part.rating is None else values_of(part.rating, conditions)
    felt = [latent_mean(float(mean), math.hypot(part.spread, part.noise), low, high) for mean in means]
    return Raters(
        np.tile(felt, plan.repetitions), part.spread, part.noise, low, high, None if step is None else float(step)
    )

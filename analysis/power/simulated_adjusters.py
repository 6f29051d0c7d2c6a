"""Simulated observers adjusting step frequency, by the thousand and without a session.

The same model as the observers of `gaitlab simulate` (preference per actor, noise per trial, anchoring,
the range of the task), without their key presses.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from analysis.errors import AnalysisError
from analysis.planned.plan import AnalysisPlan
from analysis.planned.setting_values import values_of
from analysis.recorded.gait_measures import GRAVITY
from protocols.study import Simulation

MEASURES = ("walk_ratio", "step_frequency", "step_length", "normalised_walk_ratio")


@dataclass(frozen=True)
class Adjusters:
    """A population that adjusts step frequency, and the trials it does.

    actor: (trials,) index of the actor; speed: (trials,) m/s; start: (trials,) steps/min; height: (trials,) m, of the
    actor, nan where the plan gives none. mean, sd: (actors,) m·min, preferred walk ratio; shared: its correlation over
    actors; trial_noise: m·min; anchoring: share of the way back to the start; lowest, highest: steps/min.
    """

    measure: str
    actor: np.ndarray
    speed: np.ndarray
    start: np.ndarray
    height: np.ndarray
    mean: np.ndarray
    sd: np.ndarray
    shared: float
    trial_noise: float
    anchoring: float
    lowest: float
    highest: float

    def values(self, rng: np.random.Generator, people: int) -> np.ndarray:
        """(people, trials) the measure, as one experiment's observers would give it."""
        return self._measured(np.clip(self.wanted(rng, people), self.lowest, self.highest))

    def wanted(self, rng: np.random.Generator, people: int) -> np.ndarray:
        """(people, trials) step frequencies that observers would choose if nothing limited them."""
        own, apart = rng.standard_normal((people, 1)), rng.standard_normal((people, len(self.mean)))
        z = np.sqrt(self.shared) * own + np.sqrt(1 - self.shared) * apart
        preferred = np.maximum(self.mean + self.sd * z, self.mean / 4)
        wanted = preferred[:, self.actor] + self.trial_noise * rng.standard_normal((people, len(self.actor)))
        frequency = np.sqrt(60 * self.speed / np.maximum(wanted, 1e-4))
        return frequency + self.anchoring * (self.start - frequency)

    def _measured(self, frequency: np.ndarray) -> np.ndarray:
        if self.measure == "step_frequency":
            return frequency
        length = 60 * self.speed / frequency
        if self.measure == "step_length":
            return length
        ratio = length / frequency
        return ratio * 60 * np.sqrt(GRAVITY / self.height**3) if self.measure == "normalised_walk_ratio" else ratio

    def clipped_shares(self, people: int, seed: int = 1, experiments: int = 20) -> pd.DataFrame:
        """How often the wanted step frequency lies outside the range of the task, so that the answer is its edge.

        Returns actor (index), speed (m/s) and share of trials, one row per combination.
        """
        wanted = [self.wanted(np.random.default_rng([seed, number]), people) for number in range(experiments)]
        outside = np.mean([np.mean((w < self.lowest) | (w > self.highest), axis=0) for w in wanted], axis=0)
        table = pd.DataFrame({"actor": self.actor, "speed": self.speed, "share": outside})
        return table.groupby(["actor", "speed"], as_index=False)["share"].mean()


def adjusters(
    study: Mapping[str, Any], plan: AnalysisPlan, conditions: Sequence[Mapping[str, Any]], simulation: Simulation
) -> Adjusters:
    """The population and the trials of an adjustment study (as a plain dict)."""
    stimulus, task = study.get("stimulus") or {}, study.get("task") or {}
    actors = values_of(stimulus.get("actor", ""), conditions)
    population = simulation.preferred_walk_ratio
    names = list(dict.fromkeys(map(str, actors)))
    missing = [name for name in names if name not in population]
    if missing:
        raise AnalysisError(f"The study's simulation gives no preferred walk ratio for {', '.join(missing)}.")
    bounds, again = task.get("range") or {}, plan.repetitions
    return Adjusters(
        plan.measure,
        np.tile([names.index(str(actor)) for actor in actors], again),
        np.tile(np.array(values_of(stimulus.get("speed"), conditions), dtype=float), again),
        np.tile(np.array(values_of(task.get("start"), conditions), dtype=float), again),
        np.tile([(plan.heights or {}).get(str(actor), np.nan) for actor in actors], again),
        np.array([population[name].mean for name in names], dtype=float),
        np.array([population[name].sd for name in names], dtype=float),
        simulation.shared,
        simulation.trial_noise,
        simulation.anchoring,
        float(bounds.get("minimum", 80.0)),
        float(bounds.get("maximum", 120.0)),
    )

"""QUEST+ as a value: shows the level whose answer is expected to leave the least uncertainty (Watson 2017).

A. B. Watson (2017), QUEST+: a general multidimensional Bayesian adaptive psychometric method, J. Vision 17(3):10.
Plain Python, as the protocols import no NumPy; compared with the package questplus 2023.1 in the tests.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product
from statistics import NormalDist
from typing import Literal

Function = Literal["logistic", "normal", "weibull"]

TIE = 1e-9
"""nat: expected entropies this close are equal, and the first level wins, so that every computer chooses alike."""


@dataclass(frozen=True)
class QuestPlus:
    """What is believed about a psychometric function at one moment.

    levels:     what can be shown.
    parameters: possible (threshold, spread, lapse) triples; belief: their probabilities, summing to 1.
    yes:        [level][triple], the probability of yes.
    """

    levels: tuple[float, ...]
    parameters: tuple[tuple[float, float, float], ...]
    belief: tuple[float, ...]
    yes: tuple[tuple[float, ...], ...]

    @property
    def level(self) -> float:
        """The level to show next: of least expected entropy of the belief after the answer (Watson's equation 6)."""
        entropies = [self._expected_entropy(row) for row in self.yes]
        least = min(entropies)
        return next(level for level, h in zip(self.levels, entropies, strict=True) if h <= least + TIE)

    @property
    def ended(self) -> bool:
        """False: it goes on for all its trials."""
        return False

    def after(self, level: float, yes: bool) -> QuestPlus:
        """The belief once `level` was shown and answered: Bayes' rule."""
        row = self.yes[self.levels.index(level)]
        weights = [b * (p if yes else 1.0 - p) for b, p in zip(self.belief, row, strict=True)]
        total = math.fsum(weights)
        return replace(self, belief=tuple(w / total for w in weights)) if total > 0.0 else self

    def mean(self) -> tuple[float, float, float]:
        """The expected threshold, spread and lapse."""
        return tuple(  # type: ignore[return-value]
            math.fsum(b * triple[i] for b, triple in zip(self.belief, self.parameters, strict=True)) for i in range(3)
        )

    def threshold_sd(self) -> float:
        """The standard deviation of the belief about the threshold."""
        mean = self.mean()[0]
        return math.sqrt(math.fsum(b * (t[0] - mean) ** 2 for b, t in zip(self.belief, self.parameters, strict=True)))

    def _expected_entropy(self, row: tuple[float, ...]) -> float:
        """nat; the sum over both answers of P(answer) x entropy of the belief after it."""
        expected = 0.0
        for weights in (
            [b * p for b, p in zip(self.belief, row, strict=True)],
            [b * (1.0 - p) for b, p in zip(self.belief, row, strict=True)],
        ):
            total = math.fsum(weights)
            if total > 0.0:
                expected += total * math.log(total) - math.fsum(w * math.log(w) for w in weights if w > 0.0)
        return expected


@lru_cache(maxsize=32)
def quest_plus(
    levels: tuple[float, ...],
    thresholds: tuple[float, ...],
    spreads: tuple[float, ...],
    *,
    function: Function = "logistic",
    guess: float = 0.5,
    lapses: tuple[float, ...] = (0.02,),
) -> QuestPlus:
    """A QUEST+ that believes every combination of threshold, spread and lapse equally before the first answer."""
    parameters = tuple(product(thresholds, spreads, lapses))
    yes = tuple(
        tuple(guess + (1.0 - guess - lapse) * rise(function, level, t, s) for t, s, lapse in parameters)
        for level in levels
    )
    return QuestPlus(levels, parameters, (1.0 / len(parameters),) * len(parameters), yes)


def rise(function: Function, level: float, threshold: float, spread: float) -> float:
    """The psychometric function without guesses and lapses, from 0 to 1.

    logistic: 1 / (1 + exp(-(level - threshold) / spread)); normal: cumulative Gaussian of mean threshold and s.d.
    spread; weibull: 1 - exp(-(level / threshold) ^ spread).
    """
    if function == "weibull":
        return -math.expm1(-((level / threshold) ** spread))
    z = (level - threshold) / spread
    if function == "normal":
        return NormalDist().cdf(z)
    return 1.0 / (1.0 + math.exp(-z)) if z >= 0.0 else math.exp(z) / (1.0 + math.exp(z))

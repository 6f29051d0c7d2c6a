"""What a study file can ask for, test by test and figure by figure, as plain values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class TTestPlan:
    """A one-sample t test in each level of a factor, against a value of its own; where: of these trials only."""

    each: str
    against: Mapping[str, float]
    label: str
    where: str | None = None

    @property
    def trials(self) -> str:
        """Which trials it rests on."""
        return self.where or "all trials"


@dataclass(frozen=True)
class ComparisonPlan:
    """t tests over everything or in each level of a factor.

    kind: against (a value, `against`), paired or independent (all pairs of levels of `factor`).
    """

    kind: str
    factor: str | None
    each: str | None
    against: float | None
    label: str
    where: str | None = None


@dataclass(frozen=True)
class PairsPlan:
    """Pairs of marginal means of `factors` inside each level of `by`, whether or not an effect is significant."""

    factors: tuple[str, ...]
    by: tuple[str, ...]
    adjust: str
    model: str


@dataclass(frozen=True)
class ProportionsPlan:
    """How often `success` (a condition) is met in each cell of the factors, against chance."""

    success: str
    each: tuple[str, ...]
    chance: float
    label: str


@dataclass(frozen=True)
class DPrimePlan:
    """Sensitivity: `answer` against `signal`, both conditions, in each cell of the factors."""

    signal: str
    answer: str
    each: tuple[str, ...]


@dataclass(frozen=True)
class PsychometricPlan:
    """How `success` (a condition) rises along `level`; lapse None: estimated."""

    level: str
    success: str
    each: tuple[str, ...]
    shape: str
    guess: float
    lapse: float | None
    bootstrap: int


@dataclass(frozen=True)
class AdaptivePlan:
    """The adaptive order of the study file (a plain dict), and the levels of its factor in the order of the file."""

    order: Mapping[str, Any]
    levels: tuple[float, ...]


@dataclass(frozen=True)
class EquivalencePlan:
    """Two one-sided tests of every pair of levels; bound in the unit of the measure."""

    factor: str
    bound: float
    by: str | None = None


@dataclass(frozen=True)
class RegressionPlan:
    """The mean of every level of a factor on values known of that level: predictor -> level -> value.

    units: predictor -> unit, where it has one.
    """

    of: str
    on: Mapping[str, Mapping[str, float]]
    units: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class RankTransformPlan:
    """Factors of the aligned rank transform."""

    within: tuple[str, ...]
    between: tuple[str, ...]


@dataclass(frozen=True)
class MixedModelPlan:
    """Random intercepts of participants and of the levels of `stimulus`; fixed factors, fully crossed."""

    stimulus: str
    factors: tuple[str, ...]


@dataclass(frozen=True)
class FigurePlan:
    """kind: means, interaction, raincloud, qq, order, t_tests or regression.

    reference: label of t tests whose values are drawn too; panels: groups of levels, a panel or a colour each.
    """

    kind: str
    x: str | None = None
    lines: str | None = None
    reference: str | None = None
    panels: str | None = None


@dataclass(frozen=True)
class GroupsPlan:
    """A factor made from another: its groups, each with levels of the other."""

    of: str
    levels: Mapping[str, tuple[str, ...]]

    @property
    def group_of(self) -> dict[str, str]:
        """Level of the other factor -> its group."""
        return {level: group for group, levels in self.levels.items() for level in levels}


@dataclass(frozen=True)
class Exclusion:
    """Trials left out, by a condition on one column, and why."""

    where: str
    reason: str

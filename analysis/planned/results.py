"""What the planned analysis of one measure found, before any of it is written or drawn."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import pandas as pd

from analysis.planned.further_test import FurtherTest
from analysis.planned.plan import AnalysisPlan
from analysis.recorded.journal import RecordedStudy
from analysis.recorded.trials import used_trials
from analysis.statistics.cells import CellMeans

ALPHA = 0.05


@dataclass(frozen=True)
class PlannedResults:
    """Tables of one planned analysis; an empty table where something could not be run."""

    plan: AnalysisPlan
    recorded: RecordedStudy
    trials: pd.DataFrame
    cells: pd.DataFrame  # participant x cell: trials, mean
    descriptives: pd.DataFrame  # cell: n, mean, sd, se, ci_low, ci_high
    means: CellMeans | None
    anova: pd.DataFrame
    posthoc: pd.DataFrame
    ttests: pd.DataFrame
    normality: pd.DataFrame
    assumptions: pd.DataFrame
    warnings: tuple[str, ...]
    notes: tuple[str, ...] = field(default=())
    further: tuple[FurtherTest, ...] = field(default=())
    also: tuple[PlannedResults, ...] = field(default=())  # of the plan's further measures

    @property
    def simulated(self) -> int:
        """How many of the analysed participants are simulated."""
        return sum(bool(run.header.get("simulated")) for run in self.recorded.runs)

    @property
    def used(self) -> pd.DataFrame:
        """The rows the tests rest on (`used_trials`)."""
        return used_trials(self.trials, self.plan)

    @property
    def significant(self) -> list[str]:
        """Names of the effects with p < .05 (Greenhouse-Geisser)."""
        return list(self.anova.loc[self.anova["p_gg"] < ALPHA, "effect"]) if len(self.anova) else []


def unit_decimals(results: PlannedResults) -> int:
    """Decimals that show a hundredth of the standard deviation of the measure; of percentages at least one."""
    sd = float(results.cells["mean"].std()) if len(results.cells) > 1 else math.nan
    least = 1 if results.plan.unit == "%" else 0
    return 2 if not sd > 0 else min(12, max(least, 1 - math.floor(math.log10(sd))))

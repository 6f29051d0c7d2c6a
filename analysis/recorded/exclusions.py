"""Which trials meet a condition written in a study file, such as `late_frames > 5`."""

from __future__ import annotations

import pandas as pd

from analysis.errors import AnalysisError, listed
from analysis.recorded.answers import answers
from analysis.statistics.columns import label
from protocols.condition import COMPARISONS, read_condition


def matching(trials: pd.DataFrame, where: str) -> pd.Series:
    """Which trials meet a condition such as `late_frames > 5 and response_time < 0.2`.

    A condition compares one column with a number, a word or another column (`chosen == $original`); several are
    joined by `and`. A missing value meets no condition.
    """
    chosen = pd.Series(True, index=trials.index)
    for part in where.split(" and "):
        condition = read_condition(part)
        if condition is None or condition.column not in trials.columns:
            raise AnalysisError(
                f"The exclusion {where!r} cannot be read; write a column, a comparison and a value, "
                f"as `late_frames > 5`. The columns are {listed(map(str, trials.columns), 40)}."
            )
        if condition.value.startswith("$"):
            chosen &= answers(trials, part) == 1.0
            continue
        column, value, compare = trials[condition.column], condition.value, COMPARISONS[condition.comparison]
        if pd.api.types.is_numeric_dtype(column):
            try:
                number = float(value)
            except ValueError:
                raise AnalysisError(f"The exclusion {where!r}: {value!r} is not a number.") from None
            chosen &= compare(column, number) & column.notna()
        else:
            if condition.comparison not in ("==", "!="):
                raise AnalysisError(f"The exclusion {where!r}: {condition.column} holds words; use == or !=.")
            chosen &= compare(column.map(label), value) & column.notna()
    return chosen


def selected(trials: pd.DataFrame, where: str | None) -> pd.DataFrame:
    """The trials that meet the condition, all without one; AnalysisError where none does."""
    if where is None:
        return trials
    chosen = trials[matching(trials, where)]
    if not len(chosen):
        raise AnalysisError(f"None of the {len(trials)} trials meets {where!r}, so there is nothing to test.")
    return chosen

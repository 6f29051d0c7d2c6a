"""Which trials meet a condition written in a study file, such as `late_frames > 5`."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import pandas as pd

from analysis.columns import label
from analysis.errors import AnalysisError, listed

_CONDITION = re.compile(r"\s*(\w+)\s*(<=|>=|==|!=|<|>)\s*(.+?)\s*")
_COMPARE: dict[str, Callable[[Any, Any], Any]] = {
    "<": lambda a, b: a < b, ">": lambda a, b: a > b, "<=": lambda a, b: a <= b,
    ">=": lambda a, b: a >= b, "==": lambda a, b: a == b, "!=": lambda a, b: a != b,
}  # fmt: skip


def matching(trials: pd.DataFrame, where: str) -> pd.Series:
    """Which trials meet a condition such as `late_frames > 5 and response_time < 0.2`.

    A condition compares one column with a number or a word; several are joined by `and`. A missing
    value meets no condition.
    """
    chosen = pd.Series(True, index=trials.index)
    for part in where.split(" and "):
        match = _CONDITION.fullmatch(part)
        if match is None or match[1] not in trials.columns:
            raise AnalysisError(
                f"The exclusion {where!r} cannot be read; write a column, a comparison and a value, "
                f"as `late_frames > 5`. The columns are {listed(map(str, trials.columns), 40)}."
            )
        column, value = trials[match[1]], match[3].strip("'\"")
        if pd.api.types.is_numeric_dtype(column):
            try:
                number = float(value)
            except ValueError:
                raise AnalysisError(f"The exclusion {where!r}: {value!r} is not a number.") from None
            chosen &= _COMPARE[match[2]](column, number) & column.notna()
        else:
            if match[2] not in ("==", "!="):
                raise AnalysisError(f"The exclusion {where!r}: {match[1]} holds words; use == or !=.")
            chosen &= _COMPARE[match[2]](column.map(label), value) & column.notna()
    return chosen


def selected(trials: pd.DataFrame, where: str | None) -> pd.DataFrame:
    """The trials that meet the condition, all without one; AnalysisError where none does."""
    if where is None:
        return trials
    chosen = trials[matching(trials, where)]
    if not len(chosen):
        raise AnalysisError(f"None of the {len(trials)} trials meets {where!r}, so there is nothing to test.")
    return chosen

"""What an answer was, as 0 or 1, by a condition that a study file writes."""

from __future__ import annotations

import math
from itertools import product

import pandas as pd

from analysis.errors import AnalysisError, listed
from analysis.statistics.columns import label, numeric_label
from protocols.condition import read_condition


def answers(trials: pd.DataFrame, condition: str) -> pd.Series:
    """1.0 where a trial meets the condition, 0.0 where not, nan where a column it names is empty.

    condition: as `correct == 1`, `chosen != $original` or `rating >= 3`; a value beginning with $ is another column.
    """
    read = read_condition(condition)
    names = [] if read is None else [read.column, *([read.value[1:]] if read.value.startswith("$") else [])]
    if read is None or not set(names) <= set(trials.columns):
        raise AnalysisError(
            f"The condition {condition!r} cannot be read; write a column, a comparison and a value, as `correct == 1`. "
            f"The columns are {listed(map(str, trials.columns), 40)}."
        )

    def met(row: tuple[object, ...]) -> float:
        if any(pd.isna(value) for value in row):
            return math.nan
        return float(read.holds({name: label(value) for name, value in zip(names, row, strict=True)}))

    rows = trials[names].itertuples(index=False, name=None)
    return pd.Series([met(row) for row in rows], index=trials.index, dtype=float)


def readable(condition: str) -> str:
    """A condition for the page, as "chosen = test" and "rating ≥ 3"."""
    text = condition.replace("$", "")
    for sign, written in (("==", "="), ("!=", "≠"), (">=", "≥"), ("<=", "≤")):
        text = text.replace(sign, written)
    return text


def cell_labels(data: pd.DataFrame, factors: tuple[str, ...], levels: dict[str, tuple[str, ...]]) -> pd.Series:
    """The text of every row's cell, as "pca × 1.2", "" where there are no factors; ordered as the factors' levels."""
    if not factors:
        return pd.Series("", index=data.index)
    order = [" × ".join(cell) for cell in product(*(levels[name] for name in factors))]
    place = {name: {numeric_label(level): level for level in levels[name]} for name in factors}
    texts = [
        " × ".join(
            place[name].get(numeric_label(value), label(value)) for name, value in zip(factors, row, strict=True)
        )
        for row in data[list(factors)].itertuples(index=False, name=None)
    ]
    known = [cell for cell in order if cell in set(texts)]
    return pd.Series(pd.Categorical(texts, categories=[*known, *sorted(set(texts) - set(known))]), index=data.index)

"""Student's t tests on participants' means: against a value, paired, and between two groups."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from itertools import combinations
from typing import Any

import numpy as np
import pandas as pd

from analysis.errors import AnalysisError, AnalysisWarning, listed
from analysis.statistics.cells import Levels, cell_means
from analysis.statistics.columns import (
    labels,
    numbers,
    numeric_label,
    require,
    require_different,
    require_filled,
)
from analysis.statistics.t_statistics import from_moments, independent_tests, one_sample, paired_test

COLUMNS = (
    "test", "level", "a", "b", "n", "mean", "sd", "against", "estimate", "ci_low", "ci_high", "t", "df", "p",
    "d", "d_low", "d_high", "g", "bf10", "shapiro_w", "shapiro_p", "rank_statistic", "rank_p",
)  # fmt: skip


def t_tests(
    data: pd.DataFrame,
    dv: str,
    subject: str,
    *,
    each: str | None = None,
    against: float | Mapping[Any, float] | None = None,
    paired: str | None = None,
    independent: str | None = None,
    levels: Levels | None = None,
) -> pd.DataFrame:
    """t tests on each participant's mean of `dv`, so that trials are not counted as people.

    against: one-sample tests against this value, or against the value of each level of `each`;
    paired: all pairs of levels of this within factor; independent: all pairs of levels of this
    between factor (Student's, equal variances; Welch's rows follow); each: a separate test in every
    level of this factor. Exactly one of against, paired and independent is given.

    Returns one row per test with columns test, level (of `each`), a, b, n, mean, sd (of the values, of
    the differences, or pooled), against, estimate (mean minus against, or a minus b) with 95 % limits
    ci_low, ci_high, t, df, p (two-sided), d (Cohen's: estimate over sd) with 95 % limits from the
    noncentral t, g (Hedges', exact factor), bf10 (JZS, r = sqrt(2)/2), shapiro_w, shapiro_p (values or
    differences; nan between groups), rank_statistic, rank_p (Wilcoxon or Mann-Whitney, normal
    approximation with continuity correction). Levels of `each` without a value in `against` are not tested:
    an AnalysisWarning and a sentence in `attrs["notes"]` name them. Raises AnalysisError.
    """
    given = [
        name
        for name, value in (("against", against), ("paired", paired), ("independent", independent))
        if value is not None
    ]
    if len(given) != 1:
        raise AnalysisError("Give exactly one of against, paired and independent.")
    require_different(dv=dv, subject=subject, each=each, paired=paired, independent=independent)
    labelled = [subject, *(name for name in (each, paired, independent) if name)]
    require(data, [dv, *labelled])
    require_filled(data, labelled)
    parts = _parts(data, each, levels)
    wanted = _wanted(against, each, list(parts)) if against is not None else {}
    rows: list[dict[str, Any]] = []
    notes: list[str] = []
    if against is not None and len(wanted) < len(parts):
        untested = [name for name in parts if name not in wanted]
        notes.append(f"{each}: no value to test {listed(map(repr, untested))} against was given; not tested.")
        warnings.warn(notes[-1], AnalysisWarning, stacklevel=2)
    for name, part in parts.items():
        if against is not None:
            if name in wanted:
                values = _participant_means(part, dv, subject)
                rows.append({"level": name, **one_sample(values, wanted[name])})
        elif paired is not None:
            means = cell_means(part, dv, subject, within=[paired], levels=_only(levels, paired))
            notes += means.notes
            for i, j in combinations(range(len(means.within[paired])), 2):
                a, b = means.within[paired][i], means.within[paired][j]
                rows.append({"level": name, "a": a, "b": b, **paired_test(means.values[:, i], means.values[:, j])})
        else:
            assert independent is not None
            means = cell_means(part, dv, subject, between=[independent], levels=_only(levels, independent))
            notes += means.notes
            for i, j in combinations(range(len(means.between[independent])), 2):
                x, y = (means.values[means.groups[:, 0] == k, 0] for k in (i, j))
                pair = {"level": name, "a": means.between[independent][i], "b": means.between[independent][j]}
                rows += [{**pair, **test} for test in independent_tests(x, y)]
    table = pd.DataFrame(rows).reindex(columns=list(COLUMNS))
    for column in ("level", "a", "b"):
        table[column] = [value if isinstance(value, str) else "" for value in table[column]]
    flat = table["t"].isna() & (table["n"] > 1)
    if flat.any():
        notes.append(f"{int(flat.sum())} test(s) have values without variance; no t and no p are given.")
    table.attrs["notes"] = list(dict.fromkeys(notes))
    return table


def t_tests_from_summary(summary: pd.DataFrame) -> pd.DataFrame:
    """One-sample t tests from published means and standard deviations.

    summary: columns mean, sd, n and against, one row per test; other columns are kept in front.
    Returns what `t_tests` returns, with nan where the raw values would be needed.
    """
    require(summary, ["mean", "sd", "n", "against"])
    rows = [
        from_moments("one-sample", row.mean, row.sd, int(row.n), row.against)
        for row in pd.DataFrame({c: numbers(summary, c) for c in ("mean", "sd", "n", "against")}).itertuples(
            index=False
        )
    ]
    table = pd.DataFrame(rows).reindex(columns=list(COLUMNS))
    kept = [c for c in summary.columns if c not in COLUMNS]
    return pd.concat([summary[kept].reset_index(drop=True), table], axis=1)


def _parts(data: pd.DataFrame, each: str | None, levels: Levels | None) -> dict[str, pd.DataFrame]:
    if each is None:
        return {"": data}
    column = labels(data, each, (levels or {}).get(each))
    return {name: data[column.codes == code] for code, name in enumerate(column.levels)}


def _only(levels: Levels | None, name: str) -> Levels | None:
    return {name: levels[name]} if levels and name in levels else None


def _wanted(against: float | Mapping[Any, float], each: str | None, names: list[str]) -> dict[str, float]:
    values = against.values() if isinstance(against, Mapping) else (against,)
    if not all(math.isfinite(value) for value in values):
        raise AnalysisError(f"The values to test against must be finite numbers, not {against!r}.")
    if not isinstance(against, Mapping):
        return dict.fromkeys(names, float(against))
    given = {numeric_label(name): float(value) for name, value in against.items()}
    wanted = {name: given.pop(numeric_label(name)) for name in names if numeric_label(name) in given}
    unknown = list(given)
    if unknown:
        raise AnalysisError(
            f"There is a value to test against for {listed(map(repr, unknown))}, but {each!r} has "
            f"only the levels "
            f"{listed(map(repr, names), 20)}."
        )
    return wanted


def _participant_means(data: pd.DataFrame, dv: str, subject: str) -> np.ndarray:
    values, people = numbers(data, dv), labels(data, subject)
    have = ~np.isnan(values) & (people.codes >= 0)
    counts = np.bincount(people.codes[have], minlength=len(people.levels))
    sums = np.bincount(people.codes[have], weights=values[have], minlength=len(people.levels))
    return sums[counts > 0] / counts[counts > 0]

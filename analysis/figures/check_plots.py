"""The Q-Q plots that stand in the report beside the tests whose assumption they show, and their data."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pandas as pd

from analysis.errors import AnalysisError
from analysis.figures.checks import qq_plots, residual_quantiles
from analysis.figures.drawing import DrawnFigure
from analysis.planned.results import PlannedResults
from analysis.recorded.exclusions import matching
from analysis.statistics.assumption_checks import quantiles
from analysis.statistics.columns import labels

Panels = Mapping[str, pd.DataFrame]


def check_quantiles(results: PlannedResults) -> dict[str, dict[str, pd.DataFrame]]:
    """Q-Q data by test ("anova", those of `t_test_plots`, "regression"), then by panel; none without variance."""
    found: dict[str, dict[str, pd.DataFrame]] = {}
    means = results.means
    if means is not None:
        _keep(found, "anova", {"": lambda: residual_quantiles(means)})
    plots = t_test_plots(results)
    for asked in results.plan.t_tests:
        name = plots.get((asked.each, asked.label))
        if name is None or name in found:
            continue
        used = results.used if asked.where is None else results.used[matching(results.used, asked.where)]
        column = labels(used, asked.each, results.plan.levels[asked.each])
        persons = used.assign(_level=np.array(column.levels)[column.codes])
        person = persons.groupby(["_level", "participant"])[results.plan.measure].mean()
        _keep(found, name, {level: _quantiles_of(person.loc[level]) for level in column.levels})
    for test in results.further:
        if test.kind == "regression":
            _keep(found, "regression", {"": _quantiles_of(test.more["studentised"])})
    return found


def t_test_plots(results: PlannedResults) -> dict[tuple[str, str], str]:
    """Factor and reference of every t test that was run, to the name of its Q-Q data.

    "t <factor>", and which trials it rests on where the factor's tests differ in that; the reference changes no shape.
    """
    run = set(zip(results.ttests["factor"], results.ttests["reference"], strict=True))
    tests = [test for test in results.plan.t_tests if (test.each, test.label) in run]
    names = {}
    for test in tests:
        several = len({other.where for other in tests if other.each == test.each}) > 1
        names[test.each, test.label] = f"t {test.each}" + (f" ({test.trials})" if several else "")
    return names


def _quantiles_of(values: pd.Series) -> Callable[[], pd.DataFrame]:
    return lambda: quantiles(values.dropna().to_numpy())


def _keep(found: dict[str, dict[str, pd.DataFrame]], test: str, panels: Mapping[str, Callable]) -> None:
    kept = {}
    for name, make in panels.items():
        try:
            kept[name] = make()
        except AnalysisError:  # nothing to show where nothing varies; the test itself says so
            continue
    if kept:
        found[test] = kept


def quantiles_table(found: Mapping[str, Panels]) -> pd.DataFrame:
    """All Q-Q data as one table: test, panel, theoretical, ordered."""
    parts = [
        points.assign(test=test, panel=panel) for test, panels in found.items() for panel, points in panels.items()
    ]
    columns = ["test", "panel", "theoretical", "ordered"]
    return pd.concat(parts, ignore_index=True)[columns] if parts else pd.DataFrame(columns=columns)


def check_plots(found: Mapping[str, Panels], label: str) -> dict[str, DrawnFigure]:
    """A picture for each test; the names of tests as in `check_quantiles`."""
    known = {"anova": "residuals of the analysis of variance", "regression": "studentised residuals of the regression"}
    what = {test: known.get(test) or f"means of the participants{_trials_of(test)}" for test in found}
    return {
        test: qq_plots(panels, f"qq_{test.replace(' ', '_')}", f"{label}: {what[test]}")
        for test, panels in found.items()
    }


def _trials_of(test: str) -> str:
    """Which trials a t test rests on, as its name says it; "" where it does not."""
    _, bracket, trials = test.partition(" (")
    return bracket + trials

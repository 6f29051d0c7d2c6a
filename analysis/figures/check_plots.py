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
    """Q-Q data by test ("anova", "t <factor>", "regression"), then by panel; a test without variance has none."""
    found: dict[str, dict[str, pd.DataFrame]] = {}
    means = results.means
    if means is not None:
        _keep(found, "anova", {"": lambda: residual_quantiles(means)})
    run = set(zip(results.ttests["factor"], results.ttests["reference"], strict=True))
    for factor in dict.fromkeys(results.ttests["factor"]):
        where = next(test.where for test in results.plan.t_tests if test.each == factor and (factor, test.label) in run)
        used = results.used if where is None else results.used[matching(results.used, where)]
        column = labels(used, factor, results.plan.levels[factor])
        persons = used.assign(_level=np.array(column.levels)[column.codes])
        person = persons.groupby(["_level", "participant"])[results.plan.measure].mean()
        _keep(found, f"t {factor}", {level: _quantiles_of(person.loc[level]) for level in column.levels})
    for test in results.further:
        if test.kind == "regression":
            _keep(found, "regression", {"": _quantiles_of(test.more["studentised"])})
    return found


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
    what = {test: known.get(test, "means of the participants") for test in found}
    return {
        test: qq_plots(panels, f"qq_{test.replace(' ', '_')}", f"{label}: {what[test]}")
        for test, panels in found.items()
    }

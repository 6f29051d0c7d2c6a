"""What was measured beside what it was tested against, level by level (as Niay 2022, figure 4.3)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from analysis.errors import AnalysisError
from analysis.figures.drawing import (
    COLOURS,
    REFERENCE,
    DrawnFigure,
    beeswarm,
    legend_above,
    level_ticks,
    measure_label,
    panels,
    saved,
)
from analysis.planned.plan_parts import FigurePlan
from analysis.planned.results import ALPHA, PlannedResults
from analysis.recorded.exclusions import matching
from analysis.statistics.columns import labels, numeric_label

LEGEND = 5.0  # inches that the legend above the panels needs


def t_tests_figure(figure: FigurePlan, results: PlannedResults) -> DrawnFigure:
    """Means of the levels with 95 % limits, reference values, and a star where the two do not differ.

    With panels, the levels of every group stand in a panel of their own. Where tests of several factors have the
    label, the first, or that of the groups' factor, is shown. Raises AnalysisError without the tests.
    """
    plan = results.plan
    against = results.ttests[results.ttests["reference"] == figure.reference]
    tested = set(against["factor"])
    if figure.panels is not None:
        tested &= {plan.groups[figure.panels].of}
    test = next((t for t in plan.t_tests if t.label == figure.reference and t.each in tested), None)
    if test is None:
        raise AnalysisError(f"there are no t tests against the {figure.reference} to show.")
    rows = against[against["factor"] == test.each]
    used = results.used if test.where is None else results.used[matching(results.used, test.where)]
    groups = {"": tuple(rows["level"])}
    if figure.panels is not None:
        groups = dict(plan.groups[figure.panels].levels)
    width = 0.42 * max(map(len, groups.values())) + 1.6
    width = max(width, LEGEND / len(groups))
    drawing, axes = panels(len(groups), width, 4.2)
    for place, (axis, (group, levels)) in enumerate(zip(axes, groups.items(), strict=True)):
        shown = rows[rows["level"].isin(levels)]
        persons = _persons(used, test.each, plan.levels[test.each], plan.measure)
        _panel(axis, shown, persons, COLOURS[place % 6], width - (1.1 if place == 0 else 0.2))
        axis.set_title(group)
        axis.set_xlabel(test.each)
    axes[0].set_ylabel(measure_label(plan))
    legend_above(drawing, axes[0])
    caption = (
        f"{plan.label} of every {test.each}"
        + (f" ({test.where})" if test.where else "")
        + f": means over {int(rows['n'].max())} participants with 95 % limits; each faint dot is one participant. Red "
        f"diamonds: {test.label}. A star: the t test found no difference from it."
    )
    return saved(drawing, f"t_tests_{test.each}", f"{plan.label} and {test.label}", caption)


def _persons(used: pd.DataFrame, each: str, order: tuple[str, ...], measure: str) -> pd.Series:
    """Mean of every level (first index) and participant."""
    there = set(used[each].map(numeric_label))
    column = labels(used, each, [level for level in order if numeric_label(level) in there])
    named = used.assign(_level=np.array(column.levels)[column.codes])
    return named.groupby(["_level", "participant"])[measure].mean()


def _panel(axis: Any, rows: pd.DataFrame, persons: pd.Series, colour: str, inches: float) -> None:
    for i, row in enumerate(rows.to_dict("records")):
        values = persons.loc[row["level"]].to_numpy()
        dots = axis.scatter(i + beeswarm(values, 0.12), values, s=12, color=colour, alpha=0.25, linewidths=0, zorder=2)
        dots.set_label("participants" if i == 0 else "_")
        low, high = row["against"] + row["ci_low"], row["against"] + row["ci_high"]
        axis.errorbar(
            i, row["mean"], yerr=[[row["mean"] - low], [high - row["mean"]]], fmt="o", color=colour, markersize=6,
            capsize=4, zorder=4, label="estimated, 95 % limits" if i == 0 else None,
        )  # fmt: skip
        axis.scatter(
            i + 0.25, row["against"], marker="D", s=34, color=REFERENCE, edgecolors="white", linewidths=0.7, zorder=5,
            label=row["reference"] if i == 0 else None,
        )  # fmt: skip
        if row["p"] >= ALPHA:
            top = max(values.max(), row["against"])
            axis.annotate("★", (i, top), (0, 4), textcoords="offset points", ha="center", fontsize=10)
    level_ticks(axis, list(rows["level"]), inches)
    axis.set_xlim(-0.6, len(rows) - 0.4)
    axis.tick_params(length=0)
    axis.margins(y=0.1)

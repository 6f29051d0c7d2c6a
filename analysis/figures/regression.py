"""The cases of a regression over each of its predictors (as Niay 2022, figure 4.4)."""

from __future__ import annotations

import numpy as np

from analysis.apa import p_value
from analysis.errors import AnalysisError
from analysis.figures.drawing import COLOURS, MARKERS, DrawnFigure, measure_label, panels, saved
from analysis.planned.plan_parts import FigurePlan
from analysis.planned.results import PlannedResults


def regression_figure(figure: FigurePlan, results: PlannedResults) -> DrawnFigure:
    """One panel per predictor: every case, and the fitted line with the other predictors at their means.

    Raises AnalysisError when the regression was not run.
    """
    plan = results.plan
    test = next((t for t in results.further if t.kind == "regression"), None)
    if test is None or plan.regression is None:
        raise AnalysisError("there is no regression to show.")
    of, names, cases = plan.regression.of, list(plan.regression.on), test.more
    slopes = test.table.set_index("term")
    groups = plan.groups[figure.panels].group_of if figure.panels is not None else {}
    group = [groups.get(level, "") for level in cases[of]]
    drawing, axes = panels(len(names), 3.1, 3.9)
    for letter, axis, name in zip("abcdefghij", axes, names, strict=False):
        x, y = cases[name].to_numpy(dtype=float), cases[plan.measure].to_numpy(dtype=float)
        ends = np.array([x.min(), x.max()])
        axis.plot(ends, y.mean() + slopes.loc[name, "estimate"] * (ends - x.mean()), color="#718096", linewidth=1.4)
        for place, one in enumerate(dict.fromkeys(group)):
            chosen = np.array([member == one for member in group])
            axis.scatter(
                x[chosen], y[chosen], s=26, color=COLOURS[place % 6], marker=MARKERS[place % 6], zorder=3, label=one
            )
        for level, left, height in zip(cases[of], x, y, strict=True):
            axis.annotate(level, (left, height), (4, 3), textcoords="offset points", fontsize=7, color="#718096")
        t, p = slopes.loc[name, "t"], slopes.loc[name, "p"]
        axis.set_title(f"({letter}) t = {t:.2f}, {p_value(p)}".replace("-", "−"), fontsize=9.5)
        axis.set_xlabel(name)
        axis.margins(0.1)
    axes[0].set_ylabel(measure_label(plan))
    if figure.panels is not None:
        handles, labels = axes[0].get_legend_handles_labels()
        drawing.legend(handles, labels, loc="outside upper center", ncols=len(labels), fontsize=9)
    fit = test.facts
    caption = (
        f"{plan.label} of every {of}, averaged over participants, over {', '.join(names)}; lines: the multiple "
        f"regression with the other predictors at their means (R² = {fit['r2']:.3f}, "
        f"adjusted {fit['r2_adjusted']:.3f})."
    )
    return saved(drawing, "regression", f"{plan.label} over {', '.join(names)}", caption)

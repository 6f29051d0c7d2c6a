"""The cases of a regression over each of its predictors (as Niay 2022, figure 4.4)."""

from __future__ import annotations

from collections.abc import Sequence
from string import ascii_lowercase
from typing import TYPE_CHECKING

import numpy as np

from analysis.apa import p_value
from analysis.errors import AnalysisError
from analysis.figures.drawing import COLOURS, MARKERS, DrawnFigure, legend_above, measure_label, panels, saved
from analysis.planned.plan_parts import FigurePlan
from analysis.planned.results import PlannedResults

if TYPE_CHECKING:
    from matplotlib.axes import Axes

CORNERS = tuple(np.array(corner) for corner in ((9.0, 6.5), (9.0, -6.5), (-9.0, 6.5), (-9.0, -6.5)))
"""Where a name's middle may stand, in points from what it names; the first that has most room is taken."""
NAME_SIZE = np.array([13.0, 9.0])
"""Points from a name's middle at which another name or mark just touches it, across and up."""


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
    for letter, axis, name in zip(ascii_lowercase, axes, names, strict=False):
        x, y = cases[name].to_numpy(dtype=float), cases[plan.measure].to_numpy(dtype=float)
        ends = np.array([x.min(), x.max()])
        axis.plot(ends, y.mean() + slopes.loc[name, "estimate"] * (ends - x.mean()), color="#718096", linewidth=1.4)
        for place, one in enumerate(dict.fromkeys(group)):
            chosen = np.array([member == one for member in group])
            axis.scatter(
                x[chosen], y[chosen], s=26, color=COLOURS[place % 6], marker=MARKERS[place % 6], zorder=3, label=one
            )
        t, p = slopes.loc[name, "t"], slopes.loc[name, "p"]
        axis.set_title(f"({letter}) t = {t:.2f}, {p_value(p)}".replace("-", "−"), fontsize=9.5)
        unit = plan.regression.units.get(name)
        axis.set_xlabel(f"{name} ({unit})" if unit else name)
        axis.margins(0.1)
    axes[0].set_ylabel(measure_label(plan))
    if figure.panels is not None:
        legend_above(drawing, axes[0])
    drawing.draw_without_rendering()
    for axis, name in zip(axes, names, strict=True):
        _name_points(axis, cases[name].to_numpy(float), cases[plan.measure].to_numpy(float), list(map(str, cases[of])))
    fit = test.facts
    caption = (
        f"{plan.label} of every {of}, averaged over participants, over {', '.join(names)}; lines: the multiple "
        f"regression with the other predictors at their means (R² = {fit['r2']:.3f}, "
        f"adjusted {fit['r2_adjusted']:.3f})."
    )
    return saved(drawing, "regression", f"{plan.label} over {', '.join(names)}", caption)


def _name_points(axis: Axes, x: np.ndarray, y: np.ndarray, names: Sequence[str]) -> None:
    """Writes each point's name at whichever of its corners has the most room beside other points and earlier names.

    The drawing must have been laid out.
    """
    points = axis.transData.transform(np.column_stack([x, y])) * 72 / axis.figure.dpi
    taken = list(points)
    for number, name in enumerate(names):
        others = np.array([place for place in taken if place is not taken[number]])
        room = [
            np.abs((others - points[number] - corner) / NAME_SIZE).max(axis=1).min(initial=1.0) for corner in CORNERS
        ]
        corner = CORNERS[int(np.argmax(room))]
        taken.append(points[number] + corner)
        axis.annotate(
            name, (x[number], y[number]), tuple(corner), textcoords="offset points", ha="center", va="center",
            fontsize=7, color="#718096",
        )  # fmt: skip

"""Figures of the planned analysis, each with every participant visible."""

from __future__ import annotations

import numpy as np

from analysis.errors import AnalysisError
from analysis.figures.checks import order_figure, qq_figure
from analysis.figures.choices import proportions_figure, psychometric_figure
from analysis.figures.drawing import (
    COLOURS,
    REFERENCE,
    DrawnFigure,
    averaged,
    beeswarm,
    canvas,
    finish,
    legend_above,
    saved,
    settings,
)
from analysis.figures.interaction import interaction
from analysis.figures.raincloud import raincloud
from analysis.figures.regression import regression_figure
from analysis.figures.t_tests import t_tests_figure
from analysis.planned.plan import AnalysisPlan
from analysis.planned.plan_parts import FigurePlan
from analysis.planned.results import PlannedResults
from analysis.statistics.cells import CellMeans
from analysis.statistics.intervals import ordinary, within_participant

KINDS = (
    "means", "interaction", "raincloud", "qq", "order", "t_tests", "regression", "proportions", "psychometric",
)  # fmt: skip


def draw(figure: FigurePlan, results: PlannedResults) -> DrawnFigure:
    """The figure that the plan asks for.

    Raises AnalysisError for a kind or a factor there is not, or when the test it shows was not run.
    """
    if figure.kind not in KINDS:
        raise AnalysisError(f"There is no figure of kind {figure.kind!r}; the kinds are {', '.join(KINDS)}.")
    with settings():
        if figure.kind == "t_tests":
            return t_tests_figure(figure, results)
        if figure.kind == "regression":
            return regression_figure(figure, results)
        if figure.kind == "proportions":
            return proportions_figure(results)
        if figure.kind == "psychometric":
            return psychometric_figure(results)
        return _of_means(figure, results)


def _of_means(figure: FigurePlan, results: PlannedResults) -> DrawnFigure:
    """A figure of the cell means that the analysis of variance rests on."""
    means, plan = results.means, results.plan
    if means is None:
        raise AnalysisError("there is no analysis of variance whose means it shows.")
    for name in (figure.x, figure.lines if figure.kind == "interaction" else None):
        if name is not None and name not in means.factors:
            raise AnalysisError(f"The figure names {name!r}, which is no factor of the analysis of variance.")
    if figure.kind == "qq":
        return qq_figure(means, plan)
    if figure.kind == "order":
        return order_figure(means, plan, results.used)
    if figure.x is None:
        raise AnalysisError(f"A figure of kind {figure.kind} needs x, the factor on the x axis.")
    if figure.kind == "raincloud":
        return raincloud(figure.x, means, plan)
    if figure.kind == "interaction" and figure.lines is not None:
        return interaction(figure.x, figure.lines, means, plan)
    return _means(figure.x, figure.reference, means, plan)


def _means(x: str, reference: str | None, means: CellMeans, plan: AnalysisPlan) -> DrawnFigure:
    levels = means.levels(x)
    drawing, axes = canvas()
    if x in means.within:
        values = averaged(means, (x,))
        columns, half = [values[:, i] for i in range(len(levels))], within_participant(values)
        kind, interval = (
            "95 % within-participant intervals (Cousineau–Morey)",
            "mean, 95 % within-participant interval",
        )
    else:
        person, column = means.values.mean(axis=1), list(means.between).index(x)
        columns = [person[means.groups[:, column] == i] for i in range(len(levels))]
        half = np.array([ordinary(c[:, None])[0] for c in columns])
        kind, interval = "95 % confidence intervals between participants", "mean, 95 % confidence interval"
    for i, column_values in enumerate(columns):
        spread = beeswarm(column_values, 0.12)
        axes.scatter(
            i + spread,
            column_values,
            s=16,
            color=COLOURS[0],
            alpha=0.28,
            linewidths=0,
            zorder=2,
            label="participants" if i == 0 else None,
        )
    centre = [c.mean() for c in columns]
    axes.errorbar(
        range(len(levels)),
        centre,
        yerr=half,
        fmt="o",
        color=COLOURS[0],
        markersize=8,
        capsize=5,
        elinewidth=1.8,
        capthick=1.8,
        zorder=4,
        label=interval,
    )
    caption = f"{plan.label} by {x}: means with {kind}; each faint dot is one participant."
    test = next((t for t in plan.t_tests if t.label == reference and t.each == x), None)
    if test is not None:
        known = [(i, test.against[level]) for i, level in enumerate(levels) if level in test.against]
        axes.scatter(
            [i + 0.27 for i, _ in known],
            [v for _, v in known],
            marker="D",
            s=52,
            color=REFERENCE,
            zorder=5,
            edgecolors="white",
            linewidths=0.8,
            label=test.label,
        )
        caption += f" Red diamonds: {test.label}."
    finish(axes, plan, x, levels)
    legend_above(drawing, axes)
    return saved(drawing, f"means_{x}", f"{plan.label} by {x}", caption)

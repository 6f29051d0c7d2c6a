"""Interactions: means of one factor, a line for each level of another, every participant a faint dot."""

from __future__ import annotations

import numpy as np

from analysis.errors import AnalysisError
from analysis.figures.drawing import (
    COLOURS,
    MARKERS,
    DrawnFigure,
    averaged,
    beeswarm,
    canvas,
    finish,
    legend_above,
    saved,
)
from analysis.planned.plan import AnalysisPlan
from analysis.statistics.cells import CellMeans
from analysis.statistics.intervals import ordinary, within_participant


def interaction(x: str, lines: str, means: CellMeans, plan: AnalysisPlan) -> DrawnFigure:
    """Means of a measure by the levels of one factor, joined by a line for each level of another."""
    if x == lines:
        raise AnalysisError(f"an interaction is of two factors, not of {x} with itself.")
    drawing, axes = canvas(6.8)
    levels, series = means.levels(x), means.levels(lines)
    columns, halves, kind = _series(x, lines, means)
    shifts = (np.arange(len(series)) - (len(series) - 1) / 2) * min(0.22, 0.6 / len(series))
    for j, (name, shift) in enumerate(zip(series, shifts, strict=True)):
        colour, marker = COLOURS[j % len(COLOURS)], MARKERS[j % len(MARKERS)]
        for i in range(len(levels)):
            values = columns[j][i]
            axes.scatter(
                i + shift + beeswarm(values, 0.06),
                values,
                s=10,
                color=colour,
                alpha=0.22,
                linewidths=0,
                zorder=2,
            )
        axes.errorbar(
            np.arange(len(levels)) + shift,
            [v.mean() for v in columns[j]],
            yerr=halves[j],
            marker=marker,
            color=colour,
            markersize=7,
            capsize=4,
            linewidth=1.6,
            elinewidth=1.6,
            zorder=4,
            label=name,
        )
    finish(axes, plan, x, levels)
    legend_above(drawing, axes, lines)
    caption = f"{plan.label} by {x} and {lines}: means with {kind}; each faint dot is one participant."
    return saved(drawing, f"interaction_{x}_{lines}", f"{plan.label} by {x} and {lines}", caption)


def _series(x: str, lines: str, means: CellMeans) -> tuple[list[list[np.ndarray]], list[np.ndarray], str]:
    """Values [line][x], half widths [line] (x,), and what the intervals are called."""
    n_x, n_lines = len(means.levels(x)), len(means.levels(lines))
    morey = "95 % within-participant intervals (Cousineau–Morey"
    if x in means.within and lines in means.within:
        cube = averaged(means, (lines, x))
        half = within_participant(cube.reshape(len(cube), -1)).reshape(n_lines, n_x)
        return [[cube[:, j, i] for i in range(n_x)] for j in range(n_lines)], list(half), f"{morey})"
    if x in means.within:
        column, values = list(means.between).index(lines), averaged(means, (x,))
        parts = [values[means.groups[:, column] == j] for j in range(n_lines)]
        return (
            [[p[:, i] for i in range(n_x)] for p in parts],
            [within_participant(p) for p in parts],
            f"{morey}, within each group)",
        )
    column = list(means.between).index(x)
    if lines in means.within:
        values = averaged(means, (lines,))
        parts = [values[means.groups[:, column] == i] for i in range(n_x)]
        half = np.array([within_participant(p) for p in parts]).T
        return [[p[:, j] for p in parts] for j in range(n_lines)], list(half), f"{morey}, within each group)"
    other, person = list(means.between).index(lines), means.values.mean(axis=1)
    cells = [
        [person[(means.groups[:, column] == i) & (means.groups[:, other] == j)] for i in range(n_x)]
        for j in range(n_lines)
    ]
    return (
        cells,
        [np.array([ordinary(c[:, None])[0] for c in row]) for row in cells],
        "95 % confidence intervals between participants",
    )

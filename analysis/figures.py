"""Figures of the planned analysis: means and interactions, with every participant visible.

Drawn without pyplot, from fixed settings, so that the same data give the same bytes.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np

from analysis.cells import CellMeans
from analysis.errors import AnalysisError
from analysis.intervals import ordinary, within_participant
from analysis.plan import AnalysisPlan, FigurePlan

COLOURS = ("#2b6cb0", "#c05621", "#2f855a", "#805ad5", "#b7791f", "#4a5568")
MARKERS = ("o", "s", "^", "D", "v", "P")
REFERENCE = "#c53030"
SETTINGS: dict[Any, Any] = {
    "svg.hashsalt": "gaitlab",
    "svg.fonttype": "path",
    "text.parse_math": False,
    "font.family": "DejaVu Sans",
    "font.size": 10.0,
    "axes.titlesize": 11.0,
    "axes.labelsize": 10.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#4a5568",
    "axes.labelcolor": "#2d3748",
    "text.color": "#2d3748",
    "xtick.color": "#4a5568",
    "ytick.color": "#4a5568",
    "axes.grid": True,
    "axes.grid.axis": "y",
    "grid.color": "#e2e8f0",
    "grid.linewidth": 0.8,
    "axes.axisbelow": True,
    "legend.frameon": False,
    "axes.formatter.use_mathtext": False,
    "axes.unicode_minus": True,
}


@dataclass(frozen=True)
class DrawnFigure:
    """One figure as files' content, with the words that go with it."""

    name: str  # of the files, without ending
    title: str
    caption: str
    png: bytes
    svg: bytes


def draw(figure: FigurePlan, means: CellMeans, plan: AnalysisPlan) -> DrawnFigure:
    """The figure that the plan asks for. Raises AnalysisError for a kind or a factor there is not."""
    if figure.kind not in ("means", "interaction"):
        raise AnalysisError(f"There is no figure of kind {figure.kind!r}; the kinds are means and interaction.")
    lines = figure.lines if figure.kind == "interaction" else None
    for name in (figure.x, lines):
        if name is not None and name not in means.factors:
            raise AnalysisError(f"The figure names {name!r}, which is no factor of the analysis of variance.")
    with _settings():
        return _means(figure, means, plan) if lines is None else _interaction(figure.x, lines, means, plan)


@contextmanager
def _settings() -> Iterator[None]:
    import warnings

    import matplotlib as mpl

    with mpl.rc_context(), warnings.catch_warnings():
        mpl.rcdefaults()
        mpl.rcParams.update(SETTINGS)
        warnings.filterwarnings("ignore", message="Glyph .* missing")
        yield


def _averaged(means: CellMeans, factors: tuple[str, ...]) -> np.ndarray:
    """(N, levels of each named within factor...) each participant's means over the other within factors."""
    names = list(means.within)
    shape = [len(levels) for levels in means.within.values()]
    cube = means.values.reshape(-1, *shape)
    drop = tuple(1 + place for place, name in enumerate(names) if name not in factors)
    averaged = cube.mean(axis=drop) if drop else cube
    kept = [name for name in names if name in factors]
    return np.transpose(averaged, (0, *(1 + kept.index(name) for name in factors)))


def _canvas(width: float = 6.4) -> tuple[Any, Any]:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, 4.2), layout="constrained")
    FigureCanvasAgg(figure)
    return figure, figure.add_subplot()


def _means(figure: FigurePlan, means: CellMeans, plan: AnalysisPlan) -> DrawnFigure:
    x = figure.x
    levels = means.levels(x)
    drawing, axes = _canvas()
    if x in means.within:
        values = _averaged(means, (x,))
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
        spread = _beeswarm(column_values, 0.12)
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
    test = next((t for t in plan.t_tests if t.label == figure.reference and t.each == x), None)
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
    _finish(axes, plan, x, levels)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 1.12), ncols=3, fontsize=9, handletextpad=0.3)
    return _saved(drawing, f"means_{x}", f"{plan.label} by {x}", caption)


def _interaction(x: str, lines: str, means: CellMeans, plan: AnalysisPlan) -> DrawnFigure:
    drawing, axes = _canvas(6.8)
    levels, series = means.levels(x), means.levels(lines)
    columns, halves, kind = _series(x, lines, means)
    shifts = (np.arange(len(series)) - (len(series) - 1) / 2) * min(0.22, 0.6 / len(series))
    for j, (name, shift) in enumerate(zip(series, shifts, strict=True)):
        colour, marker = COLOURS[j % len(COLOURS)], MARKERS[j % len(MARKERS)]
        for i in range(len(levels)):
            values = columns[j][i]
            axes.scatter(
                i + shift + _beeswarm(values, 0.06),
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
    _finish(axes, plan, x, levels)
    axes.legend(
        title=lines,
        loc="upper center",
        bbox_to_anchor=(0.5, 1.2),
        ncols=len(series),
        fontsize=9,
        title_fontsize=9,
    )
    caption = f"{plan.label} by {x} and {lines}: means with {kind}; each faint dot is one participant."
    return _saved(drawing, f"interaction_{x}_{lines}", f"{plan.label} by {x} and {lines}", caption)


def _series(x: str, lines: str, means: CellMeans) -> tuple[list[list[np.ndarray]], list[np.ndarray], str]:
    """Values [line][x], half widths [line] (x,), and what the intervals are called."""
    n_x, n_lines = len(means.levels(x)), len(means.levels(lines))
    morey = "95 % within-participant intervals (Cousineau–Morey"
    if x in means.within and lines in means.within:
        cube = _averaged(means, (lines, x))
        half = within_participant(cube.reshape(len(cube), -1)).reshape(n_lines, n_x)
        return [[cube[:, j, i] for i in range(n_x)] for j in range(n_lines)], list(half), f"{morey})"
    if x in means.within:
        column, values = list(means.between).index(lines), _averaged(means, (x,))
        parts = [values[means.groups[:, column] == j] for j in range(n_lines)]
        return (
            [[p[:, i] for i in range(n_x)] for p in parts],
            [within_participant(p) for p in parts],
            f"{morey}, within each group)",
        )
    column = list(means.between).index(x)
    if lines in means.within:
        values = _averaged(means, (lines,))
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


def _beeswarm(values: np.ndarray, width: float) -> np.ndarray:
    """Sideways offsets that keep equal values apart, the same every time: by rank, golden-ratio spaced."""
    order = np.argsort(np.argsort(values, kind="stable"), kind="stable")
    return ((order * 0.6180339887) % 1.0 - 0.5) * 2 * width


def _finish(axes: Any, plan: AnalysisPlan, x: str, levels: tuple[str, ...]) -> None:
    axes.set_xticks(range(len(levels)), levels)
    axes.set_xlim(-0.5, len(levels) - 0.5)
    axes.set_xlabel(x)
    axes.set_ylabel(f"{plan.label} ({plan.unit})" if plan.unit else plan.label)
    axes.tick_params(length=0)
    axes.margins(y=0.08)
    axes.yaxis.get_major_formatter().set_useOffset(False)
    axes.yaxis.get_major_formatter().set_scientific(False)


def _saved(drawing: Any, name: str, title: str, caption: str) -> DrawnFigure:
    png, svg = BytesIO(), BytesIO()
    drawing.savefig(png, format="png", dpi=200, metadata={"Software": "gaitlab"}, facecolor="white")
    drawing.savefig(svg, format="svg", metadata={"Date": None, "Creator": "gaitlab", "Title": title})
    return DrawnFigure(name, title, caption, png.getvalue(), svg.getvalue())

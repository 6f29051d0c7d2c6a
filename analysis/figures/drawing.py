"""What every figure shares: colours, paper, dots that do not hide one another, and files of equal bytes.

Drawn without pyplot, from fixed settings, so that the same data give the same bytes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from itertools import pairwise
from textwrap import wrap
from typing import Any

import numpy as np

from analysis.planned.plan import AnalysisPlan
from analysis.statistics.cells import CellMeans

COLOURS = ("#2b6cb0", "#c05621", "#2f855a", "#805ad5", "#b7791f", "#4a5568")
MARKERS = ("o", "s", "^", "D", "v", "P")
REFERENCE = "#c53030"
FITTING = 14.0  # characters of level names that fit side by side into an inch under an axis
UPRIGHT = 14  # characters of a level name from which it stands upright under an axis that is too narrow
SMALL = 9.0  # points, letters of a legend
HANDLE = 4.6  # letters' size that a mark of the legend and the space around it need beside its name
LINE = 36  # characters of the label of an axis before it is broken into lines
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


@contextmanager
def settings() -> Iterator[None]:
    """Within it all figures are drawn with the same fonts and lines, whatever the computer's own settings."""
    import warnings

    import matplotlib as mpl

    with mpl.rc_context(), warnings.catch_warnings():
        mpl.rcdefaults()
        mpl.rcParams.update(SETTINGS)
        warnings.filterwarnings("ignore", message="Glyph .* missing")
        yield


def averaged(means: CellMeans, factors: tuple[str, ...]) -> np.ndarray:
    """(N, levels of each named within factor...) each participant's means over the other within factors."""
    names = list(means.within)
    shape = [len(levels) for levels in means.within.values()]
    cube = means.values.reshape(-1, *shape)
    drop = tuple(1 + place for place, name in enumerate(names) if name not in factors)
    averaged = cube.mean(axis=drop) if drop else cube
    kept = [name for name in names if name in factors]
    return np.transpose(averaged, (0, *(1 + kept.index(name) for name in factors)))


def canvas(width: float = 6.4, height: float = 4.2) -> tuple[Any, Any]:
    """A figure with one pair of axes; width, height: inches."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure, figure.add_subplot()


def panels(count: int, width: float, height: float) -> tuple[Any, list[Any]]:
    """A figure of panels side by side with one y axis; width: inches of each."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(max(width * count, 3.4), height), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(1, count, sharey=True, squeeze=False)[0]
    axes[0].yaxis.get_major_formatter().set_useOffset(False)
    axes[0].yaxis.get_major_formatter().set_scientific(False)
    return figure, list(axes)


def beeswarm(values: np.ndarray, width: float) -> np.ndarray:
    """Sideways offsets that keep equal values apart, the same every time: by rank, golden-ratio spaced."""
    order = np.argsort(np.argsort(values, kind="stable"), kind="stable")
    return ((order * 0.6180339887) % 1.0 - 0.5) * 2 * width


def measure_label(plan: AnalysisPlan) -> str:
    """What a measure's axis is called, a long name in lines."""
    return "\n".join(wrap(f"{plan.label} ({plan.unit})" if plan.unit else plan.label, LINE))


def level_ticks(axes: Any, levels: Sequence[str], inches: float) -> None:
    """Names of levels under an axis of so many inches; if they overlap in two lines, slanted, or upright."""
    turned: dict[str, Any] = {}
    longest = max(map(len, levels))
    halves = [_two_lines(level) for level in levels]
    if _fit(levels, inches):
        names = list(levels)
    elif _fit([max(name.split("\n"), key=len) for name in halves], inches):
        names = halves
    else:
        names = list(levels)
        turned = {"rotation": 90} if longest > UPRIGHT else {"rotation": 35, "ha": "right"}
    axes.set_xticks(range(len(levels)), names, **turned)
    if longest > UPRIGHT and turned:
        drawing = axes.get_figure()
        drawing.set_figheight(max(drawing.get_figheight(), 4.0 + 0.075 * longest))


def _fit(names: Sequence[str], inches: float) -> bool:
    """Whether names at equal distances on so many inches keep off each other; two long neighbours are what counts."""
    widest = max((sum(map(len, two)) / 2 for two in pairwise(names)), default=len(names[0]))
    return (widest + 2) * len(names) <= FITTING * inches


def _two_lines(name: str) -> str:
    """A name broken after the underscore, or at the space, nearest its middle; as it is when it has none."""
    places = [i for i, letter in enumerate(name) if letter in "_ "]
    if not places:
        return name
    middle = min(places, key=lambda i: abs(i - len(name) / 2))
    return f"{name[: middle + 1].rstrip()}\n{name[middle + 1 :]}"


def legend_above(drawing: Any, axes: Any, title: str | None = None) -> None:
    """The legend of `axes` above the figure, in as many rows as its names need, on as much taller paper."""
    handles, names = axes.get_legend_handles_labels()
    room = 72 * drawing.get_figwidth()
    columns = next(n for n in range(len(names), 0, -1) if n == 1 or _legend_width(names, n) <= room)
    rows = -(-len(names) // columns)
    drawing.set_figheight(drawing.get_figheight() + 0.2 * (rows - 1))
    drawing.legend(
        handles, names, loc="outside upper center", ncols=columns, fontsize=SMALL, handletextpad=0.4, title=title,
        title_fontsize=SMALL,
    )  # fmt: skip


def _legend_width(names: Sequence[str], columns: int) -> float:
    """Points that a legend of so many columns, filled one after the other, is wide."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextToPath

    font, measured = FontProperties(family=SETTINGS["font.family"], size=SMALL), TextToPath()
    widths = [measured.get_text_width_height_descent(name, font, False)[0] for name in names]
    rows, longer = divmod(len(names), columns)
    ends = [rows * i + min(i, longer) for i in range(columns + 1)]
    return sum(max(widths[start:end]) + HANDLE * SMALL for start, end in pairwise(ends))


def finish(axes: Any, plan: AnalysisPlan, x: str, levels: tuple[str, ...]) -> None:
    """The axes of a figure over one factor: its levels from left to right, and what was measured upwards."""
    level_ticks(axes, levels, axes.get_figure().get_figwidth() - 1.1)
    axes.set_xlim(-0.5, len(levels) - 0.5)
    axes.set_xlabel(x)
    axes.set_ylabel(measure_label(plan))
    axes.tick_params(length=0)
    axes.margins(y=0.08)
    axes.yaxis.get_major_formatter().set_useOffset(False)
    axes.yaxis.get_major_formatter().set_scientific(False)


def saved(drawing: Any, name: str, title: str, caption: str) -> DrawnFigure:
    """The figure as PNG (200 dots an inch) and SVG, the same bytes every time."""
    png, svg = BytesIO(), BytesIO()
    drawing.savefig(png, format="png", dpi=200, metadata={"Software": "gaitlab"}, facecolor="white")
    drawing.savefig(svg, format="svg", metadata={"Date": None, "Creator": "gaitlab", "Title": title})
    return DrawnFigure(name, title, caption, png.getvalue(), svg.getvalue())

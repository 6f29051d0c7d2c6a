"""What every figure shares: colours, paper, dots that do not hide one another, and files of equal bytes.

Drawn without pyplot, from fixed settings, so that the same data give the same bytes.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np

from analysis.planned.plan import AnalysisPlan
from analysis.statistics.cells import CellMeans

COLOURS = ("#2b6cb0", "#c05621", "#2f855a", "#805ad5", "#b7791f", "#4a5568")
MARKERS = ("o", "s", "^", "D", "v", "P")
REFERENCE = "#c53030"
FITTING = 74  # characters of level names that fit side by side under an axis
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
    return f"{plan.label} ({plan.unit})" if plan.unit else plan.label


def finish(axes: Any, plan: AnalysisPlan, x: str, levels: tuple[str, ...]) -> None:
    slanted = sum(len(level) + 2 for level in levels) > FITTING
    axes.set_xticks(range(len(levels)), levels, **({"rotation": 35, "ha": "right"} if slanted else {}))
    axes.set_xlim(-0.5, len(levels) - 0.5)
    axes.set_xlabel(x)
    axes.set_ylabel(measure_label(plan))
    axes.tick_params(length=0)
    axes.margins(y=0.08)
    axes.yaxis.get_major_formatter().set_useOffset(False)
    axes.yaxis.get_major_formatter().set_scientific(False)


def saved(drawing: Any, name: str, title: str, caption: str) -> DrawnFigure:
    png, svg = BytesIO(), BytesIO()
    drawing.savefig(png, format="png", dpi=200, metadata={"Software": "gaitlab"}, facecolor="white")
    drawing.savefig(svg, format="svg", metadata={"Date": None, "Creator": "gaitlab", "Title": title})
    return DrawnFigure(name, title, caption, png.getvalue(), svg.getvalue())

"""Figures of the comparison of methods: points, rebuilt poulaines, errors, film strips. Knows arrays only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.figures.drawing import COLOURS, settings

Floats = NDArray[np.floating]
WAYS = ("cubic", "pchip", "hermite")


@dataclass(frozen=True, eq=False)
class PointCloud:
    """One poulaine (N, 2) m over leg length and its points: name -> (2,)."""

    xz: Floats
    points: dict[str, Floats]


@dataclass(frozen=True, eq=False)
class Rebuilt:
    """One poulaine (N, 2) m, as rebuilt, and the points used (K, 2)."""

    count: int
    interpolation: str
    original: Floats
    rebuilt: Floats
    places: Floats
    rmse: float  # m


@dataclass(frozen=True, eq=False)
class Film:
    """One method at one speed.

    bones: (K, B, 2, 2) m, forward and up, both ends of each bone in K frames; near: (B,) drawn dark
    path, captured: (N, 2) m, right poulaine and that of the captured walk
    """

    method: str
    speed: float  # m/s
    label: str
    bones: Floats
    near: NDArray[np.bool_]
    path: Floats
    captured: Floats


def points_figure(clouds: Sequence[PointCloud]) -> bytes:
    """Distribution of the characteristic points and the mean poulaine, as thesis figure 5.4 b."""
    with settings():
        figure, (axes,) = _figure(7.0, 2.9, 1, 1)
        for colour, name in zip(COLOURS, ("E", "V", "I", "A", "M"), strict=False):
            places = np.array([cloud.points[name] for cloud in clouds if name in cloud.points])
            if len(places):
                axes.plot(*places.T, "o", ms=3, alpha=0.6, color=colour, label=name)
        mean = np.mean([cloud.xz for cloud in clouds], axis=0)
        axes.plot(*np.vstack([mean, mean[:1]]).T, color="#1a202c", lw=1.5, label="mean")
        _plane(axes, "x (leg lengths, forward)", "z (leg lengths, up)")
        axes.legend(ncols=6, fontsize=8, loc="lower center", bbox_to_anchor=(0.5, 1.0))
        return _png(figure)


def rebuilding_figure(rebuilt: Sequence[Rebuilt]) -> bytes:
    """The same poulaine rebuilt from 4 and 5 points by three interpolations, as thesis figure 5.5."""
    with settings():
        figure, axes = _figure(10.0, 3.4, 2, 3)
        for part, item in zip(axes, rebuilt, strict=False):
            part.plot(*np.vstack([item.original, item.original[:1]]).T, color=COLOURS[0], lw=1.4)
            part.plot(*np.vstack([item.rebuilt, item.rebuilt[:1]]).T, color="#c53030", lw=1.4)
            part.plot(*item.places.T, "o", color=COLOURS[2], ms=5)
            part.set_title(f"{item.count} points, {item.interpolation}: {1e3 * item.rmse:.1f} mm", fontsize=9)
            _plane(part, "x (m)", "z (m)")
        return _png(figure)


def error_figure(means: pd.DataFrame) -> bytes:
    """RMSE with its standard deviation between people, as thesis figure 5.6."""
    with settings():
        figure, (axes,) = _figure(5.5, 3.8, 1, 1)
        for place, points in enumerate((4, 5)):
            rows = means[means["points"] == points].set_index("interpolation").reindex(WAYS)
            x = np.arange(len(WAYS)) + (place - 0.5) * 0.36
            axes.bar(x, rows["mean_mm"], 0.34, yerr=rows["sd_mm"].fillna(0.0), capsize=3, color=COLOURS[place],
                     label=f"{points} points")  # fmt: skip
        axes.set_xticks(range(len(WAYS)), WAYS)
        axes.set_ylabel("RMSE (mm), mean and SD over people")
        axes.legend()
        return _png(figure)


def film_figure(films: Sequence[Film]) -> bytes:
    """Rows of methods, columns of speeds: eight instants of the cycle, and the ankle path over the captured one."""
    methods = list(dict.fromkeys(film.method for film in films))
    speeds = sorted({film.speed for film in films})
    with settings():
        from matplotlib.figure import Figure

        figure = Figure(figsize=(6.6 * len(speeds), 1.55 * len(methods)), layout="constrained")
        grid = figure.subplots(len(methods), 2 * len(speeds), width_ratios=[3.2, 1.0] * len(speeds), squeeze=False)
        for axes in grid.flat:
            axes.axis("off")
        for film in films:
            row, column = methods.index(film.method), 2 * speeds.index(film.speed)
            _strip(grid[row, column], film)
            _path(grid[row, column + 1], film)
        return _png(figure, dpi=100)


def _strip(axes: Any, film: Film) -> None:
    from matplotlib.collections import LineCollection

    for frame, bones in enumerate(film.bones):
        moved = bones + np.array([0.75 * frame, 0.0])
        axes.add_collection(LineCollection(moved[~film.near], colors="#a0aec0", lw=1.0))
        axes.add_collection(LineCollection(moved[film.near], colors=COLOURS[0], lw=1.4))
    axes.plot([-0.6, 0.75 * len(film.bones)], [0.0, 0.0], color="#718096", lw=0.6)
    axes.set_xlim(-0.6, 0.75 * len(film.bones) - 0.1)
    axes.set_ylim(-0.08, 1.6)
    axes.set_aspect("equal")
    axes.set_title(film.label, fontsize=9, loc="left")


def _path(axes: Any, film: Film) -> None:
    axes.plot(*np.vstack([film.captured, film.captured[:1]]).T, color="#a0aec0", lw=1.6)
    axes.plot(*np.vstack([film.path, film.path[:1]]).T, color="#c53030", lw=1.1)
    axes.plot(0.0, film.captured[:, 1].min() - 0.03, "^", color="#718096", ms=3)
    axes.set_aspect("equal")


def _figure(width: float, height: float, rows: int, columns: int) -> tuple[Any, list[Any]]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    return figure, list(figure.subplots(rows, columns, squeeze=False).flat)


def _plane(axes: Any, x: str, y: str) -> None:
    axes.set_aspect("equal")
    axes.set_xlabel(x)
    axes.set_ylabel(y)


def _png(figure: Any, dpi: int = 110) -> bytes:
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    FigureCanvasAgg(figure)
    stream = BytesIO()
    figure.savefig(stream, format="png", dpi=dpi, metadata={"Software": None})
    return stream.getvalue()

"""Rainclouds: the distribution, its quartiles and every participant, level by level (Allen et al. 2021)."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import stats

from analysis.figures.drawing import COLOURS, DrawnFigure, averaged, beeswarm, canvas, finish, saved
from analysis.planned.plan import AnalysisPlan
from analysis.statistics.cells import CellMeans


def raincloud(x: str, means: CellMeans, plan: AnalysisPlan) -> DrawnFigure:
    """Cloud, box and rain of participants' means at each level of x; thin lines join a participant's levels."""
    levels = means.levels(x)
    drawing, axes = canvas()
    if x in means.within:
        values = averaged(means, (x,))
        columns = [values[:, i] for i in range(len(levels))]
        rain = np.array([i - 0.16 + beeswarm(column, 0.07) for i, column in enumerate(columns)])
        axes.plot(rain, values.T, color="#a0aec0", alpha=0.25, linewidth=0.7, zorder=1)
    else:
        person, place = means.values.mean(axis=1), list(means.between).index(x)
        columns = [person[means.groups[:, place] == i] for i in range(len(levels))]
    for i, column in enumerate(columns):
        _one_cloud(axes, i, column, COLOURS[i % len(COLOURS)])
    finish(axes, plan, x, levels)
    joined = " joined by thin lines across levels" if x in means.within else ""
    caption = (
        f"{plan.label} by {x}: each dot is one participant{joined}; the box holds the middle half of the participants "
        "and the median, its whiskers reach to the last within 1.5 box lengths; the cloud is a kernel density "
        "(Silverman's bandwidth, cut at the extremes)."
    )
    return saved(drawing, f"raincloud_{x}", f"{plan.label} by {x}", caption)


def _one_cloud(axes: Any, place: int, values: np.ndarray, colour: str) -> None:
    axes.scatter(place - 0.16 + beeswarm(values, 0.07), values, s=18, color=colour, alpha=0.6, linewidths=0, zorder=3)
    axes.boxplot(
        values, positions=[place], widths=0.1, showfliers=False, manage_ticks=False, patch_artist=True, zorder=4,
        boxprops={"facecolor": "white", "edgecolor": colour}, medianprops={"color": colour, "linewidth": 2},
        whiskerprops={"color": colour}, capprops={"color": colour},
    )  # fmt: skip
    if len(values) > 2 and np.ptp(values) > 0:
        height = np.linspace(values.min(), values.max(), 100)
        density = stats.gaussian_kde(values, bw_method="silverman")(height)
        cloud = place + 0.09 + 0.33 * density / density.max()
        axes.fill_betweenx(height, place + 0.09, cloud, color=colour, alpha=0.35, linewidth=0, zorder=2)

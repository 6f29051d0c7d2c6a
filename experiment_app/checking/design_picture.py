"""`gaitlab check --picture`: the design's balance as a picture, trials and participants numbered from 1."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from experiment_app.checking.balance import likely_seed
from protocols.orders.design import make_trials
from protocols.study import Study

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST = 12
"""Participants whose orders are shown."""


def write_design_picture(study: Study, path: Path) -> None:
    """A PNG of `design_picture`."""
    design_picture(study).savefig(path, dpi=110)


def design_picture(study: Study) -> Figure:
    """The level shown in each trial of the first participants, and the counts of every level."""
    import matplotlib as mpl
    import numpy as np
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    people = min(study.participants.planned, MOST)
    placed = study.order.placed_factor
    factors = {name: levels for name, levels in study.factors.items() if name != placed} or study.factors
    orders = [make_trials(study, likely_seed(study, number), number) for number in range(1, people + 1)]
    figure = Figure(figsize=(13, 2.2 + 1.6 * len(factors)))
    axes = figure.subplots(len(factors), 2, width_ratios=(5, 1), squeeze=False)
    for (factor, levels), (left, right) in zip(factors.items(), axes, strict=True):
        grid = np.array([[levels.index(t.levels[factor]) for t in order] for order in orders])
        trials = grid.shape[1]
        colours = mpl.colormaps["viridis"].resampled(len(levels))
        left.imshow(
            grid, aspect="auto", cmap=colours, vmin=-0.5, vmax=len(levels) - 0.5, interpolation="nearest",
            extent=(0.5, trials + 0.5, people + 0.5, 0.5),
        )  # fmt: skip
        left.set_ylabel("participant")
        left.set_yticks(range(1, people + 1))
        left.tick_params(axis="y", labelsize=7)
        left.xaxis.set_major_locator(MaxNLocator(integer=True))
        left.set_title(factor, loc="left", fontweight="bold")
        first, second = grid[:, : trials // 2], grid[:, trials // 2 :]
        for i, level in enumerate(levels):
            counts = (first == i).sum(), (second == i).sum()
            right.barh(i, counts[0], color=colours(i), alpha=0.65)
            right.barh(i, counts[1], left=counts[0], color=colours(i))
            right.text(sum(counts), i, f" {level}", va="center", fontsize=9)
        right.set_yticks([])
        right.invert_yaxis()
        right.spines[["top", "right"]].set_visible(False)
        right.set_title("trials: first | second half", fontsize=9, loc="left")
        right.margins(x=0.25)
    axes[-1, 0].set_xlabel("trial")
    figure.suptitle(f"{study.title}: the order of the first {people} participants", x=0.01, ha="left")
    figure.tight_layout()
    return figure

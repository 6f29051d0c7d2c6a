"""Figures that stand beside a test to judge it by: Q-Q plots, and the measure over the session."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
from scipy import special, stats

from analysis.errors import AnalysisError
from analysis.figures.drawing import COLOURS, DrawnFigure, canvas, measure_label, saved, settings
from analysis.planned.plan import AnalysisPlan
from analysis.statistics.assumption_checks import quantiles
from analysis.statistics.cells import CellMeans
from analysis.statistics.columns import labels, numbers
from analysis.statistics.intervals import within_participant
from analysis.statistics.linear_fit import fit

BINS = 12  # stretches of the session in the order figure


def residual_quantiles(means: CellMeans) -> pd.DataFrame:
    """Q-Q data of the ANOVA's residuals in units of their cell's standard deviation, without cells that have none."""
    model = fit(means)
    sd = np.sqrt(np.sum(model.residuals**2, axis=0) / model.df)
    varying = sd**2 > model.no_variance_below
    if not varying.any():
        raise AnalysisError("A Q-Q plot needs a cell in which people differ.")
    return quantiles((model.residuals[:, varying] / sd[varying]).ravel())


def qq_figure(means: CellMeans, plan: AnalysisPlan) -> DrawnFigure:
    """The planned figure of kind qq."""
    return qq_plots({"": residual_quantiles(means)}, "qq", f"{plan.label}: residuals of the analysis of variance")


def qq_plots(panels: Mapping[str, pd.DataFrame], name: str, title: str) -> DrawnFigure:
    """Q-Q plots side by side, one per named table of `quantiles`, with the band that holds 95 % pointwise."""
    from matplotlib.ticker import MaxNLocator

    with settings():
        drawing, first = canvas(max(3.6, 2.1 * len(panels) + 0.6), 3.3 if len(panels) < 2 else 2.6)
        drawing.delaxes(first)
        axes = drawing.subplots(1, len(panels), sharey=True, squeeze=False)[0]
        for place, (panel, (label, points)) in enumerate(zip(axes, panels.items(), strict=True)):
            n = len(points)
            rank = np.arange(1, n + 1)
            band = [special.ndtri(stats.beta.ppf(p, rank, n + 1 - rank)) for p in (0.025, 0.975)]
            panel.fill_between(points["theoretical"], *band, color="#e2e8f0", linewidth=0, zorder=1)
            ends = points["theoretical"].iloc[[0, -1]]
            panel.plot(ends, ends, color="#718096", linewidth=1, zorder=2)
            panel.scatter(points["theoretical"], points["ordered"], s=11, color=COLOURS[0], alpha=0.6, linewidths=0)
            panel.set_title(label, fontsize=9.5)
            panel.xaxis.set_major_locator(MaxNLocator(5, integer=True))
            panel.tick_params(length=0)
            if place == 0:
                panel.set_ylabel("observed (SD)")
        drawing.supxlabel("expected of a normal distribution (SD)", fontsize=9.5)
        caption = (
            f"{title}, against a normal distribution. Points on the line are normal; 95 % of normal samples would lie "
            "in the band at any one point."
        )
        return saved(drawing, name, title, caption)


def session_course(means: CellMeans, trials: pd.DataFrame) -> pd.DataFrame:
    """Each participant's mean in each twelfth of the session, freed of what differs between conditions.

    From every trial its participant's mean of the other trials of that condition is taken out (all people's
    mean, where somebody saw a condition once) and the participant's mean put back. Returns participant,
    trial (mean number in the stretch), the measure.
    """
    who = labels(trials, "participant")
    known = np.isin(np.array([*who.levels, ""])[who.codes], means.subjects)
    data = pd.DataFrame(
        {"participant": np.array(who.levels)[who.codes], "trial": numbers(trials, "trial"),
         "y": numbers(trials, means.measure)}
    )  # fmt: skip
    condition = [labels(trials, name).codes for name in means.within]
    data = data.assign(**{f"c{i}": codes for i, codes in enumerate(condition)})[known].dropna()
    own = data.groupby("participant")["y"].transform("mean")
    named = [f"c{i}" for i in range(len(condition))]
    cell = data.groupby(["participant", *named])["y"]
    count = cell.transform("count")
    if count.min() > 1:
        data["y"] = (data["y"] - cell.transform("mean")) * count / (count - 1) + own
    elif named:
        data["y"] += data["y"].mean() - data.groupby(named)["y"].transform("mean")
    edges = np.linspace(data["trial"].min(), data["trial"].max() + 1, BINS + 1)
    data["stretch"] = np.digitize(data["trial"], edges)
    course = data.groupby(["participant", "stretch"])[["trial", "y"]].mean().reset_index()
    middle = data.groupby("stretch")["trial"].mean()
    course["trial"] = course["stretch"].map(middle)
    return course.drop(columns="stretch").rename(columns={"y": means.measure})


def order_figure(means: CellMeans, plan: AnalysisPlan, trials: pd.DataFrame) -> DrawnFigure:
    """The planned figure of kind order: every participant a thin line, their mean with its 95 % limits."""
    if trials["trial"].nunique() < 2 * BINS:
        raise AnalysisError(f"A figure of the order needs at least {2 * BINS} trials.")
    course = session_course(means, trials).pivot_table(index="trial", columns="participant", values=means.measure)
    course = course.dropna()
    drawing, axes = canvas()
    axes.plot(course.index, course.to_numpy(), color=COLOURS[0], alpha=0.22, linewidth=0.9, zorder=2)
    people = course.to_numpy().T
    axes.errorbar(
        course.index, people.mean(axis=0), yerr=within_participant(people), fmt="o-",
        color=COLOURS[1], markersize=6, capsize=4, elinewidth=1.6, zorder=4,
    )  # fmt: skip
    axes.set_xlabel("trial")
    axes.set_ylabel(measure_label(plan))
    axes.tick_params(length=0)
    axes.yaxis.get_major_formatter().set_useOffset(False)
    axes.yaxis.get_major_formatter().set_scientific(False)
    caption = (
        f"{plan.label} over the session, differences between conditions taken out: each thin line is one participant; "
        f"dots are means over participants in twelfths of the session with 95 % within-participant intervals "
        "(Cousineau–Morey). A level line means no learning and no fatigue."
    )
    return saved(drawing, "order", f"{plan.label} over the session", caption)

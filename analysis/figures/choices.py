"""Figures of choices: shares beside chance, and psychometric functions with every participant's curve."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from scipy import special

from analysis.apa import figures
from analysis.errors import AnalysisError
from analysis.figures.drawing import (
    COLOURS,
    MARKERS,
    REFERENCE,
    DrawnFigure,
    beeswarm,
    canvas,
    legend_above,
    level_ticks,
    panels,
    saved,
)
from analysis.planned.choice_tests import answered_levels
from analysis.planned.further_test import FurtherTest
from analysis.planned.plan_parts import PsychometricPlan
from analysis.planned.results import PlannedResults
from analysis.recorded.answers import readable

LEGEND = 6.0  # inches that the legend above the panels needs


def proportions_figure(results: PlannedResults) -> DrawnFigure:
    """Shares of answers with Wilson limits beside chance, every participant a faint dot; a panel for each label."""
    test = _test(results, "proportions")
    groups = list(test.table.groupby("label", sort=False))
    width = 0.55 * max(len(part) for _, part in groups) + 1.9
    width = max(width, LEGEND / len(groups))
    drawing, axes = panels(len(groups), width, 4.2)
    for axis, (label, part) in zip(axes, groups, strict=True):
        for i, row in enumerate(part.to_dict("records")):
            people = test.more[(test.more["label"] == label) & (test.more["level"] == row["level"])]
            values = 100 * people["proportion"].to_numpy()
            axis.scatter(
                i + beeswarm(values, 0.14), values, s=14, color=COLOURS[0], alpha=0.28, linewidths=0, zorder=2,
                label="participants" if i == 0 else None,
            )  # fmt: skip
            middle, low, high = (100 * row[name] for name in ("proportion", "wilson_low", "wilson_high"))
            axis.errorbar(
                i, middle, yerr=[[middle - low], [high - middle]], fmt="o", color=COLOURS[0], markersize=7, capsize=5,
                elinewidth=1.8, zorder=4, label="all trials, 95 % Wilson limits" if i == 0 else None,
            )  # fmt: skip
        axis.axhline(100 * part["chance"].iloc[0], color=REFERENCE, linewidth=1.2, linestyle="--", label="chance")
        level_ticks(axis, list(part["level"]), width - 0.5)
        axis.set_xlim(-0.6, len(part) - 0.4)
        axis.set_ylim(-4, 104)
        axis.set_title(label)
        axis.tick_params(length=0)
    axes[0].set_ylabel("trials (%)")
    legend_above(drawing, axes[0])
    caption = "Share of trials with 95 % Wilson limits of all trials together; each faint dot is one participant."
    return saved(drawing, "proportions", "Proportions against chance", caption)


def psychometric_figure(results: PlannedResults) -> DrawnFigure:
    """Psychometric functions: answers of all with Wilson limits, the function fitted to all, everybody's faintly."""
    test, plan = _test(results, "psychometric"), results.plan
    asked = plan.psychometric
    assert asked is not None
    seen = answered_levels(results.used, plan, asked)
    drawing, axes = canvas(6.8)
    span = seen["x"].min(), seen["x"].max()
    x = np.linspace(*span, 200)
    fits = test.more[test.more["threshold"].notna()]
    names = list(dict.fromkeys(seen["level"].astype(str)))
    for j, name in enumerate(names):
        colour = COLOURS[j % len(COLOURS)]
        for row in fits[fits["level"] == name].to_dict("records"):
            axes.plot(x, _curve(asked, row, x), color=colour, alpha=0.16, linewidth=0.9, zorder=2)
        _points(axes, seen[seen["level"].astype(str) == name], colour, MARKERS[j % len(MARKERS)])
        pooled = {key: test.facts[f"{name}|{key}"] for key in ("intercept", "slope", "lapse")}
        label = f"{name}, threshold " if name else "threshold "
        mean = test.table.loc[(test.table["part"] == "threshold") & (test.table["level"] == name), "mean"]
        label += figures(float(mean.iloc[0])) if len(mean) else "–"
        axes.plot(x, _curve(asked, pooled, x), color=colour, linewidth=2.2, zorder=4, label=label)
        if len(mean):
            axes.axvline(float(mean.iloc[0]), color=colour, linewidth=0.9, linestyle=":", zorder=1)
    axes.set_xlabel(asked.level)
    axes.set_ylabel(f"{readable(asked.success)} (%)")
    axes.set_ylim(-4, 104)
    axes.margins(x=0.04)
    legend_above(drawing, axes)
    caption = (
        f"How often {readable(asked.success)} along {asked.level}: all answers together with 95 % Wilson limits, and "
        "the function fitted to them; each faint curve is one participant, dotted lines are mean thresholds."
    )
    return saved(drawing, "psychometric", "Psychometric functions", caption)


def _points(axes: Any, seen: pd.DataFrame, colour: str, marker: str) -> None:
    middle = 100 * seen["proportion"].to_numpy()
    low, high = middle - 100 * seen["wilson_low"], 100 * seen["wilson_high"] - middle
    axes.errorbar(
        seen["x"], middle, yerr=[np.maximum(low, 0), np.maximum(high, 0)], fmt=marker, color=colour, markersize=5.5,
        capsize=3, elinewidth=1.2, zorder=5,
    )  # fmt: skip


def _curve(asked: PsychometricPlan, fit: dict[str, float], x: np.ndarray) -> np.ndarray:
    z = fit["intercept"] + fit["slope"] * x
    rise = special.expit(z) if asked.shape == "logistic" else special.ndtr(z)
    return 100 * (asked.guess + (1 - asked.guess - fit["lapse"]) * rise)


def _test(results: PlannedResults, kind: str) -> FurtherTest:
    found = next((test for test in results.further if test.kind == kind), None)
    if found is None:
        raise AnalysisError(f"the tests it shows ({kind}) could not be computed.")
    return found

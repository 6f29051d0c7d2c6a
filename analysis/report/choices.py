"""Sections of the report for t tests of pairs, planned pairs, proportions, d' and psychometric functions."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from analysis import apa
from analysis.figures.drawing import DrawnFigure
from analysis.planned.further_test import FurtherTest
from analysis.planned.results import ALPHA, PlannedResults
from analysis.recorded.answers import readable
from analysis.report.markup import Markup, element, table, text
from analysis.report.values import (
    ADJUSTED,
    BF,
    D_AV,
    D_AV_IS,
    HOLM_LIMITS,
    Columns,
    D,
    F,
    P,
    T,
    bayes_cell,
    degrees_cell,
    interval,
    p_cell,
    section,
    share_cell,
    str_right,
    unit_cell,
)

Plots = Mapping[str, DrawnFigure]
LONG = 24  # rows of a table that is folded away


def comparisons_section(test: FurtherTest, results: PlannedResults, plots: Plots) -> Markup:
    """Planned t tests: differences with 95 % limits, t, df, p and standardised difference."""
    data, (unit, decimals) = test.table, unit_cell(results)
    shown = data.assign(
        place=[f"{r['each']} {r['level']}" if r["each"] else "" for r in data.to_dict("records")],
        pair=[f"{r['a']} − {r['b']}" if r["a"] else f"mean − {r['reference']}" for r in data.to_dict("records")],
        limits=[interval(a, b, decimals) for a, b in zip(data["ci_low"], data["ci_high"], strict=True)],
    )
    columns: Columns = {
        "test": ("test", text),
        **({"place": ("inside", text)} if data["each"].any() else {}),
        **({"where": ("trials with", text)} if data["where"].any() else {}),
        "pair": ("difference of", text), "n": (element("i", "n"), str_right),
        "estimate": ("difference", unit), "limits": ("95 % limits", str_right), "t": (T, apa.number),
        "df": ("df", degrees_cell), "p": (P, p_cell), "d": (D, apa.number), "bf10": (BF, bayes_cell),
        "rank_p": (Markup("rank test <i>p</i>"), p_cell), "shapiro_p": (Markup("Shapiro–Wilk <i>p</i>"), p_cell),
    }  # fmt: skip
    notes = [
        "t tests of participants' means, two-sided, not corrected for their number. Paired: of differences; "
        "independent: Student's with equal variances, and Welch's without; d is the difference over its SD (paired) or "
        "the pooled SD. Rank test: Wilcoxon or Mann–Whitney. Shapiro–Wilk: of the differences; none between groups.",
        *test.notes,
    ]
    return section("t tests", [_folded(shown, columns)], notes, list(data["sentence"]))


def pairs_section(test: FurtherTest, results: PlannedResults, plots: Plots) -> Markup:
    """Planned pairs of marginal means, a table for each family."""
    data, (unit, decimals) = test.table, unit_cell(results)
    parts: list[object] = []
    for (factors, by, adjust), part in data.groupby(["factors", "by", "adjust"], sort=False):
        shown = part.assign(
            limits=[interval(a, b, decimals) for a, b in zip(part["ci_low"], part["ci_high"], strict=True)]
        )
        columns: Columns = {
            **({"level": (by, text)} if by else {}),
            "a": ("a", text), "b": ("b", text), "estimate": ("a − b", unit), "limits": ("95 % limits", str_right),
            "t": (T, apa.number), "df": ("df", degrees_cell), "p": (P, p_cell), "d_av": (D_AV, apa.number),
        }  # fmt: skip
        inside = f" inside every {by}" if by else ""
        head = element("h3", f"{factors}{inside} ({ADJUSTED.get(adjust, 'p uncorrected')})")
        parts += [head, _folded(shown, columns)]
    holm = HOLM_LIMITS if (data["adjust"] == "holm").any() else ""
    notes = [
        "Estimated marginal means, one family of comparisons in every level they stand in. "
        f"{holm}{' ' if holm else ''}{D_AV_IS}",
        *test.notes,
    ]
    return section("Planned pairs", parts, notes, list(data["sentence"]))


def proportions_section(test: FurtherTest, results: PlannedResults, plots: Plots) -> Markup:
    """Counts and proportions (%) against chance, with exact and Wilson's tests and the t test over participants."""
    parts: list[object] = []
    for label, part in test.table.groupby("label", sort=False):
        shown = part.assign(
            count=[f"{k} of {n}" for k, n in zip(part["k"], part["trials"], strict=True)],
            exact=[_percents(a, b) for a, b in zip(part["exact_low"], part["exact_high"], strict=True)],
            wilson=[_percents(a, b) for a, b in zip(part["wilson_low"], part["wilson_high"], strict=True)],
        )
        columns: Columns = {
            **({"level": ("", text)} if part["level"].any() else {}),
            "count": ("trials", str_right), "proportion": ("share", _percent), "wilson": ("Wilson 95 %", str_right),
            "exact": ("exact 95 %", str_right), "p_exact": (Markup("exact <i>p</i>"), p_cell),
            "n": (element("i", "n"), str_right), "t": (T, apa.number), "df": ("df", degrees_cell), "p": (P, p_cell),
            "d": (D, apa.number), "shapiro_p": (Markup("Shapiro–Wilk <i>p</i>"), p_cell),
        }  # fmt: skip
        title = f"{label}, chance {_percent(part['chance'].iloc[0])}"
        parts += [element("h3", title), table(shown, columns, list(part["p"] < ALPHA))]
    notes = [
        "Left: all answers together, with exact (Clopper–Pearson) and Wilson limits and the exact binomial p; right as "
        "long as the answers of one person are independent. Right: t test of participants' shares against chance, "
        "which generalises to other participants. Every participant's share is in proportions_participants.csv.",
        *test.notes,
    ]
    return section("Proportions against chance", parts, notes, _named(test.table, ("label", "level")))


def d_prime_section(test: FurtherTest, results: PlannedResults, plots: Plots) -> Markup:
    """Sensitivity d′ and criterion (both in standard deviations) by level."""
    data = test.table
    limits = [interval(a, b, 2) for a, b in zip(data["ci_low"], data["ci_high"], strict=True)]
    columns: Columns = {
        **({"level": ("", text)} if data["level"].any() else {}),
        "n": (element("i", "n"), str_right), "mean": ("mean d′", apa.number), "sd": ("SD", apa.number),
        "limits": ("95 % limits", str_right), "criterion": ("mean criterion", apa.number), "t": (T, apa.number),
        "df": ("df", degrees_cell), "p": (P, p_cell), "d": (D, apa.number), "bf10": (BF, bayes_cell),
        "shapiro_p": (Markup("Shapiro–Wilk <i>p</i>"), p_cell),
    }  # fmt: skip
    notes = [
        "d′ = z(hits) − z(false alarms), with half an observation added to every count (log-linear rule, Hautus 1995); "
        "criterion = −(z(hits) + z(false alarms)) / 2. t tests of participants' d′ against 0; everybody's counts "
        "are in d_prime_participants.csv.",
        *test.notes,
    ]
    body = [table(data.assign(limits=limits), columns, list(data["p"] < ALPHA))]
    return section("Sensitivity d′", body, notes, _named(data, ("level",)))


def psychometric_section(test: FurtherTest, results: PlannedResults, plots: Plots) -> Markup:
    """Thresholds and just noticeable differences in the unit of the level, and effects on the threshold."""
    asked = results.plan.psychometric
    assert asked is not None
    data = test.table[test.table["part"] == "threshold"]
    limits = [apa.limits(a, b) for a, b in zip(data["ci_low"], data["ci_high"], strict=True)]
    columns: Columns = {
        **({"level": ("", text)} if data["level"].any() else {}),
        "n": (element("i", "n"), str_right), "mean": ("threshold", apa.figures), "sd": ("SD", apa.figures),
        "limits": ("95 % limits", str_right), "jnd": ("JND", apa.figures), "jnd_sd": ("SD of JND", apa.figures),
    }  # fmt: skip
    parts = [table(data.assign(limits=limits), columns)]
    effects = test.table[test.table["part"] == "effect"]
    if len(effects):
        shown = effects.assign(
            df=[
                f"{apa.degrees(a)}, {apa.degrees(b)}" for a, b in zip(effects["df1_gg"], effects["df2_gg"], strict=True)
            ],
            effect=effects["level"].map(apa.effect_name),
        )
        named: Columns = {
            "effect": ("Effect on the threshold", text), "df": ("df", str_right), "F": (F, apa.number),
            "p_gg": (P, p_cell), "eta_p2": (Markup("η<sub>p</sub>²"), share_cell),
        }  # fmt: skip
        parts.append(table(shown, named, list(effects["p_gg"] < ALPHA)))
    lapse = "estimated between 0 and .06" if asked.lapse is None else f"fixed at {asked.lapse:g}"
    notes = [
        f"Maximum likelihood, {'cumulative Gaussian' if asked.shape == 'normal' else asked.shape} function of "
        f"{asked.level} for every participant, yes where {readable(asked.success)}; guess rate {asked.guess:g}, lapse "
        f"rate {lapse}. The threshold is the level half-way up, the JND (just noticeable difference) the way from "
        "there to three quarters. Every fit, with bootstrap limits and its deviance, is in psychometric_fits.csv.",
        *test.notes,
    ]
    return section("Psychometric functions", parts, notes, _named(test.table, ("level",)))


def adaptive_section(test: FurtherTest, results: PlannedResults, plots: Plots) -> Markup:
    """Thresholds of adaptive tracks in the unit of the level."""
    data = test.table
    limits = [apa.limits(a, b) for a, b in zip(data["ci_low"], data["ci_high"], strict=True)]
    columns: Columns = {
        **({"level": ("", text)} if data["level"].any() else {}),
        "n": (element("i", "n"), str_right), "mean": ("threshold", apa.figures), "sd": ("SD", apa.figures),
        "limits": ("95 % limits", str_right),
    }  # fmt: skip
    how = {
        "quest_plus": "what QUEST+ believes of the threshold in the end (Watson 2017)",
        "staircase": "the mean level of the reversals without the first two (Levitt 1971)",
        "weighted": "the mean level of the reversals without the first two (Kaernbach 1991)",
    }[str(test.more["rule"].iloc[0])]
    without = int(test.more["threshold"].isna().sum())
    missing = f" {without} track(s) turned too seldom for one." if without else ""
    notes = [f"Threshold of a track: {how}; every track is in adaptive_tracks.csv.{missing}", *test.notes]
    return section("Adaptive tracks", [table(data.assign(limits=limits), columns)], notes, _named(data, ("level",)))


def _folded(shown: pd.DataFrame, columns: Columns) -> Markup:
    """A table of tests; a long one to unfold."""
    drawn = table(shown, columns, list(shown["p"] < ALPHA))
    if len(shown) <= LONG:
        return drawn
    low = int((shown["p"] < ALPHA).sum())
    return element("details", element("summary", f"{low} of {len(shown)} tests have p < .05."), drawn)


def _named(data: pd.DataFrame, names: tuple[str, ...]) -> list[str]:
    """The sentences, each with what it is about in front."""
    rows = data.to_dict("records")
    heads = [", ".join(apa.effect_name(str(row[name])) for name in names if row[name]) for row in rows]
    return [f"{head}: {row['sentence']}" if head else row["sentence"] for head, row in zip(heads, rows, strict=True)]


def _percent(value: float) -> str:
    return f"{apa.number(100 * value, 1)} %"


def _percents(low: float, high: float) -> str:
    return f"[{apa.number(100 * low, 1)}, {apa.number(100 * high, 1)}]"


CHOICE_SECTIONS = {
    "comparisons": comparisons_section,
    "pairs": pairs_section,
    "proportions": proportions_section,
    "d_prime": d_prime_section,
    "psychometric": psychometric_section,
    "adaptive": adaptive_section,
}
"""What writes the section of each of these tests."""

"""The parts of the report that hold results: one function, one section."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from analysis import apa
from analysis.figures.check_plots import t_test_plots
from analysis.figures.drawing import DrawnFigure
from analysis.planned.results import ALPHA, PlannedResults
from analysis.report import paragraphs
from analysis.report.markup import Cell, Markup, bullets, element, join, table, text
from analysis.report.values import (
    ADJUSTED,
    D_AV,
    D_AV_IS,
    HOLM_LIMITS,
    bayes_cell,
    check_plot,
    degrees_cell,
    epsilon_cell,
    interval,
    p_cell,
    share_cell,
    share_interval,
    str_right,
    unit_cell,
)

P_UNCORRECTED = Markup("<i>p</i> uncorrected")
LONGEST_TABLE = 70  # pairs shown in the page; longer families are in posthoc.csv


def anova_section(results: PlannedResults, plot: DrawnFigure | None = None) -> Markup:
    """The analysis of variance as a table, its assumptions and what was left out."""
    data = results.anova
    if not len(data):
        return Markup("")
    shown = data.assign(
        effect=data["effect"].map(apa.effect_name),
        df=[apa.both_degrees(a, b) for a, b in zip(data["df1_gg"], data["df2_gg"], strict=True)],
        limits=[share_interval(a, b) for a, b in zip(data["eta_p2_low"], data["eta_p2_high"], strict=True)],
        uncorrected=[f"{a}, {b}" for a, b in zip(data["df1"], data["df2"], strict=True)],
        mauchly=[p_cell(p) for p in data["mauchly_p"]],
    )
    columns: dict[str, tuple[object, Cell]] = {
        "effect": ("Effect", text),
        "df": ("df", str_right),
        "F": (element("i", "F"), apa.number),
        "p_gg": (element("i", "p"), p_cell),
        "eta_p2": (Markup("η<sub>p</sub>²"), share_cell),
        "limits": ("90 % limits", str_right),
        "eta_g2": (Markup("η<sub>G</sub>²"), share_cell),
        "epsilon_gg": ("ε (GG)", epsilon_cell),
        "uncorrected": ("df uncorrected", str_right),
        "p": (P_UNCORRECTED, p_cell),
        "mauchly": (element("span", "Mauchly ", element("i", "p")), str_right),
    }
    notes = [
        f"Dependent variable: {apa.mid_sentence(results.plan.label)}"
        + (f" ({results.plan.unit})" if results.plan.unit else "")
        + f"; n = {len(results.means.subjects) if results.means else 0}. Bold: p < .05. df and p are "
        "Greenhouse–Geisser "
        "corrected where the within-participant part has more than one df; F is the same either way.",
        paragraphs.sphericity_sentence(results),
        paragraphs.normality_sentence(results),
        *paragraphs.other_checks(results),
        *results.notes,
    ]
    return join(
        [
            element("h2", "Analysis of variance"),
            table(shown, columns, list(data["p_gg"] < ALPHA)),
            *(element("p", note, class_="note") for note in notes if note),
            check_plot(plot),
            element(
                "details",
                element("summary", "The same as sentences"),
                bullets(
                    [f"{apa.effect_name(row['effect'])}: {apa.anova_sentence(row)}" for row in data.to_dict("records")]
                ),
            ),
        ]
    )


def t_tests_section(results: PlannedResults, plots: Mapping[str, DrawnFigure]) -> Markup:
    """One-sample t tests of levels against reference values, with Bayes factors."""
    data = results.ttests
    if not len(data):
        return Markup("")
    unit, decimals = unit_cell(results)
    names = t_test_plots(results)
    parts: list[object] = [element("h2", "Comparison with reference values")]
    for (factor, reference), part in data.groupby(["factor", "reference"], sort=False):
        shown = part.assign(
            limits=[interval(a, b, decimals) for a, b in zip(part["ci_low"], part["ci_high"], strict=True)],
        )
        columns: dict[str, tuple[object, Cell]] = {
            "level": (factor, text),
            "mean": ("mean", unit),
            "sd": ("SD", unit),
            "against": (reference, unit),
            "estimate": ("difference", unit),
            "limits": ("95 % limits", str_right),
            "t": (element("i", "t"), apa.number),
            "df": ("df", degrees_cell),
            "p": (element("i", "p"), p_cell),
            "d": (element("i", "d"), apa.number),
            "bf10": ("BF₁₀", bayes_cell),
            "shapiro_p": (element("span", "Shapiro–Wilk ", element("i", "p")), p_cell),
        }
        parts += [table(shown, columns, list(part["p"] < ALPHA)), check_plot(plots.get(names[factor, reference]))]
    of_measure = results.plan.unit
    measured_in = f" Means and differences in {of_measure}." if apa.follows_numbers(of_measure) else ""
    parts.append(
        element(
            "p",
            "One-sample t tests of participants' means, two-sided, not corrected for their number. d "
            "is Cohen's; BF₁₀ is the JZS Bayes factor (Cauchy scale .707). "
            "Limits of d and Hedges' g are in ttests.csv." + measured_in,
            class_="note",
        )
    )
    return join(parts)


def posthoc_section(results: PlannedResults) -> Markup:
    """Pairwise comparisons of the effects that were significant."""
    plan = results.plan
    if results.means is None or plan.adjust is None:
        return Markup("")
    parts: list[object] = [element("h2", "Pairwise comparisons")]
    if not len(results.posthoc):
        parts.append(element("p", "No effect was significant, so none was followed up."))
    for effect, part in results.posthoc.groupby("effect", sort=False):
        parts.append(_family(str(effect), part, results))
    if len(results.posthoc):
        holm = f"{HOLM_LIMITS} " if plan.adjust == "holm" else ""
        kind = "pairs that differ are bold. " if len(results.posthoc) else ""
        parts.append(
            element(
                "p",
                f"p: {ADJUSTED.get(plan.adjust, 'unadjusted')}, over all pairs of one effect; {kind}{holm}{D_AV_IS} "
                "All pairs, with standard errors and limits, are in "
                "posthoc.csv.",
                class_="note",
            )
        )
    return join(parts)


def _family(effect: str, part: pd.DataFrame, results: PlannedResults) -> Markup:
    unit, decimals = unit_cell(results)
    low = part[part["p"] < ALPHA]
    title = element("h3", apa.effect_name(effect))
    columns: dict[str, tuple[object, Cell]] = {
        "a": ("a", text),
        "b": ("b", text),
        "estimate": ("a − b", unit),
        "limits": ("95 % limits", str_right),
        "t": (element("i", "t"), apa.number),
        "df": ("df", degrees_cell),
        "p": (element("i", "p"), p_cell),
        "d_av": (D_AV, apa.number),
    }
    words = f"{len(low)} of {len(part)} pairs differ."

    def shown(rows: pd.DataFrame) -> Markup:
        limits = [interval(a, b, decimals) for a, b in zip(rows["ci_low"], rows["ci_high"], strict=True)]
        return table(rows.assign(limits=limits), columns, list(rows["p"] < ALPHA))

    if len(part) <= 15:
        return join([title, element("p", words), shown(part)])
    if len(part) <= LONGEST_TABLE:
        return join([title, element("details", element("summary", words), shown(part))])
    listed = low.reindex(low["p_unadjusted"].sort_values(kind="stable").index)[:LONGEST_TABLE]
    if not len(listed):
        return join([title, element("p", words)])
    summary = f"{words} Those that do" + (f" (the {LONGEST_TABLE} clearest):" if len(low) > LONGEST_TABLE else ":")
    return join([title, element("details", element("summary", summary), shown(listed))])

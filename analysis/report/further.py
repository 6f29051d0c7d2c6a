"""Sections of the report for equivalence tests, regression, aligned ranks and the mixed model."""

from __future__ import annotations

import math
from collections.abc import Mapping

import pandas as pd

from analysis import apa
from analysis.figures.drawing import DrawnFigure
from analysis.planned.further_test import FurtherTest
from analysis.planned.results import ALPHA, PlannedResults
from analysis.report.choices import CHOICE_SECTIONS
from analysis.report.markup import Markup, element, join, table, text
from analysis.report.values import (
    Columns,
    F,
    P,
    T,
    check_plot,
    degrees_cell,
    interval,
    p_cell,
    section,
    share_cell,
    str_right,
    unit_cell,
)


def further_sections(results: PlannedResults, plots: Mapping[str, DrawnFigure]) -> Markup:
    """One section for each further test, in the order of the plan."""
    write = {
        **CHOICE_SECTIONS,
        "equivalence": _equivalence,
        "regression": _regression,
        "aligned_rank_transform": _rank_transform,
        "mixed_model": _mixed_model,
    }
    return join(write[test.kind](test, results, plots) for test in results.further)


def _normality(what: str, w: float, p: float) -> str:
    if not math.isfinite(p):
        return ""
    verdict = "deviate from a normal distribution" if p < ALPHA else "show no deviation from normality"
    return f"{what} {verdict} (Shapiro–Wilk W = {w:.3f}, {apa.p_value(p)})."


def _equivalence(test: FurtherTest, results: PlannedResults, plots: Mapping[str, DrawnFigure]) -> Markup:
    data, (_, decimals) = test.table, unit_cell(results)
    shown = data.assign(
        place=[
            f"{r['factor']} inside {r['by']} {r['level']}" if r["by"] else r["factor"] for r in data.to_dict("records")
        ],
        limits=[interval(a, b, decimals + 1) for a, b in zip(data["ci_low"], data["ci_high"], strict=True)],
        bounds=[f"±{apa.figures(bound)}" for bound in data["upper_bound"]],
        verdict=["equivalent" if same else "not shown" for same in data["equivalent"]],
    )
    columns: Columns = {
        "place": ("factor", text),
        "a": ("a", text), "b": ("b", text),
        "estimate": ("a − b", lambda value: apa.number(value, decimals + 1)),
        "limits": ("90 % limits", str_right), "bounds": ("bounds", str_right),
        "t_lower": (Markup("<i>t</i> lower"), apa.number), "t_upper": (Markup("<i>t</i> upper"), apa.number),
        "df": ("df", degrees_cell), "p": (P, p_cell), "verdict": ("", text),
        "shapiro_p": (Markup("Shapiro–Wilk <i>p</i>"), p_cell),
    }  # fmt: skip
    notes = [
        f"Two one-sided tests (Schuirmann 1987) of estimated marginal means ({results.plan.model} model), with bounds "
        "set in the study file before the data. A pair is equivalent when its 90 % limits lie inside the bounds; all "
        "levels are when all pairs are, so p is not corrected. Not shown does not mean different. Shapiro–Wilk: of "
        "participants' differences, which the tests take to be normal; none between groups.",
        *test.notes,
    ]
    return section("Equivalence", [table(shown, columns, list(data["equivalent"]))], notes, list(data["sentence"]))


def _regression(test: FurtherTest, results: PlannedResults, plots: Mapping[str, DrawnFigure]) -> Markup:
    data, fit, of = test.table, test.facts, results.plan.regression.of if results.plan.regression else ""
    limits = [apa.limits(a, b) for a, b in zip(data["ci_low"], data["ci_high"], strict=True)]
    columns: Columns = {
        "term": ("", text), "estimate": (element("i", "b"), apa.figures), "se": ("SE", apa.figures),
        "limits": ("95 % limits", str_right), "beta": ("β", apa.number), "t": (T, apa.number), "p": (P, p_cell),
        "vif": ("VIF", apa.number),
    }  # fmt: skip
    farthest = test.more.loc[test.more["cooks_distance"].idxmax()]
    notes = [
        f"Cases: the {fit['n']} levels of {of}, each with its mean over participants. "
        f"{apa.regression_sentence(fit)}; RMSE {apa.figures(fit['rmse'])}, "
        f"leaving one out {apa.figures(fit['loo_rmse'])}.",
        _normality("Normality: the residuals", fit["shapiro_w"], fit["shapiro_p"])
        + f" Independence: Durbin–Watson {apa.number(fit['durbin_watson'])}. Influence: the largest Cook's distance is "
        f"{apa.number(farthest['cooks_distance'])}, of {farthest[of]}; all are in regression_cases.csv.",
        *test.notes,
    ]
    tables = [table(data.assign(limits=limits), columns, list(data["p"] < ALPHA)), check_plot(plots.get("regression"))]
    return section("Regression", tables, notes, list(data["sentence"]))


def _rank_transform(test: FurtherTest, results: PlannedResults, plots: Mapping[str, DrawnFigure]) -> Markup:
    data = test.table
    columns: Columns = {
        "effect": ("Effect", text), "df": ("df", str_right), "F": (F, apa.number), "p": (P, p_cell),
        "eta_p2": (Markup("η<sub>p</sub>²"), share_cell),
    }  # fmt: skip
    shown = _effects(data, "effect", "df1", "df2")
    parts: list[object] = [table(shown, columns, list(data["p"] < ALPHA))]
    for effect, pairs in test.more.groupby("effect", sort=False):
        low = pairs[pairs["p"] < ALPHA]
        named: Columns = {
            "a": ("a", text), "b": ("b", text), "estimate": ("a − b (ranks)", apa.number), "t": (T, apa.number),
            "df": ("df", degrees_cell), "p": (P, p_cell),
        }  # fmt: skip
        words = f"{apa.effect_name(str(effect))}: {len(low)} of {len(pairs)} pairs differ (ART-C, Holm)."
        rows = pairs if len(pairs) <= 70 else low[:70]
        inside = table(rows, named, list(rows["p"] < ALPHA)) if len(rows) else ""
        parts.append(element("details", element("summary", words), inside))
    largest = test.facts["largest_other_F"]
    notes = [
        "Aligned rank transform (Wobbrock et al. 2011), one error term within participants as in ARTool. Ranks need no "
        "normal distribution. "
        + (
            "Alignment: in data aligned for one effect no other effect is left (largest F below 0.001)."
            if largest < 1e-3
            else f"Alignment: data aligned for one effect keep up to F = {apa.number(largest)} of another, because "
            "groups are unequal; read the table with care."
        ),
        *test.notes,
    ]
    sentences = [f"{apa.effect_name(row['effect'])}: {row['sentence']}" for row in data.to_dict("records")]
    return section("Aligned rank transform", parts, notes, sentences)


def _mixed_model(test: FurtherTest, results: PlannedResults, plots: Mapping[str, DrawnFigure]) -> Markup:
    data = test.table
    effects, deviations = data[data["part"] == "effect"], data[data["part"] == "deviation"]
    columns: Columns = {
        "effect": ("Effect", text), "df": ("df", str_right), "statistic": (F, apa.number), "p": (P, p_cell),
    }  # fmt: skip
    spread: Columns = {
        "term": ("Random intercepts of", text), "estimate": ("SD", apa.figures), "share": ("share", share_cell),
    }  # fmt: skip
    facts, stimulus = test.facts, results.plan.mixed_model.stimulus if results.plan.mixed_model else ""
    notes = [
        f"Single trials, random intercepts of participants and of {stimulus}, crossed; REML, Satterthwaite df, "
        "type III. "
        f"It asks whether an effect would hold for other participants and for other levels of {stimulus}. "
        "Coefficients are in mixed_model.csv.",
        " ".join(
            filter(
                None,
                [
                    _normality("Normality: the residuals", facts["residual_w"], facts["residual_p"]),
                    _normality("Participants' intercepts", facts["intercept_w"], facts["intercept_p"]),
                ],
            )
        ),
        *test.notes,
    ]
    tables = [table(_effects(effects, "term", "df1", "df2"), columns, list(effects["p"] < ALPHA)),
              table(deviations, spread)]  # fmt: skip
    sentences = [
        f"{apa.effect_name(row['term'])}: {row['sentence']}"
        for row in data.to_dict("records")
        if row["part"] != "coefficient"
    ]
    return section("Mixed model", tables, notes, sentences)


def _effects(data: pd.DataFrame, name: str, df1: str, df2: str) -> pd.DataFrame:
    df = [f"{apa.degrees(a)}, {apa.degrees(b)}" for a, b in zip(data[df1], data[df2], strict=True)]
    return data.assign(effect=data[name].map(apa.effect_name), df=df)

"""Tests a plan can ask for beside the ANOVA, in one list: those of other modules, and four that are made here."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import pandas as pd

from analysis import apa
from analysis.errors import AnalysisError
from analysis.planned.choice_tests import d_prime_tests, proportion_tests, psychometric_tests
from analysis.planned.comparison_tests import comparison_tests, pair_tests
from analysis.planned.further_test import FurtherTest, worth_saying
from analysis.planned.plan import AnalysisPlan
from analysis.planned.plan_parts import EquivalencePlan, MixedModelPlan, RankTransformPlan, RegressionPlan
from analysis.planned.results import ALPHA
from analysis.planned.track_tests import track_tests
from analysis.statistics.aligned_ranks import aligned, art_anova, art_contrasts
from analysis.statistics.cells import cell_means
from analysis.statistics.columns import labels, numeric_label
from analysis.statistics.contrasts import subsets
from analysis.statistics.crossed_effects import mixed_model
from analysis.statistics.equivalence_tests import equivalence
from analysis.statistics.linear_regression import regression, regression_diagnostics
from analysis.statistics.repeated_measures import anova_of_cells
from analysis.statistics.t_statistics import shapiro


def planned_tests(plan: AnalysisPlan) -> Iterator[tuple[str, Callable[[pd.DataFrame], FurtherTest]]]:
    """A name for each further test in the plan, and the function from used trials to its result."""
    if plan.comparisons:
        yield "The t tests", lambda used: comparison_tests(used, plan)
    if plan.pairs:
        yield "The planned pairs", lambda used: pair_tests(used, plan)
    if plan.proportions:
        yield "The tests of proportions", lambda used: proportion_tests(used, plan)
    if (sensitivity := plan.d_prime) is not None:
        yield "The sensitivity d′", lambda used: d_prime_tests(used, plan, sensitivity)
    if (functions := plan.psychometric) is not None:
        yield "The psychometric functions", lambda used: psychometric_tests(used, plan, functions)
    if (adaptive := plan.adaptive) is not None:
        yield "The thresholds of the tracks", lambda used: track_tests(used, plan, adaptive)
    if plan.equivalence:
        yield "The equivalence tests", lambda used: equivalence_tests(used, plan)
    if (cases := plan.regression) is not None:
        yield "The regression", lambda used: regression_of_levels(used, plan, cases)
    if (ranks := plan.rank_transform) is not None:
        yield "The aligned rank transform", lambda used: rank_transform(used, plan, ranks)
    if (mixed := plan.mixed_model) is not None:
        yield "The mixed model", lambda used: mixed_model_of_trials(used, plan, mixed)


def equivalence_tests(used: pd.DataFrame, plan: AnalysisPlan) -> FurtherTest:
    """All planned pairs in one table: factor, by, level, then the columns of `equivalence`, and shapiro_w, shapiro_p.

    Shapiro-Wilk is of participants' differences; nan between groups.
    """
    parts, notes = [], []
    for asked in plan.equivalence:
        table = equivalence(
            used, plan.measure, "participant", plan.within, plan.between, factors=asked.factor, bound=asked.bound,
            by=(asked.by,) if asked.by else (), model=plan.model, levels=_levels(plan),
        )  # fmt: skip
        notes += table.attrs["notes"]
        table = table.rename(columns={asked.by: "level"}) if asked.by else table.assign(level="")
        table = pd.concat([table, _normality_of_differences(used, plan, asked, table)], axis=1)
        parts.append(table.assign(factor=asked.factor, by=asked.by or ""))
    result = pd.concat(parts, ignore_index=True)
    first = ["factor", "by", "level"]
    result = result[[*first, *(name for name in result if name not in first)]]
    result["sentence"] = [apa.equivalence_sentence(row) for row in result.to_dict("records")]
    return FurtherTest("equivalence", result, notes=worth_saying(notes))


def _normality_of_differences(
    used: pd.DataFrame, plan: AnalysisPlan, asked: EquivalencePlan, table: pd.DataFrame
) -> pd.DataFrame:
    rows: list[dict[str, float]] = []
    for pair in table.to_dict("records"):
        inside = used
        if asked.by:
            column = labels(used, asked.by, plan.levels[asked.by])
            inside = used[column.codes == column.levels.index(pair["level"])]
        if asked.factor not in plan.within:
            rows.append({})
            continue
        levels = {asked.factor: plan.levels[asked.factor]}
        means = cell_means(inside, plan.measure, "participant", [asked.factor], levels=levels)
        place = means.within[asked.factor].index
        rows.append(shapiro(means.values[:, place(pair["a"])] - means.values[:, place(pair["b"])]))
    return pd.DataFrame(rows, index=table.index).reindex(columns=["shapiro_w", "shapiro_p"])


def regression_of_levels(used: pd.DataFrame, plan: AnalysisPlan, asked: RegressionPlan) -> FurtherTest:
    """One case per level of a factor: its mean over participants' means, on the values in the plan."""
    levels = {asked.of: plan.levels[asked.of]}
    means = cell_means(used, plan.measure, "participant", [asked.of], levels=levels)
    cases = pd.DataFrame({asked.of: list(means.within[asked.of]), plan.measure: means.values.mean(axis=0)})
    for name, values in asked.on.items():
        cases[name] = [values.get(numeric_label(level), math.nan) for level in cases[asked.of]]
        gaps = list(cases.loc[cases[name].isna(), asked.of])
        if gaps:
            raise AnalysisError(f"the plan gives no {name} of {', '.join(gaps)}.")
    table = regression(cases, plan.measure, list(asked.on))
    fit, notes = table.attrs["fit"], [*worth_saying(means.notes), *table.attrs["notes"]]
    table["sentence"] = [
        apa.regression_sentence(fit) if row["term"] == "(intercept)" else apa.coefficient_sentence(row, fit["df2"])
        for row in table.to_dict("records")
    ]
    diagnostics = regression_diagnostics(cases, plan.measure, list(asked.on)).drop(columns="row")
    diagnostics = pd.concat([cases, diagnostics], axis=1)
    return FurtherTest("regression", table, diagnostics, fit, tuple(notes))


def rank_transform(used: pd.DataFrame, plan: AnalysisPlan, asked: RankTransformPlan) -> FurtherTest:
    """ANOVA of aligned ranks; ART-C, Holm, of every effect with p < .05.

    facts["largest_other_F"]: the largest F that any effect keeps in data aligned for another one; it is
    zero when alignment succeeded, as it always is with equal groups.
    """
    table = art_anova(used, plan.measure, "participant", asked.within, asked.between, levels=_levels(plan, asked))
    table["sentence"] = [
        apa.anova_sentence({**row, "df1_gg": row["df1"], "df2_gg": row["df2"], "p_gg": row["p"]})
        for row in table.to_dict("records")
    ]
    means = cell_means(used, plan.measure, "participant", asked.within, asked.between, _levels(plan, asked))
    largest = 0.0
    for effect in subsets(means.factors)[1:]:
        rest = anova_of_cells(replace(means, values=aligned(means, effect)))
        others = rest.loc[rest["effect"] != ":".join(effect), "F"]
        largest = max([largest, *others.fillna(0.0)])
    pairs = [
        art_contrasts(
            used, plan.measure, "participant", asked.within, asked.between,
            factors=effect.split(":"), levels=_levels(plan, asked),
        ).assign(effect=effect)
        for effect in table.loc[table["p"] < ALPHA, "effect"]
    ]  # fmt: skip
    columns = ["effect", "a", "b", "estimate", "se", "df", "t", "p", "p_unadjusted"]
    contrasts = pd.concat(pairs, ignore_index=True)[columns] if pairs else pd.DataFrame(columns=columns)
    notes = worth_saying(table.attrs["notes"])
    return FurtherTest("aligned_rank_transform", table, contrasts, {"largest_other_F": largest}, notes)


def mixed_model_of_trials(used: pd.DataFrame, plan: AnalysisPlan, asked: MixedModelPlan) -> FurtherTest:
    """The mixed model of single trials, with Shapiro-Wilk tests of its residuals and participants' intercepts."""
    chosen: dict[str, Any] = {name: plan.levels[name] for name in asked.factors}
    table = mixed_model(used, plan.measure, "participant", asked.stimulus, asked.factors, levels=chosen)
    facts, notes = table.attrs["checks"], tuple(table.attrs["notes"])
    table["sentence"] = [apa.mixed_sentence(row) for row in table.to_dict("records")]
    return FurtherTest("mixed_model", table, facts=facts, notes=notes)


def _levels(plan: AnalysisPlan, asked: RankTransformPlan | None = None) -> dict[str, tuple[str, ...]]:
    factors = (*plan.within, *plan.between) if asked is None else (*asked.within, *asked.between)
    return {name: plan.levels[name] for name in factors}

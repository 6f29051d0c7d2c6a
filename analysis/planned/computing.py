"""Runs the plan on the recorded trials: everything that is computed, in one place."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace

import numpy as np
import pandas as pd

from analysis.errors import AnalysisError, AnalysisWarning, listed
from analysis.planned.further_tests import planned_tests
from analysis.planned.plan import GAZE_SHARE, AnalysisPlan
from analysis.planned.plan_parts import TTestPlan
from analysis.planned.results import ALPHA, PlannedResults
from analysis.recorded.exclusions import selected
from analysis.recorded.journal import RecordedStudy
from analysis.recorded.trials import exclusion_counts, used_trials
from analysis.statistics.assumption_checks import assumptions
from analysis.statistics.cells import CellMeans, cell_means
from analysis.statistics.columns import numeric_label
from analysis.statistics.comparisons import pairwise_of
from analysis.statistics.intervals import ordinary
from analysis.statistics.marginal_means import marginal_means
from analysis.statistics.repeated_measures import COLUMNS as ANOVA_COLUMNS
from analysis.statistics.repeated_measures import anova_of_cells
from analysis.statistics.shapiro_wilk import normality_of_cells
from analysis.statistics.student import COLUMNS as T_COLUMNS
from analysis.statistics.student import t_tests

POSTHOC_COLUMNS = (
    "effect", "a", "b", "estimate", "se", "df", "t", "p", "p_unadjusted", "ci_low", "ci_high", "d_av", "d_z",
)  # fmt: skip


def compute(recorded: RecordedStudy, plan: AnalysisPlan, trials: pd.DataFrame) -> PlannedResults:
    """Run the plan, and those of its further measures.

    What cannot be run is a warning, so that what was recorded still comes out in tables.
    """
    also = tuple(_compute(replace(recorded, warnings=()), further, trials) for further in plan.also)
    return replace(_compute(recorded, plan, trials), also=also)


def _compute(recorded: RecordedStudy, plan: AnalysisPlan, trials: pd.DataFrame) -> PlannedResults:
    said = list(recorded.warnings)
    used = used_trials(trials, plan)
    if plan.measure == GAZE_SHARE and plan.measure not in used:
        said.append(
            "No gaze was recorded, so there are no shares of looking time to analyse; record with an eye tracker "
            "(`gaze:` in the study file)."
        )
        used = used.iloc[:0].assign(gaze_share=pd.Series(dtype=float), region=pd.Series(dtype=object))
    used = _known_groups(used, plan, said)
    if len(trials) and (trials["excluded"] != "").all():
        said.append(_all_excluded(trials, plan))
    cells, descriptives = describe(used, plan)
    means = None
    if len(used) and (plan.within or plan.between):  # why nothing is used is said already
        means = _attempt(said, "The analysis of variance cannot be run", _cell_means, used, plan)
    table = pd.DataFrame(columns=list(ANOVA_COLUMNS))
    normal = pd.DataFrame(columns=["scope", "n", "mean", "sd", "w", "p"])
    notes: list[str] = []
    if means is not None:
        said += [note for note in means.notes if "left out" in note]
        table = anova_of_cells(means)
        notes += [note for note in table.attrs["notes"] if note not in said]
        if plan.normality:
            normal = normality_of_cells(means)
    checks = _attempt(said, "The assumption checks cannot be run", _checks, used, plan) if means is not None else None
    if checks is None:
        checks = pd.DataFrame(columns=["check", "where", "statistic", "df1", "df2", "p", "note"])
    posthoc = _posthoc(means, table, plan, notes)
    ttests = _t_tests(used, plan, said)
    planned = planned_tests(plan) if len(used) else ()
    tested = [_attempt(said, f"{name} cannot be run", run, used) for name, run in planned]
    said += [complaint for test in tested if test is not None for complaint in test.complaints]
    if len(table) and any(":" in e for e in table.loc[table["p_gg"] < ALPHA, "effect"]):
        notes.append(
            "An interaction is significant: comparisons of a main effect inside it average over the "
            "other factor; "
            "read the cells of the interaction as well."
        )
    return PlannedResults(
        plan, recorded, trials, cells, descriptives, means, table, posthoc, ttests, normal, checks,
        tuple(dict.fromkeys(said)), tuple(dict.fromkeys(notes)), tuple(test for test in tested if test is not None),
    )  # fmt: skip


def _attempt(said: list[str], what: str, function, *arguments):  # type: ignore[no-untyped-def]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", AnalysisWarning)
        try:
            return function(*arguments)
        except AnalysisError as error:
            said.append(f"{what}: {error}")
            return None


def _all_excluded(trials: pd.DataFrame, plan: AnalysisPlan) -> str:
    counts = exclusion_counts(trials, plan)
    each = [f"{row.trials} by {row.where!r} ({row.reason})" for row in counts[counts["trials"] > 0].itertuples()]
    return (
        f"All {len(trials)} trials are excluded, {listed(each)}, so nothing can be tested. They are all in "
        "trials.csv; correct the exclusions in a copy of the study file and name it with --plan."
    )


def _checks(used: pd.DataFrame, plan: AnalysisPlan) -> pd.DataFrame:
    return assumptions(
        used, plan.measure, "participant", plan.within, plan.between,
        trial=None if plan.adaptive else "trial",  # the answers of a track drift by design
        start=plan.start if plan.start in plan.within else None, levels=plan.levels,
    )  # fmt: skip


def _cell_means(used: pd.DataFrame, plan: AnalysisPlan) -> CellMeans:
    return cell_means(used, plan.measure, "participant", plan.within, plan.between, plan.levels)


def _known_groups(used: pd.DataFrame, plan: AnalysisPlan, said: list[str]) -> pd.DataFrame:
    """Without participants whose answer is no level of a between factor (as 'I prefer not to say')."""
    for name in plan.between:
        if name not in used:
            said.append(f"Nobody answered the question {name!r}, which the analysis needs as a between factor.")
            return used.iloc[:0]
        known = used[name].map(lambda value: str(value).strip()).isin(plan.levels[name])
        if not known.all():
            odd = used.loc[~known].drop_duplicates("participant")
            who = [f"{row['participant']} ({row[name]})" for _, row in odd.iterrows()]
            said.append(
                f"{len(who)} participant(s) were left out because their answer to {name!r} is not one of "
                f"{listed(plan.levels[name])}: {listed(who)}."
            )
            used = used[known]
    return used


def describe(used: pd.DataFrame, plan: AnalysisPlan) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Mean of each participant and cell; and n, mean, sd, se, 95 % limits of each cell over participants."""
    factors = [*plan.within, *plan.between]
    keyed = used.assign(**{f: _categories(used, f, plan.levels[f]) for f in factors if f in used})
    factors = [f for f in factors if f in keyed]
    grouped = keyed.groupby(["participant", *factors], observed=True, sort=True)[plan.measure]
    cells = grouped.agg(trials="count", mean="mean").reset_index()
    rows = []
    for names, part in cells.groupby(factors, observed=True, sort=True) if factors else [((), cells)]:
        values = part["mean"].to_numpy(dtype=float)
        values = values[~np.isnan(values)]
        sd = values.std(ddof=1) if len(values) > 1 else math.nan
        half = float(ordinary(values[:, None])[0]) if len(values) > 1 else math.nan
        mean = values.mean() if len(values) else math.nan
        rows.append((*names, len(values), mean, sd, sd / math.sqrt(len(values) or 1), mean - half, mean + half))
    columns = [*factors, "n", "mean", "sd", "se", "ci_low", "ci_high"]
    return cells, pd.DataFrame(rows, columns=columns)


def _categories(used: pd.DataFrame, factor: str, order: tuple[str, ...]) -> pd.Categorical:
    place = {numeric_label(level): code for code, level in enumerate(order)}
    codes = [place.get(numeric_label(value), -1) for value in used[factor]]
    return pd.Categorical.from_codes(codes, list(order), ordered=True)


def _posthoc(means: CellMeans | None, table: pd.DataFrame, plan: AnalysisPlan, notes: list[str]) -> pd.DataFrame:
    """Comparisons of every effect with p < .05, one family per effect."""
    empty = pd.DataFrame(columns=list(POSTHOC_COLUMNS))
    if means is None or plan.adjust is None:
        return empty
    parts = []
    for effect in table.loc[table["p_gg"] < ALPHA, "effect"]:
        pairs = pairwise_of(marginal_means(means, effect.split(":")), 0, plan.model, plan.adjust)
        notes += [note for note in pairs.attrs["notes"] if note not in means.notes]
        parts.append(pairs.assign(effect=effect))
    return pd.concat(parts, ignore_index=True)[list(POSTHOC_COLUMNS)] if parts else empty


def _t_tests(used: pd.DataFrame, plan: AnalysisPlan, said: list[str]) -> pd.DataFrame:
    parts = []
    for test in plan.t_tests if len(used) else ():
        table = _attempt(said, f"The t tests against the {test.label} cannot be run", _one_t, used, plan, test)
        if table is not None:
            said += table.attrs["notes"]
            parts.append(table.assign(factor=test.each, reference=test.label))
    columns = ["factor", "reference", *T_COLUMNS]
    return pd.concat(parts, ignore_index=True)[columns] if parts else pd.DataFrame(columns=columns)


def _one_t(used: pd.DataFrame, plan: AnalysisPlan, test: TTestPlan) -> pd.DataFrame:
    chosen = selected(used, test.where)
    return t_tests(
        chosen, plan.measure, "participant", each=test.each, against=dict(test.against),
        levels={test.each: plan.levels[test.each]},
    )  # fmt: skip

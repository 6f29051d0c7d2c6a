"""Planned tests of choices: proportions against chance, sensitivity d', psychometric functions."""

from __future__ import annotations

import math
from itertools import product
from typing import Any

import pandas as pd

from analysis import apa
from analysis.errors import AnalysisError
from analysis.planned.further_test import FurtherTest
from analysis.planned.plan import AnalysisPlan
from analysis.planned.plan_parts import DPrimePlan, PsychometricPlan
from analysis.recorded.answers import answers, cell_labels
from analysis.statistics.forced_choice import d_prime, proportions
from analysis.statistics.psychometric_functions import psychometric
from analysis.statistics.repeated_measures import anova
from analysis.statistics.student import t_tests

T_COLUMNS = ["n", "mean", "sd", "estimate", "ci_low", "ci_high", "t", "df", "p", "d", "bf10", "shapiro_w", "shapiro_p"]


def proportion_tests(used: pd.DataFrame, plan: AnalysisPlan) -> FurtherTest:
    """All planned proportions in one table, and every participant's in a second.

    Columns: label, level, k, trials, proportion, chance, p_exact, exact_low, exact_high, wilson_low, wilson_high (all
    answers together), then a t test of participants' proportions against chance (`t_tests`' columns), sentence.
    """
    tables, people = [], []
    for asked in plan.proportions:
        data = _answered(used, plan, asked.success, asked.each)
        pooled = proportions(data, "yes", by="level", chance=asked.chance)
        pooled = pooled.rename(columns={"n": "trials", "p": "p_exact"})
        person = data.groupby(["level", "participant"], observed=True)["yes"].agg(["count", "mean"]).reset_index()
        person = person.rename(columns={"count": "trials", "mean": "proportion"})
        tested = _tested(person, "proportion", asked.chance)
        table = pd.concat([pooled.reset_index(drop=True), tested[T_COLUMNS].reset_index(drop=True)], axis=1)
        tables.append(table.assign(label=asked.label))
        people.append(person.assign(label=asked.label))
    table = pd.concat(tables, ignore_index=True)
    table["level"] = table["level"].astype(str)
    table["sentence"] = [proportion_sentence(row) for row in table.to_dict("records")]
    first = ["label", "level"]
    more = pd.concat(people, ignore_index=True).astype({"level": str})[[*first, "participant", "trials", "proportion"]]
    return FurtherTest("proportions", table[[*first, *(c for c in table if c not in first)]], more)


def d_prime_tests(used: pd.DataFrame, plan: AnalysisPlan, asked: DPrimePlan) -> FurtherTest:
    """Sensitivity of every participant and cell, tested against 0 over participants; the participants' in `more`."""
    data = _answered(used, plan, asked.answer, asked.each)
    data["signal"] = answers(used, asked.signal).loc[data.index]
    data = data.dropna(subset=["signal"])
    person = d_prime(data, "signal", "yes", by=["level", "participant"])
    tested = _tested(person, "d_prime", 0.0)
    bias = person.groupby("level", observed=True)["criterion"].mean().to_numpy()
    table = tested[["level", *T_COLUMNS]].assign(criterion=bias)
    table["sentence"] = [d_prime_sentence(row) for row in table.to_dict("records")]
    return FurtherTest("d_prime", table, person.astype({"level": str}))


def psychometric_tests(used: pd.DataFrame, plan: AnalysisPlan, asked: PsychometricPlan) -> FurtherTest:
    """A function for every participant and cell (`more`); thresholds and their spread over participants (`table`).

    With `each`, rows of part "effect" are the ANOVA of the thresholds.
    """
    data = _answered(used, plan, asked.success, asked.each)
    data["x"] = pd.to_numeric(used.loc[data.index, asked.level], errors="coerce")
    fits = psychometric(
        data, "x", "yes", by=["participant", "level"], shape=asked.shape, guess=asked.guess, lapse=asked.lapse,
        bootstrap=asked.bootstrap, seed=1,
    )  # fmt: skip
    if hasattr(data["level"], "cat"):
        fits["level"] = pd.Categorical(fits["level"], categories=data["level"].cat.categories)
    known = fits[fits["threshold"].notna()]
    if not len(known):
        raise AnalysisError("nobody's answers determine a function; they must rise or fall along the levels.")
    table = threshold_rows(known)
    notes = list(fits.attrs.get("notes", []))
    if asked.each:
        table = pd.concat([table, _effects_on_thresholds(known, plan, asked, notes)], ignore_index=True)
    pooled = psychometric(data, "x", "yes", by=["level"], shape=asked.shape, guess=asked.guess, lapse=asked.lapse)
    facts = {
        f"{row['level']}|{k}": row[k] for row in pooled.to_dict("records") for k in ("intercept", "slope", "lapse")
    }
    table["n"] = table["n"].astype("Int64")  # whole, though rows of effects have none
    more = fits.astype({"level": str})
    return FurtherTest("psychometric", table, more, facts, tuple(dict.fromkeys(notes)))


def answered_levels(used: pd.DataFrame, plan: AnalysisPlan, asked: PsychometricPlan) -> pd.DataFrame:
    """How often yes was answered at every level of every cell, over all participants: level, x, k, n and limits."""
    data = _answered(used, plan, asked.success, asked.each)
    data["x"] = pd.to_numeric(used.loc[data.index, asked.level], errors="coerce")
    return proportions(data.dropna(subset=["x"]), "yes", by=["level", "x"])


def _answered(used: pd.DataFrame, plan: AnalysisPlan, condition: str, each: tuple[str, ...]) -> pd.DataFrame:
    """participant, level (the cell of the factors in `each`) and yes (0 or 1) of every trial with an answer."""
    data = pd.DataFrame({"participant": used["participant"], "yes": answers(used, condition)})
    data["level"] = cell_labels(used, each, dict(plan.levels))
    data = data.dropna(subset=["yes"])
    if not len(data):
        raise AnalysisError(f"no trial has the answer that {condition!r} asks about.")
    return data


def _tested(person: pd.DataFrame, measure: str, against: float) -> pd.DataFrame:
    """One-sample t tests of participants' values in every level, in order; no t where there is one participant."""
    rows = []
    for level, part in person.groupby("level", observed=True, sort=True):
        if len(part) > 1:
            row = t_tests(part, measure, "participant", against=against).iloc[0].to_dict()
        else:
            row = {"n": len(part), "mean": part[measure].mean(), "estimate": part[measure].mean() - against}
        rows.append({**row, "level": str(level)})
    return pd.DataFrame(rows).reindex(columns=["level", *T_COLUMNS])


def threshold_rows(thresholds: pd.DataFrame) -> pd.DataFrame:
    """Mean threshold of every level over participants with 95 % limits, and the mean JND if there is a column jnd."""
    rows = []
    for level, part in thresholds.groupby("level", observed=True, sort=True):
        tested = t_tests(part, "threshold", "participant", against=0.0).iloc[0] if len(part) > 1 else None
        half = math.nan if tested is None else float(tested["estimate"] - tested["ci_low"])
        mean, jnd = part["threshold"].mean(), part["jnd"].abs() if "jnd" in part else pd.Series(dtype=float)
        row = {
            "part": "threshold", "level": str(level), "n": len(part), "mean": mean, "sd": part["threshold"].std(ddof=1),
            "ci_low": mean - half, "ci_high": mean + half, "jnd": jnd.mean(), "jnd_sd": jnd.std(ddof=1),
        }  # fmt: skip
        rows.append(row | {"sentence": threshold_sentence(row)})
    return pd.DataFrame(rows)


def _effects_on_thresholds(
    fits: pd.DataFrame, plan: AnalysisPlan, asked: PsychometricPlan, notes: list[str]
) -> pd.DataFrame:
    levels = {name: plan.levels[name] for name in asked.each}
    cells = {" × ".join(cell): cell for cell in product(*levels.values())}
    columns = zip(*(cells[str(cell)] for cell in fits["level"]), strict=True)
    data = pd.DataFrame({"participant": list(fits["participant"]), "threshold": list(fits["threshold"])})
    data = data.assign(**{name: list(values) for name, values in zip(asked.each, columns, strict=True)})
    try:
        table = anova(data, "threshold", "participant", within=list(asked.each), levels=levels)
    except AnalysisError as error:
        notes.append(f"The thresholds cannot be compared: {error}")
        return pd.DataFrame()
    notes += list(table.attrs["notes"])
    table["sentence"] = [apa.anova_sentence(row) for row in table.to_dict("records")]
    return table.assign(part="effect", level=table["effect"])


def proportion_sentence(row: dict[str, Any]) -> str:
    """'129 of 180, 71.7 %, 95 % CI [64.7, 77.7], exact p < .001; over participants t(11) = 4.21, p = .001'."""
    limits = f"95 % CI [{apa.number(100 * row['wilson_low'], 1)}, {apa.number(100 * row['wilson_high'], 1)}]"
    pooled = f"{row['k']} of {row['trials']}, {apa.number(100 * row['proportion'], 1)} %, {limits}"
    over = f"over participants {apa.t_sentence(row)}" if row["n"] > 1 else "one participant"
    return f"{pooled}, exact {apa.p_value(row['p_exact'])}; {over}"


def d_prime_sentence(row: dict[str, Any]) -> str:
    """'mean d′ = 1.20 (SD 0.41), t(11) = 10.1, p < .001, d = 2.9'."""
    over = apa.t_sentence(row) if row["n"] > 1 else "one participant"
    return f"mean d′ = {apa.number(row['mean'])} (SD {apa.number(row['sd'])}), {over}"


def threshold_sentence(row: dict[str, Any]) -> str:
    """'threshold 4.31, 95 % CI [3.9, 4.7], just noticeable difference 1.2 (n = 12)'."""
    mean, low, high = apa.together(row["mean"], row["ci_low"], row["ci_high"])
    limits = f", 95 % CI [{low}, {high}]"
    jnd = "" if math.isnan(row["jnd"]) else f", just noticeable difference {apa.figures(row['jnd'])}"
    return f"threshold {mean}{'' if math.isnan(row['ci_low']) else limits}{jnd} (n = {row['n']})"

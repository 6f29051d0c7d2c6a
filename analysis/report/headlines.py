"""What was found, in short: one sentence for each planned test, with its numbers."""

from __future__ import annotations

import math

import pandas as pd

from analysis.apa import anova_sentence, effect_name, number, p_value, regression_sentence, t_sentence, with_unit
from analysis.errors import listed
from analysis.planned.further_test import FurtherTest
from analysis.planned.results import ALPHA, PlannedResults, unit_decimals

MANY = 12  # pairs that are no longer told one by one
FEW = 4  # tests of one family that are told one by one


def _direction(results: PlannedResults, effect: str) -> list[str]:
    """'F1 < M1, F2 < M1 (Tukey).' for a main effect of more than two levels."""
    pairs = results.posthoc[(results.posthoc["effect"] == effect) & (results.posthoc["p"] < ALPHA)]
    if ":" in effect:
        return []
    if not len(pairs):
        return [f"No pair of levels of {effect} differs after correction."] if len(results.posthoc) else []
    if len(pairs) > MANY:
        count = int((results.posthoc["effect"] == effect).sum())
        return [f"{effect.capitalize()}: {len(pairs)} of {count} pairs of levels differ after correction."]
    words = [f"{r.a} < {r.b}" if r.estimate < 0 else f"{r.b} < {r.a}" for r in pairs.itertuples()]
    adjust = {"tukey": "Tukey", "bonferroni": "Bonferroni", "holm": "Holm"}.get(
        str(results.plan.adjust), "no correction"
    )
    return [f"{effect.capitalize()}, pairs that differ ({adjust}): {', '.join(words)}."]


def headlines(results: PlannedResults) -> list[str]:
    """What was found, each with its test: the significant effects, then the t tests."""
    plan, found = results.plan, []
    if len(results.anova):
        for row in results.anova.to_dict("records"):
            if row["p_gg"] < ALPHA:
                what = "interaction" if ":" in row["effect"] else "effect"
                found.append(f"{plan.label}: {what} of {effect_name(row['effect'])}, {anova_sentence(row)}.")
                found += _direction(results, row["effect"])
        rest = [r for r in results.anova.to_dict("records") if not r["p_gg"] < ALPHA and ":" not in r["effect"]]
        if rest:
            tests = "; ".join(f"{r['effect']}, {anova_sentence(r)}" for r in rest if math.isfinite(r["F"]))
            found += [f"No evidence of an effect of {tests}."] if tests else []
            flat = [r["effect"] for r in rest if not math.isfinite(r["F"])]
            found += [f"{plan.label}: no test of {listed(flat)}, as there is no variance."] if flat else []
        interactions = results.anova.loc[results.anova["effect"].str.contains(":"), "F"]
        if interactions.notna().any() and not any(":" in effect for effect in results.significant):
            found.append("No interaction was significant.")
    decimals = unit_decimals(results)
    for row in results.ttests.to_dict("records"):
        if not math.isfinite(row["t"]):
            found.append(
                f"{row['factor'].capitalize()} {row['level']}: mean {number(row['mean'], decimals)}, not testable "
                f"against the {row['reference']} of {number(row['against'], decimals)}: everybody has the same mean."
            )
            continue
        side = "not shown to differ from" if not row["p"] < ALPHA else "below" if row["estimate"] < 0 else "above"
        found.append(
            f"{row['factor'].capitalize()} {row['level']}: mean {number(row['mean'], decimals)}, {side} the "
            f"{row['reference']} of {number(row['against'], decimals)}, {t_sentence(row)}."
        )
    for test in results.further:
        found += _further(test, results)
    if len(results.normality) and results.normality["p"].iloc[0] < ALPHA:
        w, p = results.normality["w"].iloc[0], results.normality["p"].iloc[0]
        found.append(f"The residuals are not normal (Shapiro–Wilk W = {w:.3f}, {p_value(p)}).")
    for other in results.also:
        found += [_of(other.plan.label, sentence) for sentence in headlines(other)]
    return found


def _of(label: str, sentence: str) -> str:
    return sentence if sentence.startswith(label) else f"{label}: {sentence[:1].lower()}{sentence[1:]}"


def _comparison(label: str, what: str, factor: str, each: str, where: str, part: pd.DataFrame) -> list[str]:
    """One sentence per test of a small family; of a large one, how many differ."""
    if len(part) <= FEW:
        return [f"{label}, {what.removesuffix('s')}: {sentence}." for sentence in part["sentence"]]
    inside = f" inside every {each}" if each else ""
    trials = f" in trials with {where}" if where else ""
    low = int((part["p"] < ALPHA).sum())
    return [f"{label}, {what} of {factor}{inside}{trials}: {low} of {len(part)} differ with p < .05."]


def _shares(label: str, part: pd.DataFrame) -> list[str]:
    """One sentence per share of a few; of many, where they lie above and below chance."""
    if len(part) <= FEW:
        heads = [", ".join(filter(None, [label, str(level)])) for level in part["level"]]
        return [f"{head}: {sentence}." for head, sentence in zip(heads, part["sentence"], strict=True)]
    low = part["p"] < ALPHA
    found = {
        "above chance": part.loc[low & (part["estimate"] > 0), "level"],
        "below chance": part.loc[low & (part["estimate"] < 0), "level"],
        "not shown to differ from chance": part.loc[part["p"] >= ALPHA, "level"],
        "not testable": part.loc[part["p"].isna(), "level"],
    }
    told = [f"{what}: {', '.join(levels)}" for what, levels in found.items() if len(levels)]
    return [f"{label} (t tests over participants), {'; '.join(told)}."]


def _of_choices(test: FurtherTest, results: PlannedResults) -> list[str]:
    """Sentences of the tests of choices and of pairs, with what each is about."""
    plan, rows = results.plan, test.table.to_dict("records")
    if test.kind == "comparisons":
        families = test.table[test.table["test"] != "Welch"].groupby(["factor", "each", "where"], sort=False)
        return [
            s for (of, by, where), part in families for s in _comparison(plan.label, "t tests", of, by, where, part)
        ]
    if test.kind == "pairs":
        families = test.table.groupby(["factors", "by"], sort=False)
        return [s for (of, by), part in families for s in _comparison(plan.label, "planned pairs", of, by, "", part)]
    if test.kind == "proportions":
        return [s for label, part in test.table.groupby("label", sort=False) for s in _shares(str(label), part)]
    name = {"d_prime": "Sensitivity", "psychometric": "Psychometric function", "adaptive": "Adaptive tracks"}[test.kind]
    heads = [", ".join(filter(None, [name, effect_name(str(row["level"]))])) for row in rows]
    return [f"{head}: {row['sentence']}." for head, row in zip(heads, rows, strict=True)]


def _further(test: FurtherTest, results: PlannedResults) -> list[str]:
    plan, table = results.plan, test.table
    if test.kind in ("comparisons", "pairs", "proportions", "d_prime", "psychometric", "adaptive"):
        return _of_choices(test, results)
    if test.kind == "equivalence":
        found = []
        for (factor, by), part in table.groupby(["factor", "by"], sort=False):
            inside = f" inside every {by}" if by else ""
            bound = with_unit(f"±{part['upper_bound'].iloc[0]:g}", plan.unit)
            same, worst = int(part["equivalent"].sum()), part["p"].max(skipna=False)
            largest = f"largest {p_value(worst)}" if math.isfinite(worst) else "no p without variance"
            verdict = "all levels are equivalent" if same == len(part) else "equivalence of all levels is not shown"
            found.append(
                f"{plan.label} over {factor}{inside}: {verdict} within {bound} "
                f"({same} of {len(part)} pairs, {largest})."
            )
        return found
    if test.kind == "regression" and plan.regression is not None:
        names = ", ".join(plan.regression.on)
        return [f"{plan.label} of every {plan.regression.of} on {names}: {regression_sentence(test.facts)}."]
    name = {"aligned_rank_transform": "aligned ranks", "mixed_model": "mixed model"}[test.kind]
    rows = table[table["part"] == "effect"] if "part" in table else table
    key = "term" if "part" in table else "effect"
    low = [f"{effect_name(row[key])}, {row['sentence']}" for row in rows.to_dict("records") if row["p"] < ALPHA]
    none = "no effect is significant" if rows["p"].notna().any() else "not testable: no variance"
    return [f"{plan.label}, {name}: {'; '.join(low) if low else none}."]

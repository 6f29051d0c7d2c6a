"""The paragraphs of the report: who took part, what was done, and what the checks say."""

from __future__ import annotations

import math
from dataclasses import replace

from analysis.apa import degrees, mid_sentence, number, p_value, share, with_unit
from analysis.errors import listed
from analysis.planned.plan import AnalysisPlan
from analysis.planned.results import ALPHA, PlannedResults
from analysis.recorded.answers import readable
from analysis.report.values import ADJUSTED
from analysis.statistics.normal_test import sampled

WAYS = {1: "one", 2: "two", 3: "three", 4: "four", 5: "five", 6: "six"}


def simulated_sentence(results: PlannedResults) -> str:
    """Says that nobody was there; empty when everybody was."""
    count, total = results.simulated, len(results.recorded.runs)
    if not count:
        return ""
    if count == total:
        return (
            f"Simulated participants: all {total} runs come from simulated observers, not from people. "
            "The numbers show that the study and its analysis work; they say nothing about perception."
        )
    return f"{count} of the {total} participants are simulated observers, not people. Do not report these results."


def participants_paragraph(results: PlannedResults) -> str:
    """Who took part: how many, of how many planned, of which groups and what age."""
    plan, runs = results.plan, results.recorded.runs
    n = len(runs)
    words = f"{n} participant{'s' if n != 1 else ''} finished the study"
    if plan.planned:
        words += f" ({plan.planned} were planned)"
    words += "."
    for name in plan.between:
        counts = [(level, sum(str(run.answers.get(name)) == level for run in runs)) for level in plan.levels[name]]
        words += f" {name.capitalize()}: {listed(f'{count} {level}' for level, count in counts)}."
    ages = [float(run.answers["age"]) for run in runs if _is_number(run.answers.get("age"))]
    if len(ages) > 1:
        mean = sum(ages) / len(ages)
        sd = math.sqrt(sum((age - mean) ** 2 for age in ages) / (len(ages) - 1))
        words += f" Mean age {mean:.1f} years (SD {sd:.1f}, range {min(ages):.0f}–{max(ages):.0f})."
    if results.means is not None and len(results.means.subjects) < n:
        words += f" The analysis of variance rests on {len(results.means.subjects)} of them."
    return words


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def methods_paragraphs(results: PlannedResults) -> list[str]:
    """As they could stand in a Methods section: the analysis of variance, then the other tests; only what was run."""
    plan = _carried_out(results)
    first = _anova_methods(results) if plan.within or plan.between else []
    words: list[str] = []
    for test in plan.t_tests:
        words.append(
            f"For each {test.each}, participants' mean {mid_sentence(plan.label)}"
            + (f" in trials with {test.where}" if test.where else "")
            + f" was compared with the {test.label} in a "
            "two-sided one-sample t test; these p values are not corrected for their number."
        )
    words += choice_methods(plan)
    for same in plan.equivalence:
        inside = f" inside every level of {same.by}" if same.by else ""
        words.append(
            f"Whether {mid_sentence(plan.label)} is the same at all levels of {same.factor}{inside} was tested with "
            f"two one-sided tests of every pair, with bounds of {with_unit(f'±{same.bound:g}', plan.unit)}."
        )
    if plan.regression is not None:
        words.append(
            f"The mean {mid_sentence(plan.label)} of every {plan.regression.of} was regressed on "
            f"{listed(plan.regression.on)} (ordinary least squares)."
        )
    if plan.rank_transform is not None:
        factors = listed((*plan.rank_transform.within, *plan.rank_transform.between))
        words.append(f"An aligned rank transform with {factors} was run, followed up by ART-C with Holm's correction.")
    if plan.mixed_model is not None:
        words.append(
            f"A linear mixed model of single trials had the fixed factors {listed(plan.mixed_model.factors)} with all "
            f"interactions and crossed random intercepts of participants and {plan.mixed_model.stimulus} "
            "(REML, Satterthwaite degrees of freedom)."
        )
    if plan.normality and results.means is not None:
        first.append("Normality was assessed with Shapiro–Wilk tests of the residuals and of every cell.")
    if plan != results.plan and not words and not first:
        return ["None of the planned tests could be run."]
    return [" ".join(part) for part in (first, words) if part] or ["The study file plans no test."]


def _carried_out(results: PlannedResults) -> AnalysisPlan:
    """The plan without the tests that could not be run, of which a Methods section says nothing."""
    plan, ran = results.plan, {test.kind for test in results.further}
    tested = set(zip(results.ttests["factor"], results.ttests["reference"], strict=True))
    tables = [test.table for test in results.further if test.kind == "comparisons"]
    compared = {row for one in tables for row in one[["factor", "each", "where"]].itertuples(index=False, name=None)}
    return replace(
        plan,
        within=plan.within if results.means is not None else (),
        between=plan.between if results.means is not None else (),
        t_tests=tuple(test for test in plan.t_tests if (test.each, test.label) in tested),
        comparisons=tuple(t for t in plan.comparisons if (t.factor or "", t.each or "", t.where or "") in compared),
        pairs=plan.pairs if "pairs" in ran else (),
        proportions=plan.proportions if "proportions" in ran else (),
        d_prime=plan.d_prime if "d_prime" in ran else None,
        psychometric=plan.psychometric if "psychometric" in ran else None,
        equivalence=plan.equivalence if "equivalence" in ran else (),
        regression=plan.regression if "regression" in ran else None,
        rank_transform=plan.rank_transform if "aligned_rank_transform" in ran else None,
        mixed_model=plan.mixed_model if "mixed_model" in ran else None,
    )


def choice_methods(plan: AnalysisPlan) -> list[str]:
    """Sentences on the t tests of pairs, planned pairs, proportions, d' and psychometric functions of a plan."""
    words = []
    for test in plan.comparisons:
        inside = f" in every {test.each}" if test.each else ""
        trials = f" in trials with {test.where}" if test.where else ""
        how = {
            "paired": f"compared between all pairs of levels of {test.factor} in paired t tests",
            "independent": f"compared between the groups of {test.factor} in Student's and Welch's t tests",
            "against": f"compared with the {test.label} of {test.against or 0.0:g} in a one-sample t test",
        }[test.kind]
        words.append(
            f"Participants' mean {mid_sentence(plan.label)}{trials} was {how}{inside} (two-sided, uncorrected)."
        )
    for pairs in plan.pairs:
        inside = f" inside every {listed(pairs.by)}" if pairs.by else ""
        words.append(
            f"Planned comparisons of {listed(pairs.factors)}{inside} used estimated marginal means "
            f"({pairs.model} model, {ADJUSTED.get(pairs.adjust, 'p uncorrected')})."
        )
    for share_of in plan.proportions:
        inside = f" in every {listed(share_of.each)}" if share_of.each else ""
        words.append(
            f"The share of trials with {readable(share_of.success)}{inside} was tested against {share_of.chance:g} "
            "with an exact binomial test of all trials and a t test of participants' shares."
        )
    if plan.d_prime is not None:
        inside = f" in every {listed(plan.d_prime.each)}" if plan.d_prime.each else ""
        words.append(
            f"Sensitivity d′ was computed for every participant{inside} (signal: {readable(plan.d_prime.signal)}; "
            f"yes: {readable(plan.d_prime.answer)}; log-linear rule) and tested against 0."
        )
    if plan.psychometric is not None:
        inside = f" and {listed(plan.psychometric.each)}" if plan.psychometric.each else ""
        words.append(
            f"A psychometric function of {plan.psychometric.level} was fitted to the trials of every "
            f"participant{inside} by maximum likelihood, and thresholds were compared over participants."
        )
    return words


def _anova_methods(results: PlannedResults) -> list[str]:
    plan = results.plan
    n = "" if results.means is None else f" (n = {len(results.means.subjects)})"
    design = []
    for kind, names in (("within-participant", plan.within), ("between-participant", plan.between)):
        if names:
            sizes = [f"{name} ({', '.join(plan.levels[name])})" for name in names]
            design.append(f"the {kind} factor{'s' if len(names) > 1 else ''} {listed(sizes)}")
    factors = len(plan.within) + len(plan.between)
    words = [
        f"{plan.label} was averaged over the trials of each participant and cell and submitted to a "
        f"{WAYS.get(factors, str(factors))}-way {'mixed ' if plan.within and plan.between else ''}"
        f"analysis of variance{n} with {' and '.join(design)}.",
        "Sums of squares are type III.",
    ]
    if any(len(plan.levels[name]) > 2 for name in plan.within):
        words.append(
            "Greenhouse–Geisser corrected degrees of freedom and p values are reported for every "
            "effect whose "
            "within-participant part has more than one degree of freedom, whatever Mauchly's test says."
        )
    words.append("Effect sizes are partial eta squared (ηp²) with 90 % limits from the noncentral F distribution.")
    if plan.adjust is not None:
        correction = {"tukey": "Tukey-adjusted", "bonferroni": "Bonferroni-adjusted", "holm": "Holm-adjusted"}
        words.append(
            f"Effects with p < {share(ALPHA)} were followed by "
            f"{correction.get(plan.adjust, 'unadjusted')} pairwise "
            f"comparisons of estimated marginal means ({plan.model} model, groups weighted equally), "
            f"one family "
            "per effect."
        )
    return words


def sphericity_sentence(results: PlannedResults) -> str:
    """What Mauchly's test says of the effects it applies to; nothing where it applies to none."""
    tested = results.anova[results.anova["mauchly_p"].notna()] if len(results.anova) else results.anova
    if not len(tested):
        return ""
    low = tested[tested["mauchly_p"] < ALPHA]
    if not len(low):
        if len(tested) == 1:
            row = tested.iloc[0]
            return f"Sphericity: Mauchly's test does not reject it for {row['effect']} ({p_value(row['mauchly_p'])})."
        return f"Sphericity: Mauchly's test rejects for none of the {len(tested)} testable effects."
    found = [f"{row.effect.replace(':', ' × ')} ({p_value(row.mauchly_p)})" for row in low.itertuples()]
    return (
        f"Sphericity: Mauchly's test rejects for {listed(found, 20)}. The correction is applied to "
        f"every effect "
        "it can concern, not only to these."
    )


def normality_sentence(results: PlannedResults) -> str:
    """What Shapiro–Wilk says of the residuals and of the cells; nothing where it was not run."""
    table = results.normality
    if not len(table) or not math.isfinite(table["p"].iloc[0]):
        return ""
    first, cells = table.iloc[0], table.iloc[1:]
    tested, low = int(cells["p"].notna().sum()), int((cells["p"] < ALPHA).sum())
    verdict = "deviate from a normal distribution" if first["p"] < ALPHA else "show no deviation from normality"
    return (
        f"Normality: the residuals {verdict} (Shapiro–Wilk W = {first['w']:.3f}, {p_value(first['p'])}, n = "
        f"{int(first['n'])}). Of {tested} cells tested one by one, {low} "
        f"{'has' if low == 1 else 'have'} p < .05; "
        f"{number(tested * ALPHA, 1)} would be expected by chance alone."
        + "".join(f" {note}" for note in sampled(int(first["n"])))
    )


def other_checks(results: PlannedResults) -> list[str]:
    """Equal variances, outlying cells, learning and anchoring, a sentence each; all of it is in assumptions.csv."""
    table, found = results.assumptions, []
    levene = table[(table["check"] == "Levene (median)") & table["p"].notna()]
    if len(levene) == 1 and not results.plan.within:
        row = levene.iloc[0]
        found.append(
            f"Equal variances of the groups: Levene's test (from the median) "
            f"{'rejects' if row['p'] < ALPHA else 'does not reject'} them, "
            f"F({degrees(row['df1'])}, {degrees(row['df2'])}) = {number(row['statistic'])}, {p_value(row['p'])}."
        )
    elif len(levene):
        low = levene[levene["p"] < ALPHA]
        found.append(
            f"Equal variances of the groups: Levene's test (from the median) has p < .05 in {len(low)} of "
            f"{len(levene)} within-participant cells."
        )
    outliers = table.loc[table["check"] == "outlier", "where"]
    found.append(
        f"Outliers: {listed(outliers)} lie more than 3 standard deviations from the mean of their group and cell; "
        "they were kept."
        if len(outliers)
        else "Outliers: no participant's cell mean lies more than 3 standard deviations from that of the group."
    )
    for check, name in (("learning", "Learning"), ("anchoring", "Anchoring to the start value")):
        for row in table[(table["check"] == check) & table["p"].notna()].to_dict("records"):
            verdict = "found" if row["p"] < ALPHA else "not found"
            found.append(
                f"{name}: {verdict}, {with_unit(row['note'], results.plan.unit)}, t({degrees(row['df2'])}) = "
                f"{number(row['statistic'])}, {p_value(row['p'])}."
            )
    return found

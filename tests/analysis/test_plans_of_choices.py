"""Proportions, d', psychometric functions, t tests of pairs and gaze shares are planned, run, written and reported.

The data are simulated by the study file choosing.yaml: observers who choose the faster of two with known shares.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from analysis import analyse, d_prime, emmeans, pairwise, proportions, psychometric, t_tests
from analysis.errors import AnalysisError
from analysis.planned.plan import plan_of
from analysis.recorded.answers import answers, readable
from analysis.recorded.gait_measures import gaze_rows
from analysis.recorded.trials import used_trials
from experiment_app.simulated.simulate import simulate
from protocols.mistakes.consistency import inconsistencies
from protocols.study_file import StudyFileError, parse_study

STUDY = Path(__file__).with_name("choosing.yaml")
TRUTH = {0.8: 0.08, 0.9: 0.25, 1.0: 0.5, 1.1: 0.75, 1.2: 0.92}


@pytest.fixture(scope="module")
def analysed(tmp_path_factory):
    file = parse_study("choosing.yaml", STUDY.read_text(encoding="utf-8"))
    assert inconsistencies(file.study) == []
    data, out = tmp_path_factory.mktemp("data"), tmp_path_factory.mktemp("out")
    for _ in simulate(file, 12, data, seed=0):
        pass
    return out, analyse(data / "faster", out), data / "faster"


def read(analysed, name: str) -> pd.DataFrame:
    return pd.read_csv(analysed[0] / name, dtype={"level": str}, keep_default_na=False, na_values=[""])


def test_every_test_of_choices_has_table_sentence_section_and_figure(analysed):
    out, outcome, _ = analysed
    page = (out / "report.html").read_text(encoding="utf-8")
    assert re.search(r"\bnan\b", page) is None
    sections = {"comparisons": "t tests", "pairs": "Planned pairs", "proportions": "Proportions against chance",
                "d_prime": "Sensitivity d′", "psychometric": "Psychometric functions"}  # fmt: skip
    for name, title in sections.items():
        assert f"<h2>{title}</h2>" in page
        sentences = read(analysed, f"{name}.csv")["sentence"]
        assert sentences.notna().all()
        assert sentences[0].replace("<", "&lt;") in page
    for figure in ("proportions", "psychometric"):
        assert (out / f"{figure}.svg").stat().st_size > 5000
    assert "All checks of assumptions" in page
    assert outcome.warnings == ()


def test_all_answers_together_are_counted_as_r_counts_them(analysed):
    trials, table = read(analysed, "trials.csv"), read(analysed, "proportions.csv")
    for row in table[table["label"] == "Test chosen"].to_dict("records"):
        chosen = trials[trials["comparison"] == float(row["level"])]["chosen"] == "test"
        assert (row["k"], row["trials"]) == (chosen.sum(), len(chosen))
        exact = stats.binomtest(int(row["k"]), int(row["trials"]), 0.5)
        assert row["p_exact"] == pytest.approx(exact.pvalue, rel=1e-9)
        assert row["wilson_low"] == pytest.approx(exact.proportion_ci(method="wilson").low, rel=1e-9)


def test_shares_are_tested_over_participants_so_that_trials_are_not_people(analysed):
    trials, table = read(analysed, "trials.csv"), read(analysed, "proportions.csv")
    person = trials[trials["comparison"] == 1.1].groupby("participant")["chosen"].agg(lambda c: (c == "test").mean())
    wanted = stats.ttest_1samp(person, 0.5)
    row = table[(table["label"] == "Test chosen") & (table["level"] == "1.1")].iloc[0]
    assert (row["t"], row["p"]) == pytest.approx((wanted.statistic, wanted.pvalue), rel=1e-9)
    assert row["n"] == 12


def test_what_the_simulated_observers_do_is_found_again(analysed):
    table = read(analysed, "proportions.csv")
    shares = table[table["label"] == "Test chosen"].set_index("level")
    for level, share in TRUTH.items():
        row = shares.loc[f"{level:.1f}"]
        # 99.9 % limits of 192 trials, widened by the spread between observers (s.d. 0.3 logit)
        assert row["proportion"] == pytest.approx(share, abs=3.3 * np.sqrt(share * (1 - share) / 192) + 0.05)
    thresholds = read(analysed, "psychometric.csv")
    assert thresholds[thresholds["part"] == "threshold"]["mean"].to_numpy() == pytest.approx(1.0, abs=0.04)


def test_the_tables_are_those_of_the_functions(analysed):
    trials = read(analysed, "trials.csv").assign(yes=lambda t: (t["chosen"] == "test") * 1.0)
    mine = d_prime(trials.assign(signal=(trials["comparison"] > 1.0) * 1), "signal", "yes", by=["actor", "participant"])
    written = read(analysed, "d_prime_participants.csv")
    assert written["d_prime"].to_numpy() == pytest.approx(mine["d_prime"].to_numpy(), rel=1e-9)
    fits = psychometric(trials, "comparison", "yes", by=["participant", "actor"], shape="normal")
    assert read(analysed, "psychometric_fits.csv")["threshold"].to_numpy() == pytest.approx(fits["threshold"], rel=1e-8)
    pairs = read(analysed, "comparisons.csv")
    paired = t_tests(trials, "confusion_rate", "participant", paired="comparison", each="actor")
    assert pairs[pairs["each"] == "actor"]["t"].to_numpy() == pytest.approx(paired["t"].to_numpy(), rel=1e-9)
    wide = trials.groupby(["participant", "actor"])["confusion_rate"].mean().unstack()
    assert pairs["t"][0] == pytest.approx(stats.ttest_rel(wide["F1"], wide["M1"]).statistic, rel=1e-9)
    groups = trials.groupby(["viewing", "participant"])["confusion_rate"].mean()
    welch = stats.ttest_ind(groups["screen"], groups["headset"], equal_var=False)
    assert pairs[pairs["test"] == "Welch"]["p"].to_numpy() == pytest.approx(welch.pvalue, rel=1e-9)
    simple = pairwise(
        trials, "confusion_rate", "participant", ["actor", "comparison"], "viewing", factors="comparison", by="actor",
        adjust="holm",
    )  # fmt: skip
    planned = read(analysed, "pairs.csv")
    assert planned[planned["by"] == "actor"]["p"].to_numpy() == pytest.approx(simple["p"].to_numpy(), rel=1e-7)
    means = read(analysed, "marginal_means.csv")
    wanted = emmeans(trials, "confusion_rate", "participant", ["actor", "comparison"], "viewing", factors="comparison")
    assert means[means["effect"] == "comparison"]["emmean"].to_numpy() == pytest.approx(wanted["emmean"], rel=1e-9)


def test_the_pooled_share_is_the_proportion_function(analysed):
    trials = read(analysed, "trials.csv").assign(yes=lambda t: t["correct"])
    mine = proportions(trials, "yes", by=["actor", "viewing"]).set_index(["actor", "viewing"])
    table = read(analysed, "proportions.csv")
    row = table[(table["label"] == "Standard chosen") & (table["level"] == "F1 × screen")].iloc[0]
    assert row["proportion"] == pytest.approx(mine.loc[("F1", "screen"), "proportion"], rel=1e-12)


def test_the_same_journals_give_the_same_bytes(analysed, tmp_path):
    out, outcome, data = analysed
    again = analyse(data, tmp_path)
    assert [p.name for p in again.paths] == [p.name for p in outcome.paths]
    for path in again.paths:
        assert path.read_bytes() == (out / path.relative_to(tmp_path)).read_bytes(), path.name


@pytest.mark.parametrize(
    ("condition", "wanted"),
    [
        ("chosen == a", [1.0, 0.0, np.nan]),
        ("chosen != $original", [0.0, 1.0, np.nan]),
        ("rating >= 2", [0.0, 1.0, 1.0]),
        ("level == 0.80", [1.0, 0.0, 0.0]),
    ],
)
def test_answers_are_read_from_conditions(condition, wanted):
    trials = pd.DataFrame(
        {"chosen": ["a", "b", None], "original": ["a", "a", "a"], "rating": [1, 2, 3.5], "level": [0.8, 1.0, 1.2]}
    )
    assert answers(trials, condition).tolist() == pytest.approx(wanted, nan_ok=True)


def test_a_condition_on_no_column_is_a_sentence():
    with pytest.raises(AnalysisError, match="cannot be read; write a column, a comparison and a value"):
        answers(pd.DataFrame({"chosen": ["a"]}), "chose == a")


def test_conditions_are_written_for_people_to_read():
    assert readable("chosen != $original") == "chosen ≠ original"
    assert readable("rating >= 3") == "rating ≥ 3"


WRONG = {
    "t_tests: [{paired: actr}]": "did you mean actor?",
    "t_tests: [{paired: actor, independent: viewing}]": "one of against, paired and independent",
    "t_tests: [{each: actor}]": "one of against, paired and independent",
    "t_tests: [{paired: viewing}]": "viewing is no within factor",
    "t_tests: [{paired: actor, each: actor}]": "is the factor compared",
    "t_tests: [{against: {F1: 50}}]": "need each",
    "t_tests: [{each: actor, against: {F1: 50, M3: 50}}]": "M3 is no level of actor",
    "proportions: [{success: chosen}]": "is no condition",
    "proportions: [{success: choosen == test}]": "did you mean chosen?",
    "proportions: [{success: chosen == test, each: sped}]": "sped is no factor",
    "proportions: [{success: chosen == test, chance: 1.5}]": "less than 1",
    "d_prime: {signal: comparison > 1, answer: chose == test}": "did you mean chosen?",
    "psychometric: {level: actor, success: chosen == test}": "which is no number",
    "psychometric: {level: comparison, success: chosen == test, each: comparison}": "leave it out",
    "pairs: [{factors: actor, by: actor}]": "is a factor compared",
    "pairs: [{factors: actr}]": "actr is no factor of the anova",
    "figures: [{kind: psychometric}]": "needs psychometric in this analysis",
    "measure: walk_ratio": "is not what choice trials give",
}


@pytest.mark.parametrize("part", WRONG)
def test_mistakes_in_tests_of_choices_are_found_before_anyone_sits_down(part):
    text = STUDY.read_text(encoding="utf-8")
    start, end = text.index("analysis:"), text.index("simulation:")
    measure = "" if part.startswith("measure") else "  measure: confusion_rate\n"
    text = f"{text[:start]}analysis:\n{measure}  anova: {{within: [actor]}}\n  {part}\n{text[end:]}"
    try:
        found = [mistake.message for mistake in inconsistencies(parse_study("x.yaml", text).study)]
    except StudyFileError as error:
        found = [str(error)]
    assert any(WRONG[part] in message for message in found), found


GAZE = pd.DataFrame(
    {
        "participant": ["a", "a", "b", "b"], "trial": [1, 2, 1, 2],
        "measured_gaze_legs": [50.0, 60.0, 40.0, np.nan], "measured_gaze_arms": [20.0, 10.0, 20.0, np.nan],
        "measured_gaze_torso": [10.0, 10.0, 20.0, np.nan], "measured_gaze_head": [10.0, 10.0, 10.0, np.nan],
        "measured_gaze_elsewhere": [10.0, 10.0, 10.0, np.nan],
    }
)  # fmt: skip
PLAN = {
    "factors": {"actor": ["F1"]},
    "analysis": {"measure": "gaze_share", "anova": {"within": ["region"]}, "t_tests": [{"paired": "region"}]},
}


def test_gaze_shares_become_a_within_factor_of_regions():
    plan = plan_of(PLAN)
    assert plan.levels["region"] == ("legs", "arms", "torso", "head", "elsewhere")
    rows = used_trials(GAZE, plan)
    assert len(rows) == 3 * 5  # the trial without gaze is left out
    shares = rows.groupby(["participant", "region"], observed=True)["gaze_share"].mean()
    assert shares["a", "legs"] == 55.0
    assert shares["b", "torso"] == 20.0
    paired = t_tests(rows, "gaze_share", "participant", paired="region", levels={"region": plan.levels["region"]})
    assert paired.loc[0, ["a", "b"]].tolist() == ["legs", "arms"]
    # a: 55 - 15 = 40, b: 40 - 20 = 20; mean 30, s.d. 14.142, t = 30 / (14.142 / sqrt 2) = 3
    assert paired.loc[0, "t"] == pytest.approx(3.0)


def test_gaze_shares_without_an_eye_tracker_are_a_sentence():
    with pytest.raises(AnalysisError, match="No gaze was recorded"):
        gaze_rows(pd.DataFrame({"participant": ["a"]}), ["legs"])


def test_a_study_without_an_eye_tracker_is_analysed_all_the_same_and_says_so(analysed, tmp_path):
    from tests.analysis.recorded import study_text, write_study

    gaze = "measure: gaze_share, label: Gaze, unit: '%', anova: {within: [region]}, figures: [{kind: means, x: region}]"
    also = f"  also: [{{{gaze}}}]\n"
    text = study_text().replace("  exclusions: []", f"{also}  exclusions: []")
    assert inconsistencies(parse_study("s.yaml", text).study) == []
    outcome = analyse(write_study(tmp_path / "walk_ratio", 6, text), tmp_path / "out")
    assert any("No gaze was recorded" in warning for warning in outcome.warnings)
    assert len(pd.read_csv(tmp_path / "out" / "anova.csv")) == 15


@pytest.mark.parametrize(
    ("people", "confusion"), [(1, "{$comparison: {0.8: 0.1, 0.9: 0.3, 1.0: 0.5, 1.1: 0.7, 1.2: 0.9}}"), (4, "1.0")]
)
def test_one_participant_and_participants_who_all_answer_alike_are_still_described(people, confusion, tmp_path):
    text = re.sub(r"confusion: \{.*", f"confusion: {confusion}", STUDY.read_text(encoding="utf-8"))
    for _ in simulate(parse_study("s.yaml", text), people, tmp_path):
        pass
    outcome = analyse(tmp_path / "faster", tmp_path / "out")
    assert any("cannot be run" in warning for warning in outcome.warnings)
    shares = pd.read_csv(tmp_path / "out" / "proportions.csv")
    assert shares["trials"].sum() == 80 * people * 2
    assert shares["t"].isna().all()
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert re.search(r"\bnan\b", page) is None


def test_every_test_has_a_table_for_latex(analysed, tmp_path):
    text = (analysed[0] / "tables.tex").read_text(encoding="utf-8")
    for caption in ("t tests", "planned pairs", "proportions against chance", "sensitivity", "thresholds of the psych"):
        assert f"\\caption{{Test chosen: {caption}" in text
    assert len(re.findall(r"\\begin\{(tabular|longtable)\}", text)) == 8
    tables = re.findall(r"\\begin\{(?:tabular|longtable)\}\{@\{\}(.*?)(r+)@\{\}\}(.*?)\\end\{", text, re.S)
    assert len(tables) == 8
    for texts, numbers, body in tables:
        rows = [row for row in body.splitlines() if row.endswith(r"\\") and not row.startswith(r"\caption")]
        assert {row.count("&") for row in rows} == {len(numbers) + (texts.count("p{") or len(texts)) - 1}


def test_recorded_gaze_shares_are_analysed_part_by_part(tmp_path):
    from tests.analysis.recorded import study_text, write_study
    from tests.journals import rewrite

    gaze = "measure: gaze_share, label: Looking time, unit: '%', anova: {within: [region]}, t_tests: [{paired: region}]"
    text = study_text().replace("  exclusions: []", f"  also: [{{{gaze}}}]\n  exclusions: []")
    data = write_study(tmp_path / "walk_ratio", 8, text)
    rng = np.random.default_rng(4)
    names = ("legs", "arms", "torso", "head", "elsewhere")

    def looked(records: list[dict]) -> list[dict]:
        for record in records:
            if record["kind"] == "trial":
                shares = rng.dirichlet([50, 17, 12, 8, 13]) * 100  # near the published 49.7, 17.2, 11.9, 7.9, 13.3 %
                record["measured"] |= {f"gaze_{n}": float(s) for n, s in zip(names, shares, strict=True)}
        return records

    for path in data.rglob("journal.jsonl"):
        rewrite(path, looked)
    outcome = analyse(data, tmp_path / "out")
    assert not any("gaze" in warning.lower() for warning in outcome.warnings)
    means = pd.read_csv(tmp_path / "out" / "gaze_share" / "descriptives.csv").set_index("region")["mean"]
    assert means["legs"] == pytest.approx(50.0, abs=1.0)
    assert means.sum() == pytest.approx(100.0, abs=1e-6)
    pairs = pd.read_csv(tmp_path / "out" / "gaze_share" / "comparisons.csv")
    assert pairs.loc[0, ["a", "b"]].tolist() == ["legs", "arms"]
    assert (pairs["df"] == 7).all()

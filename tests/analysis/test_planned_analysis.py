"""From recorded runs to tables, figures and a report."""

from __future__ import annotations

import csv
import math
import re
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from analysis import AnalysisError, anova, apa
from analysis.planned.plan import plan_of, read_plan
from analysis.planned_analysis import AnalysisOutcome, analyse
from analysis.recorded.exclusions import matching, selected
from analysis.recorded.journal import read_journal, read_study
from tests.analysis.recorded import PERCEIVED, journal_lines, study_text, write_run, write_study
from tests.analysis.typesetting import needs_latex, too_wide
from tests.journals import rechained, rewrite


@pytest.fixture(scope="module")
def analysed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path, AnalysisOutcome]:
    data = write_study(tmp_path_factory.mktemp("data") / "walk_ratio", 12)
    out = tmp_path_factory.mktemp("out")
    return data, out, analyse(data, out)


def test_every_file_is_written_and_named(analysed: tuple[Path, Path, AnalysisOutcome]) -> None:
    _, out, outcome = analysed
    names = {path.name for path in outcome.paths}
    assert names | {".gaitlab-report.json"} == {path.name for path in out.iterdir()}
    assert names >= {
        "trials.csv", "cell_means.csv", "anova.csv", "posthoc.csv", "ttests.csv", "normality.csv",
        "report.html",
        "means_actor.png", "means_actor.svg", "interaction_actor_sex.svg", "interaction_actor_speed.png",
    }  # fmt: skip


def test_the_same_journals_give_the_same_bytes(analysed: tuple[Path, Path, AnalysisOutcome], tmp_path: Path) -> None:
    data, out, _ = analysed
    analyse(data, tmp_path)
    for path in sorted(out.iterdir()):
        assert path.read_bytes() == (tmp_path / path.name).read_bytes(), path.name


def test_the_trials_table_is_tidy_and_leads_to_the_same_anova(
    analysed: tuple[Path, Path, AnalysisOutcome],
) -> None:
    _, out, _ = analysed
    with (out / "trials.csv").open(newline="", encoding="utf-8") as file:
        assert next(csv.reader(file))[:11] == [
            "study", "participant", "run", "age", "sex", "vision",
            "trial", "block", "repetition", "actor", "speed",
        ]  # fmt: skip
    assert b"\r\n" in (out / "trials.csv").read_bytes()
    trials = pd.read_csv(out / "trials.csv")
    assert len(trials) == 12 * 96
    mine = anova(trials, "walk_ratio", "participant", ["actor", "speed", "start"], "sex")
    written = pd.read_csv(out / "anova.csv")
    assert list(written["effect"]) == list(mine["effect"])
    assert written["F"].to_numpy() == pytest.approx(mine["F"].to_numpy(), rel=1e-10)
    assert written["sentence"][0].startswith("F(")


def test_each_actors_mean_lies_where_its_participants_put_it(
    analysed: tuple[Path, Path, AnalysisOutcome],
) -> None:
    _, out, _ = analysed
    tests = pd.read_csv(out / "ttests.csv").set_index("level")
    for actor, (mean, sd) in PERCEIVED.items():
        assert abs(tests.loc[actor, "mean"] - mean) < 3 * sd / 12**0.5
    assert tests.loc["F1", "p"] < 0.05


def test_the_report_stands_alone_and_says_that_nobody_was_there(
    analysed: tuple[Path, Path, AnalysisOutcome],
) -> None:
    _, out, outcome = analysed
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "http" not in page.replace("http-equiv", "")
    assert "<script" not in page
    figures = len(read_plan(study_text(), "walk_ratio").figures)
    assert page.count("<b>Figure ") == figures >= 3
    assert page.count("data:image/svg+xml;base64,") == figures + 2  # Q-Q plots beside the ANOVA and the t tests
    assert page.index("Simulated participants") < page.index("Results in short")
    assert outcome.simulated
    for sentence in outcome.headlines:
        assert sentence.replace("<", "&lt;") in page
    assert "SHA-256" in page
    assert "@media print" in page


def test_the_report_says_which_walks_were_captured_and_which_were_modelled(
    analysed: tuple[Path, Path, AnalysisOutcome],
) -> None:
    report = (analysed[1] / "report.html").read_text(encoding="utf-8")
    assert "F1, M1, M2: modelled; F2: 4 cycles captured, 21 modelled" in report


def test_real_participants_are_not_called_simulated(tmp_path: Path) -> None:
    write_study(tmp_path / "s", 5, simulated=False)
    outcome = analyse(tmp_path / "s", tmp_path / "out")
    assert not outcome.simulated
    assert "imulated observers" not in outcome.report.read_text(encoding="utf-8")


def test_text_from_journals_cannot_become_markup(tmp_path: Path) -> None:
    evil = study_text().replace(
        "title: Which walk looks most natural?", "title: \"<script>alert('x')</script> & $x^2$\""
    )
    for number in range(1, 5):
        name = f"<b>{number}"
        write_run(tmp_path / "s", f"P{number}", journal_lines(name, number, evil))
    page = analyse(tmp_path / "s", tmp_path / "out").report.read_text(encoding="utf-8")
    assert "<script" not in page
    assert "&lt;script&gt;" in page


@pytest.mark.parametrize("participants", [1, 2])
def test_too_few_participants_still_get_their_tables(tmp_path: Path, participants: int) -> None:
    write_study(tmp_path / "s", participants)
    outcome = analyse(tmp_path / "s", tmp_path / "out")
    assert len(pd.read_csv(tmp_path / "out" / "trials.csv")) == 96 * participants
    assert len(pd.read_csv(tmp_path / "out" / "cell_means.csv")) == 24 * participants
    assert any("analysis of variance cannot be run" in warning for warning in outcome.warnings)
    assert "cannot be run" in outcome.report.read_text(encoding="utf-8")


def test_pilot_runs_are_called_pilot_runs(tmp_path: Path) -> None:
    from analysis.recorded.journal import read_study

    folder = write_study(tmp_path / "s", 2)
    for journal in folder.glob("sourcedata/sub-*/run-*/journal.jsonl"):
        rewrite(journal, lambda records: [{**records[0], "pilot": True}, *records[1:]])
    assert any("pilot runs" in warning for warning in read_study(folder).warnings)


def test_unfinished_declined_and_withdrawn_runs_are_left_out_and_named(tmp_path: Path) -> None:
    folder = write_study(tmp_path / "s", 4)
    write_run(folder, "P05", journal_lines("P05", 5, reason=None, trials=30))
    write_run(folder, "P06", journal_lines("P06", 6, reason="withdrawn"))
    write_run(folder, "P07", journal_lines("P07", 7, reason="declined", trials=0))
    outcome = analyse(folder, tmp_path / "out")
    said = " ".join(outcome.warnings)
    assert "P05: unfinished run (30 trials" in said
    assert "P06: withdrew" in said
    assert outcome.participants == 4
    assert set(pd.read_csv(tmp_path / "out" / "trials.csv")["participant"]) == {"P01", "P02", "P03", "P04"}


def test_an_answer_outside_the_groups_leaves_the_participant_out_of_the_anova(tmp_path: Path) -> None:
    folder = write_study(tmp_path / "s", 5)
    write_run(folder, "P06", journal_lines("P06", 6, sex="not_said"))
    outcome = analyse(folder, tmp_path / "out")
    assert any("P06 (not_said)" in warning for warning in outcome.warnings)
    assert "rests on 5 of them" in outcome.report.read_text(encoding="utf-8")


def test_a_torn_last_line_is_skipped_and_reported(tmp_path: Path) -> None:
    lines = journal_lines("P01", 1)
    path = write_run(tmp_path, "P01", lines)
    path.write_bytes(path.read_bytes()[:-40])
    run = read_journal(path)
    assert run.torn
    assert not run.finished
    assert len(run.trials) == 96


def test_a_damaged_inner_line_is_an_error_with_file_and_line(tmp_path: Path) -> None:
    folder = write_study(tmp_path / "s", 3)
    path = folder / "sourcedata" / "sub-P02" / "run-1" / "journal.jsonl"
    path.write_text(path.read_text(encoding="utf-8").replace('"number":7,', '"number":8,', 1), encoding="utf-8")
    with pytest.raises(AnalysisError, match=r"sub-P02/run-1/journal.jsonl, line \d+ of \d+"):
        analyse(folder, tmp_path / "out")


def test_a_trial_recorded_twice_counts_once(tmp_path: Path) -> None:
    lines = journal_lines("P01", 1)
    path = write_run(tmp_path, "P01", rechained([*lines[:-1], lines[10], lines[-1]]))
    run = read_journal(path)
    assert len(run.trials) == 96
    assert len(run.repeated) == 1
    assert any("more than once" in warning for warning in read_study(tmp_path).warnings)


def test_declared_exclusions_are_applied_and_reported_with_their_reason(tmp_path: Path) -> None:
    text = study_text().replace("exclusions: []", "exclusions: [{where: response_time > 15, reason: looked away}]")
    folder = write_study(tmp_path / "s", 6, text)
    analyse(folder, tmp_path / "out")
    trials = pd.read_csv(tmp_path / "out" / "trials.csv", keep_default_na=False)
    assert ((trials["response_time"] > 15) == (trials["excluded"] == "looked away")).all()
    assert (trials["excluded"] != "").any()
    assert "looked away" in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")


def test_exclusions_that_leave_no_trial_are_named_once_instead_of_a_complaint_per_test(tmp_path: Path) -> None:
    text = study_text().replace("exclusions: []", "exclusions: [{where: response_time > 0, reason: looked away}]")
    outcome = analyse(write_study(tmp_path / "s", 3, text), tmp_path / "out")
    about = [warning for warning in outcome.warnings if "excluded" in warning]
    assert about == [
        "All 288 trials are excluded, 288 by 'response_time > 0' (looked away), so nothing can be tested. They are "
        "all in trials.csv; correct the exclusions in a copy of the study file and name it with --plan."
    ]
    assert not any("no rows" in warning for warning in outcome.warnings)
    assert len(pd.read_csv(tmp_path / "out" / "trials.csv")) == 288


def test_a_condition_that_cannot_be_read_names_the_columns() -> None:
    trials = pd.DataFrame({"late_frames": [0, 9], "actor": ["F1", "M1"]})
    assert list(matching(trials, "late_frames > 5")) == [False, True]
    assert list(matching(trials, "actor == F1 and late_frames <= 0")) == [True, False]
    with pytest.raises(AnalysisError, match="late_frames"):
        matching(trials, "__import__('os')")


def test_a_condition_compares_two_columns_as_the_tests_of_answers_do() -> None:
    trials = pd.DataFrame({"chosen": ["F1", "M1", None], "original": ["F1", "F1", "M1"], "late_frames": [0, 0, 0]})
    assert list(matching(trials, "chosen == $original and late_frames < 1")) == [True, False, False]
    assert list(matching(trials, "chosen != $original")) == [False, True, False]


def test_a_test_of_a_part_of_the_trials_that_is_empty_says_so() -> None:
    with pytest.raises(AnalysisError, match="None of the 2 trials meets 'late_frames > 99'"):
        selected(pd.DataFrame({"late_frames": [0, 9]}), "late_frames > 99")


def test_reference_values_of_actors_that_are_not_shown_do_not_stop_the_other_tests() -> None:
    tests = [
        {"each": "actor", "against": {"F1": 0.0069, "F2": 0.0056, "M1": 0.007}},
        {"each": "speed", "against": {"0.8": 0.006, 1: 0.0065, 1.2: 0.007}},
    ]
    factors = {"actor": ["F1", "M1"], "speed": [0.8, 1.0]}
    by_actor, by_speed = plan_of(
        {"study": "s", "factors": factors, "analysis": {"measure": "walk_ratio", "t_tests": tests}}
    ).t_tests
    assert by_actor.against == {"F1": 0.0069, "M1": 0.007}
    assert list(by_speed.against.values()) == [0.006, 0.0065]


def test_missing_folders_and_empty_ones(tmp_path: Path) -> None:
    with pytest.raises(AnalysisError, match="There is no folder"):
        analyse(tmp_path / "nowhere", tmp_path / "out")
    with pytest.raises(AnalysisError, match="holds no recorded run"):
        analyse(tmp_path, tmp_path / "out")
    write_run(tmp_path / "s", "P01", journal_lines("P01", 1, reason=None))
    with pytest.raises(AnalysisError, match=r"name the study's folder, as .*s\.$"):
        analyse(tmp_path, tmp_path / "out")
    with pytest.raises(AnalysisError, match=r"name the study's folder, as .*s\.$"):
        analyse(tmp_path / "s" / "sourcedata" / "sub-P01", tmp_path / "out")
    with pytest.raises(AnalysisError, match="none of the 1 recorded runs can be analysed"):
        analyse(tmp_path / "s", tmp_path / "out")


def test_a_folder_that_cannot_be_written(tmp_path: Path) -> None:
    folder = write_study(tmp_path / "s", 4)
    (tmp_path / "out").write_text("a file, not a folder")
    with pytest.raises(AnalysisError, match="is a file; name a folder"):
        analyse(folder, tmp_path / "out")


def test_assumptions_stand_beside_the_test_and_in_a_table(analysed: tuple[Path, Path, AnalysisOutcome]) -> None:
    _, out, outcome = analysed
    checks = set(pd.read_csv(out / "assumptions.csv")["check"])
    assert checks >= {"Shapiro-Wilk", "Mauchly", "Mauchly (textbook)", "Levene (mean)", "learning", "anchoring"}
    page = outcome.report.read_text(encoding="utf-8")
    section = page[page.index("Analysis of variance</h2>") : page.index("Figures</h2>")]
    for word in ("Sphericity:", "Normality:", "Equal variances", "Outliers:", "Learning:", "Anchoring"):
        assert word in section


def test_tables_for_latex_escape_what_latex_would_read(analysed: tuple[Path, Path, AnalysisOutcome]) -> None:
    from analysis.report.latex import escaped

    _, out, _ = analysed
    text = (out / "tables.tex").read_text(encoding="utf-8")
    assert r"actor $\times$ speed & " in text
    assert text.count(r"\begin{table}") == text.count(r"\end{table}") >= 2
    assert escaped("50 % of a_b & −1 {x}") == r"50 \% of a\_\allowbreak{}b \& $-$1 \{x\}"


@needs_latex
def test_latex_sets_the_tables_within_its_narrow_page(
    analysed: tuple[Path, Path, AnalysisOutcome], tmp_path: Path
) -> None:
    _, out, _ = analysed
    tables = (out / "tables.tex").read_text(encoding="utf-8")
    packages = tables.split(";")[0].removeprefix("% ")
    _, points = too_wide(tmp_path, packages, tables)
    assert all(width <= 5 for width in points)


def test_values_side_by_side_have_the_same_decimals() -> None:
    """By hand: three figures of 0.0000415 are its seventh decimal; of 25.25, its first."""
    assert apa.together(0.00000123, -0.0000391, 0.0000415) == ["0.0000012", "−0.0000391", "0.0000415"]
    assert apa.limits(-1.5, 25.25) == "[−1.5, 25.2]"
    assert apa.limits(math.nan, 0.0) == "[–, 0]"


PLANS = {
    "one between factor": """
  anova: {within: [], between: [sex]}
  t_tests: []
  figures: [{kind: means, x: sex}]
""",
    "within only, nothing else": """
  anova: {within: [actor], between: []}
  post_hoc: null
  normality: null
  figures: [{kind: means, x: actor}, {kind: interaction, x: actor, lines: speed}]
""",
    "between on the x axis": """
  anova: {within: [speed, actor], between: [sex]}
  post_hoc: {adjust: holm, model: univariate}
  figures: [{kind: interaction, x: sex, lines: actor}, {kind: interaction, x: speed, lines: actor}]
""",
}


@pytest.mark.parametrize("name", PLANS)
def test_other_plans_than_the_thesis_run_as_well(name: str, tmp_path: Path) -> None:
    head, _, rest = study_text().partition("\nanalysis:")
    tail = rest[rest.index("# Simulated observers") :]
    text = f"{head}\nanalysis:\n  measure: response_time\n  label: Response time\n  unit: s{PLANS[name]}\n{tail}"
    outcome = analyse(write_study(tmp_path / "s", 7, text), tmp_path / "out")
    page = outcome.report.read_text(encoding="utf-8")
    assert "Response time" in page
    assert re.search(r"\bnan\b", page) is None
    drawn = [path for path in outcome.paths if path.suffix == ".png"]
    assert len(drawn) == (2 if "x axis" in name else 1)
    assert any("figure was not drawn" in w for w in outcome.warnings) == (name == "within only, nothing else")


def test_a_plan_made_later_is_followed_on_request_and_the_report_says_what_differs(tmp_path: Path) -> None:
    folder = write_study(tmp_path / "s", 3)
    later = study_text().replace("  normality: shapiro_wilk\n", "")
    outcome = analyse(folder, tmp_path / "out", plan_text=later)
    assert outcome.warnings[0] == (
        "The plan followed is not the one that was recorded with P01's run, but that of plan.yaml beside this report, "
        "which differs in analysis.normality."
    )
    assert (tmp_path / "out" / "plan.yaml").read_text(encoding="utf-8") == later
    same = analyse(folder, tmp_path / "out", plan_text=study_text())
    assert not any("plan" in warning for warning in same.warnings)
    assert not (tmp_path / "out" / "plan.yaml").exists()
    with pytest.raises(AnalysisError, match="that is the study other, and these are runs of walk_ratio"):
        analyse(folder, tmp_path / "out", plan_text=later.replace("study: walk_ratio", "study: other"))


def test_levels_with_unlike_decimals_are_drawn_beside_what_they_were_tested_against(tmp_path: Path) -> None:
    speeds = study_text().replace("speed: [0.8, 1.0, 1.2] ", "speed: [0.8, 1.0, 1.25] ")
    text = with_tests(speeds, "{each: speed, against: 0.006, label: a guess}")
    text = text.replace("  figures:\n", "  figures:\n    - {kind: t_tests, reference: a guess}\n")
    data = write_study(tmp_path / "walk_ratio", 8, text)
    for journal in data.rglob("journal.jsonl"):
        rewrite(journal, lambda records: [_faster(record) for record in records])
    outcome = analyse(data, tmp_path / "out")
    assert "t_tests_speed.png" in {path.name for path in outcome.paths}
    assert not any("not drawn" in warning for warning in outcome.warnings)


def _faster(record: dict[str, Any]) -> dict[str, Any]:
    """The record of a trial at 1.2 m/s as one at 1.25 m/s."""
    if record.get("factors", {}).get("speed") != 1.2:
        return record
    return {**record, "factors": {**record["factors"], "speed": 1.25}}


def test_a_t_test_that_cannot_be_run_does_not_keep_another_of_the_same_factor_from_its_report(tmp_path: Path) -> None:
    text = with_tests(study_text(), "{each: actor, against: 0.006, label: a guess, where: actor == F1}")
    outcome = analyse(write_study(tmp_path / "walk_ratio", 8, text), tmp_path / "out")
    assert any("t tests against the a guess cannot be run" in warning for warning in outcome.warnings)
    assert len(pd.read_csv(tmp_path / "out" / "ttests.csv")) == 4


def with_tests(text: str, test: str) -> str:
    """The study with one more t test before its own."""
    return text.replace("    - each: actor\n      against:", f"    - {test}\n    - each: actor\n      against:", 1)


def test_t_tests_of_the_same_factor_in_other_trials_have_a_q_q_plot_of_their_own(tmp_path: Path) -> None:
    """Each of the residuals it rests on; the label alone, which may be the same, would not tell them apart."""
    text = with_tests(study_text(), "{each: actor, against: 0.006, label: captured walk ratio, where: speed == 1.2}")
    out = tmp_path / "out"
    outcome = analyse(write_study(tmp_path / "walk_ratio", 8, text), out)
    points, trials = pd.read_csv(out / "qq.csv"), pd.read_csv(out / "trials.csv")
    assert set(points["test"]) == {"anova", "t actor (speed == 1.2)", "t actor (all trials)"}
    for name, rested in (("speed == 1.2", trials[trials["speed"] == 1.2]), ("all trials", trials)):
        means = rested[rested["actor"] == "F1"].groupby("participant")["walk_ratio"].mean().sort_values()
        shown = points[(points["test"] == f"t actor ({name})") & (points["panel"] == "F1")]["ordered"]
        assert shown.to_numpy() == pytest.approx(((means - means.mean()) / means.std()).to_numpy(), abs=1e-6)
    page = outcome.report.read_text(encoding="utf-8")
    assert page.index("means of the participants (speed == 1.2)") < page.index("means of the participants (all trials)")
    table = pd.read_csv(out / "ttests.csv")
    assert list(table["reference"].unique()) == ["captured walk ratio", "captured walk ratio (all trials)"]
    assert len(table) == 8


def test_a_figure_of_t_tests_shows_one_factor_where_two_have_the_same_label(tmp_path: Path) -> None:
    """As "reference value", which is what a test without a label of its own is against."""
    text = with_tests(study_text(), "{each: speed, against: 0.006, label: captured walk ratio}")
    text = text.replace("  figures:\n", "  figures:\n    - {kind: t_tests, reference: captured walk ratio}\n")
    outcome = analyse(write_study(tmp_path / "walk_ratio", 8, text), tmp_path / "out")
    assert "t_tests_speed.png" in {path.name for path in outcome.paths}
    assert not any("not drawn" in warning for warning in outcome.warnings)


def test_one_t_test_of_a_factor_needs_no_word_on_its_trials(analysed: tuple[Path, Path, AnalysisOutcome]) -> None:
    assert set(pd.read_csv(analysed[1] / "qq.csv")["test"]) == {"anova", "t actor"}

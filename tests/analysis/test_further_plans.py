"""Everything a study file can plan beside ANOVA, pairs and t tests is run, written, drawn and reported."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis import AnalysisError, art_anova, equivalence, mixed_model, regression
from analysis.figures.checks import session_course
from analysis.planned.plan import plan_of, read_plan
from analysis.planned_analysis import AnalysisOutcome, analyse
from analysis.recorded.trials import _add_derived
from protocols.mistakes.consistency import inconsistencies
from protocols.study_file import StudyFileError, parse_study
from tests.analysis.recorded import study_text, write_study

HEIGHTS = "{F1: 1.72, F2: 1.60, M1: 1.80, M2: 1.83}"
FURTHER = f"""
  equivalence:
    - {{factor: speed, bound: 0.0003}}
    - {{factor: speed, bound: 0.0005, by: actor}}
    - {{factor: sex, bound: 0.0005}}
  regression: {{of: actor, on: {{height: {HEIGHTS}}}, units: {{height: m}}}}
  aligned_rank_transform: {{within: [actor, speed], between: [sex]}}
  mixed_model: {{stimulus: actor, factors: [speed, sex]}}
  also:
    - measure: response_time
      label: Response time
      unit: s
      anova: {{within: [actor, speed], between: [sex]}}
      figures: [{{kind: order}}, {{kind: raincloud, x: sex}}]
    - measure: normalised_walk_ratio
      label: Normalised walk ratio
      unit: ""
      heights: {HEIGHTS}
      aligned_rank_transform: {{within: [actor]}}
  figures: [{{kind: raincloud, x: actor}}, {{kind: qq}}, {{kind: order}}, {{kind: regression}}]
"""


def with_plan(further: str) -> str:
    """The shipped study with these parts of the plan in place of its own equivalence tests and figures."""
    text = re.sub(r"^  (figures|equivalence):.*\n(    - .*\n)+", "", study_text(), flags=re.M)
    return text.replace("  exclusions: []", f"{further.strip(chr(10))}\n  exclusions: []")


@pytest.fixture(scope="module")
def analysed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path, AnalysisOutcome]:
    data = write_study(tmp_path_factory.mktemp("data") / "walk_ratio", 12, with_plan(FURTHER))
    out = tmp_path_factory.mktemp("out")
    return data, out, analyse(data, out)


def test_the_plan_is_accepted_by_the_check_of_study_files() -> None:
    assert inconsistencies(parse_study("x.yaml", with_plan(FURTHER)).study) == []


def test_every_planned_test_has_its_table_sentences_and_section(analysed: tuple[Path, Path, AnalysisOutcome]) -> None:
    _, out, outcome = analysed
    assert outcome.warnings == ()
    page = (out / "report.html").read_text(encoding="utf-8")
    assert re.search(r"\bnan\b", page) is None
    for name, title in {
        "equivalence": "Equivalence", "regression": "Regression", "aligned_rank_transform": "Aligned rank transform",
        "mixed_model": "Mixed model",
    }.items():  # fmt: skip
        assert f"<h2>{title}</h2>" in page
        sentences = pd.read_csv(out / f"{name}.csv")["sentence"]
        assert sentences.notna().all()
        assert sentences[0].replace("<", "&lt;") in page
    assert "TOST t(" in pd.read_csv(out / "equivalence.csv")["sentence"][0]
    assert page.count("<summary>Q–Q plot</summary>") == 4  # two ANOVAs, t tests, regression
    drawn = (out / "regression.svg").read_text(encoding="utf-8")
    assert "<!-- height (m) -->" in drawn
    for actor in ("F1", "F2", "M1", "M2"):
        assert f"<!-- {actor} -->" in drawn


def test_the_tables_are_those_of_the_functions(analysed: tuple[Path, Path, AnalysisOutcome]) -> None:
    _, out, _ = analysed
    trials = pd.read_csv(out / "trials.csv")
    who = ("walk_ratio", "participant")
    same = pd.read_csv(out / "equivalence.csv", keep_default_na=False, na_values=[""])
    mine = equivalence(trials, *who, ["actor", "speed", "start"], "sex", factors="speed", bound=0.0003)
    assert same[:3]["p"].to_numpy() == pytest.approx(mine["p"].to_numpy(), rel=1e-8)
    inside = equivalence(trials, *who, ["actor", "speed", "start"], "sex", factors="speed", by="actor", bound=0.0005)
    assert same[3:15]["t_upper"].to_numpy() == pytest.approx(inside["t_upper"].to_numpy(), rel=1e-8)
    ranks = art_anova(trials, *who, ["actor", "speed"], "sex")
    assert pd.read_csv(out / "aligned_rank_transform.csv")["F"].to_numpy() == pytest.approx(ranks["F"], rel=1e-8)
    mixed = mixed_model(trials, *who, "actor", ["speed", "sex"], levels={"sex": ["female", "male"]})
    written = pd.read_csv(out / "mixed_model.csv")
    assert written["estimate"][3:].to_numpy() == pytest.approx(mixed["estimate"][3:], rel=1e-6)
    cases = pd.read_csv(out / "regression_cases.csv")
    lines = regression(cases, "walk_ratio", "height")
    assert pd.read_csv(out / "regression.csv")["estimate"].to_numpy() == pytest.approx(lines["estimate"], rel=1e-9)
    assert cases["walk_ratio"].to_numpy() == pytest.approx(trials.groupby("actor")["walk_ratio"].mean(), rel=1e-9)


def test_further_measures_get_their_folder_and_their_part_of_the_page(
    analysed: tuple[Path, Path, AnalysisOutcome],
) -> None:
    _, out, outcome = analysed
    assert {path.parent.name for path in outcome.paths} == {out.name, "response_time", "normalised_walk_ratio"}
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "Also: Response time" in page
    assert "Also: Normalised walk ratio" in page
    assert len(pd.read_csv(out / "response_time" / "anova.csv")) == 7
    assert any(sentence.startswith("Response time: ") for sentence in outcome.headlines)


def test_the_normalised_walk_ratio_is_hofs(analysed: tuple[Path, Path, AnalysisOutcome]) -> None:
    _, out, _ = analysed
    row = pd.read_csv(out / "trials.csv").iloc[0]
    height = {"F1": 1.72, "F2": 1.60, "M1": 1.80, "M2": 1.83}[row["actor"]]
    wanted = (row["step_length"] / height) / (row["step_frequency"] / 60 / np.sqrt(9.81 / height))
    assert row["normalised_walk_ratio"] == pytest.approx(wanted, rel=1e-12)


def test_the_same_journals_give_the_same_bytes_for_all_of_it(
    analysed: tuple[Path, Path, AnalysisOutcome], tmp_path: Path
) -> None:
    data, out, outcome = analysed
    analyse(data, tmp_path)
    for path in outcome.paths:
        assert path.read_bytes() == (tmp_path / path.relative_to(out)).read_bytes(), path.name


def test_every_participant_is_a_dot_of_the_raincloud(analysed: tuple[Path, Path, AnalysisOutcome]) -> None:
    _, out, _ = analysed
    drawn = (out / "raincloud_actor.svg").read_text(encoding="utf-8")
    rain = [part for part in drawn.split('<g id="PathCollection_')[1:] if "<use" in part]
    assert [part.split("</g>\n   <g id=")[0].count("<use") for part in rain[:4]] == [12] * 4


def test_the_course_over_the_session_shows_a_drift_and_no_condition(
    analysed: tuple[Path, Path, AnalysisOutcome],
) -> None:
    from analysis.statistics.cells import cell_means

    _, out, _ = analysed
    trials = pd.read_csv(out / "trials.csv")
    trials["y"] = trials["trial"] * 0.01 + trials["actor"].map({"F1": 0, "F2": 5, "M1": 50, "M2": -20})
    means = cell_means(trials, "y", "participant", ["actor", "speed", "start"])
    course = session_course(means, trials).groupby("trial")["y"].mean()
    assert np.polyfit(course.index, course, 1)[0] == pytest.approx(0.01, rel=0.15)


def test_confusion_is_the_share_of_copies_taken_for_the_original() -> None:
    plan: Any = plan_of({"factors": {"actor": ["F1", "M1"]}, "analysis": {"measure": "confusion_rate"}})
    table = pd.DataFrame({"chosen": ["copy", "captured"], "original": "captured"})
    _add_derived(table, plan)
    assert list(table["confusion_rate"]) == [100.0, 0.0]


def test_a_test_that_cannot_be_run_is_a_warning_and_the_rest_is_written(tmp_path: Path) -> None:
    text = with_plan("  regression: {of: actor, on: {height: {F1: 1.7, F2: 1.6, M1: 1.8}}}")
    outcome = analyse(write_study(tmp_path / "s", 5, text), tmp_path / "out")
    assert any("The regression cannot be run: the plan gives no height of M2" in said for said in outcome.warnings)
    assert (tmp_path / "out" / "anova.csv").exists()


def test_a_height_that_is_missing_is_named(tmp_path: Path) -> None:
    text = with_plan("  also: [{measure: normalised_walk_ratio, heights: {F1: 1.7, F2: 1.6, M1: 1.8}}]")
    with pytest.raises(AnalysisError, match="no height for M2"):
        analyse(write_study(tmp_path / "s", 3, text), tmp_path / "out")
    with pytest.raises(AnalysisError, match="walk_ratio is analysed twice"):
        read_plan(with_plan("  also: [{measure: walk_ratio}]"), "x")


WRONG = {
    "  equivalence: [{factor: sped, bound: 0.1}]": "sped is no factor of the anova; did you mean speed?",
    "  equivalence: [{factor: speed, bound: 0}]": "it must be more than 0",
    "  equivalence: [{factor: speed, bound: 1, by: speed}]": "is the factor compared",
    "  regression: {of: actor, on: {height: {F1: 1.7}}}": "the height of F2, M1, M2 is missing",
    "  regression: {of: actor, on: {height: {F1: 1.7}}, units: {hight: m}}": "did you mean height?",
    "  regression: {of: speed, on: {a: {'0.8': 1, '1.0': 2, '1.2': 3}, b: {'0.8': 1, '1.0': 2, '1.2': 4}}}": "too few",
    "  aligned_rank_transform: {within: [sex]}": "sex is a between factor; name it under between",
    "  aligned_rank_transform: {}": "name at least one factor",
    "  mixed_model: {stimulus: actor, factors: [actor]}": "the random stimulus already",
    "  mixed_model: {stimulus: sex, factors: [speed]}": "sex is no within factor",
    "  also: [{measure: walk_ratio}]": "walk_ratio is analysed twice",
    "  also: [{measure: confusion_rate}]": "is not what adjustment trials give",
    "  also: [{measure: normalised_walk_ratio}]": "needs heights",
    "  also: [{measure: normalised_walk_ratio, heights: {F1: 1.7}}]": "the height of F2, M1, M2 is missing",
    "  heights: {F1: 1.7}": "walk_ratio needs no heights",
    "  figures: [{kind: raincloud}]": "needs x",
    "  figures: [{kind: order, x: no_such}]": "no_such is no factor",
    "  figures: [{kind: interaction, x: actor, lines: actor}]": "actor is on the x axis already",
}


@pytest.mark.parametrize("further", WRONG)
def test_mistakes_in_the_plan_are_found_before_anyone_sits_down(further: str) -> None:
    try:
        found = [mistake.message for mistake in inconsistencies(parse_study("x.yaml", with_plan(further)).study)]
    except StudyFileError as error:
        found = [str(error)]
    assert any(WRONG[further] in message for message in found), found

"""What the page, the headlines and the LaTeX tables say, where a reviewer would find a wrong word.

A rating study whose observers all answer at the floor for two of three walks: values without variance.
"""

from __future__ import annotations

import html
import re
import warnings
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from analysis import AnalysisError, AnalysisOutcome, AnalysisWarning, analyse, apa
from analysis.figures.drawing import canvas, level_ticks, settings
from analysis.figures.interaction import interaction
from analysis.planned.comparison_tests import comparison_tests
from analysis.planned.further_tests import planned_tests
from analysis.planned.plan import plan_of
from analysis.report.latex import _table
from analysis.statistics.cells import cell_means
from experiment_app.simulated.simulate import simulate
from protocols.mistakes.consistency import inconsistencies
from protocols.study_file import parse_study
from tests.analysis.typesetting import needs_latex, too_wide

STUDY = """
study: floor
title: How natural?
about: Ratings at the floor of the scale.
participants: {planned: 12, between: {viewing: [screen, headset]}, assigned: [viewing]}
factors: {pace: [slow, middle, fast]}
repetitions: 2
stimulus: {actor: F1, speed: {$pace: {slow: 0.9, middle: 1.1, fast: 1.3}}, ground: plain}
task:
  kind: rating
  question: How natural?
  scale: {minimum: 0, maximum: 4, step: 1, low: not, high: very}
  alternatives: {walk: {}}
interval: 0.5
pages:
  consent: {title: Taking part, text: You will rate walks.}
  instructions: [{title: Your task, text: Rate.}]
  debrief: {title: Thank you, text: That was all.}
analysis:
  measure: rating
  label: VAS of naturalness
  unit: "0-4"
  anova: {ANOVA}
  t_tests: [{paired: pace}]
  pairs: [{factors: pace, by: viewing, adjust: holm}]
  equivalence: [{factor: pace, bound: 0.5}]
  aligned_rank_transform: {within: [pace]}
  exclusions: EXCLUSIONS
simulation:
  rating: {rating: {$pace: {slow: -5, middle: MIDDLE, fast: -5}}, spread: 0.3, noise: 0.3}
"""


def run(folder: Path, middle: str, within: bool = True, exclusions: str = "[]") -> tuple[AnalysisOutcome, str]:
    study = (
        STUDY.replace("MIDDLE", middle)
        .replace("EXCLUSIONS", exclusions)
        .replace("ANOVA", "within: [pace], between: [viewing]")
    )
    if not within:
        study = re.sub(r"\n  (pairs|equivalence):.*", "", study).replace("within: [pace], between", "between")
    file = parse_study("floor.yaml", study)
    assert inconsistencies(file.study) == []
    for _ in simulate(file, 12, folder / "data", seed=0):
        pass
    outcome = analyse(folder / "data" / "floor", folder / "out")
    return outcome, html.unescape(re.sub("<[^>]+>", "", outcome.report.read_text(encoding="utf-8")))


@pytest.fixture(scope="module")
def some(tmp_path_factory: pytest.TempPathFactory) -> tuple[AnalysisOutcome, str]:
    return run(tmp_path_factory.mktemp("some"), "0.5")


def test_measures_that_nobody_varied_in_are_said_not_to_be_tested(tmp_path: Path) -> None:
    outcome, page = run(tmp_path, "-5")
    said = "\n".join(outcome.headlines)
    assert "VAS of naturalness: no test of pace and viewing, as there is no variance." in said
    assert "aligned ranks: not testable: no variance." in said
    assert "(0 of 3 pairs, no p without variance)" in said
    for wrong in ("No evidence of an effect", "No interaction was significant", "no effect is significant", "nan"):
        assert wrong not in said
    assert "[–, –]" not in page


def test_a_scale_is_no_unit_and_an_abbreviation_keeps_its_capitals(some: tuple[AnalysisOutcome, str]) -> None:
    outcome, page = some
    assert "±0.5 0-4" not in page
    assert "within ±0.5 (" in "\n".join(outcome.headlines)
    assert "Dependent variable: VAS of naturalness (0-4)" in page
    assert [apa.mid_sentence(label) for label in ("Walk ratio", "RT", "x")] == ["walk ratio", "RT", "x"]
    assert [apa.with_unit("3", unit) for unit in ("s", "%", "", "0-4")] == ["3 s", "3 %", "3", "3"]


def test_the_two_standardised_differences_have_names_of_their_own(some: tuple[AnalysisOutcome, str]) -> None:
    """The same pair: t = d sqrt(n) of differences, where d_av is over the spread between participants."""
    outcome, page = some
    pair = pd.read_csv(outcome.report.with_name("pairs.csv"))["sentence"].iloc[0]
    assert pair.startswith("viewing screen: slow − middle = ")
    assert re.search(r"p [=<] \.\d{3} \(Holm\), d_av = −\d\.\d\d$", pair)
    assert "d_av is the difference over the root mean" in page
    assert "(multivariate model, Holm)" in page
    table = pd.read_csv(outcome.report.with_name("comparisons.csv"))
    row = table[(table["a"] == "slow") & (table["b"] == "middle")].iloc[0]
    assert row["t"] == pytest.approx(row["d"] * row["n"] ** 0.5, rel=1e-12)


def test_words_for_one_of_a_kind(tmp_path: Path, some: tuple[AnalysisOutcome, str]) -> None:
    assert "submitted to a two-way mixed analysis" in some[1]
    _, page = run(tmp_path, "2", within=False)
    assert "submitted to a one-way analysis of variance" in page
    assert re.search(r"Levene's test \(from the median\) (does not reject|rejects) them, F\(1, 10\) = ", page)
    assert re.search(r"Of 2 cells tested one by one, . ha(s|ve) p < .05; 0\.1 would be expected by chance", page)


def test_the_methods_claim_only_what_was_run(tmp_path: Path) -> None:
    """One level is left of the only factor within participants."""
    outcome, page = run(tmp_path, "2", exclusions="[{where: pace != slow, reason: lost}]")
    assert any("The analysis of variance cannot be run" in warning for warning in outcome.warnings)
    for claim in ("analysis of variance", "Planned comparisons", "two one-sided tests", "aligned rank"):
        assert claim not in page.split("Method\n")[1].split("Cell means")[0]
    assert "None of the planned tests could be run." in page


def test_a_planned_t_test_that_cannot_be_run_does_not_take_the_others_with_it() -> None:
    """Two people, one in each group: their conditions can be compared, the groups cannot."""
    plan = plan_of({
        "factors": {"pace": ["slow", "fast"]},
        "participants": {"between": {"sex": ["female", "male"]}},
        "analysis": {"measure": "y", "t_tests": [{"independent": "sex"}, {"paired": "pace"}]},
    })  # fmt: skip
    rows = [("P1", "female", "slow", 1.0), ("P1", "female", "fast", 3.0), ("P2", "male", "slow", 2.0)]
    used = pd.DataFrame([*rows, ("P2", "male", "fast", 7.0)], columns=["participant", "sex", "pace", "y"])
    test = comparison_tests(used, plan)
    # by hand: differences -2 and -5 have mean -3.5 and SD 3 / sqrt(2), so t(1) = -3.5 / 1.5
    assert test.table[["test", "t", "df"]].values.tolist() == [["paired", pytest.approx(-7 / 3), 1.0]]
    assert [c.split(" cannot")[0] for c in test.complaints] == ["The t tests of sex"]
    with pytest.raises(AnalysisError, match="too few"):
        comparison_tests(used[used["sex"] == "male"], plan)


def test_a_test_that_leaves_somebody_out_says_so_beside_its_result() -> None:
    """The ANOVA may rest on more or fewer people than the ranks and the regression do."""
    plan = plan_of({
        "factors": {"actor": ["F1", "F2", "M1"]},
        "analysis": {
            "measure": "y",
            "aligned_rank_transform": {"within": ["actor"]},
            "equivalence": [{"factor": "actor", "bound": 1}],
            "anova": {"within": ["actor"]},
            "regression": {"of": "actor", "on": {"height": {"F1": 1.6, "F2": 1.7, "M1": 1.8}}},
        },
    })  # fmt: skip
    rng = np.random.default_rng(3)
    used = pd.DataFrame([(f"P{p}", a, rng.normal()) for p in range(8) for a in ("F1", "F2", "M1")])
    used = used.set_axis(["participant", "actor", "y"], axis=1).iloc[1:]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", AnalysisWarning)
        tests = [run_one(used) for _, run_one in planned_tests(plan)]
    assert [test.kind for test in tests] == ["equivalence", "regression", "aligned_rank_transform"]
    assert all(any("P0 (no data in F1)" in note for note in test.notes) for test in tests)


@needs_latex
def test_a_table_longer_or_wider_than_a_page_goes_on_over_the_next_and_breaks_its_words(tmp_path: Path) -> None:
    """An ANOVA of seven factors has 127 effects; a pair of cells of four factors has long names."""
    effects = [[f"effect {i}", "1, 20", "1.00", "< .001"] for i in range(127)]
    cell = "the_captured_walk × a_woman_of_the_same_height × seen_on_a_screen × female"
    pairs = [[cell, cell, cell, "−0.00012", "−12.34", "20.1", "< .001"]] * 30
    written = _table("Analysis of variance", ["Effect", "df", "$F$", "$p$"], effects)
    written += _table("Pairs", ["Effect", "a", "b", "a $-$ b", "$t$", "df", "$p$"], pairs, texts=3)
    said, points = too_wide(tmp_path, r"\usepackage{booktabs,array,longtable}", written)
    assert "too large" not in said
    assert all(width <= 5 for width in points)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("lines", ["way", "experience"])
def test_names_as_long_as_people_give_them_stay_on_the_paper_and_off_each_other(lines: str) -> None:
    """Ten ways of making a walk, three kinds of people, and a measure that is a sentence."""
    ways = [f"walk_made_in_the_way_of_number_{i}" for i in range(10)]
    people = ("has_never_seen_a_virtual_human", "plays_games_every_day", "develops_virtual_humans")
    label = "Walk ratio that looked most natural to the participant"
    plan = plan_of({
        "factors": {"way": ways, "speed": ["slow", "fast"]},
        "participants": {"between": {"experience": list(people)}},
        "analysis": {"measure": "y", "label": label, "unit": "m·min", "anova": {"within": ["way", "speed"]}},
    })  # fmt: skip
    rng = np.random.default_rng(1)
    rows = [(p, w, s, people[p % 3], rng.normal()) for p in range(9) for w in ways for s in ("slow", "fast")]
    data = pd.DataFrame(rows, columns=["participant", "way", "speed", "experience", "y"])
    means = cell_means(data, "y", "participant", ["way", "speed"], "experience")
    seen: list[Figure] = []
    with settings(), pytest.MonkeyPatch.context() as patch:
        patch.setattr("analysis.figures.interaction.saved", lambda drawing, *words: seen.append(drawing))
        interaction("speed" if lines == "way" else "way", lines, means, plan)
    drawing = seen[0]
    drawing.canvas.draw()
    paper, axes = drawing.bbox, drawing.axes[0]
    names = [text.get_window_extent() for text in axes.get_xticklabels()]
    for box in (drawing.legends[0].get_window_extent(), axes.yaxis.label.get_window_extent(), *names):
        assert paper.x0 <= box.x0 < box.x1 <= paper.x1
        assert paper.y0 <= box.y0 < box.y1 <= paper.y1
    assert all(left.x1 <= right.x0 for left, right in pairwise(names))
    assert not axes.yaxis.label.get_window_extent().overlaps(names[0])
    assert axes.get_window_extent().height > 0.4 * paper.height


def test_two_long_names_among_short_ones_are_broken_and_keep_off_each_other() -> None:
    """The bodies of point-light studies: as long as these, side by side, they ran into each other."""
    names = ["stick_figure", "point_light", "point_light_inverted", "point_light_scrambled"]
    with settings():
        drawing, axes = canvas(6.4, 3.6)
        level_ticks(axes, names, 5.3)
        drawing.canvas.draw()
    shown = axes.get_xticklabels()
    assert [text.get_text().replace("\n", "") for text in shown] == names
    assert all(text.get_rotation() == 0 for text in shown)
    boxes = [text.get_window_extent() for text in shown]
    assert all(left.x1 < right.x0 for left, right in pairwise(boxes))

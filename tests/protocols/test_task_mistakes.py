"""Mistakes in choice and rating studies: each is named with its place and what is allowed."""

from __future__ import annotations

import pytest

from experiment_app.checking.check import checked_study
from protocols.mistakes.consistency import inconsistencies
from protocols.study_file import StudyFileError, parse_study, read_study


def said(tmp_path, name: str, *replacements: tuple[str, str]) -> str:
    """What is said about a shipped study with texts replaced; "" when nothing is wrong."""
    text = read_study(name).text
    for old, new in replacements:
        assert old in text, old
        text = text.replace(old, new, 1)
    path = tmp_path / "s.yaml"
    path.write_text(text, encoding="utf-8")
    try:
        checked_study(str(path))
    except StudyFileError as error:
        return str(error)
    return ""


CHOICE = [
    ("original: captured ", "original: capturd ", "task.original: capturd is no alternative; did you mean captured?"),
    ("side_by_side", "one_after_the_other", "one after the other needs time_limit"),
    ("first: left", "first: right", "right is also the key for first"),
    ("first: left", "first: escape", "escape is kept for the pause page"),
    ("kind: choice", "kind: choise", "did you mean choice?"),
    ("arrangement: side", "arangement: side", "unknown key; did you mean arrangement?"),
    ("    rebuilt:\n      making:", "    rebuilt:\n      makings:", "unknown key; did you mean making?"),
    ("source_speed: $speed", "source_sped: $speed", "unknown key; did you mean source_speed?"),
    ("points: $points", "points: $ponts", "did you mean $points?"),
    ("points: [4, 5] ", "points: [4, 6] ", "6 is not allowed for task.alternatives.rebuilt.making.points; allowed: 4"),
    ("[cubic, pchip, hermite]\nrep", "[cubic, linear, hermite]\nrep", "linear is not allowed for task.alternatives"),
    ("source_speed: $speed", "source_speed: {$speed: {0.88: 0.7, 1.06: 0.88}}", "a value for 1.24 is missing"),
    ("source_speed: $speed", "source_speed: {$sped: {0.88: 0.7}}", "did you mean $speed?"),
    ("source_speed: $speed", "source_speed: {0.88: 0.7}", "a table names one factor and its levels"),
    ("source_speed: $speed", "source_speed: 5", "5 is out of range; it must be at most 3"),
    ("method: captured}", "method: captured, style: sadd}", "there is no style sadd; did you mean sad?"),
    ("measure: confusion_rate", "measure: walk_ratio", "walk_ratio is not what choice trials give; they give"),
    ("4: 0.21", "4: 1.4", "1.4 is out of range; for simulation.choice.confusion it must be at most 1"),
    ("speed: 1.06, points: 4, interpolation: cubic", "speed: 1.06, points: 4", "interpolation is missing"),
    ("speed: [0.88, 1.06, 1.24] ", "speed: [0.88, 1.06, 2.4] ", "factors.speed[2]"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "sentence"), CHOICE)
def test_a_mistake_in_a_choice_study_is_one_sentence(tmp_path, old, new, sentence):
    lines = said(tmp_path, "poulaine_reconstruction", (old, new)).split("\n")
    assert any(sentence in line for line in lines), lines
    assert lines[0].startswith(f"{tmp_path / 's.yaml'}:")


@pytest.mark.parametrize(
    ("yes", "sentence"),
    [
        ("chosen == left", "order.yes: chosen is never left; it can be: captured, rebuilt"),
        ("side == first", "order.yes: side is never first; it can be: left, right"),
        ("first == rebuilt", "first is no factor or part of a response"),  # they stand side by side
        ("decision_time < 2", "decision_time is no factor or part of a response"),
        ("chosen != $original", ""),
        ("side == left", ""),
        ("left == rebuilt", ""),
    ],
)
def test_an_answer_that_no_trial_can_have_places_nothing_and_is_refused(tmp_path, yes, sentence):
    order = f"order: {{kind: adaptive, of: speed, yes: {yes}, rule: {{kind: staircase}}}}"
    says = said(tmp_path, "poulaine_reconstruction", ("order: random", order))
    assert sentence in says
    assert bool(sentence) == ("order.yes" in says)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (("  original: captured ", "  # original: captured "), "analysis.measure: confusion_rate needs task.original"),
        (("measure: response_time", "measure: decision_time"), "decision_time needs walks one after the other"),
    ],
)
def test_a_measure_that_no_trial_would_have_is_refused_before_anybody_comes(tmp_path, change, sentence):
    assert sentence in said(tmp_path, "poulaine_reconstruction", change)


MAKING = [  # what the study has, what it becomes, the place and the text of the line that is blamed
    ("poulaine_reconstruction", "points: $points,", "points: $points, share: 0.5,",
     "task.alternatives.rebuilt.making.share", "share: 0.5"),
    ("poulaine_reconstruction", "{method: captured}", "{method: captured, source_speed: 0.7}",
     "task.alternatives.captured.making.source_speed", "captured: {making"),
    ("poulaine_reconstruction", "method: poulaine, source_speed: $speed,", "method: poulaine, source_speed: 2.9,",
     "task.alternatives.rebuilt.making.source_speed", "source_speed: 2.9"),
    ("poulaine_reconstruction", "{method: poulaine,", "{method: poulaine, height: 2.5, walk_ratio: 0.0001,",
     "task.alternatives.rebuilt.making.", "walk_ratio: 0.0001"),
    ("speed_editing", "1.06: 0.88, 1.24: 1.06}", "1.06: 2.88, 1.24: 1.06}",
     "task.alternatives.edited.making.source_speed.$direction.sped_up.$speed.1.06", "sped_up: {$speed"),
    ("fourier_naturalness", "method: fourier, harmonics: 2}", "method: pca, share: 3}",
     "task.alternatives.synthetic.making.share", "share: 3}"),
    ("fourier_naturalness", "  making:\n    style:", "  making:\n    height: 1.9\n    style:",
     "stimulus.making.height", "height: 1.9"),
]  # fmt: skip


@pytest.mark.parametrize(("study", "old", "new", "place", "line"), MAKING)
def test_a_walk_that_its_making_rules_out_is_told_at_the_making(tmp_path, study, old, new, place, line):
    mistakes = [one for one in said(tmp_path, study, (old, new)).split("\n") if one.startswith(str(tmp_path))]
    assert mistakes
    written = (tmp_path / "s.yaml").read_text(encoding="utf-8").split("\n")
    for mistake in mistakes:
        number, rest = mistake.removeprefix(f"{tmp_path / 's.yaml'}:").split(":", 1)
        assert place in rest
        assert line in written[int(number) - 1]


def test_a_speed_that_the_actor_cannot_walk_at_is_told_at_the_speed_whatever_the_making(tmp_path):
    says = said(tmp_path, "fourier_naturalness", ("proud: 1.06, decided", "proud: 2.9, decided"))
    assert "stimulus.speed.$pair.proud: " in says
    says = said(tmp_path, "fourier_naturalness", ("synthetic: {making", "synthetic: {speed: 2.9, making"))
    assert "task.alternatives.synthetic.speed: " in says


def test_captured_walks_at_a_speed_that_the_actor_does_not_cover_are_refused_in_any_task(tmp_path):
    change = (
        "making: {method: poulaine, source_speed: $speed, points: $points, interpolation: $interpolation}",
        "actor: F2",
    )
    says = said(
        tmp_path, "poulaine_reconstruction", change, ("speed: [0.88, 1.06, 1.24] ", "speed: [0.88, 1.06, 2.4] ")
    )
    assert "factors.speed[2]: actor F1: speed 2.4 m/s is outside the cycles there are" in says


RATING = [
    ("minimum: 0, maximum: 4", "minimum: 4, maximum: 4", "minimum 4 is not below maximum 4"),
    ("step: 1,", "step: 3,", "steps of 3 do not lead from 0 to 4"),
    ("step: 1,", "step: 0.1,", "41 points are too many; at most 21, or step: null"),
    ("sad_2: F2, ", "", "stimulus.actor.$pair: a value for sad_2 is missing"),
    ("confirm: enter", "confirm: r", "r is also the key for confirm"),
    ("low: not realistic, ", "", "task.scale.low: this key is missing"),
    ("body: stick_figure", "body: stick_figur", "did you mean stick_figure?"),
    ("drunken: 1.60, ", "", "a value for drunken is missing"),
]


@pytest.mark.parametrize(("old", "new", "sentence"), RATING)
def test_a_mistake_in_a_rating_study_is_one_sentence(tmp_path, old, new, sentence):
    lines = said(tmp_path, "fourier_naturalness", (old, new)).split("\n")
    assert any(sentence in line for line in lines), lines


def test_a_choice_needs_two_alternatives(tmp_path):
    text = read_study("poulaine_reconstruction").text
    start, end = text.index("    rebuilt:\n"), text.index("  original:")
    study = parse_study("s.yaml", text[:start] + text[end:]).study
    assert any("a choice needs two alternatives" in mistake.message for mistake in inconsistencies(study))


def test_a_continuous_scale_needs_no_steps(tmp_path):
    assert said(tmp_path, "fourier_naturalness", ("step: 1,", "step: null,")) == ""


def test_a_table_may_go_on_inside_and_is_checked_there_too(tmp_path):
    assert said(tmp_path, "speed_editing") == ""
    inside = said(tmp_path, "speed_editing", ("0.88: 0.70, 1.06", "0.88: brisk, 1.06"))
    assert "source_speed.$direction.sped_up.$speed.0.88: 'brisk' is not a number" in inside


@pytest.mark.parametrize("name", ["side", "correct", "views", "response_time", "excluded", "mean", "n"])
def test_a_factor_called_as_a_recorded_column_would_lose_its_levels_and_is_refused(tmp_path, name):
    """`side` (left or right) is recorded in every choice, over a factor of that name."""
    says = said(tmp_path, "poulaine_reconstruction", ("factors:\n", f"factors:\n  {name}: [left, right]\n"))
    assert f"factors.{name}: is the name of a column of the tables; rename the factor" in says


def test_a_question_called_as_a_recorded_column_would_lose_its_answers_and_is_refused(tmp_path):
    asked = "questions:\n    - {id: rating, kind: number, prompt: How often?, minimum: 0, maximum: 9}\n"
    says = said(tmp_path, "fourier_naturalness", ("questions:\n", asked))
    assert "rating is already the name of a question, factor or column" in says

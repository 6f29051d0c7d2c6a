"""Study files: the shipped one is right, and every mistake is named with its place."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from protocols.mistakes.consistency import inconsistencies
from protocols.study_file import StudyFileError, find_study, parse_study, read_study, shipped_studies
from tests.protocols.studies import changed, shipped_text


def message(text: str) -> str:
    """Every mistake found in a study text, "" when there is none."""
    try:
        file = parse_study("s.yaml", text)
    except StudyFileError as error:
        return str(error)
    mistakes = inconsistencies(file.study)
    return str(file.error(mistakes)) if mistakes else ""


@pytest.mark.parametrize("name", shipped_studies())
def test_every_shipped_study_is_consistent(name):
    file = read_study(name)
    assert inconsistencies(file.study) == []
    assert file.study.study == name


def place(text: str, sought: str) -> str:
    """line:column of a text in a file, both from 1."""
    assert text.count(sought) == 1, f"{sought!r} does not stand exactly once"
    before = text[: text.index(sought)]
    return f"{before.count(chr(10)) + 1}:{len(before) - before.rfind(chr(10))}"


@pytest.mark.parametrize(
    ("old", "new", "at", "says"),
    [
        ("repetitions: 4 ", "repetition: 4 ", "repetition: 4", "unknown key; did you mean repetitions?"),
        ("prompt: How old are you (years)?", "prompt: Age, in years?", "in years", "a comma stands in quotes"),
        ("ground:", "level_of_detail: $start\n  ground:", "$start\n  g", "the same in all trials, no factor's"),
        ("ground:", "marks: {$speed: {}}\n  ground:", "$speed: {}", "the same in all trials, no table by a"),
        ("{view: three_quarter,", "{$speed: {},", "$speed: {}", "a table belongs to a single key, as view: {$speed:"),
        ("order: random", "order: randm", "randm", "did you mean random?"),
        ("rate: 10 ", "rate: brisk ", "brisk", "'brisk' must be a number, as 1.2"),
        ("rate: 10 ", "rate: '10' ", "'10'", "'10' must be a number, as 1.2; take the quotes away"),
        ("rate: 10 ", "rate: '1,5' ", "'1,5'", "'1,5' must be a number, as 1.2; write it with a point"),
        ("repetitions: 4 ", "repetitions: '4' ", "'4'", "'4' must be a whole number, as 4; take the quotes away"),
        ("repetitions: 4 ", "repetitions: 2026-11-24 ", "2026-11-24", "2026-11-24 must be a whole number, as 4"),
        ("title: Ready?", "title: #ready", " #ready", "nothing stands here; it must be text (what follows # is"),
        ("title: Ready?", "title: 10", "10\n    text: |\n      That was", 'be text; put it into quotes, as "10"'),
        ("title: Ready?", "title: *ready*", "*ready", "a text that begins with * needs quotes"),
        ("title: Ready?", "title: %ready", "%ready", "a text that begins with % needs quotes"),
        ("title: Ready?", "title: @ready", "@ready", "a text that begins with @ needs quotes"),
        ("between: [sex]", "between: sex", "sex\n  post_hoc", "'sex' must be a list, as [a, b]; put it into brackets"),
        ("actor: [F1, F2, M1, M2] ", "actor:\n    -F1\n    -F2", "-F1", "- and a space begin each line of one"),
        ("[0.8, 1.0, 1.2]", "[[0.8, 1.0], 1.2]", "[0.8, 1.0], 1.2", "[0.8, 1.0] must be text, or a number, as 1.2"),
        ("within: [actor, speed, start]", "within: actor, speed", "actor, speed\n", "as [actor, speed]"),
        ("lower: left", "lower: 1", "1, raise", '1 needs quotes here, as "1"'),
        ("lower: left", "lower: LEFT", "LEFT", "did you mean left?"),
        ("title: Ready?", "title: ''", "''", "there is nothing between the quotes; write a text"),
        ("speed: $speed", "speed: ${speed}", "${speed}", "write the factor's name after the $, as $speed"),
        ("language: en", "language: deutsch", "deutsch", "'deutsch' is no language; write its code, as en, de"),
        ("against: {F1: 0.00690", "against: {F1: 6,90", "{F1: 6", "against[90]: 90 must be text"),
        ("repetitions: 4 ", "1: 4\nrepetitions: 4 ", "1: 4", "a key is a name in letters, as speed"),
        ("repetitions: 4 ", "true: 4\nrepetitions: 4 ", "true: 4", "a key is a name in letters, as speed"),
        ("[0.8, 1.0, 1.2]", "['0.8', '1.0']", "'0.8'", "takes it from here; take the quotes away"),
        ("minimum_looking_time: 2 ", "minimum_looking_time: -1 ", "-1", "must be at least 0"),
        ("start: $start", "start: $strat", "$strat", "did you mean $start?"),
        ("[0.8, 1.0, 1.2]", "[0.8, slow, 1.2]", "slow, 1.2", "'slow' is not a number"),
        ("[80, 120] ", "[70, 120] ", "70, 120", "70 is outside the range 80 to 120"),
        ("start: $start", "start: {$speed: {0.8: 130, 1.0: 100, 1.2: 100}}", "130,", "130 is outside the range 80 to"),
        ("sex: [female, male]", "sex: [female, mail]", "mail]", "did you mean male?"),
        ("sex: [female, male]", "sex: [female, female]", "female]", "level female stands twice"),
        ("within: [actor, speed, start]", "within: [actor, sped, start]", "sped,", "did you mean speed?"),
        ("M2: 0.00700}", "M3: 0.00700}", "M3:", "M3 is no level of actor"),
        ("break: b,", "break: left,", "left, counter", "left is also the key for lower"),
        ("confirm: enter", "confirm: escape", "escape", "escape is kept for the pause page"),
        ("actor: [F1, F2, M1, M2] ", "actor: [F1, F1, M1, M2] ", "F1, M1, M2]", "level F1 stands twice"),
        ("{actor: T1, speed: 1.0, start: 120}", "{actor: T1, start: 120}", "{actor: T1, start", "speed is missing"),
        ("view: three_quarter", "view: sideways", "sideways", "side, front, legs, elevated or first_person"),
        ("exclusions: [] ", "exclusions: [{where: lat > 5, reason: x}]", "lat > 5", "lat is no column"),
        ("exclusions: [] ", "exclusions: [{where: reversals > 5 and la < 1, reason: x}]", "reversals > 5", "la is"),
        ("exclusions: [] ", "exclusions: [{where: reversals > 5 and low, reason: x}]", "reversals > 5", "'low' is"),
        ("exclusions: [] ", "exclusions: [{where: actor == $actr, reason: x}]", "actor == $actr", "mean actor?"),
        ("planned: 22", "planned: 22.5", "22.5", "22.5"),
        ("speed: $speed", "speed: $sped", "$sped", "did you mean $speed?"),
        ("repetitions: 4 ", "repetitions: 900 ", "900 ", "21600 trials; at most 10000"),
        ("{actor: T1, speed: 1.0,", "{actor: T1, speed: -1.0,", "-1.0", "must be more than 0"),
        ("[0.8, 1.0, 1.2]", "[0.8, .inf, 1.2]", ".inf", "a level must be a finite number"),
        ("start: [80, 120] ", "start: [80, 80.0] ", "80.0]", "level 80.0 stands twice"),
        ("actor: [F1, F2, M1, M2] ", "actor: [F1, yes, M1, M2]\n  trial: [a, b]", "trial: [a", "name of a column"),
    ],
)  # fmt: skip
def test_a_mistake_is_named_with_line_column_and_what_is_allowed(old, new, at, says):
    text = changed((old, new))
    said = message(text)
    assert says in said
    assert said.startswith(f"s.yaml:{place(text, at)}:"), (said, place(text, at))


def test_a_training_trial_whose_level_a_table_does_not_know_is_told_and_may_be_given_a_value_there():
    speeds = "{$actor: {F1: 1.0, F2: 1.0, M1: 1.0, M2: 1.0}}"
    text = changed(("speed: $speed", f"speed: {speeds}"))
    said = message(text)
    assert "practice[0].actor: T1 has no value in stimulus.speed, which has F1, F2, M1, M2" in said
    assert said.startswith(f"s.yaml:{place(text, 'T1, speed')}:"), said
    parse_study("s.yaml", text.replace("M2: 1.0}}", "M2: 1.0, T1: 1.0, T2: 1.1}}"))


def test_quoted_levels_are_not_blamed_on_the_training_trials():
    said = message(changed(("[0.8, 1.0, 1.2]", "['0.8', '1.0', '1.2']")))
    assert "practice" not in said


def test_a_second_study_in_a_file_is_told():
    assert "--- begins a second study here; a file holds one" in message(changed() + "\n---\nstudy: b\n")


def test_all_mistakes_are_reported_at_once():
    said = message(
        changed(("rate: 10 ", "rate: brisk "), ("order: random", "order: randm"), ("planned: 22", "planed: 22"))
    )
    assert len(said.splitlines()) == 3


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "s.yaml:1:1: the file is empty"),
        ("study: a\n\ttitle: b\n", "s.yaml:2:1: a tab cannot"),
        ("study: a\ntitle: b\nstudy: c\n", 's.yaml:3:1: found duplicate key "study"'),
        ("study: [a\n", "s.yaml:2:1:"),
        ("- a\n", "s.yaml:1:1: the file is"),
        ("study: Sex: which\n", "s.yaml:1:11: a text with a colon in it needs quotes"),
        ("a: [1, 2\nb: 3\n", "s.yaml:2:2: the bracket opened at 1:4 is not closed"),
        ("a: 'x\n", "s.yaml:2:1: the quote opened at 1:4 is not closed"),
        ("a:\n  b: 1\n c: 2\n", "s.yaml:3:2: this line is indented differently"),
        ("study: !!python/object/apply:os.system ['true']\n", "s.yaml:1:"),
    ],
)
def test_broken_yaml_is_one_sentence_with_its_place(text, says):
    assert message(text).startswith(says)


def test_a_file_that_is_not_utf_8_is_refused_with_the_place_of_the_byte(tmp_path):
    path = tmp_path / "latin.yaml"
    path.write_bytes(b"study: a\ntitle: caf\xe9\n")
    with pytest.raises(StudyFileError, match=r"latin.yaml:2:11: byte 0xe9 is not UTF-8"):
        read_study(str(path))


def test_an_unknown_study_names_the_shipped_ones():
    with pytest.raises(FileNotFoundError, match=r"Did you mean walk_ratio\?"):
        find_study("walk_ratoi")


def test_a_folder_or_a_misspelt_ending_says_what_to_name(tmp_path):
    (tmp_path / "good.yaml").write_text("study: a\n")
    with pytest.raises(FileNotFoundError, match="is a folder; name a study file in it"):
        find_study(str(tmp_path))
    with pytest.raises(FileNotFoundError, match=r"Did you mean .*good\.yaml\?"):
        find_study(str(tmp_path / "good.yml"))


def test_yes_and_no_are_words_and_0_8_is_a_number():
    file = parse_study("s.yaml", shipped_text())
    assert "yes" in file.study.participants.questions[2].options  # type: ignore[union-attr]
    assert file.study.factors["speed"] == [0.8, 1.0, 1.2]


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_a_mutated_study_file_is_accepted_or_refused_with_a_place_and_never_breaks(data):
    text = shipped_text()
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(text) - 1))
        length = data.draw(st.integers(0, 30))
        text = text[:at] + data.draw(st.text(max_size=8)) + text[at + length :]
    said = message(text)
    assert said == "" or said.startswith("s.yaml:")

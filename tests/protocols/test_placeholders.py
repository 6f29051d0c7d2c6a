"""Names in braces: those that stand for something where they are, and those that participants would read."""

from __future__ import annotations

import pytest

from experiment_app.command import run
from protocols.mistakes.placeholders import unknown_placeholders
from protocols.study_file import parse_study, shipped_studies
from tests.protocols.studies import changed, edited


def found(*replacements: tuple[str, str]) -> list[str]:
    study = parse_study("s.yaml", changed(*replacements)).study
    return [f"{'.'.join(map(str, one.where))}: {one.message}" for one in unknown_placeholders(study)]


KEYS = "{lower}, {raise}, {confirm}, {break}"


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("press {confirm}", "press {confrim}", "pages.instructions.0.text: {confrim} is shown to participants as it is "
         f"written; did you mean {{confirm}}? This text has {KEYS} filled in, and leaves other braces as they are"),
        ("press {confirm}", "press {foo}", "pages.instructions.0.text: {foo} is shown to participants as it is "
         f"written; this text has {KEYS} filled in, and leaves other braces as they are"),
        ("press {confirm}", "press {confirm", "did you mean {confirm}?"),
        ("press {confirm}", "press { confirm }", "did you mean {confirm}?"),
        ("every: 24  ", "every: 24\n  text: '{Done}!'  ", "breaks.text: {Done} is shown to participants as it "
         "is written; did you mean {done}? This text has {done}, {total} filled in"),
        ("title: Thank you!", "title: 'Thanks, {name}'", "pages.debrief.title: {name} is shown to participants as it "
         "is written; in this text nothing in braces is filled in"),
        ("prompt: What is", "prompt: Use {lower}. What is", "participants.questions.1.prompt: {lower} is shown"),
        ("female: Female", "female: '{F}'", "participants.questions.1.options.female: {F} is shown"),
        ("female: Female", "female: '{}'", "{} is shown"),
    ],
)  # fmt: skip
def test_a_name_that_stands_for_nothing_is_told_with_those_that_would(old, new, sentence):
    (told,) = found((old, new))
    assert sentence in told


@pytest.mark.parametrize("name", shipped_studies())
def test_shipped_studies_name_nothing_in_vain(name):
    assert list(unknown_placeholders(edited(name).study)) == []


def test_check_names_the_line_of_the_braces_themselves(tmp_path, capfd):
    text = changed(("press {confirm}", "press {confrim}"))
    path = tmp_path / "s.yaml"
    path.write_text(text, encoding="utf-8")
    assert run(["check", str(path)]) == 0
    line = next(n for n, one in enumerate(text.split("\n"), start=1) if "{confrim}" in one)
    said = " ".join(capfd.readouterr().err.split())
    assert f"Note: line {line}: {{confrim}} is shown to participants as it is written" in said

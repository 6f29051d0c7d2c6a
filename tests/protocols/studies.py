"""Study texts for tests: the shipped study, shortened, and with single places changed."""

from __future__ import annotations

from functools import cache

from pydantic import TypeAdapter

from protocols.orders.order import Order
from protocols.study import Study
from protocols.study_file import StudyFile, parse_study, read_study


def shipped_text() -> str:
    """The text of walk_ratio.yaml."""
    return read_study("walk_ratio").text


def changed(*replacements: tuple[str, str]) -> str:
    """walk_ratio.yaml with texts replaced; a text that is not there is an error of the test."""
    text = shipped_text()
    for old, new in replacements:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


def short() -> StudyFile:
    """Two actors, one speed, two starts, once: 4 trials after 2 training trials, a break after every second."""
    return parse_study(
        "short.yaml",
        changed(
            ("actor: [F1, F2, M1, M2]  ", "actor: [F1, M1]"),
            ("speed: [0.8, 1.0, 1.2]  ", "speed: [1.0]"),
            ("repetitions: 4  ", "repetitions: 1"),
            ("every: 24  ", "every: 2"),
            ("within: [actor, speed, start]", "within: [actor, start]"),
            ("{factor: speed, bound: 0.0003}", "{factor: start, bound: 0.0003}"),
            ("F1: 0.00690, F2: 0.00560, M1: 0.00700, M2: 0.00700", "F1: 0.00690, M1: 0.00700"),
            ("{kind: interaction, x: actor, lines: speed}", "{kind: interaction, x: actor, lines: start}"),
        ),
    )


@cache
def study() -> Study:
    """The shipped study."""
    return read_study("walk_ratio").study


def ordered(old: Study, **order: object) -> Study:
    """The study with another order, and other factors where `factors` and `repetitions` are given."""
    changes = {name: order.pop(name) for name in ("factors", "repetitions") if name in order}
    return old.model_copy(update={"order": TypeAdapter(Order).validate_python(order), **changes})


def edited(name: str, *replacements: tuple[str, str]) -> StudyFile:
    """A shipped study with texts replaced, checked only as far as its types go."""
    text = read_study(name).text
    for old, new in replacements:
        assert old in text, old
        text = text.replace(old, new, 1)
    return parse_study(f"{name}.yaml", text)


def few_choices(*replacements: tuple[str, str]) -> StudyFile:
    """speed_editing with one actor and one speed: 3 methods x 2 directions, each twice, after two training trials."""
    return edited(
        "speed_editing",
        ("actor: [F1, F2, M1, M2]", "actor: [F1]"),
        ("speed: [0.88, 1.06, 1.24]", "speed: [1.06]"),
        *replacements,
    )

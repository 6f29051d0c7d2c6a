"""Conditions that no trial can meet, or every trial meets, are told from those that say something."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protocols.condition import COMPARISONS, Condition, number_of
from protocols.mistakes.possible import Span, condition_mistakes
from tests.protocols.studies import edited

COLUMNS = {
    "rating": Span(1.0, 7.0, 1.0), "slider": Span(0.0, 100.0), "response_time": Span(), "correct": (0, 1),
    "chosen": ("captured", "rebuilt"), "original": ("captured", "rebuilt"), "speed": (0.8, 1.0, 1.2), "left": None,
}  # fmt: skip


def said(text: str, both_ways: bool = True) -> list[str]:
    return [one.message for one in condition_mistakes(text, ("order", "yes"), COLUMNS, both_ways=both_ways)]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("rating >= 500", "rating >= 500 is never true; rating can be: 1 to 7 in steps of 1"),
        ("rating > 7", "rating > 7 is never true; rating can be: 1 to 7 in steps of 1"),
        ("rating == 3.5", "rating is never 3.5; it can be: 1 to 7 in steps of 1"),
        ("rating >= high", "rating is a number, and high is none; it can be: 1 to 7 in steps of 1"),
        ("response_time > 30 s", "response_time is a number, and 30 s is none; it can be: 0 or more"),
        (
            "rating > 3 or slider > 3",
            "'rating > 3 or slider > 3' joins conditions by or, which cannot be; "
            "write one condition, or two exclusions",
        ),
        ("rating >= 1", "rating >= 1 is true of every trial; rating can be: 1 to 7 in steps of 1"),
        ("slider < 0", "slider < 0 is never true; slider can be: 0 to 100"),
        ("response_time < 0", "response_time < 0 is never true; response_time can be: 0 or more"),
        ("correct == true", "correct is never true; it can be: 0, 1"),
        ("chosen == left", "chosen is never left; it can be: captured, rebuilt"),
        ("chosen > captured", "chosen > captured is never true; chosen can be: captured, rebuilt"),
        ("chosen != left", "chosen != left is true of every trial; chosen can be: captured, rebuilt"),
        ("speed > 1.2", "speed > 1.2 is never true; speed can be: 0.8, 1.0, 1.2"),
    ],
)
def test_a_condition_that_tells_no_trials_apart_is_a_sentence_with_what_can_be(text, sentence):
    assert said(text) == [sentence]


@pytest.mark.parametrize(
    "text",
    ["rating >= 7", "rating == 3", "rating != 7", "slider == 33.3", "response_time > 600", "correct == 1",
     "chosen == captured", "chosen != $original", "speed >= 1.2", "left == whatever", "speed == 0.80"],
)  # fmt: skip
def test_a_condition_that_some_trials_meet_is_none(text):
    assert said(text) == []


def test_what_every_trial_meets_is_told_only_where_it_matters():
    assert said("rating >= 1", both_ways=False) == []


@given(
    st.integers(-5, 5), st.integers(1, 12), st.sampled_from([0.1, 0.25, 0.5, 1.0, 2.0]),
    st.sampled_from([*COMPARISONS]), st.integers(-40, 120),
)  # fmt: skip
def test_the_verdict_on_a_scale_is_that_of_trying_all_its_points(minimum, steps, step, sign, tenths):
    points = [round(minimum + k * step, 9) for k in range(steps + 1)]
    held = {COMPARISONS[sign](point, tenths / 10) for point in points}
    columns = {"rating": Span(float(minimum), points[-1], step)}
    found = list(condition_mistakes(f"rating {sign} {tenths / 10:g}", (), columns))
    assert bool(found) == (len(held) == 1)


def test_an_answer_outside_the_scale_is_refused_before_anyone_sits_down():
    from protocols.mistakes.consistency import inconsistencies

    study = edited(
        "fourier_naturalness",
        (
            "  exclusions: []",
            "  exclusions: [{where: rating > 10, reason: odd}]\n  proportions: [{success: rating >= -1}]",
        ),
    ).study
    assert {mistake.message for mistake in inconsistencies(study)} == {
        "rating > 10 is never true; rating can be: 0 to 4 in steps of 1",
        "rating >= -1 is true of every trial; rating can be: 0 to 4 in steps of 1",
    }


def test_alternatives_named_as_what_is_no_number_are_words():
    assert [number_of(one) for one in ("nan", "-inf", "infinity", "Nan Jing", None)] == [None] * 5
    assert [number_of(one) for one in ("3", " 1.5 ", True, 2)] == [3.0, 1.5, 1.0, 2.0]
    assert Condition("chosen", "==", "nan").holds({"chosen": "nan"})
    assert not Condition("chosen", "!=", "$original").holds({"chosen": "nan", "original": "nan"})

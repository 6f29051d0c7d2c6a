"""Pages to fill in: keyboard alone and mouse alone both reach every answer, and nothing wrong gets through."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protocols.events import Clicked, KeyDown, Typed
from protocols.form import Choice, Entry, Form, handle_form

AGE = Entry("age", "How old are you?", digits=True, minimum=18, maximum=99)
SEX = Choice("sex", "Sex?", (("female", "Female"), ("male", "Male"), ("not_said", "-")))
NAME = Entry("note", "Anything else?", required=False, max_length=5)


def questions() -> Form:
    return Form(fields=(AGE, SEX, NAME), buttons=(("next", "Continue"),), submit="next", focus=0)


def keyed(form: Form, *keys: str) -> Form:
    for key in keys:
        form = handle_form(form, KeyDown(0.0, key) if len(key) > 1 else Typed(0.0, key))
    return form


def test_the_keyboard_alone_fills_a_page():
    form = keyed(questions(), "3", "4", "enter", "right", "right", "enter", "o", "k", "enter", "enter")
    assert (form.pressed, form.values) == ("next", {"age": "34", "sex": "male", "note": "ok"})


def test_the_mouse_alone_chooses_and_continues():
    form = questions()
    for event in (Clicked(0, "age"), Typed(0, "34"), Clicked(0, "sex:female"), Clicked(0, "next")):
        form = handle_form(form, event)
    assert (form.pressed, form.values["sex"]) == ("next", "female")


@pytest.mark.parametrize(("age", "error"), [("", "Please answer"), ("17", "from 18 to 99"), ("100", "from 18 to 99")])
def test_a_missing_or_impossible_age_is_said_beside_it_and_focused(age, error):
    form = handle_form(keyed(questions(), *age, "tab", "right"), Clicked(0.0, "next"))
    assert not form.pressed
    assert error in form.errors["age"]
    assert form.focus == 0


def test_an_error_goes_away_when_the_answer_changes():
    form = handle_form(questions(), Clicked(0.0, "next"))
    assert "age" in form.errors
    assert "age" not in keyed(handle_form(form, Clicked(0.0, "age")), "3").errors


def test_letters_do_not_enter_a_number_and_other_scripts_digits_do():
    assert keyed(questions(), "a", "٣", "4", "-").values["age"] == "34"


def test_typed_text_ends_at_the_maximum_length():
    form = handle_form(questions(), Clicked(0.0, "note"))
    assert keyed(form, *"abcdefgh").values["note"] == "abcde"


def test_enter_on_a_consent_page_without_a_choice_does_nothing():
    form = Form(buttons=(("agree", "I agree"), ("decline", "No")))
    assert not keyed(form, "enter", "space").pressed
    assert keyed(form, "right", "enter").pressed == "agree"
    assert keyed(form, "left", "enter").pressed == "agree"  # one press never lands on the refusal
    assert keyed(form, "right", "right", "enter").pressed == "decline"


def test_an_impossible_number_is_said_when_its_field_is_left():
    assert "from 18 to 99" in keyed(questions(), "1", "5", "0", "tab").errors["age"]
    assert "age" not in keyed(questions(), "tab").errors


def test_shift_and_tab_go_back():
    assert keyed(questions(), "tab", "tab", "backtab").focus == 1


def test_joiners_that_belong_to_a_spelling_are_kept():
    form = handle_form(Form(fields=(Entry("n", "?"),), focus=0), Typed(0.0, "می\u200cروم\u202e"))
    assert form.values["n"] == "می\u200cروم"


def test_enter_leaves_a_page_that_is_only_to_be_read():
    assert keyed(Form(), "space", "a").pressed == ""
    assert keyed(Form(), "enter").pressed == "next"


@given(st.lists(st.one_of(
    st.sampled_from(["tab", "up", "down", "left", "right", "enter", "space", "backspace", "escape"]).map(
        lambda key: KeyDown(0.0, key)),
    st.text(max_size=3).map(lambda text: Typed(0.0, text)),
    st.sampled_from(["age", "sex", "sex:male", "sex:other", "next", "nothing"]).map(lambda box: Clicked(0.0, box)),
), max_size=40))  # fmt: skip
def test_whatever_is_pressed_a_finished_page_holds_only_valid_answers(events):
    form = questions()
    for event in events:
        form = handle_form(form, event)
    if form.pressed:
        assert 18 <= int(form.values["age"]) <= 99
        assert form.values["sex"] in ("female", "male", "not_said")
        assert len(form.values.get("note", "")) <= 5

"""Rating scales on a page: every point can be clicked, in any window, from the right in a right-to-left script too."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from experiment_app.render.layout import hit, layout_page
from experiment_app.scene import Box, Page, Row, Slider

WINDOWS = st.sampled_from([(640, 360), (1280, 720), (1920, 1080), (3840, 2160), (800, 600)])
FIVE = Slider("scale", 0.0, 4.0, 1.0, "not realistic", "as natural as the original")
LINE = Slider("scale", -10.0, 10.0, None, "much worse", "much better", 2.5)
CAPTION = "The walk on the left is the original. How natural is the one on the right?"


def page(slider: Slider, caption: str = CAPTION) -> Page:
    return Page((), (Row(caption, (Box("confirm", "Continue", "button"),), slider=slider),), strip=0.2)


@given(WINDOWS, st.integers(0, 4))
def test_a_click_on_a_point_is_its_value(window, index):
    layout = layout_page(page(FIVE), *window, 1.0)
    assert layout.complete
    (scale,) = layout.sliders
    at = scale.points[index]
    assert hit(layout, at.x + at.width / 2, at.y + at.height / 2) == f"scale:{index}"


@given(WINDOWS, st.floats(0.0, 1.0))
def test_a_click_anywhere_on_a_line_is_a_value_of_it_and_rises_to_the_right(window, share):
    layout = layout_page(page(LINE), *window, 1.0)
    (scale,) = layout.sliders
    at = scale.rectangle
    x = at.x + share * (at.width - 1)
    value = scale.value_at(x)
    assert -10.0 <= value <= 10.0
    assert scale.value_at(x + 5.0) >= value


def test_the_mark_of_a_line_stands_where_its_value_is_clicked():
    (scale,) = layout_page(page(LINE), 1920, 1080, 1.0).sliders
    assert scale.knob is not None
    assert scale.value_at(scale.knob.x + scale.knob.width / 2) == pytest.approx(2.5, abs=0.02)


@given(WINDOWS)
def test_a_scale_stays_where_it_is_when_the_missing_answer_is_named(window):
    before = page(FIVE)
    after = replace(before, rows=(replace(before.rows[0], error="Please answer this question."),))
    without, with_sentence = (layout_page(found, *window, 1.0) for found in (before, after))
    assert (without.sliders, without.boxes) == (with_sentence.sliders, with_sentence.boxes)
    (sentence,) = [text for text in with_sentence.texts if text.role == "error"]
    assert sentence.rectangle.bottom <= window[1]
    assert with_sentence.complete


@given(WINDOWS)
def test_nothing_on_the_strip_overlaps_or_leaves_it(window):
    width, height = window
    layout = layout_page(page(FIVE), width, height, 1.0)
    places = [t.rectangle for t in layout.texts if t.role in ("prompt", "small")]
    places += [layout.boxes[0].rectangle, *layout.sliders[0].points]
    assert not any(a.overlaps(b) for a, b in combinations(places, 2))
    assert all(height - round(0.2 * height) <= at.y and at.bottom <= height for at in places)
    assert all(at.x >= 0 and at.right <= width for at in places)


def test_a_right_to_left_scale_begins_on_the_right():
    slider = Slider("scale", 0.0, 4.0, 1.0, "غير واقعي", "طبيعي")
    (scale,) = layout_page(page(slider, "ما مدى طبيعية المشي؟"), 1280, 720, 1.0).sliders
    assert scale.points[0].x > scale.points[4].x
    at = scale.points[4]
    assert scale.value_at(at.x + at.width / 2) == 4.0

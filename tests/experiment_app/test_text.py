"""Fonts and lines of text: what covers what, where lines end, and that no string is too strange."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from experiment_app.render.fonts import _font_folders, can_shape, main_face, missing_glyphs, needs_shaping
from experiment_app.render.text import (
    break_lines,
    clean,
    is_right_to_left,
    last_part,
    mask_of,
    overhang,
    width_of,
)

ANY_TEXT = st.text(st.characters(), max_size=60)  # surrogates and controls too
SENTENCE = "Hold ← for fewer, longer steps, hold → for more, shorter steps, and press Enter."


@pytest.mark.parametrize(
    "text",
    ["Où êtes-vous né ?", "Θα δείτε έναν άνθρωπο", "Вы увидите человека", "سترى شخصًا واحدًا", "תראו אדם אחד", "← → ✓ …"],
)
def test_latin_greek_cyrillic_arabic_hebrew_and_arrows_need_no_font_of_the_system(text):
    assert missing_glyphs(text) == frozenset()


def test_a_character_that_no_font_has_is_reported_and_spaces_and_joiners_are_not():
    assert missing_glyphs("a \u200d\ufe0f\n\U0010fffd") == {"\U0010fffd"}


def test_the_main_font_is_the_one_that_comes_with_matplotlib():
    assert main_face(False).path.endswith("DejaVuSans.ttf")
    assert main_face(True).path.endswith("DejaVuSans-Bold.ttf")


def test_latin_is_set_without_the_systems_shaping_so_that_its_pixels_are_the_same_everywhere():
    assert not needs_shaping("Où êtes-vous né ? Θα δείτε Вы увидите 中文 ←")
    assert needs_shaping("سترى")
    assert needs_shaping("हिन्दी")


def test_a_letter_and_its_accent_are_composed():
    assert clean("e\u0301te\u0301") == "été"


def test_a_broken_half_of_a_character_becomes_a_replacement_character():
    assert clean("a\ud800b\tc\0") == "a\ufffdb c "


def test_no_line_is_wider_than_asked_and_no_word_is_lost():
    lines = break_lines(SENTENCE, 28, False, 300.0)
    assert len(lines) > 3
    assert all(width_of(line, 28) <= 300.0 for line in lines)
    assert " ".join(lines) == SENTENCE


def test_a_paragraph_does_not_end_with_a_lonely_word_where_that_can_be_helped():
    text = "one two three four five six seven eight nine ten"
    width = width_of(text.removesuffix(" ten"), 28) + 1.0
    assert break_lines(text, 28, False, width)[-1] != "ten" or len(break_lines(text, 28, False, width)) == 1


def test_a_word_wider_than_the_line_is_broken():
    lines = break_lines("Donaudampfschifffahrtsgesellschaft", 28, False, 120.0)
    assert len(lines) > 2
    assert "".join(lines) == "Donaudampfschifffahrtsgesellschaft"


def test_chinese_breaks_between_characters_but_never_before_a_full_stop():
    lines = break_lines("您会看到一个人在走路。按住键走得更慢，选择看起来最自然的步态。", 28, False, 160.0)
    assert len(lines) > 3
    assert not any(line[0] in "，。" for line in lines)


def test_a_mark_is_never_parted_from_its_letter():
    lines = break_lines("x\u0323\u0304" * 30, 28, False, 100.0)
    assert len(lines) > 2
    assert all(line.startswith("x") for line in lines)


def test_a_long_answer_shows_its_end():
    shown = last_part("I have been a research engineer for a long time", 28, False, 200.0)
    assert shown.startswith("…")
    assert shown.endswith("time")
    assert width_of(shown, 28) <= 200.0


def test_the_first_letter_with_a_direction_gives_the_paragraphs():
    assert is_right_to_left("1. תראו Enter")
    assert not is_right_to_left("Enter תראו")


@pytest.mark.parametrize("text", [SENTENCE, "AVATAR To jiffy", "Ωμέγα"])
@pytest.mark.parametrize("size", [12, 17, 28, 61])
def test_ink_is_inside_the_width_and_the_line(text, size):
    mask = mask_of(text, size, False, round(1.5 * size))
    columns = np.flatnonzero(mask.any(axis=0))
    margin = overhang(size)
    assert columns[0] >= margin // 2
    assert columns[-1] <= mask.shape[1] - margin // 2
    assert not mask[0].any()
    assert not mask[-1].any()


@pytest.mark.skipif(not can_shape(), reason="Pillow found no FriBiDi here")
def test_arabic_letters_are_joined():
    assert width_of("سترى", 60) < 0.95 * sum(width_of(letter, 60) for letter in "سترى")


@settings(deadline=None, max_examples=150)
@given(ANY_TEXT, st.integers(6, 40), st.floats(1.0, 900.0))
def test_any_text_at_all_can_be_broken_into_lines_and_drawn(text, size, width):
    for line in break_lines(clean(text), size, False, width):
        assert mask_of(line, size, False, 2 * size).dtype == np.uint8
    assert isinstance(missing_glyphs(text), frozenset)


@settings(deadline=None, max_examples=100)
@given(st.text("abc éß-中。 ", max_size=80), st.floats(60.0, 900.0))
def test_breaking_loses_only_spaces(text, width):
    lines = break_lines(clean(text), 20, False, width)
    assert "".join(lines).replace(" ", "") == text.replace(" ", "")
    assert all(width_of(line, 20) <= width for line in lines)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the folders of Linux")
def test_an_empty_list_of_data_folders_is_no_list(monkeypatch):
    """As the XDG Base Directory Specification has it."""
    monkeypatch.setenv("XDG_DATA_DIRS", "")
    assert Path("/usr/share/fonts") in _font_folders()

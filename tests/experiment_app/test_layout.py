"""Where things go on a page: inside the window, apart from each other, large enough to read, easy to click."""

from __future__ import annotations

from itertools import combinations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from experiment_app.render.layout import hit, layout_caption, layout_page
from experiment_app.render.page_shapes import (
    ACCENT,
    BACKS,
    CAPTION_BACK,
    CARD,
    FIELD,
    INKS,
    PAGE,
    PageLayout,
    Rectangle,
    colour,
    contrast,
    over,
)
from experiment_app.scene import Box, Line, Page, Row

PARAGRAPH = (
    "In this study you will watch people walking on the screen and adjust how they walk. It takes about half "
    "an hour. You can take a break at any time, and you can stop at any time without giving a reason."
)
BUTTONS = Row("", (Box("yes", "I take part", "button", focused=True), Box("no", "I do not take part", "button")))
CONSENT = Page(
    (Line("Taking part in this study", "title"), Line(PARAGRAPH), Line(PARAGRAPH), Line("A detail.", "small")),
    (BUTTONS,),
    hint="Choose with the arrow keys and Enter, or with the mouse.",
)
QUESTIONS = Page(
    (Line("A few questions", "title"),),
    (
        Row("How old are you (years)?", (Box("age", "7", "field"),), "Please type a whole number from 18 to 99."),
        Row(
            "How often do you play video games in which people are seen walking?",
            tuple(
                Box(f"games:{i}", label, "option", chosen=i == 1, focused=True)
                for i, label in enumerate(("Never", "Less than once a month", "Every week " * 12, "Every day"))
            ),
        ),
        Row("Is your vision normal?", (Box("v:yes", "Yes", "option"), Box("v:no", "No", "option")), "Please answer."),
        Row("", (Box("go", "Continue", "button"),)),
    ),
    hint="Tab or arrows move between answers; Enter continues.",
)
ARABIC = Page(
    (Line("بعض الأسئلة", "title"), Line("سترى شخصًا واحدًا يمشي في كل مرة.")),
    (
        Row("كم عمرك؟", (Box("age", "27", "field", focused=True),), "من فضلك اكتب عددًا."),
        Row("ما جنسك؟", (Box("f", "أنثى", "option", chosen=True), Box("m", "ذكر", "option"))),
    ),
    hint="اضغط على Enter",
)
LONG = Page((Line("Information", "title"), *(Line(PARAGRAPH + " " + PARAGRAPH) for _ in range(6))), (BUTTONS,))
BREAK = Page((Line("Time for a break", "title"), Line("Rest your eyes.")), hint="Press Enter.", progress=0.25)
PAUSE = Page((Line("Pause", "title"), Line("Take your time.")), (BUTTONS,), hint="Choose.", over_scene=True)
PAGES = {
    "consent": CONSENT,
    "questions": QUESTIONS,
    "arabic": ARABIC,
    "long": LONG,
    "break": BREAK,
    "pause": PAUSE,
}
WINDOWS = [
    (800, 600, 1.0),
    (1024, 768, 1.0),
    (1280, 720, 1.0),
    (1920, 1080, 1.0),
    (2560, 1080, 1.0),
    (3440, 1440, 1.0),
    (1080, 1920, 1.0),
    (2560, 1440, 2.0),
    (3840, 2160, 2.0),
]

every_page = pytest.mark.parametrize("page", PAGES.values(), ids=PAGES.keys())
every_window = pytest.mark.parametrize(("width", "height", "ratio"), WINDOWS)


def rectangles(layout: PageLayout) -> list[Rectangle]:
    """Everything that is drawn, boxes as wholes."""
    parts = [text.rectangle for text in layout.texts if text.role != "sign"]
    parts += [placed.rectangle for placed in layout.boxes]
    return parts + [*layout.signs] + ([layout.track] if layout.track else [])


@every_page
@every_window
def test_everything_is_inside_the_window(page, width, height, ratio):
    layout = layout_page(page, width, height, ratio)
    assert layout.complete
    for part in [*rectangles(layout), *layout.rings, *([layout.card] if layout.card else [])]:
        assert part.x >= 0
        assert part.y >= 0
        assert part.right <= width
        assert part.bottom <= height


@every_page
@every_window
def test_nothing_overlaps(page, width, height, ratio):
    layout = layout_page(page, width, height, ratio)
    assert not [pair for pair in combinations(rectangles(layout), 2) if pair[0].overlaps(pair[1])]
    texts = [text.rectangle for text in layout.texts]
    assert not [text for text in texts for ring in layout.rings if ring.overlaps(text)]


@every_page
@every_window
def test_labels_and_carets_are_inside_their_boxes_and_apart(page, width, height, ratio):
    for placed in layout_page(page, width, height, ratio).boxes:
        parts = [text.rectangle for text in placed.texts if text.role != "check"]
        parts += [part for part in (placed.mark, placed.caret) if part]
        assert not [pair for pair in combinations(parts, 2) if pair[0].overlaps(pair[1])]
        for part in parts:
            assert placed.rectangle.contains(part.x, part.y)
            assert part.right <= placed.rectangle.right
            assert part.bottom <= placed.rectangle.bottom


@every_page
@every_window
def test_text_is_large_enough_to_read(page, width, height, ratio):
    """1.3 % of the height is a capital letter of 0.26 degrees on a 24-inch display seen from 60 cm."""
    for text in layout_page(page, width, height, ratio).texts:
        if text.text and text.role != "sign":
            assert text.size >= 8.5 * ratio
            assert text.size >= 0.013 * min(height, width / 1.25)


@pytest.mark.parametrize(("width", "height", "ratio"), [(1920, 1080, 1.0), (2560, 1440, 2.0), (3840, 2160, 2.0)])
def test_an_ordinary_page_has_the_same_proportions_at_any_density(width, height, ratio):
    sizes = {text.role: text.size / height for text in layout_page(CONSENT, width, height, ratio).texts}
    assert sizes["title"] == pytest.approx(0.042, abs=0.001)
    assert sizes["text"] == pytest.approx(0.026, abs=0.0005)
    assert sizes["hint"] == pytest.approx(0.0205, abs=0.001)


def test_lines_hold_about_sixty_letters():
    lines = [t.text for t in layout_page(CONSENT, 1920, 1080, 1.0).texts if t.role == "text"]
    assert 52 <= max(map(len, lines)) <= 70


def test_paragraphs_share_a_left_edge_and_the_column_is_in_the_middle():
    layout = layout_page(BREAK, 1920, 1080, 1.0)
    assert layout.track is not None
    assert abs(layout.track.x + layout.track.right - 1920) <= 1
    assert {text.rectangle.x for text in layout.texts} == {layout.track.x}


def test_right_to_left_pages_are_mirrored():
    layout = layout_page(ARABIC, 1920, 1080, 1.0)
    assert len({text.rectangle.right for text in layout.texts if text.role in ("title", "text", "prompt")}) == 1
    first, second = (placed.rectangle for placed in layout.boxes if placed.box.kind == "option")
    assert first.x > second.right


def test_choosing_an_answer_moves_nothing():
    def chosen(which: int) -> Page:
        boxes = tuple(Box(str(i), label, "option", chosen=i == which) for i, label in enumerate(("Yes", "No")))
        return Page(rows=(Row("Is your vision normal?", boxes),))

    before, after = (layout_page(chosen(which), 1920, 1080, 1.0) for which in (-1, 1))
    assert [p.rectangle for p in before.boxes] == [p.rectangle for p in after.boxes]


def test_progress_fills_its_part_of_the_bar_and_no_more():
    for progress, part in ((0.25, 0.25), (1.0, 1.0), (7.0, 1.0), (-1.0, 0.0)):
        layout = layout_page(Page(progress=progress), 1920, 1080, 1.0)
        assert layout.track is not None
        assert layout.done is not None
        assert layout.done.width == pytest.approx(part * layout.track.width, abs=1)


@every_page
@every_window
def test_a_click_on_a_box_answers_its_id_and_beside_all_boxes_nothing(page, width, height, ratio):
    layout = layout_page(page, width, height, ratio)
    for placed in layout.boxes:
        at = placed.rectangle
        assert hit(layout, at.x + at.width / 2, at.y + at.height / 2) == placed.box.id
        assert hit(layout, at.x, at.y) == placed.box.id
        assert hit(layout, at.x - 1, at.y) is None
    assert hit(layout, 0, 0) is None


def test_a_page_without_anything_has_nothing_on_it():
    layout = layout_page(Page(), 1920, 1080, 1.0)
    assert (layout.texts, layout.boxes, layout.card) == ((), (), None)


@pytest.mark.parametrize("size", [(1, 1), (3, 200), (200, 3), (64, 64)])
def test_a_tiny_window_is_no_error(size):
    for page in PAGES.values():
        layout_page(page, *size, 1.0)
    layout_caption("Adjust the steps.", *size, 1.0)


@every_window
def test_the_caption_is_in_the_lower_part_of_the_window(width, height, ratio):
    layout = layout_caption(
        "Adjust the steps with ← and →. Press Enter when the walk looks natural.", width, height, ratio
    )
    assert layout.card is not None
    assert layout.card.y > 0.8 * height
    assert layout.card.bottom < height
    assert layout.card.x >= 0
    assert all(layout.card.overlaps(text.rectangle) for text in layout.texts)


@pytest.mark.parametrize("role", INKS)
def test_every_kind_of_text_has_a_contrast_of_at_least_seven(role):
    assert contrast(INKS[role], BACKS.get(role, PAGE)) >= 7.0


def test_typed_text_captions_and_pages_over_a_scene_have_it_too_even_on_white():
    white = colour("#ffffff")
    assert contrast(INKS["label"], FIELD) >= 7.0
    assert contrast(INKS["text"], over(CAPTION_BACK, white)) >= 7.0
    assert contrast(INKS["hint"], over(CARD, white)) >= 7.0
    assert contrast(ACCENT, PAGE) >= 7.0


texts = st.text(st.characters(), max_size=80)
boxes = st.builds(Box, texts, texts, st.sampled_from(["field", "option", "button"]), st.booleans(), st.booleans())
pages = st.builds(
    Page,
    st.lists(st.builds(Line, texts, st.sampled_from(["title", "text", "small", "hint", "error"])), max_size=3).map(
        tuple
    ),
    st.lists(st.builds(Row, texts, st.lists(boxes, max_size=4).map(tuple), texts), max_size=3).map(tuple),
    texts,
    st.none() | st.floats(0, 1),
    st.booleans(),
)


@settings(deadline=None, max_examples=60)
@given(pages, st.sampled_from(WINDOWS))
def test_any_page_at_all_fits_without_overlaps(page, window):
    layout = layout_page(page, *window)
    assert layout.complete
    assert all(part.x >= 0 and part.right <= window[0] for part in rectangles(layout))
    assert not [pair for pair in combinations(rectangles(layout), 2) if pair[0].overlaps(pair[1])]


@pytest.mark.parametrize(("width", "height", "ratio"), [(1280, 720, 1.0), (1920, 1080, 1.0), (3840, 2160, 2.0)])
def test_titles_stand_at_one_height_on_all_ordinary_pages(width: int, height: int, ratio: float) -> None:
    """From a page of two words to one of a hundred and twenty with buttons."""
    button = Row("", (Box("next", "Continue", "button"),))
    pages = [
        Page((Line("Title", "title"), Line("word " * words)), rows, hint=hint)
        for words, rows, hint in ((2, (), ""), (60, (), "Press Enter"), (120, (button,), "Press Enter"))
    ]
    tops = {layout_page(page, width, height, ratio).texts[0].rectangle.y for page in pages}
    assert len(tops) == 1

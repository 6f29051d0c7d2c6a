"""Pages as pixels: the same each time, over what they should be over, and not drawn anew without need."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from experiment_app.render.page_shapes import BUTTON, CARD, INKS, PAGE, Colour
from experiment_app.render.pages import PagePainter
from experiment_app.scene import Box, Line, Page, Row, Scene, Slider, Walker

SIZE = (640, 360)
WALKER = Walker("F1", 1.0, 100.0, 0.0)
TEXT = Page((Line("Your task", "title"), Line("Hold ← or →.")), hint="Press Enter.")
PAUSE = Page((Line("Pause", "title"),), (Row("", (Box("go", "Resume", "button", focused=True),)),), over_scene=True)


@pytest.fixture(scope="module")
def target(context):
    """One framebuffer for all: moderngl would bind a released one again."""
    return context.simple_framebuffer(SIZE)


@pytest.fixture
def drawn(context, target):
    """A function from a scene to its pixels, (height, width, 3) uint8, top row first, over plain white."""
    painter = PagePainter(context, SIZE, 1.0)

    def draw(scene: Scene) -> NDArray[np.uint8]:
        target.use()
        target.clear(1.0, 1.0, 1.0, 1.0)
        painter.draw(scene)
        assert context.fbo is target
        assert context.error == "GL_NO_ERROR"
        pixels = np.frombuffer(target.read(components=3, alignment=1), np.uint8)
        return pixels.reshape(SIZE[1], SIZE[0], 3)[::-1]

    yield draw
    painter.release()


def codes(of: Colour) -> list[int]:
    return [round(255 * part) for part in of[:3]]


def test_between_trials_the_screen_is_plain(drawn):
    for scene in (Scene(page=Page()), Scene()):
        assert (drawn(scene) == codes(PAGE)).all()


def test_a_scene_with_a_walker_and_nothing_to_read_is_left_alone(drawn):
    assert (drawn(Scene((WALKER,))) == 255).all()


def test_a_page_covers_the_scene_and_shows_its_text_the_right_way_up(drawn):
    pixels = drawn(Scene((WALKER,), page=TEXT))
    assert (pixels[0] == codes(PAGE)).all()
    assert (pixels == codes(INKS["title"])).all(axis=2).any()
    rows = np.flatnonzero((pixels != codes(PAGE)).any(axis=(1, 2)))
    assert rows[0] < 180 < rows[-1]
    assert (pixels[rows[0] : rows[0] + 20] == codes(INKS["title"])).all(axis=2).any()


def test_a_pause_dims_the_scene_and_stands_on_a_card(drawn):
    pixels = drawn(Scene((WALKER,), page=PAUSE))
    corner = pixels[0, 0].astype(int)
    assert (corner < 160).all()
    assert (corner > codes(PAGE)).all()
    assert (pixels == codes(CARD)).all(axis=2).mean() > 0.05


def test_a_caption_darkens_only_the_lower_edge(drawn):
    pixels = drawn(Scene((WALKER,), caption="Press Enter when the walk looks natural."))
    assert (pixels[:280] == 255).all()
    assert (pixels[280:] != 255).any()


def test_the_same_scene_gives_the_same_pixels_whatever_was_shown_before(drawn):
    first = drawn(Scene(page=TEXT)).copy()
    drawn(Scene((WALKER,), page=PAUSE, caption="x"))
    assert (drawn(Scene(page=TEXT)) == first).all()


def test_focus_choice_and_error_can_be_seen_without_colour(drawn):
    """Every state changes brightness, not only hue."""
    box = Box("yes", "Yes", "option")
    page = Page(rows=(Row("Normal vision?", (box, Box("no", "No", "option"))),))
    states = [
        page,
        replace(page, rows=(replace(page.rows[0], boxes=(replace(box, chosen=True), page.rows[0].boxes[1])),)),
        replace(page, rows=(replace(page.rows[0], boxes=(replace(box, focused=True), page.rows[0].boxes[1])),)),
        replace(page, rows=(replace(page.rows[0], error="Please answer."),)),
    ]
    grey = [drawn(Scene(page=state)).astype(float).mean(axis=2) for state in states]
    assert all(np.abs(state - grey[0]).max() > 60 for state in grey[1:])


def test_a_page_that_does_not_change_is_composed_once(context, target, monkeypatch):
    painter = PagePainter(context, SIZE, 1.0)
    target.use()
    painter.draw(Scene(page=TEXT))
    monkeypatch.setattr("experiment_app.render.pages._sheet", None)
    painter.draw(Scene(page=TEXT))
    painter.release()


def test_after_resizing_a_click_finds_the_button_where_it_is_drawn(context):
    painter = PagePainter(context, SIZE, 1.0)
    painter.resize((1280, 720), 2.0)
    larger = context.simple_framebuffer((1280, 720))
    larger.use()
    painter.draw(Scene(page=PAUSE))
    pixels = np.frombuffer(larger.read(components=3, alignment=1), np.uint8).reshape(720, 1280, 3)[::-1]
    spots = [(x, y) for x in range(0, 1280, 4) for y in range(0, 720, 4)]
    assert {painter.hit(PAUSE, x, y) for x, y in spots} == {None, "go"}
    for x, y in spots:
        if (pixels[y, x] == codes(BUTTON)).all():
            assert painter.hit(PAUSE, x, y) == "go"
    painter.release()


def test_a_question_in_a_strip_changes_nothing_above_it(drawn):
    row = Row(
        "How natural?", (Box("go", "Go on", "button"),), slider=Slider("scale", 0.0, 4.0, 1.0, "low", "high", 3.0)
    )
    pixels = drawn(Scene((WALKER,), page=Page((), (row,), over_scene=True, strip=0.25), strip=0.25))
    assert (pixels[:270] == 255).all()
    assert len(np.unique(pixels[270:].reshape(-1, 3), axis=0)) > 10

"""Two scenes side by side: equal halves, each as it would be alone, one page over both, parts found in either."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np
import pytest
from numpy.typing import NDArray

from experiment_app.render.renderer import Renderer
from experiment_app.render.viewports import divide
from experiment_app.scene import Camera, Ground, Line, Marks, Page, Scene, Walker
from experiment_app.walkers import measured_gait
from tests.experiment_app.drawing import picture

SIZE = (480, 270)
WALKER = Walker("F1", 1.2, 105.0, 0.3, distance=4.7)
CLOSE = Camera("three_quarter", 4.5, 1.2, 30.0)
Pixels = NDArray[np.uint8]


def halves(pixels: Pixels) -> tuple[Pixels, Pixels, Pixels]:
    """Left half, right half, strip."""
    height, width = pixels.shape[:2]
    (_, _, half, _), (right, _, _, _), _ = divide((width, height))
    return pixels[:, :half], pixels[:, right:], pixels[:, half:right]


@pytest.mark.parametrize("width", range(1, 9))
@pytest.mark.parametrize("height", [1, 270, 1080, 2160])
def test_the_halves_and_the_strip_fill_the_picture_once(width: int, height: int) -> None:
    left, right, strip = divide((1280 + width, height))
    assert left[2:] == right[2:]
    assert (left[0], left[0] + left[2], strip[0] + strip[2], right[0] + right[2]) == (
        0,
        strip[0],
        right[0],
        1280 + width,
    )
    assert 2 <= strip[2] <= max(2, height / 240) + 1.5


@pytest.mark.parametrize("size", [SIZE, (481, 271)])
@pytest.mark.parametrize(
    ("ground", "body"),
    [("open_ground", ""), ("treadmill", ""), ("plain", "point_light"), ("plain", "stick_figure"), ("plain", "")],
)
def test_equal_scenes_are_equal_to_the_pixel_on_both_sides(
    context: moderngl.Context, renderer: Renderer, ground: Ground, body: str, size: tuple[int, int]
) -> None:
    scene = Scene((replace(WALKER, body=body),), CLOSE, ground)
    left, right, _ = halves(picture(context, renderer, replace(scene, beside=scene), size))
    assert np.array_equal(left, right)
    assert left.std() > 5.0


def test_each_half_is_what_a_picture_of_that_size_is(context: moderngl.Context, renderer: Renderer) -> None:
    first = Scene((WALKER,), CLOSE)
    second = Scene((replace(WALKER, actor="M1", phase=0.8),), Camera("side", 4.0), "treadmill")
    left, right, strip = halves(picture(context, renderer, replace(first, beside=second), SIZE))
    alone = left.shape[1], left.shape[0]
    assert np.array_equal(left, picture(context, renderer, first, alone))
    assert np.array_equal(right, picture(context, renderer, second, alone))
    assert len(np.unique(strip.reshape(-1, 3), axis=0)) == 1


def test_the_viewers_angle_counts_in_both_halves(context: moderngl.Context, renderer: Renderer) -> None:
    light = Scene((replace(WALKER, body="point_light"),), CLOSE, "plain", marks=Marks(dot_size=0.8))
    for angle in (20.0, 40.0):
        pair = replace(light, beside=replace(light, screen_angle=5.0), screen_angle=angle)
        left, right, _ = halves(picture(context, renderer, pair, SIZE))
        assert np.array_equal(left, right)


def test_a_page_and_a_caption_lie_over_both_halves(context: moderngl.Context, renderer: Renderer) -> None:
    pair = Scene((WALKER,), CLOSE, beside=Scene((WALKER,), CLOSE))
    bare = picture(context, renderer, pair, SIZE).astype(int)
    for changed in (
        replace(pair, page=Page((Line("Paused", "title"),), over_scene=True)),
        replace(pair, caption="Which of the two walks looks more natural?"),
    ):
        different = (np.abs(picture(context, renderer, changed, SIZE) - bare).max(axis=2) > 0).any(axis=0)
        assert different[: SIZE[0] // 2].any()
        assert different[SIZE[0] // 2 :].any()


def test_a_half_may_be_empty(context: moderngl.Context, renderer: Renderer) -> None:
    left, right, strip = halves(picture(context, renderer, Scene(beside=Scene((WALKER,), CLOSE)), SIZE))
    assert len(np.unique(left.reshape(-1, 3), axis=0)) == 1
    assert np.array_equal(left[0, 0], strip[0, 0])
    assert right.std() > 5.0


def test_marks_look_the_same_after_a_page_was_shown(context: moderngl.Context, renderer: Renderer) -> None:
    """A dot is round again after text, which is blended in another way."""
    light = Scene((replace(WALKER, body="point_light"),), CLOSE, "plain", marks=Marks(dot_size=1.0))
    before = picture(context, renderer, light, SIZE)
    picture(context, renderer, replace(light, caption="A caption"), SIZE)
    assert np.array_equal(before, picture(context, renderer, light, SIZE))


def test_the_part_map_knows_both_halves(context: moderngl.Context, renderer: Renderer) -> None:
    alone = Scene((WALKER,), CLOSE)
    pair = replace(alone, beside=Scene((replace(WALKER, phase=0.8),), CLOSE))
    picture(context, renderer, pair, SIZE)
    parts = renderer.draw_parts()
    assert parts is not None
    half = divide(SIZE)[0][2:]
    for column, scene in ((0, pair), (SIZE[0] - half[0], pair.beside)):
        assert scene is not None
        picture(context, renderer, replace(scene, beside=None), half)
        single = renderer.draw_parts()
        assert single is not None
        assert np.array_equal(parts.codes[:, column : column + half[0]], single.codes)
    row, column = np.argwhere(single.codes[..., 0] > 0)[0]
    found = parts.at(column + SIZE[0] - half[0], row)
    assert found.beside
    assert replace(found, beside=False) == single.at(column, row)


def test_a_page_leaves_nothing_in_the_part_map(context: moderngl.Context, renderer: Renderer) -> None:
    picture(context, renderer, Scene((WALKER,), CLOSE), SIZE)
    picture(context, renderer, Scene(page=Page((Line("A page"),))), SIZE)
    parts = renderer.draw_parts()
    assert parts is not None
    assert not parts.codes.any()


def test_both_walkers_are_measured() -> None:
    one, other = Scene((WALKER,)), Scene((replace(WALKER, actor="M1", speed=0.9),))
    both = measured_gait(replace(one, beside=other))
    assert measured_gait(one) | {f"beside_{k}": v for k, v in measured_gait(other).items()} == both

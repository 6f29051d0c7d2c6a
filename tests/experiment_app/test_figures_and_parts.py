"""Point lights on the screen, the body-part map, forced levels of detail, pictures on bodies, golden images."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import moderngl
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from experiment_app.render.drawn import DrawnWalker
from experiment_app.render.part_map import part_of
from experiment_app.render.renderer import Renderer
from experiment_app.scene import Camera, Marks, Scene, Walker
from experiment_app.walkers import cast, drawn_walkers
from stimuli.bodies.skinning import skin
from stimuli.skeleton import JOINTS

SIZE = (256, 288)
WALKER = Walker("F1", 1.2, 105.0, 0.3, distance=4.7)
CLOSE = Camera("three_quarter", 4.0, 1.2, 30.0)
GOLDEN = Path(__file__).parent / "golden"
Draw = Callable[[Scene], NDArray[np.uint8]]


@pytest.fixture(scope="module")
def draw(context: moderngl.Context, renderer: Renderer) -> Iterator[Draw]:
    target = context.simple_framebuffer(SIZE)

    def drawn(scene: Scene) -> NDArray[np.uint8]:
        renderer.draw(scene, drawn_walkers(scene), target)
        return renderer.read_pixels(target)

    yield drawn
    target.release()


def test_a_point_light_is_fifteen_discs_of_the_asked_visual_angle_on_black(draw: Draw) -> None:
    from scipy.ndimage import label

    camera = Camera("front", 4.0, 1.2, 30.0)
    walker = replace(WALKER, phase=0.1, body="point_light")
    light = draw(Scene((walker,), camera, marks=Marks(dot_size=0.5), screen_angle=30.0))
    grey = light[..., 0] / 255.0
    covered = np.where(grey <= 0.04045, grey / 12.92, ((grey + 0.055) / 1.055) ** 2.4)
    _, count = label(grey > 0.1)
    assert 12 <= count <= 15  # dots of pelvis, hips and wrists may touch
    radius = 0.5 * np.tan(np.radians(0.25)) / np.tan(np.radians(15.0)) * SIZE[1]
    assert covered.sum() / 15 == pytest.approx(np.pi * radius**2, rel=0.1)
    assert np.median(light) == 0


def test_twice_the_screen_angle_halves_the_dots(draw: Draw) -> None:
    scene = Scene((replace(WALKER, body="point_light"),), CLOSE, marks=Marks(dot_size=0.8), screen_angle=30.0)
    wide = replace(scene, screen_angle=60.0)
    assert (draw(wide) > 128).sum() < 0.4 * (draw(scene) > 128).sum()


@pytest.mark.parametrize("body", ["point_light_scrambled", "point_light_inverted", "stick_figure"])
def test_every_figure_is_drawn_and_differs_from_the_point_light(draw: Draw, body: str) -> None:
    figure, light = (draw(Scene((replace(WALKER, body=name),), CLOSE)) for name in (body, "point_light"))
    assert (figure > 128).sum() > 50
    assert not np.array_equal(figure, light)


def test_figures_stand_beside_bodies_on_the_ground(draw: Draw) -> None:
    alone = draw(Scene((WALKER,), CLOSE))
    both = draw(Scene((WALKER, replace(WALKER, body="stick_figure", place=(0.7, 0.0))), CLOSE))
    assert 20 < np.any(alone != both, axis=2).sum() < 0.1 * alone[..., 0].size


def test_the_part_map_names_what_the_reference_skinning_puts_there(draw: Draw, renderer: Renderer) -> None:
    scene = Scene((WALKER,), CLOSE, lod=0)
    draw(scene)
    parts = renderer.draw_parts()
    assert parts is not None
    assert {parts.at(x, y).region for y in range(SIZE[1]) for x in range(SIZE[0])} == {
        "legs", "arms", "torso", "head", "elsewhere",
    }  # fmt: skip
    (walker,) = drawn_walkers(scene)
    from experiment_app.render.cameras import place_camera

    matrix = place_camera(CLOSE, SIZE[0] / SIZE[1], walker.body.stature, walker.place).matrix
    points = np.concatenate([skin(s, walker.matrices)[0] for s in walker.body.levels[0]]) + walker.place
    clip = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    x = (clip[:, 0] / clip[:, 3] * 0.5 + 0.5) * SIZE[0]
    y = (0.5 - clip[:, 1] / clip[:, 3] * 0.5) * SIZE[1]
    inside = parts.codes[..., 0] > 0
    rows, columns = np.nonzero(inside)
    assert abs(rows.min() - y.min()) < 1.5
    assert abs(rows.max() + 1 - y.max()) < 1.5
    assert abs(columns.min() - x.min()) < 1.5
    assert abs(columns.max() + 1 - x.max()) < 1.5
    assert parts.at(-1, 5).region == "elsewhere"
    assert parts.at(0, 0).walker == -1


@pytest.mark.parametrize("phase", [0.0, 0.3, 0.6])
def test_a_region_is_one_piece_or_one_for_each_side(draw: Draw, renderer: Renderer, phase: float) -> None:
    """No sleeve leaves teeth on the trunk: head and trunk are one piece, arms and legs two at most, in a front view."""
    from scipy.ndimage import label

    draw(Scene((replace(WALKER, phase=phase),), Camera("front", 4.0, 1.2, 30.0), lod=0))
    parts = renderer.draw_parts()
    assert parts is not None
    regions = np.array(["", *(part_of(joint, 0).region for joint in JOINTS)])[parts.codes[..., 0]]
    for region, most in (("head", 1), ("torso", 1), ("arms", 2), ("legs", 2)):
        pieces, _ = label(regions == region, np.ones((3, 3)))
        sizes = np.bincount(pieces.ravel())[1:]
        assert (sizes > 3).sum() <= most, (region, sizes)
        assert sizes.max() > 100


def test_the_part_map_of_the_frame_before_needs_no_wait(draw: Draw, context: moderngl.Context) -> None:
    fresh = Renderer(context, SIZE, 1.0, 1)
    target = context.simple_framebuffer(SIZE)
    maps = []
    for scene in (Scene((WALKER,), CLOSE), Scene((replace(WALKER, phase=0.8),), CLOSE)):
        fresh.draw(scene, drawn_walkers(scene), target)
        before = fresh.draw_parts(1)
        maps.append((before, fresh._parts.take() if fresh._parts else None))
    assert maps[0][0] is None
    first, then = maps[0][1], maps[1][0]
    assert first is not None
    assert then is not None
    assert np.array_equal(first.codes, then.codes)
    fresh.release()
    target.release()


def test_walkers_in_the_part_map_keep_their_numbers(draw: Draw, renderer: Renderer) -> None:
    walkers = (WALKER, replace(WALKER, actor="M1", place=(-0.9, 0.0)), replace(WALKER, place=(0.9, 0.0)))
    draw(Scene(walkers, Camera("front", 5.0, 1.2, 30.0)))
    parts = renderer.draw_parts()
    assert parts is not None
    middle = [parts.codes[:, x0:x1, 1].max() for x0, x1 in ((0, 86), (86, 170), (170, 256))]
    assert sorted(int(m) for m in middle) == [1, 2, 3]


@pytest.mark.parametrize("level", [0, 1, 2])
def test_a_level_of_detail_can_be_forced_and_is_told(draw: Draw, renderer: Renderer, level: int) -> None:
    draw(Scene((WALKER,), CLOSE, lod=level))
    assert renderer.levels == (level,)


def test_a_picture_colours_and_a_mask_cuts(context: moderngl.Context) -> None:
    actor, body = cast("F1", "")
    (posed,) = drawn_walkers(Scene((WALKER,), CLOSE))
    green = np.zeros((4, 4, 4), np.uint8)
    green[..., 1], green[..., 3] = 255, 255
    seen = []
    for alpha, opacity in (("opaque", 0), ("mask", 0), ("mask", 255)):
        picture = green.copy()
        picture[..., 3] = opacity
        worn = tuple(
            replace(s, picture=picture, picture_at=np.zeros((len(s.positions), 2)), alpha=alpha, colour=np.ones(3))
            for s in body.levels[0]
        )
        walker = DrawnWalker(replace(body, levels=(worn,)), posed.matrices, posed.place)
        target = context.simple_framebuffer(SIZE)
        renderer = Renderer(context, SIZE, 1.0, 4)
        renderer.draw(Scene((WALKER,), CLOSE), (walker,), target)
        pixels = renderer.read_pixels(target).astype(int)
        seen.append(int((pixels[..., 1] > pixels[..., 0] + 60).sum()))
        renderer.release()
        target.release()
    assert seen[0] > 1500
    assert seen[1] == 0
    assert seen[2] == seen[0]
    assert actor.name == "F1"


PAIR = (480, 270)
SCENES: dict[str, tuple[Scene, tuple[int, int]]] = {
    "woman": (Scene((WALKER,), CLOSE), SIZE),
    "man-treadmill": (Scene((replace(WALKER, actor="M1"),), Camera("side", 4.2, 1.2, 30.0), "treadmill"), SIZE),
    "point-light": (Scene((replace(WALKER, body="point_light"),), CLOSE), SIZE),
    "stick-figure": (Scene((replace(WALKER, body="stick_figure"),), CLOSE), SIZE),
    "street": (
        Scene((WALKER,), Camera("first_person", height=1.6, field_of_view=45.0, place=(1.5, 12.0)), "street"),
        PAIR,
    ),
    "pair": (Scene((WALKER,), CLOSE, beside=Scene((replace(WALKER, actor="M1"),), Camera("legs"))), PAIR),
}


def drawn_anew(context: moderngl.Context, name: str) -> NDArray[np.uint8]:
    """The pixels of a golden image's scene as this computer's driver draws it."""
    scene, size = SCENES[name]
    target = context.simple_framebuffer(size)
    renderer = Renderer(context, size, 1.0, 4)
    renderer.draw(scene, drawn_walkers(scene), target)
    pixels = renderer.read_pixels(target)
    renderer.release()
    target.release()
    return pixels


@pytest.mark.parametrize("name", SCENES)
def test_golden_images_are_drawn_to_the_byte(context: moderngl.Context, name: str) -> None:
    """Drawn under the driver that golden/about.json names; `python -m tests.experiment_app.test_figures_and_parts`
    makes them anew after a wanted change."""
    about = json.loads((GOLDEN / "about.json").read_text(encoding="utf-8"))
    here = {key: context.info[key] for key in ("GL_RENDERER", "GL_VERSION")}
    if here != about:
        pytest.skip(f"golden images were made with {about['GL_RENDERER']}, here is {here['GL_RENDERER']}")
    with Image.open(GOLDEN / f"{name}.png") as golden:
        assert np.array_equal(drawn_anew(context, name), np.asarray(golden))


def make_golden() -> None:
    """Draws the golden images with this computer's driver."""
    context = moderngl.create_context(standalone=True, backend="egl", require=330)
    GOLDEN.mkdir(exist_ok=True)
    for name in SCENES:
        Image.fromarray(drawn_anew(context, name)).save(GOLDEN / f"{name}.png", optimize=True)
    about = {key: context.info[key] for key in ("GL_RENDERER", "GL_VERSION")}
    (GOLDEN / "about.json").write_text(json.dumps(about, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    make_golden()

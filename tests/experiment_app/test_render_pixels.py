"""What the renderer draws: equal for equal scenes, the walker inside the frame, feet that darken the ground."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np
import pytest

from experiment_app.render.body_buffers import MOST_KEPT
from experiment_app.render.cameras import place_camera
from experiment_app.render.drawn import DrawnWalker
from experiment_app.render.renderer import Renderer
from experiment_app.render.treadmill_pass import corners
from experiment_app.scene import Camera, Ground, Scene, View, Walker
from experiment_app.walkers import cast, drawn_walkers
from stimuli.bodies.skinning import skin
from tests.experiment_app.drawing import picture

SIZE = (320, 180)
WALKER = Walker("F1", 1.2, 105.0, 0.3, distance=4.7)
VIEWS: tuple[View, ...] = ("three_quarter", "side", "front", "legs")


@pytest.mark.parametrize("ground", ["open_ground", "treadmill"])
def test_equal_scenes_give_equal_bytes(context: moderngl.Context, renderer: Renderer, ground: Ground) -> None:
    scene = Scene((WALKER,), ground=ground)
    first = picture(context, renderer, scene, SIZE)
    picture(context, renderer, Scene((replace(WALKER, phase=0.7),), Camera("side")), SIZE)
    again = picture(context, renderer, scene, SIZE)
    other = Renderer(context, SIZE, 1.0, 4)
    fresh = picture(context, other, scene, SIZE)
    other.release()
    assert np.array_equal(first, again)
    assert np.array_equal(first, fresh)


def test_a_body_is_uploaded_once(context: moderngl.Context) -> None:
    renderer = Renderer(context, SIZE, 1.0, 1)
    for phase in (0.0, 0.2, 0.4):
        picture(context, renderer, Scene((replace(WALKER, phase=phase),)), SIZE)
    assert renderer.uploads == 1
    picture(context, renderer, Scene((WALKER, replace(WALKER, place=(0.8, 0.0), phase=0.1))), SIZE)
    assert renderer.uploads == 1
    picture(context, renderer, Scene((replace(WALKER, actor="M1"),)), SIZE)
    assert renderer.uploads == 2
    renderer.release()


def test_a_picture_of_more_bodies_than_are_kept_on_the_gpu_is_that_of_one_body(context: moderngl.Context) -> None:
    places = [(1.2 * (i % 10) - 5.4, 1.5 * (i // 10)) for i in range(MOST_KEPT + 12)]
    scene = Scene(tuple(replace(WALKER, place=place, phase=0.3) for place in places), Camera("elevated", 17.0, 8.0))
    walkers = drawn_walkers(scene)
    unlike = [replace(walker, body=replace(walker.body)) for walker in walkers if isinstance(walker, DrawnWalker)]
    target = context.simple_framebuffer(SIZE)
    found = []
    for drawn in (walkers, unlike):
        renderer = Renderer(context, SIZE, 1.0, 4)
        renderer.draw(scene, drawn, target)
        renderer.draw(scene, drawn, target)
        found.append(renderer.read_pixels(target))
        assert renderer.uploads == (1 if drawn is walkers else len(unlike))
        renderer.release()
    target.release()
    assert np.array_equal(found[0], found[1])


def test_samples_are_brought_down_to_what_the_driver_has(context: moderngl.Context) -> None:
    renderer = Renderer(context, SIZE, 1.0, 64)
    assert 1 <= renderer.samples <= context.max_samples
    assert picture(context, renderer, Scene((WALKER,)), SIZE).std() > 5.0
    renderer.release()


def test_many_walkers_are_drawn_at_their_places(context: moderngl.Context, renderer: Renderer) -> None:
    """Twelve walkers, more than the textures first hold, leave marks where each stands, of two bodies."""
    camera = Camera("front", distance=9.0)
    empty_side = Scene((WALKER,), camera)
    walkers = [WALKER] + [
        replace(WALKER, actor=("F1", "M1")[i % 2], place=(0.6 * (i - 5.5) + 0.1, -0.8), phase=i / 12) for i in range(11)
    ]
    alone, together = (
        picture(context, renderer, empty_side, SIZE),
        picture(context, renderer, Scene(tuple(walkers), camera), SIZE),
    )
    changed = np.abs(alone.astype(int) - together).max(axis=2) > 40
    columns = changed.any(axis=0).nonzero()[0]
    assert changed.sum() > 1500
    assert columns[-1] - columns[0] > 150


def test_resize_changes_the_picture_and_its_pixels(context: moderngl.Context) -> None:
    renderer = Renderer(context, (160, 120), 1.0, 4)
    scene = Scene((WALKER,))
    for size in ((160, 120), (400, 200), (160, 120)):
        target = context.simple_framebuffer(size)
        renderer.resize(size, 1.0)
        renderer.draw(scene, drawn_walkers(scene), target)
        assert renderer.read_pixels(target).shape == (size[1], size[0], 3)
        assert renderer.read_pixels(target).std() > 5.0
        target.release()
    renderer.release()


@pytest.mark.parametrize("aspect", [4 / 3, 16 / 9, 21 / 9])
@pytest.mark.parametrize("view", ["three_quarter", "side", "front"])
@pytest.mark.parametrize("actor", ["F1", "M1"])
def test_the_whole_walker_is_inside_the_frame_and_centred(view: View, aspect: float, actor: str) -> None:
    """Every vertex at 8 phases is at least 5 % of the picture away from its edges; equal margins above and below."""
    camera = Camera(view)
    top, bottom, sides = -1.0, 1.0, 0.0
    for phase in np.arange(8) / 8:
        (drawn,) = drawn_walkers(Scene((replace(WALKER, actor=actor, phase=float(phase), distance=31.0),)))
        viewpoint = place_camera(camera, aspect, drawn.body.stature, drawn.place)
        points = np.concatenate([skin(surface, drawn.matrices)[0] for surface in drawn.body.levels[-1]])
        clip = np.c_[points + drawn.place, np.ones(len(points))] @ viewpoint.matrix.T
        seen = clip[:, :2] / clip[:, 3:]
        top, bottom = max(top, seen[:, 1].max()), min(bottom, seen[:, 1].min())
        sides = max(sides, np.abs(seen[:, 0]).max())
    assert top < 0.9
    assert bottom > -0.9
    assert sides < 0.9
    assert abs(top + bottom) < 0.16
    assert top - bottom > 1.1, "the walker should fill more than half of the height"


@pytest.mark.parametrize("aspect", [4 / 3, 16 / 9])
@pytest.mark.parametrize("view", ["three_quarter", "side", "front"])
def test_the_whole_treadmill_is_in_the_picture_and_so_is_the_walker(view: View, aspect: float) -> None:
    machine = corners((0.0, 0.0, 0.0))
    viewpoint = place_camera(Camera(view), aspect, 1.80, (0.0, 0.0, 0.0), machine)
    points = np.c_[np.vstack([machine, (0.0, 1.80, 0.0)]), np.ones(len(machine) + 1)]
    clip = points @ viewpoint.matrix.T
    assert np.abs(clip[:, :2] / clip[:, 3:]).max() < 0.97


def test_the_treadmill_stands_at_one_place_of_the_picture_whoever_walks() -> None:
    machine = corners((0.0, 0.0, 0.0))
    placed = [place_camera(Camera("side"), 16 / 9, stature, (0.0, 0.0, 0.0), machine) for stature in (1.5, 1.65, 1.86)]
    assert all(np.array_equal(viewpoint.matrix, placed[0].matrix) for viewpoint in placed)


def test_a_narrow_field_of_view_cuts_the_treadmill_before_the_walker() -> None:
    machine = corners((0.0, 0.0, 0.0))
    camera = Camera("three_quarter", 4.0, 1.6, 30.0)
    viewpoint = place_camera(camera, 16 / 9, 1.80, (0.0, 0.0, 0.0), machine)
    for height in (1.80, 0.0):
        clip = viewpoint.matrix @ np.array([0.0, height, 0.0, 1.0])
        assert abs(clip[1] / clip[3]) < 0.9


def test_the_legs_view_ends_below_the_hips() -> None:
    stature = cast("F1", "")[1].stature
    viewpoint = place_camera(Camera("legs"), 16 / 9, stature, (0.0, 0.0, 0.0))
    for height, edge in ((0.50, 1.0), (-0.08, -1.0)):
        clip = viewpoint.matrix @ np.array([0.0, height * stature, 0.0, 1.0])
        assert clip[1] / clip[3] == pytest.approx(edge, abs=1e-9)


def test_the_camera_keeps_pace_with_the_walker(context: moderngl.Context, renderer: Renderer) -> None:
    """The walker stays at the same place of the picture while the ground goes past."""
    here = picture(context, renderer, Scene((WALKER,)), SIZE).astype(int)
    there = picture(context, renderer, Scene((replace(WALKER, distance=5.4),)), SIZE).astype(int)
    changed = np.abs(here - there).max(axis=2)
    torso = np.s_[60:85, 155:165]
    assert changed[torso].max() <= 2
    assert (changed[120:, :100] > 4).mean() > 0.05


def test_the_belt_runs_while_the_walker_stays(context: moderngl.Context, renderer: Renderer) -> None:
    here = picture(context, renderer, Scene((WALKER,), ground="treadmill"), SIZE).astype(int)
    there = picture(context, renderer, Scene((replace(WALKER, distance=4.8),), ground="treadmill"), SIZE).astype(int)
    changed = np.abs(here - there).max(axis=2) > 4
    rows = changed.any(axis=1).nonzero()[0]
    assert 20 < changed.sum() < 2000
    assert rows[0] > 115, "only the belt moves"


@pytest.mark.parametrize("ground", ["open_ground", "treadmill"])
def test_the_stance_sole_darkens_the_ground_under_it(
    context: moderngl.Context, renderer: Renderer, ground: Ground
) -> None:
    """Beside the standing foot the ground is darker than where nothing is near, and darker still in the shadow."""
    scene = Scene((replace(WALKER, phase=0.25),), Camera("legs"), ground)
    with_walker = picture(context, renderer, scene, SIZE).astype(float).sum(axis=2)
    (drawn,) = drawn_walkers(scene)
    target = context.simple_framebuffer(SIZE)
    hidden = replace(drawn, matrices=np.zeros_like(drawn.matrices))  # the walker, shrunk to a point
    renderer.draw(scene, (hidden,), target)
    without = renderer.read_pixels(target).astype(float).sum(axis=2)
    target.release()

    feet = [surface for surface in drawn.body.levels[0] if surface.name == "soles"]
    assert feet, "the body has no surface named soles"
    points = np.concatenate([skin(surface, drawn.matrices)[0] for surface in feet])
    standing = points[points[:, 1] < 0.01]
    beside = standing[standing[:, 0].argmin()] + np.array([-0.012, 0.0, 0.0])  # just in front of the sole's edge
    viewpoint = place_camera(scene.camera, SIZE[0] / SIZE[1], drawn.body.stature, drawn.place)
    clip = viewpoint.matrix @ np.array([*(beside * (1, 0, 1) + drawn.place), 1.0])
    x = int((0.5 + 0.5 * clip[0] / clip[3]) * SIZE[0])
    y = int((0.5 - 0.5 * clip[1] / clip[3]) * SIZE[1])
    assert with_walker[y, x] < 0.93 * without[y, x]
    shadow = with_walker < 0.8 * without
    assert shadow[:, : SIZE[0] // 2].sum() > 100, "the shadow falls behind the walker"

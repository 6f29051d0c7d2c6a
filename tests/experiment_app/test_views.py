"""Cameras that stand still, the street, and the study file's camera, marks and display in what is drawn."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np
import pytest

from experiment_app.errors import UsageError
from experiment_app.pictures.film import condition_of, walking
from experiment_app.render.cameras import AIM, HEADINGS, place_camera
from experiment_app.render.renderer import Renderer
from experiment_app.render.street_model import HOUSES_AT, KERB_HEIGHT, STRETCH, street_side
from experiment_app.scene import STREET_HALF_WIDTH, Camera, Ground, Scene, View, Walker
from experiment_app.staging import stage, staged
from experiment_app.walkers import cast, measured_gait
from protocols.events import Shown
from protocols.plan import TrialStep, make_plan
from protocols.session import begin, handle
from protocols.study_file import parse_study
from tests.experiment_app.drawing import picture
from tests.protocols.studies import changed, edited

SIZE = (320, 180)
WALKER = Walker("F1", 1.2, 105.0, 0.3, distance=4.7)
NOWHERE = (0.0, 0.0, 0.0)


def seen(camera: Camera, point: tuple[float, float, float], walker: tuple[float, float, float] = NOWHERE) -> np.ndarray:
    """Where a point is on a picture twice as wide as high, from -1 to 1, and its distance ahead (m)."""
    clip = place_camera(camera, 2.0, 1.75, walker).matrix @ np.array([*point, 1.0])
    return np.array([clip[0] / clip[3], clip[1] / clip[3], clip[3]])


def test_an_elevated_camera_has_its_place_in_the_middle_wherever_people_are() -> None:
    camera = Camera("elevated", 20.0, 12.0, 35.0, place=(3.0, -7.0))
    for walker in (NOWHERE, (4.0, 0.0, 30.0)):
        x, y, ahead = seen(camera, (3.0, AIM, -7.0), walker)
        assert (x, y) == pytest.approx((0.0, 0.0), abs=1e-9)
        assert ahead == pytest.approx(np.hypot(20.0, 12.0 - AIM))


def test_first_person_stands_at_its_place_and_has_the_horizon_in_the_middle() -> None:
    camera = Camera("first_person", height=1.62, place=(1.0, 6.0))
    viewpoint = place_camera(camera, 2.0, 1.75, (9.0, 0.0, 9.0))
    assert viewpoint.eye == pytest.approx([1.0, 1.62, 6.0])
    x, y, ahead = seen(camera, (1.0, 1.62, -4.0))
    assert (x, y, ahead) == pytest.approx((0.0, 0.0, 10.0), abs=1e-9)


@pytest.mark.parametrize("view", HEADINGS)
def test_a_heading_of_zero_looks_along_the_walkers_way(view: View) -> None:
    """What is further along the way is further away, in the middle; what is to the walkers' left, on the left."""
    camera = Camera(view, 6.0, 1.6, 40.0, heading=0.0)
    middle, ahead, left = (seen(camera, point) for point in ((0.0, 1.0, 5.0), (0.0, 1.0, 9.0), (1.0, 1.0, 9.0)))
    assert ahead[0] == pytest.approx(0.0, abs=1e-9)
    assert ahead[2] > middle[2]
    assert left[0] < 0.0


def test_a_metre_at_the_viewers_distance_has_a_metres_angle_in_true_perspective() -> None:
    """A screen 0.3 m high at 0.6 m: a person of 1.75 m, 3.5 m away, covers as much of it as of a window there."""
    study = parse_study(
        "s.yaml",
        changed(
            ("field_of_view: 24}", "}"),
            ("height: 1.5, }", "height: 1.5}"),
            ("interval: 0.7", "display: {viewing_distance: 0.6, screen_height: 0.3}\ninterval: 0.7"),
        ),
    ).study
    scene = staged(study, (WALKER,), {})
    assert scene.screen_angle == pytest.approx(28.07, abs=0.01)
    camera = replace(scene.camera, view="first_person", height=0.0, place=(0.0, 0.0))
    top, bottom = (seen(camera, (0.0, y, -3.5))[1] for y in (0.875, -0.875))
    assert 0.5 * (top - bottom) * 0.3 == pytest.approx(1.75 * 0.6 / 3.5)


def test_the_study_files_look_reaches_the_scene() -> None:
    text = changed(
        ("ground: open_ground", "ground: plain\n  body: point_light\n  level_of_detail: 0\n  marks: "
         "{dot_size: 0.3, line_width: 0.2, brightness: 0.5, background: 0.1, seed: 7}"),
        ("camera: {view: three_quarter, distance: 5.5, height: 1.5, field_of_view: 24}",
         "camera: {view: elevated, distance: 12.0, height: 6.0, heading: 170.0, place: [1.0, 2.0]}"),
    )  # fmt: skip
    study = parse_study("s.yaml", text).study
    scene = walking(study, condition_of(study, ["actor=M1"]), 1.0)
    assert scene.camera == Camera("elevated", 12.0, 6.0, 30.0, 170.0, (1.0, 2.0))
    assert scene.ground == "plain"
    assert scene.lod == 0
    assert (scene.marks.dot_size, scene.marks.brightness, scene.marks.background, scene.marks.seed) == (
        0.3,
        0.5,
        0.1,
        7,
    )
    assert walking(study, condition_of(study, []), 1.0, lod=2).lod == 2


def test_what_the_program_assigns_is_filmed_like_a_factor_of_the_design() -> None:
    bodies = "body: {$viewing: {screen: matched, headset: mismatched}}"
    study = edited("walk_ratio_actors", ("body: $character", bodies)).study
    shown = [walking(study, condition_of(study, given), 1.0) for given in ([], ["viewing=headset"])]
    assert [scene.walkers[0].body for scene in shown] == ["matched", "mismatched"]
    with pytest.raises(UsageError, match="the levels of viewing are screen, headset"):
        condition_of(study, ["viewing=cinema"])


def test_the_street_is_there_when_nobody_is(context: moderngl.Context, renderer: Renderer) -> None:
    empty = Scene((), Camera("first_person", height=1.6, field_of_view=50.0), "street")
    alone = picture(context, renderer, empty, SIZE)
    assert alone.std() > 15.0
    assert np.array_equal(alone, picture(context, renderer, empty, SIZE))
    parts = renderer.draw_parts()
    assert parts is not None
    assert not parts.codes.any()
    with_walker = picture(context, renderer, replace(empty, walkers=(replace(WALKER, place=(0.0, -12.0)),)), SIZE)
    changed_pixels = np.abs(alone.astype(int) - with_walker).max(axis=2) > 8
    assert 100 < changed_pixels.sum() < 0.1 * changed_pixels.size


def test_the_walker_looks_the_same_on_the_street_as_on_open_ground(
    context: moderngl.Context, renderer: Renderer
) -> None:
    """The houses cast no shadow, so every walker of a crowd has the same light."""
    grounds: tuple[Ground, Ground] = ("open_ground", "street")
    on = [picture(context, renderer, Scene((WALKER,), ground=ground), SIZE).astype(int) for ground in grounds]
    parts = renderer.draw_parts()
    assert parts is not None
    inside = parts.codes[..., 0] > 0
    inside &= np.roll(inside, 1, 0) & np.roll(inside, -1, 0) & np.roll(inside, 1, 1) & np.roll(inside, -1, 1)
    assert inside.sum() > 500
    different = np.abs(on[0] - on[1])[inside].max(axis=1) > 0
    assert different.mean() < 0.005, "at most a gap narrower than a pixel shows what is behind"


def test_the_street_passes_by(context: moderngl.Context, renderer: Renderer) -> None:
    """Paving and houses move past a walker that the camera follows."""
    here = picture(context, renderer, Scene((WALKER,), Camera("side"), "street"), SIZE).astype(int)
    there = picture(context, renderer, Scene((replace(WALKER, distance=6.1),), Camera("side"), "street"), SIZE).astype(
        int
    )
    different = np.abs(here - there).max(axis=2) > 4
    assert different[:80, :110].mean() > 0.04  # houses
    assert different[130:, :110].mean() > 0.08  # paving


def test_the_street_is_closed_along_its_length_and_clear_of_the_roadway() -> None:
    side = street_side()
    position, normal = side["position"], side["normal"]
    assert position[:, 0].min() == STREET_HALF_WIDTH
    assert np.all(position[position[:, 0] < HOUSES_AT - 0.01][:, 1] <= KERB_HEIGHT + 1e-6)
    fronts = position[(side["paint"][:, 3] == 2.0)].reshape(-1, 6, 3)
    starts, ends = np.sort(fronts[..., 2].min(axis=1)), np.sort(fronts[..., 2].max(axis=1))
    assert starts[0] == 0.0
    assert ends[-1] == STRETCH
    assert starts[1:] == pytest.approx(ends[:-1], abs=1e-4)
    triangles = position.reshape(-1, 3, 3)
    facing = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    assert np.all(np.sum(facing * normal.reshape(-1, 3, 3)[:, 0], axis=1) > 0.0)


def test_a_mismatched_body_has_the_actors_height_and_walks_at_the_actors_speed() -> None:
    for actor in ("F1", "M1"):
        (own, body), (other, worn) = cast(actor, "matched"), cast(actor, "mismatched")
        assert body.name != worn.name
        assert worn.stature == pytest.approx(body.stature)
        assert own.sex == other.sex
        walkers = (Walker(actor, 1.1, 105.0, 0.0, body=name) for name in ("matched", "mismatched"))
        for walker in walkers:
            assert measured_gait(Scene((walker,)))["speed"] == pytest.approx(1.1, abs=0.02)


def test_a_body_of_the_actors_own_build_walks_like_the_matched_one() -> None:
    """F6 weighs 54 kg at 166.5 cm, less than an average woman of that height; F7 83 kg at 169 cm, more."""
    for actor, wider in (("F6", False), ("F7", True)):
        (own, body), (matched, usual) = cast(actor, "own_build"), cast(actor, "matched")
        assert np.array_equal(own.skeleton.offsets, matched.skeleton.offsets)
        depths = [np.ptp(next(s for s in b.levels[0] if s.name == "shirt").positions[:, 2]) for b in (usual, body)]
        assert (depths[1] > depths[0]) == wider


@pytest.mark.parametrize("each_trial", [False, True])
def test_a_scrambled_point_light_can_differ_from_trial_to_trial(each_trial: bool) -> None:
    text = changed(
        (
            "ground: open_ground",
            f"ground: plain\n  body: point_light_scrambled\n  marks: {{each_trial: {str(each_trial).lower()}}}",
        )
    )
    plan = make_plan(parse_study("s.yaml", text).study, 1, 1)
    trials = [step for step in plan.steps if isinstance(step, TrialStep)]
    seeds = []
    for step in trials[:6]:
        session = begin(replace(plan, steps=(step,)))
        scene = stage(handle(session, Shown(0.0)))
        assert scene == stage(handle(session, Shown(0.0)))
        seeds.append(scene.marks.seed)
    assert len(set(seeds)) == (6 if each_trial else 1)

"""Crowds as drawn: who, where and how as planned; the same pixels for the same scene; nobody pops."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from experiment_app.crowds import END, crowd_cast, drawn_crowd
from experiment_app.pictures.film import condition_of, walking
from experiment_app.render import crowd_pass
from experiment_app.render.cameras import place_camera
from experiment_app.render.contact import BALLS, CROWD_HALF_SIZE, crowd_occluders
from experiment_app.render.crowd_levels import BAND, HEIGHTS, levels_of, seen_instances, shadow_instances
from experiment_app.render.drawn import PLACE
from experiment_app.render.renderer import Renderer
from experiment_app.scene import Camera, Crowd, Scene
from experiment_app.walkers import drawn_walkers, measured_gait
from experiment_app.windows.offscreen import offscreen_context
from protocols.study_file import read_study
from stimuli.actors import load_actor
from stimuli.blend_tree import Leaf
from stimuli.crowds.motions import figure_of, motion_of
from stimuli.skeleton import JOINTS
from stimuli.walker import drawn_pose, skin_matrices
from tests.stimuli.transforms import as_matrices

SIZE = (320, 180)
CAMERA = Camera("elevated", 30.0, 9.0, 40.0, 180.0)
CROWD = Crowd(60, "1:10", seed=2, seconds=3.0)


def pixels(*scenes, size=SIZE, samples=1):
    context = offscreen_context()
    target = context.simple_framebuffer(size)
    renderer = Renderer(context, size, 1.0, samples)
    drawn = []
    for scene in scenes:
        renderer.draw(scene, drawn_walkers(scene), target)
        drawn.append(renderer.read_pixels(target).astype(int))
    renderer.release()
    context.release()
    return drawn


def street(seconds=3.0, **changed):
    return Scene((), CAMERA, "street", crowd=replace(CROWD, seconds=seconds), **changed)


def test_everybody_is_posed_as_their_motion_says_and_stands_where_the_plan_says():
    crowd, plan = drawn_crowd(CROWD), crowd_cast(replace(CROWD, seconds=0.0)).plan
    places, phases = plan.places(3.0), plan.phases(3.0)
    np.testing.assert_allclose(crowd.rows[:, PLACE, 0], places[:, 0], atol=1e-5)
    np.testing.assert_allclose(crowd.rows[:, PLACE, 2], places[:, 1] + END - plan.length, atol=1e-4)
    for walker in range(0, CROWD.size, 7):
        motion = motion_of(plan.motions[plan.motion[walker]])
        alone = replace(load_actor("F1"), figure=figure_of(motion.style.sex), table=motion.table, tree=Leaf(0))
        speed = motion.step_length * plan.step_frequency[walker] / 60.0
        pose = drawn_pose(alone, speed, plan.step_frequency[walker], phases[walker])
        expected = plan.sizes[walker] * skin_matrices(alone, pose)
        got = as_matrices(crowd.rows[walker, :PLACE].reshape(21, 2, 4))
        expected[..., 3] += crowd.rows[walker, PLACE, :3]
        np.testing.assert_allclose(got, expected, atol=1e-4)
        moved = plan.sizes[walker] * speed
        assert moved == pytest.approx(plan.speed[walker])


def test_the_same_crowd_has_the_same_pixels_whatever_was_drawn_before():
    first, _, again = pixels(street(3.0), street(9.0), street(3.0))
    (alone,) = pixels(street(3.0))
    np.testing.assert_array_equal(first, again)
    np.testing.assert_array_equal(first, alone)


def test_the_balls_that_darken_the_ground_go_with_the_joints_they_hang_on():
    crowd = drawn_crowd(CROWD)
    there = np.array([3, 0, 11])
    rows = crowd_occluders(crowd, there)
    matrices = as_matrices(crowd.rows[there, :PLACE].reshape(3, 21, 2, 4))
    for row, walker, own in zip(rows, there, matrices, strict=True):
        body = crowd.cast.bodies[crowd.cast.body[walker]]
        stature = crowd.cast.statures[walker]
        np.testing.assert_allclose(row[0], [*crowd.rows[walker, PLACE, :3], CROWD_HALF_SIZE * stature], atol=1e-6)
        for side, balls in (("left", row[1:4]), ("right", row[4:7])):
            for ball, number in zip(balls, (1, 3, 6), strict=True):
                part, offset, radius = BALLS[number]
                joint = JOINTS.index(side + part)
                at = body.skeleton.positions[joint] + np.array(offset) * body.stature
                np.testing.assert_allclose(ball[:3], own[joint] @ np.append(at, 1.0), atol=1e-4)
                assert ball[3] == pytest.approx(radius * stature, rel=1e-6)


def test_a_crowd_casts_shadows_and_touches_the_ground():
    empty, people = pixels(Scene((), CAMERA, "street"), street())
    darker = (people.sum(axis=2) < 0.75 * empty.sum(axis=2)).mean()
    assert 0.002 < darker < 0.3


def test_two_crowds_stand_side_by_side():
    scene = street()
    together, alone = pixels(replace(scene, beside=scene), scene, size=(640, 180))
    left, right = together[:, :319], together[:, -319:]
    np.testing.assert_array_equal(left, right)
    assert np.abs(left - alone[:, :319]).max() > 0


def test_two_unlike_crowds_side_by_side_are_drawn_each_in_its_looks_with_bodies_uploaded_once(monkeypatch):
    uploaded = []

    class Counted(crowd_pass.CrowdMeshes):
        def __init__(self, context, cast):
            uploaded.append(cast)
            super().__init__(context, cast)

    monkeypatch.setattr(crowd_pass, "CrowdMeshes", Counted)
    varied = street()
    alike = replace(varied, crowd=replace(varied.crowd, variation="1:5", palette="equal_luminance"))
    scenes = (replace(varied, beside=alike), replace(varied, beside=alike), replace(alike, beside=varied))
    first, again, swapped = pixels(*scenes, size=(640, 180))
    assert len(uploaded) == 1
    np.testing.assert_array_equal(first, again)
    np.testing.assert_array_equal(first[:, :319], swapped[:, -319:])
    np.testing.assert_array_equal(first[:, -319:], swapped[:, :319])
    assert np.abs(first[:, :319] - first[:, -319:]).max() > 0


def test_the_part_map_knows_the_walkers_of_a_crowd():
    context = offscreen_context()
    target = context.simple_framebuffer(SIZE)
    renderer = Renderer(context, SIZE, 1.0, 1)
    scene = street()
    drawn = drawn_walkers(scene)
    renderer.draw(scene, drawn, target)
    parts = renderer.draw_parts()
    viewpoint = place_camera(CAMERA, SIZE[0] / SIZE[1], 1.7, (0.0, 0.0, 0.0))
    found = 0
    (crowd,) = drawn
    for walker, (place, stature) in enumerate(zip(crowd.rows[:, PLACE, :3], crowd.cast.statures, strict=True)):
        clip = viewpoint.matrix @ np.append(place + np.array([0.0, 0.75 * stature, 0.0]), 1.0)
        x, y = (0.5 + 0.5 * clip[0] / clip[3]) * SIZE[0], (0.5 - 0.5 * clip[1] / clip[3]) * SIZE[1]
        part = parts.at(x, y)
        found += part.walker == walker and part.region == "torso"
    renderer.release()
    context.release()
    assert found > 0.6 * CROWD.size  # the others stand behind somebody or out of the picture


def test_nobody_is_drawn_in_more_or_less_than_all_of_their_pixels():
    heights = np.linspace(1.0, 700.0, 5000)
    nobody = np.zeros(len(heights), int)
    rows, low, high, _ = seen_instances(heights, np.ones(len(heights)), nobody, nobody, 6, None).table.T
    covered = np.zeros(len(heights))
    np.add.at(covered, rows.astype(int), high - low)
    np.testing.assert_allclose(covered, 1.0, atol=1e-6)


@pytest.mark.parametrize("threshold", HEIGHTS)
def test_a_level_changes_little_by_little_across_its_threshold(threshold):
    heights = threshold * np.linspace(1.0 - 2 * BAND, 1.0 + 2 * BAND, 401)
    level, share = levels_of(heights, len(HEIGHTS) + 1)
    detail = level + (1.0 - share)  # goes from the coarser level's number to the finer's
    steps = np.diff(detail)
    assert (steps <= 1e-9).all()
    assert np.abs(steps).max() < 0.02
    assert detail[0] - detail[-1] == pytest.approx(1.0)


def test_a_forced_level_is_everybodys():
    heights = np.array([10.0, 100.0, 600.0])
    for forced in (0, 2, 9):
        instances = seen_instances(heights, np.ones(3), np.zeros(3, int), np.zeros(3, int), 6, forced)
        assert {batch.level for batch in instances.batches} == {min(forced, 5)}
        assert sum(batch.count for batch in instances.batches) == 3


def test_batches_are_one_per_body_and_level_and_hold_everybody_once():
    rng = np.random.default_rng(1)
    heights, body = rng.uniform(5.0, 600.0, 500), rng.integers(0, 4, 500)
    shown = np.where(rng.random(500) < 0.1, rng.random(500), 1.0)
    instances = seen_instances(heights, shown, body, body, 6, None)
    keys = [(batch.body, batch.level, batch.far, batch.faded) for batch in instances.batches]
    assert len(keys) == len(set(keys))
    for batch in instances.batches:
        rows = instances.table[batch.first : batch.first + batch.count, 0].astype(int)
        assert (body[rows] == batch.body).all()
        shares = instances.table[batch.first : batch.first + batch.count, 1:3]
        assert (((shares[:, 0] > 0) | (shares[:, 1] < 1)) == batch.faded).all()
    casting = shadow_instances(heights, shown > 0.5, body, 6)
    assert sorted(casting.table[:, 0].astype(int)) == np.flatnonzero(shown > 0.5).tolist()


def test_shadows_are_cast_by_the_coarse_levels_and_by_the_coarsest_of_people_far_away():
    """600 pixels tall: the finest of the three coarse levels; 150: the next; 100 and 20: the coarsest."""
    heights = np.array([600.0, 150.0, 100.0, 20.0])
    casting = shadow_instances(heights, np.ones(4, bool), np.arange(4), 6)
    assert [batch.level for batch in casting.batches] == [3, 4, 5, 5]


@pytest.mark.slow
def test_levels_change_without_a_jump_in_the_picture():
    """The largest change of one frame, of all in which somebody changes level, is no larger than without changes."""
    times = 3.0 + np.arange(24) / 60.0
    size = (640, 360)

    def changes(lod):
        frames = pixels(*(street(t, lod=lod) for t in times), size=size)
        blocks = [np.abs(b - a).mean(axis=2).reshape(45, 8, 80, 8).mean(axis=(1, 3)) for a, b in pairwise(frames)]
        return np.array(blocks)

    by_size, fixed = changes(None), changes(2)
    assert np.quantile(by_size, 0.999) < 1.25 * np.quantile(fixed, 0.999)


def test_what_a_crowd_walks_is_measured():
    gait = measured_gait(street())
    assert gait["walkers"] == 60
    assert gait["motions"] == 6
    assert gait["step_length_mean"] == pytest.approx(0.77, abs=0.05)
    assert gait["nearest_m"] > 0.55
    assert 1.3 < gait["speed_mean"] < 1.8


def test_a_study_shows_its_crowds_at_the_time_they_have_walked():
    study = read_study("crowd_variety").study
    scene = walking(study, condition_of(study, ["variation=1:25", "size=250"]), 5.0)
    crowds = (scene.crowd, scene.beside.crowd)
    assert [crowd.variation for crowd in crowds] == ["1:1", "1:25"]
    assert {crowd.seconds for crowd in crowds} == {5.0}
    assert {crowd.size for crowd in crowds} == {250}
    assert "more different walks" in str(scene.page)
    gone = walking(study, condition_of(study, ["variation=1"]), 28.5)
    assert gone.crowd is None
    assert gone.page is not None

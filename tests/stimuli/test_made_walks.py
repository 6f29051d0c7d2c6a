"""Any method's walk, of any actor, as something that can be drawn at any phase."""

from typing import get_args

import numpy as np
import pytest

from stimuli.actors import load_actor
from stimuli.bodies.known import load_body
from stimuli.methods import recipe
from stimuli.methods.delivery import delivered
from stimuli.methods.errors import MethodError
from stimuli.methods.made import captured_speeds, made_walk
from stimuli.methods.recipe import Making
from stimuli.poulaine.rebuilding import INTERPOLATIONS
from stimuli.poulaine.regression import TABLES
from stimuli.skeleton import JOINTS
from stimuli.walker import drawn_pose

SPEED = 1.06
EVERY_WAY = [
    Making(),
    Making("blend"),
    Making("timewarp", source_speed=0.88),
    Making("fourier"),
    Making("fourier", source_speed=SPEED, harmonics=8),
    Making("pca"),
    Making("poulaine", source_speed=1.24),
    Making("poulaine", source_speed=SPEED, points=4, interpolation="pchip"),
    Making("poulaine", sex="F", height=1.7),
    Making("poulaine", walk_ratio=0.006),
]


@pytest.fixture(scope="module")
def actor():
    return load_actor("M1")


def test_a_making_knows_what_the_poulaine_knows():
    assert get_args(recipe.Interpolation) == INTERPOLATIONS
    assert get_args(recipe.Table) == TABLES


@pytest.mark.parametrize("phase", [0.0, 0.25, 0.609375])
def test_a_captured_making_is_the_actor_as_drawn(actor, phase):
    walk = made_walk(actor, Making(step_frequency=100.0), SPEED)
    drawn, made = drawn_pose(actor, SPEED, 100.0, phase), walk.pose(phase)
    assert walk.step_frequency == pytest.approx(100.0)
    np.testing.assert_allclose(made.hips, drawn.hips, atol=1e-9)
    np.testing.assert_allclose(np.abs(np.sum(made.rotations * drawn.rotations, axis=1)), 1.0, atol=1e-9)


@pytest.mark.parametrize("making", EVERY_WAY, ids=lambda making: making.method)
def test_every_making_walks_at_the_speed_asked_for(actor, making):
    walk = made_walk(actor, making, SPEED)
    # timewarp has a whole number of frames, N = d f / v, so its speed is off by v / 2N at most
    assert walk.cycle.stride_length / walk.cycle.stride_time == pytest.approx(SPEED, rel=0.005)
    assert walk.pose(0.3).rotations.shape == (len(JOINTS), 4)
    np.testing.assert_allclose(walk.pose(1.3).hips, walk.pose(0.3).hips)


def test_time_warping_keeps_the_step_length_of_its_source(actor):
    slow, warped = made_walk(actor, Making(), 0.88), made_walk(actor, Making("timewarp", source_speed=0.88), 1.2)
    assert warped.cycle.stride_length == pytest.approx(slow.cycle.stride_length)
    assert warped.step_frequency == pytest.approx(slow.step_frequency * 1.2 / 0.88, rel=0.005)


def test_by_default_a_method_starts_from_the_other_captured_speeds(actor):
    assert captured_speeds(actor) == (0.70, 0.88, 1.06, 1.24, 1.42)
    default, named = Making("timewarp"), Making("timewarp", source_speed=1.24)
    assert made_walk(actor, default, 1.16).cycle.provenance == made_walk(actor, named, 1.16).cycle.provenance
    assert "1.24" not in made_walk(actor, default, 1.24).cycle.provenance.clip.split(",")[0]


def test_a_poulaine_walk_towards_another_height_is_a_walk_of_a_person_of_that_height(actor):
    walk = made_walk(actor, Making("poulaine", source_speed=SPEED, height=0.9 * actor.height), SPEED)
    assert walk.size == pytest.approx(0.9, abs=0.02)  # stature from the leg's length (Drillis & Contini 1966)
    np.testing.assert_allclose(walk.pose(0.0).hips[1] * walk.size, walk.cycle.hips[0, 1])


def test_a_poulaine_walk_towards_a_walk_ratio_has_it(actor):
    walk = made_walk(actor, Making("poulaine", walk_ratio=0.006), SPEED)
    assert walk.step_frequency == pytest.approx(np.sqrt(60 * SPEED / 0.006))


def test_the_lower_sole_is_at_the_ground_half_of_the_time(actor):
    from stimuli.kinematics import world_matrices
    from stimuli.measure import sole_points

    walk = made_walk(actor, Making("poulaine", source_speed=0.7), 1.2)
    lowest = []
    for phase in walk.cycle.phases:
        pose = walk.pose(phase)
        pose = type(pose)(pose.hips[None], pose.rotations[None])
        points = sole_points(actor.skeleton, actor.figure.sole, world_matrices(actor.skeleton, pose))
        lowest.append(points[..., 1].min())
    assert np.median(lowest) == pytest.approx(0.0, abs=1e-6)


def test_a_made_walk_is_made_once(actor):
    assert made_walk(actor, Making("pca"), 1.0) is made_walk(actor, Making("pca"), 1.0)


def test_a_walk_made_for_another_body_has_that_bodys_bones():
    other = load_actor("M1", load_body("woman"))
    walk = made_walk(other, Making("pca"), SPEED)
    np.testing.assert_allclose(walk.cycle.offsets[1:], other.skeleton.offsets[1:])


def test_moved_at_another_pace_it_is_measured_as_shown(actor):
    walk = made_walk(actor, Making(), SPEED)
    assert delivered(walk.at_gait(SPEED, walk.step_frequency)).slide < 10
    assert delivered(walk.at_gait(1.3 * SPEED, walk.step_frequency)).slide > 50


@pytest.mark.parametrize(
    ("making", "speed", "sentence"),
    [
        (Making("blend"), 1.42, "needs captured walks below and above"),
        (Making("fourier"), 0.70, "needs captured walks below and above"),
        (Making("pca"), 3.0, "km/h is outside the PCA engine"),
        (Making("poulaine"), 3.5, "is no walk"),
        (Making("captured"), 2.0, "speed 2 m/s is outside the cycles there are"),
        (Making("captured", source_speed=0.9), 1.0, "is not made from one at"),
    ],
)
def test_what_cannot_be_made_is_refused_with_a_sentence(actor, making, speed, sentence):
    with pytest.raises(ValueError, match=sentence):
        made_walk(actor, making, speed)


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"method": "magic"}, "method: there is no 'magic'; there are captured, blend, timewarp"),
        ({"points": 6}, "points: there is no 6; there are 4, 5"),
        ({"interpolation": "linear"}, "interpolation: there is no 'linear'"),
        ({"table": "other"}, "table: there is no 'other'"),
        ({"method": "blend", "height": 1.8}, "height: blend cannot edit it; poulaine and pca can"),
        ({"method": "timewarp", "walk_ratio": 0.006}, "walk_ratio: timewarp cannot edit it; poulaine can"),
    ],
)
def test_a_making_of_unknown_values_is_refused(values, sentence):
    with pytest.raises(MethodError, match=sentence):
        Making(**values)

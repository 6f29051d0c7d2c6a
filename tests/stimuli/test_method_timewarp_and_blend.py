"""Time warping and blending to a speed: what changes, and what must not."""

from dataclasses import replace

import pytest

from stimuli.actors import load_actor
from stimuli.methods.actor_walks import actor_walk, actor_walks
from stimuli.methods.blend import blend_to_speed, nearest_two
from stimuli.methods.comparison import METHODS, compared
from stimuli.methods.delivery import delivered, joint_rmse
from stimuli.methods.making import MethodError, rotations_at
from stimuli.methods.timewarp import frame_count, timewarp
from stimuli.rotations import angle_between

SPEEDS = (0.75, 0.9, 1.06, 1.2, 1.35)


@pytest.fixture(scope="module")
def walks():
    return actor_walks(load_actor("F2"), SPEEDS)


def test_equation_5_6_gives_the_frames():
    """v = d f / N: 1.2 m of travel at 120 Hz and 1.2 m/s is one second."""
    assert frame_count(1.2, 120.0, 1.2) == 120


@pytest.mark.parametrize("speed", [0.5, 1.0, 2.0])
def test_timewarp_changes_the_duration_only(walks, speed):
    walk = walks[2]
    warped = timewarp(walk, speed)
    assert warped.stride_length == walk.stride_length
    assert warped.gait.speed == pytest.approx(speed, rel=0.01)
    assert len(warped.hips) == round(warped.stride_time * 120)
    assert angle_between(warped.rotations, rotations_at(walk, warped.phases)).max() < 1e-6
    assert joint_rmse(warped, walk) < 0.5
    assert warped.provenance.format == "timewarp"
    assert "F2" in warped.provenance.clip


def test_timewarp_at_its_own_rate_and_speed_is_the_same_walk(walks):
    walk = walks[2]
    same = timewarp(walk, walk.gait.speed, frame_rate=len(walk.hips) / walk.stride_time)
    assert joint_rmse(same, walk) < 1e-6


def test_blend_delivers_the_speed_and_stays_near_the_captured_walk(walks):
    others = [walk for walk in walks if walk is not walks[2]]
    blended = blend_to_speed(others, SPEEDS[2])
    assert blended.gait.speed == pytest.approx(SPEEDS[2])
    assert joint_rmse(blended, walks[2]) < 1.5
    assert delivered(blended).slide < 10.0


def test_blend_takes_the_two_nearest_captures(walks):
    low, high, share = nearest_two(walks, 1.0)
    assert (low, high) == (walks[1], walks[2])
    assert share == pytest.approx((1.0 - 0.9) / (1.06 - 0.9))


def test_a_drawn_actor_as_a_cycle_walks_at_its_speed_and_hardly_slides():
    measured = delivered(actor_walk(load_actor("M1"), 1.2))
    assert measured.speed == pytest.approx(1.2, rel=0.01)
    assert measured.slide < 6.0


def test_every_method_is_measured_against_the_walk_left_out(walks):
    rows, problems = compared("F2", walks, count=1)
    assert problems == []
    assert [row.method for row in rows] == ["captured", *METHODS]
    assert rows[0].legs < 1e-6
    for row in rows[1:]:
        assert row.cycle.gait.speed == pytest.approx(row.speed, rel=0.01)
        assert 0.0 < row.legs < 12.0
        assert row.cycle.provenance.format == row.method


@pytest.mark.parametrize(
    ("made", "sentence"),
    [
        (lambda walks: timewarp(walks[0], -1.0), "is no walk"),
        (lambda walks: timewarp(walks[0], float("nan")), "is no walk"),
        (lambda walks: blend_to_speed(walks, 3.0), "outside the captures"),
        (lambda walks: blend_to_speed(walks[:1], 1.0), "two speeds"),
        (lambda walks: compared("X", walks[:2]), "three speeds"),
        (
            lambda walks: blend_to_speed([walks[0], replace(walks[1], offsets=walks[1].offsets * 1.1)], 0.8),
            "different skeletons",
        ),
    ],
)
def test_bad_input_is_a_sentence(walks, made, sentence):
    with pytest.raises(MethodError, match=sentence):
        made(walks)

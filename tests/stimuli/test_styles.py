"""Eleven styles of walking, on any actor, as captured walks and as Fourier walks."""

import numpy as np
import pytest

from stimuli.actor_library import stored
from stimuli.actors import load_actor
from stimuli.kinematics import world_joints
from stimuli.methods.delivery import delivered, joint_rmse
from stimuli.methods.errors import MethodError
from stimuli.methods.made import made_walk
from stimuli.methods.recipe import Making
from stimuli.methods.styles import default_styles, styled
from stimuli.skeleton import JOINTS, Pose
from tests.stimuli.test_actor_library import actor as stored_actor

SPEED = 1.1
OWN = Making()


@pytest.fixture(scope="module")
def actor():
    return load_actor("M1")


def joints(actor, making):
    """(N, 21, 3) m over one cycle."""
    cycle = made_walk(actor, making, SPEED).cycle
    return world_joints(actor.skeleton, Pose(cycle.hips, cycle.rotations))


def test_there_are_the_eleven_styles_with_the_names_the_source_uses():
    assert len(default_styles()) == 11
    assert {"drunken", "manly", "tiptoe"} <= set(default_styles())  # figures 2 and 5 of Tilmanne & Dutoit


@pytest.mark.parametrize("name", default_styles())
def test_a_style_walks_at_the_speed_asked_for_without_sliding(actor, name):
    measured = delivered(made_walk(actor, Making(style=name), SPEED).cycle)
    assert measured.speed == pytest.approx(SPEED, rel=0.03)
    assert measured.slide < 20
    assert measured.knee_least > 0


def test_styles_differ_from_each_other_and_from_the_actor(actor):
    walks = [made_walk(actor, Making(style=name), SPEED).cycle for name in default_styles()]
    walks.append(made_walk(actor, OWN, SPEED).cycle)
    for index, walk in enumerate(walks):
        for other in walks[index + 1 :]:
            assert joint_rmse(walk, other, walk.joints) > 2.0  # degrees, over all joints


def test_styles_do_what_their_names_say(actor):
    own = joints(actor, OWN)
    head, chest, toes = (JOINTS.index(name) for name in ("head", "chest", "rightToes"))
    foot, left = (JOINTS.index(name) for name in ("rightFoot", "leftFoot"))
    sad, tiptoe, cat = (joints(actor, Making(style=name)) for name in ("sad", "tiptoe", "cat_walk"))
    assert (sad[:, head, 2] - sad[:, chest, 2]).mean() > (own[:, head, 2] - own[:, chest, 2]).mean() + 0.02
    assert np.median(tiptoe[:, foot, 1] - tiptoe[:, toes, 1]) > np.median(own[:, foot, 1] - own[:, toes, 1]) + 0.03
    assert (cat[:, left, 0] - cat[:, foot, 0]).mean() < (own[:, left, 0] - own[:, foot, 0]).mean() - 0.05
    hurried, cool = (made_walk(actor, Making(style=name), SPEED).step_frequency for name in ("hurried", "cool"))
    assert hurried > made_walk(actor, OWN, SPEED).step_frequency > cool


def test_the_two_steps_of_the_drunken_walk_differ_and_those_of_the_sad_one_do_not(actor):
    """What makes it the worst in figure 5: two successive steps are very different from each other."""

    def step_times(name):
        places = joints(actor, Making(style=name))
        strikes = [np.argmax(places[:, JOINTS.index(f"{side}Foot"), 2]) / len(places) for side in ("right", "left")]
        return (strikes[1] - strikes[0]) % 1.0

    assert step_times("sad") == pytest.approx(0.5, abs=0.01)
    assert abs(step_times("drunken") - 0.5) > 0.02


def test_more_harmonics_come_nearer_to_the_style(actor):
    original = made_walk(actor, Making(style="drunken"), SPEED).cycle
    errors = [
        joint_rmse(made_walk(actor, Making("fourier", style="drunken", harmonics=order), SPEED).cycle, original)
        for order in (1, 2, 4, 8)
    ]
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 1.5 < errors[0]


def test_a_fourier_walk_goes_part_of_the_way_to_a_style_and_beyond_it(actor):
    head = JOINTS.index("head")
    low = [
        joints(actor, Making("fourier", style="sad", share=share))[:, head, 1].mean() for share in (0.0, 0.5, 1.0, 1.3)
    ]
    assert low == sorted(low, reverse=True)
    own = made_walk(actor, Making("fourier", source_speed=SPEED), SPEED).cycle
    assert joint_rmse(made_walk(actor, Making("fourier", style="sad", share=0.0), SPEED).cycle, own) < 0.01


def test_an_imported_actor_walks_in_a_style_too(tmp_path, monkeypatch):
    monkeypatch.setenv("GAITLAB_ACTORS", str(tmp_path))
    stored(stored_actor())
    anna = load_actor("anna")
    assert "sad style made from the gait model" in styled(anna, "sad").provenance
    walk = made_walk(anna, Making("fourier", style="sad"), 1.1)
    assert walk.step_frequency == pytest.approx(102.0, rel=1e-3)  # her captures leave the step frequency no choice


def test_an_unknown_style_is_refused_with_those_there_are(actor):
    with pytest.raises(MethodError, match="style: there is no 'angry'; there are proud, decided, sad"):
        made_walk(actor, Making(style="angry"), SPEED)


def test_only_a_fourier_walk_can_be_part_of_the_way_to_a_style():
    with pytest.raises(MethodError, match="share: only a fourier walk in a style"):
        Making("pca", style="sad", share=0.5)

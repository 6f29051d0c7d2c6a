"""Point lights and stick figures: where markers are, and what scrambling and inversion keep."""

import numpy as np
import pytest

from stimuli.actors import load_actor
from stimuli.bodies.point_light import CARRIERS, FIGURES, MARKERS, STICKS, carried, figure_lines, resting, scrambling
from stimuli.kinematics import world_joints
from stimuli.skeleton import JOINTS
from stimuli.walker import drawn_pose, skin_matrices

ACTOR = load_actor("F1")
REST = resting(ACTOR.skeleton, ACTOR.height)


def matrices(phase):
    return skin_matrices(ACTOR, drawn_pose(ACTOR, 1.0, 100.0, phase))


def test_there_are_the_fifteen_markers_of_troje_2002():
    assert len(MARKERS) == len(set(MARKERS)) == len(CARRIERS) == 15
    assert {name for pair in STICKS for name in pair} == set(MARKERS)


@pytest.mark.parametrize("phase", [0.0, 0.3, 0.8])
def test_limb_markers_are_the_joints_of_forward_kinematics(phase):
    joints = world_joints(ACTOR.skeleton, drawn_pose(ACTOR, 1.0, 100.0, phase))
    markers = carried(REST, matrices(phase))
    for marker, joint in (("leftKnee", "leftLowerLeg"), ("rightWrist", "rightHand"), ("leftAnkle", "leftFoot")):
        assert np.allclose(markers[MARKERS.index(marker)], joints[JOINTS.index(joint)], atol=1e-5)


def test_scrambled_markers_keep_their_motion_but_not_their_places():
    seen = [figure_lines("point_light_scrambled", REST, matrices(p), ACTOR.height, 3)[:, 0] for p in (0.1, 0.6)]
    plain = [figure_lines("point_light", REST, matrices(p), ACTOR.height, 3)[:, 0] for p in (0.1, 0.6)]
    assert np.allclose(seen[1] - seen[0], plain[1] - plain[0])
    assert np.abs(seen[0] - plain[0]).max() > 0.2
    assert np.array_equal(scrambling(REST, 3), scrambling(REST, 3))
    assert not np.array_equal(scrambling(REST, 3), scrambling(REST, 4))


def test_an_inverted_figure_is_upside_down_in_the_same_space():
    plain = figure_lines("point_light", REST, matrices(0.2), ACTOR.height, 0)[:, 0]
    upside_down = figure_lines("point_light_inverted", REST, matrices(0.2), ACTOR.height, 0)[:, 0]
    assert np.allclose(upside_down[:, 1], ACTOR.height - plain[:, 1])
    assert np.allclose(upside_down[:, [0, 2]], plain[:, [0, 2]])


@pytest.mark.parametrize("figure", FIGURES)
def test_dots_have_no_length_and_sticks_have(figure):
    lines = figure_lines(figure, REST, matrices(0.2), ACTOR.height, 0)
    lengths = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1)
    assert (lengths > 0.03).all() if figure == "stick_figure" else (lengths == 0).all()

"""Forward kinematics and the leg's inverse kinematics, checked by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stimuli.bodies.known import load_body
from stimuli.kinematics import skinning_matrices, world_joints, world_matrices
from stimuli.legs.two_bone import Leg, solve
from stimuli.rotations import about_axis, to_matrix
from stimuli.skeleton import JOINTS, Pose

SKELETON = load_body("man").skeleton
REST = np.tile([0.0, 0.0, 0.0, 1.0], (21, 1))


def test_the_rest_pose_stands_where_the_skeleton_says():
    pose = Pose(SKELETON.positions[0], REST)
    np.testing.assert_allclose(world_joints(SKELETON, pose), SKELETON.positions, atol=1e-12)
    np.testing.assert_allclose(skinning_matrices(SKELETON, pose), np.tile(np.eye(4)[:3], (21, 1, 1)), atol=1e-6)


def test_turning_the_hips_left_brings_the_left_hip_back():
    rotations = REST.copy()
    rotations[0] = about_axis((0.0, 1.0, 0.0), np.pi / 2)
    joints = world_joints(SKELETON, Pose(np.zeros(3), rotations))
    left = SKELETON.offsets[JOINTS.index("leftUpperLeg")]
    np.testing.assert_allclose(joints[JOINTS.index("leftUpperLeg")], [left[2], left[1], -left[0]], atol=1e-12)


def test_a_batch_of_poses_is_as_one_after_the_other():
    rng = np.random.default_rng(1)
    rotations = rng.normal(size=(5, 21, 4))
    rotations /= np.linalg.norm(rotations, axis=-1, keepdims=True)
    hips = rng.normal(size=(5, 3))
    together = world_matrices(SKELETON, Pose(hips, rotations))
    for n in range(5):
        np.testing.assert_allclose(together[n], world_matrices(SKELETON, Pose(hips[n], rotations[n])), atol=1e-12)


@given(st.floats(-0.5, 0.5), st.floats(-0.2, 0.2), st.floats(0.55, 0.84), st.floats(-0.3, 0.3))
def test_the_leg_reaches_the_ankle_and_bends_forward(angle, aside, distance, knee_yaw):
    leg = Leg.of(SKELETON, "right")
    distance = min(distance, 0.999 * leg.length)
    ankle = distance * np.array([np.sin(aside), -np.cos(aside) * np.cos(angle), np.cos(aside) * np.sin(angle)])
    thigh, shank = (to_matrix(turn) for turn in solve(leg, (0.0, 0.0, 0.0), tuple(ankle), knee_yaw))
    offsets = SKELETON.offsets
    knee = thigh @ offsets[JOINTS.index("rightLowerLeg")]
    np.testing.assert_allclose(knee + shank @ offsets[JOINTS.index("rightFoot")], ankle, atol=1e-9)
    straight = ankle * (knee @ ankle) / (ankle @ ankle)
    assert (knee - straight) @ [np.sin(knee_yaw), 0.0, np.cos(knee_yaw)] >= -1e-9
    np.testing.assert_allclose(thigh @ thigh.T, np.eye(3), atol=1e-9)


def test_a_leg_of_3_and_4_with_the_ankle_at_5_bends_by_a_right_angle():
    offsets = np.array(SKELETON.offsets)
    offsets[JOINTS.index("rightLowerLeg")] = (0.0, -3.0, 0.0)
    offsets[JOINTS.index("rightFoot")] = (0.0, -4.0, 0.0)
    leg = Leg.of(type(SKELETON)(offsets), "right")
    thigh, shank = (to_matrix(turn) for turn in solve(leg, (0.0, 0.0, 0.0), (0.0, -5.0, 0.0), 0.0))
    assert (thigh @ [0, -1, 0]) @ (shank @ [0, -1, 0]) == pytest.approx(0.0, abs=1e-12)

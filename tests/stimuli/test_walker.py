"""The walker as drawn: continuous in everything, bones keep their length, knees do not snap, arms oppose legs."""

import numpy as np
import pytest

from stimuli.actors import load_actor
from stimuli.blend_tree import CoverageError
from stimuli.measure import poses
from stimuli.quality.delivery import comfort
from stimuli.rotations import angle_between
from stimuli.skeleton import JOINTS, PARENTS
from stimuli.walker import drawn_pose, skin_matrices, world_joints

CONDITIONS = [(0.8, 80.0), (0.8, 120.0), (1.0, 97.0), (1.2, 80.0), (1.2, 120.0)]


def farthest(first, second):
    turns = angle_between(first.rotations, second.rotations)
    return max(float(np.max(turns)), float(np.max(np.abs(first.hips - second.hips))))


@pytest.mark.parametrize(("speed", "step_frequency"), CONDITIONS)
def test_the_end_of_a_cycle_meets_its_start(speed, step_frequency):
    actor = load_actor("F1")
    before, after = (drawn_pose(actor, speed, step_frequency, phase) for phase in (1.0 - 1e-9, 0.0))
    assert farthest(before, after) < 1e-5
    assert farthest(after, drawn_pose(actor, speed, step_frequency, 5.0)) < 1e-9


@pytest.mark.parametrize("name", ["F2", "M1"])
def test_the_walker_does_not_jump_when_the_setting_changes(name):
    actor = load_actor(name)
    for phase in (0.0, 0.13, 0.5, 0.62, 0.9):
        for step_frequency in (89.999, 99.999, 109.999):
            first, second = (drawn_pose(actor, 1.0, step_frequency + d, phase) for d in (0.0, 0.002))
            assert farthest(first, second) < 0.002
        for speed in (0.8799, 1.0599, 1.2399 - 0.1):
            assert farthest(drawn_pose(actor, speed, 95, phase), drawn_pose(actor, speed + 0.0002, 95, phase)) < 0.004


@pytest.mark.parametrize(("speed", "step_frequency"), CONDITIONS)
def test_bones_keep_their_length(speed, step_frequency):
    actor = load_actor("M2")
    lengths = np.linalg.norm(actor.skeleton.offsets, axis=1)[1:]
    for phase in np.linspace(0, 1, 17):
        joints = world_joints(actor.skeleton, drawn_pose(actor, speed, step_frequency, phase))
        drawn = np.linalg.norm(joints[1:] - joints[list(PARENTS[1:])], axis=1)
        np.testing.assert_allclose(drawn, lengths, atol=1e-9)


@pytest.mark.parametrize("name", ["F2", "F7", "M1", "T1"])
def test_no_joint_jerks_where_the_leg_is_nearly_straight_before_the_heel_strikes(name):
    """Each place is foretold by the three poses before, a thousandth of a cycle apart, to 3.5 mm (it was 8 once)."""
    actor = load_actor(name)
    gait = comfort(actor)
    joints = world_joints(actor.skeleton, poses(actor, gait.speed, gait.step_frequency, np.arange(1000) / 1000))
    foretold = np.roll(joints, 3, 0) - 3 * np.roll(joints, 2, 0) + 3 * np.roll(joints, 1, 0)
    assert np.linalg.norm(foretold - joints, axis=2).max() < 0.0035


@pytest.mark.parametrize("name", ["F1", "F4", "F8", "M1"])
@pytest.mark.parametrize(("speed", "step_frequency"), CONDITIONS)
def test_a_foot_leaves_the_ground_no_faster_than_a_captured_one(name, speed, step_frequency):
    """Toe markers of Schreiber & Moissenet's fast walks (up to 2.2 m/s) rise at 0.5 to 1.2 m/s; it was 2.8 once."""
    actor = load_actor(name)
    phases = np.arange(0.5, 0.8, 0.001)
    toes = world_joints(actor.skeleton, poses(actor, speed, step_frequency, phases))[:, JOINTS.index("rightToes"), 1]
    assert 0.4 < np.max(np.diff(toes)) / (0.001 * 120 / step_frequency) < 1.3


@pytest.mark.parametrize("name", ["F1", "F3", "M1", "M5"])
def test_the_hips_do_not_tremble(name):
    """Captured hips (four CMU and Schreiber & Moissenet walks) move 0.4 mm at most in any harmonic above the sixth."""
    actor = load_actor(name)
    gait = comfort(actor)
    hips = poses(actor, gait.speed, gait.step_frequency, np.arange(256) / 256).hips
    amplitudes = 2 * np.abs(np.fft.rfft(hips[:, 1:], axis=0)) / 256
    assert amplitudes[7:40].max() < 0.0008  # m
    assert amplitudes[9:40].max() < 0.0004


def test_left_and_right_mirror_each_other_half_a_cycle_apart():
    actor = load_actor("F3")
    mirror = [JOINTS.index(n.replace("left", "#").replace("right", "left").replace("#", "right")) for n in JOINTS]
    for phase in np.linspace(0, 0.5, 9):
        first = world_joints(actor.skeleton, drawn_pose(actor, 1.1, 105, phase))
        second = world_joints(actor.skeleton, drawn_pose(actor, 1.1, 105, phase + 0.5))
        np.testing.assert_allclose(second[mirror] * [-1.0, 1.0, 1.0], first, atol=2e-4)


@pytest.mark.parametrize("name", ["F1", "F2", "M1", "M2"])
def test_each_arm_swings_with_the_opposite_leg(name):
    actor = load_actor(name)
    pose = poses(actor, 1.1, 105, np.arange(100) / 100)
    joints = world_joints(actor.skeleton, pose)
    hand = joints[:, JOINTS.index("rightHand"), 2] - joints[:, JOINTS.index("rightUpperArm"), 2]
    same, other = (joints[:, JOINTS.index(f"{side}Foot"), 2] - pose.hips[:, 2] for side in ("right", "left"))
    assert np.corrcoef(hand, other)[0, 1] > 0.7
    assert np.corrcoef(hand, same)[0, 1] < -0.7


def test_the_hips_bob_twice_per_cycle_by_some_centimetres_and_the_head_is_steadier_in_pitch_than_the_knee():
    actor = load_actor("M2")
    pose = poses(actor, 1.15, 100, np.arange(100) / 100)
    spectrum = np.abs(np.fft.rfft(pose.hips[:, 1]))
    assert int(np.argmax(spectrum[1:])) + 1 == 2
    assert 0.015 < np.ptp(pose.hips[:, 1]) < 0.06  # Murray 1964: 4 to 5 cm


def test_longer_steps_at_one_speed_come_with_lower_step_frequency():
    actor = load_actor("M1")
    spans = []
    for step_frequency in (80, 100, 120):
        joints = world_joints(actor.skeleton, poses(actor, 1.0, step_frequency, np.arange(60) / 60))
        spans.append(np.ptp(joints[:, JOINTS.index("leftFoot"), 2] - joints[:, JOINTS.index("rightFoot"), 2]))
    assert spans[0] > spans[1] > spans[2]


def test_skin_matrices_put_the_joints_where_the_kinematics_do():
    actor = load_actor("F1")
    pose = drawn_pose(actor, 1.0, 100, 0.3)
    matrices = skin_matrices(actor, pose)
    assert matrices.shape == (21, 3, 4)
    assert matrices.dtype == np.float32
    rest = np.column_stack([actor.skeleton.positions, np.ones(21)])
    placed = np.einsum("jik,jk->ji", matrices, rest)
    np.testing.assert_allclose(placed, world_joints(actor.skeleton, pose), atol=1e-5)


def test_outside_the_coverage_is_refused():
    with pytest.raises(CoverageError, match=r"speed 2 m/s"):
        drawn_pose(load_actor("F1"), 2.0, 100, 0.0)

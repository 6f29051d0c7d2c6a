"""One-stride loops: closed in place and velocity, true to the clip they come from."""

from pathlib import Path

import numpy as np
import pytest

from stimuli.clip import world_positions
from stimuli.cycle import close_curve, close_rotations, cycle_positions, extract_cycle, seam_gaps
from stimuli.events import GaitError, find_events, foot_paths
from stimuli.gait_measures import measure
from stimuli.motion_files.bvh import read_bvh
from stimuli.rotations import angle_between, from_exponential
from stimuli.skeleton import JOINTS

BVH = Path(__file__).parents[2].parent / "shared" / "mocap" / "bvh"
CMU = sorted((BVH / "cmu").glob("*.bvh"))
BANDAI = sorted((BVH / "bandai").glob("*normal_0*.bvh"))[2:]
needs_captures = pytest.mark.skipif(not CMU, reason="the shared captures are not beside the checkout")


@needs_captures
@pytest.mark.parametrize("path", CMU + BANDAI, ids=lambda path: path.stem)
def test_the_seam_is_continuous_to_a_millimetre_and_2_percent_of_peak_joint_speed(path):
    """Sampled finely, so that what is measured is the seam and not the curve's own bend."""
    position, velocity = seam_gaps(extract_cycle(read_bvh(path), phases=1024))
    assert position < 0.001
    assert velocity < 0.02


@needs_captures
@pytest.mark.parametrize("path", CMU[::4] + BANDAI[:1], ids=lambda path: path.stem)
def test_a_loop_walks_as_its_clip_does(path):
    clip = read_bvh(path)
    cycle, measures = extract_cycle(clip), measure(clip)
    assert cycle.rotations.shape == (128, len(cycle.joints), 4)
    assert set(cycle.joints) <= set(JOINTS)
    assert cycle.gait.step_frequency == pytest.approx(measures.gait.step_frequency, rel=0.05)
    assert cycle.gait.speed == pytest.approx(measures.speed, rel=0.05)


@needs_captures
@pytest.mark.parametrize("path", CMU[:3] + BANDAI[:2], ids=lambda path: path.stem)
def test_the_posture_is_the_clips(path):
    """Legs keep to the captured distances of hips and ankles: within 12 mm after closing and smoothing."""
    clip = read_bvh(path)
    cycle = extract_cycle(clip)
    source = cycle.provenance
    captured = world_positions(clip)[source.first_frame : source.last_frame + 1]
    positions = cycle_positions(cycle)
    for side in ("left", "right"):
        ankle = positions[:, cycle.joints.index(side + "Foot")] - positions[:, 0]
        there = captured[:, clip.roles[side + "Foot"]] - captured[:, clip.roles["hips"]]
        reach, captured_reach = np.linalg.norm(ankle, axis=1), np.linalg.norm(there, axis=1)
        assert np.quantile(reach, [0, 0.5, 1]) == pytest.approx(np.quantile(captured_reach, [0, 0.5, 1]), abs=0.012)


@needs_captures
def test_phase_0_is_the_right_heel_strike_and_the_walker_faces_forward():
    cycle = extract_cycle(read_bvh(CMU[0]))
    positions = cycle_positions(cycle)
    right, left = (positions[:, cycle.joints.index(side + "Foot")] - positions[:, 0] for side in ("right", "left"))
    assert right[0, 2] > 0.2  # ahead
    assert left[0, 2] < -0.2  # behind
    assert left[0, 0] > right[0, 0]  # left is +X
    assert np.argmax(right[:, 2]) in (0, 1, *range(118, 128))


@needs_captures
def test_a_bandai_walker_stands_upright_on_its_mean_posture():
    cycle = extract_cycle(read_bvh(BANDAI[0]))
    assert cycle.provenance.rest == "mean posture"
    positions = cycle_positions(cycle)
    assert np.all(positions[:, cycle.joints.index("head"), 1] > positions[:, 0, 1] + 0.3)
    assert np.median(np.degrees(angle_between(cycle.rotations[:, 0], [0.0, 0.0, 0.0, 1.0]))) < 15


@needs_captures
def test_the_travel_is_taken_off_and_kept_as_a_number():
    cycle = extract_cycle(read_bvh(CMU[0]))
    assert np.ptp(cycle.hips[:, 2]) < 0.1
    assert cycle.stride_length == pytest.approx(cycle.gait.speed * cycle.stride_time)
    np.testing.assert_allclose(cycle.hips[:, [0, 2]].mean(axis=0), 0, atol=0.005)
    assert 0.8 < cycle.hips[:, 1].mean() < 1.1


@needs_captures
def test_a_walk_without_a_whole_stride_gives_no_cycle():
    with pytest.raises(GaitError):
        extract_cycle(read_bvh(BVH / "bandai/dataset-1_walk_normal_002.bvh"))


@needs_captures
def test_every_clip_of_the_figure_of_eight_and_the_turn_still_loops():
    for name in ("pymo/AV_8Walk_Meredith_HVHA_Rep1.bvh", "cmu/cmu_32_02.bvh"):
        clip = read_bvh(BVH / name)
        assert find_events(foot_paths(clip))
        assert seam_gaps(extract_cycle(clip, phases=1024))[0] < 0.001


def test_closing_a_curve_spreads_its_difference_and_meets_its_slopes():
    share = np.linspace(-0.02, 1.02, 209)
    curve = np.sin(2 * np.pi * share) + 0.3 * share + 0.2 * share**2
    closed = close_curve(curve[:, None], share)[:, 0]
    step = 1 / (len(closed) - 1)
    assert closed[-1] == closed[0]
    before, after = (closed[-1] - closed[-2]) / step, (closed[1] - closed[0]) / step
    assert after == pytest.approx(before, abs=0.02 * 2 * np.pi)


def test_closing_a_closed_curve_changes_nothing():
    share = np.linspace(-0.01, 1.01, 103)
    turn = from_exponential(np.stack([np.sin(2 * np.pi * share), 0 * share, 0.3 * np.cos(4 * np.pi * share)], axis=1))
    inside = (share > -1e-9) & (share < 1 + 1e-9)
    np.testing.assert_allclose(angle_between(close_rotations(turn[:, None], share)[:, 0], turn[inside]), 0, atol=1e-3)

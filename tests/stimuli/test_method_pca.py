"""The PCA walking engine after Glardon, Boulic & Thalmann (2004)."""

import numpy as np
import pytest

from stimuli.actors import load_actor
from stimuli.cycle import cycle_positions
from stimuli.methods.actor_walks import actor_walks
from stimuli.methods.delivery import delivered, joint_rmse
from stimuli.methods.frequency_law import GLARDON, INMAN, fitted_law
from stimuli.methods.making import MethodError
from stimuli.methods.pca import FRAMES, motion_vector, pca_walk, standing_posture
from stimuli.rotations import angle_between

SPEEDS = (0.75, 0.9, 1.06, 1.2, 1.35)


@pytest.fixture(scope="module")
def walks():
    return actor_walks(load_actor("F2"), SPEEDS)


@pytest.fixture(scope="module")
def engine(walks):
    return pca_walk(walks)


def test_the_components_kept_hold_the_variance_asked_for_and_one_fewer_does_not(walks):
    engine = pca_walk(walks, kept=0.995)
    count = len(engine.components)
    assert engine.variance.sum() == pytest.approx(1.0)
    assert engine.variance[:count].sum() >= 0.995
    assert engine.variance[: count - 1].sum() < 0.995
    assert engine.reduction == pytest.approx((len(SPEEDS) + 1) / count)


def test_table_1_two_to_four_components_hold_80_percent_of_the_variance(engine):
    assert 2 <= len(engine.components) <= 4
    assert engine.variance[: len(engine.components)].sum() >= 0.80


def test_equation_1_with_all_components_gives_the_captures_back(walks):
    full = pca_walk(walks, kept=1.0 - 1e-12)
    vector = motion_vector(walks[1], full.leg_length)
    rows = full.components.reshape(len(full.components), -1)
    alpha = rows @ (vector - full.mean).ravel()
    np.testing.assert_allclose(full.mean.ravel() + alpha @ rows, vector.ravel(), atol=1e-6)


def test_equation_2_line_is_the_least_squares_line_and_meets_the_standing_segment(engine, walks):
    rows = engine.components.reshape(len(engine.components), -1)
    alpha = np.array([rows @ (motion_vector(w, engine.leg_length) - engine.mean).ravel() for w in walks])
    slope, intercept = np.polyfit([w.gait.speed for w in walks], alpha, 1)
    np.testing.assert_allclose(engine.slope, slope, atol=1e-9)
    np.testing.assert_allclose(engine.intercept, intercept, atol=1e-9)
    np.testing.assert_allclose(engine.coefficients(0.0), engine.standing, atol=1e-12)
    below, above = engine.coefficients(engine.slowest - 1e-9), engine.coefficients(engine.slowest + 1e-9)
    np.testing.assert_allclose(below, above, atol=1e-6)


def test_equation_4_inmans_law_and_equation_6():
    assert INMAN.frequency(1.44, 1.0) == pytest.approx(0.743 * 1.2)
    assert GLARDON.frequency(1.0, 1.0) == 0.85
    assert INMAN.frequency(0.0, 0.9) == 0.0


def test_the_law_fitted_to_walks_of_equation_6_is_equation_6():
    speeds = [0.8, 1.0, 1.3, 1.9]
    law = fitted_law(speeds, [GLARDON.frequency(speed, 0.9) for speed in speeds], 0.9)
    assert (law.factor, law.exponent) == pytest.approx((0.85, 0.4))


def test_equation_5_advances_the_phase_by_time_times_frequency(engine):
    assert engine.phase_advance(1.2, 0.1) == pytest.approx(0.1 * engine.law.frequency(1.2, engine.leg_length))


def test_shorter_legs_step_faster_at_the_same_speed(engine):
    short, tall = engine.cycle(1.2, leg=0.7), engine.cycle(1.2, leg=0.95)
    assert short.gait.step_frequency > tall.gait.step_frequency
    assert short.gait.speed == pytest.approx(1.2)
    assert tall.gait.speed == pytest.approx(1.2)


@pytest.mark.parametrize("kilometres_per_hour", range(11))
def test_it_walks_from_0_to_10_kilometres_per_hour_without_breaking(engine, kilometres_per_hour):
    walk = engine.cycle(kilometres_per_hour / 3.6)
    assert np.isfinite(walk.rotations).all()
    assert np.isfinite(walk.hips).all()
    np.testing.assert_allclose(np.linalg.norm(walk.rotations, axis=-1), 1.0, atol=1e-12)


def test_a_walk_left_out_is_found_between_the_others(walks):
    made = pca_walk([walk for walk in walks if walk is not walks[2]]).cycle(SPEEDS[2])
    assert joint_rmse(made, walks[2]) < 3.0


def test_poses_in_a_batch_are_the_cycles_frames(engine):
    walk = engine.cycle(1.1, leg=0.85)
    phases = np.arange(FRAMES) / FRAMES
    rotations, hips = engine.poses(np.full(FRAMES, 1.1), phases, np.full(FRAMES, 0.85))
    assert angle_between(rotations, walk.rotations).max() < 1e-6
    np.testing.assert_allclose(hips, walk.hips, atol=1e-9)


def test_standing_is_the_rest_pose_with_hanging_arms(walks):
    still = standing_posture(walks[0])
    arms = [joint.endswith(("Shoulder", "Arm", "Hand")) for joint in still.joints]
    assert np.all(still.rotations[:, np.logical_not(arms), 3] == 1.0)
    assert still.stride_length == 0.0
    places = cycle_positions(still)
    shoulder, hand = (places[0, still.joints.index(f"left{part}")] for part in ("UpperArm", "Hand"))
    assert np.arctan2(hand[0] - shoulder[0], shoulder[1] - hand[1]) < np.radians(20)


def test_where_speeds_are_narrow_two_components_still_follow_the_speed(engine):
    for kilometres_per_hour in (3, 4, 5):
        assert delivered(engine.cycle(kilometres_per_hour / 3.6)).slide < 10  # mm


def test_bad_input_is_a_sentence(walks, engine):
    with pytest.raises(MethodError, match="three speeds or more; there are 2"):
        pca_walk(walks[:2])
    with pytest.raises(MethodError, match="three different speeds"):
        pca_walk([walks[0]] * 4)
    with pytest.raises(MethodError, match="outside the PCA engine"):
        engine.cycle(4.0)
    with pytest.raises(MethodError, match="leg length"):
        engine.cycle(1.0, leg=-1.0)

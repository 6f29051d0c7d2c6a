"""Blend weights and rotation means: plain arithmetic, checked by hand and by properties."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stimuli.actors import CYCLE_SPEEDS, METRONOME, metronome_tree
from stimuli.blend import blend_rotations
from stimuli.blend_tree import Branch, CoverageError, Leaf, blend_weights, coverage
from stimuli.rotations import about_axis

TREE = metronome_tree(METRONOME, CYCLE_SPEEDS)


def test_the_example_of_the_thesis_blends_two_clips_of_two_sub_trees():
    tree = metronome_tree((80.0, 90.0), (0.9, 1.1))
    weights = blend_weights(tree, {"speed": 1.0, "step_frequency": 85.0})
    assert weights == pytest.approx({0: 0.25, 1: 0.25, 2: 0.25, 3: 0.25})


def test_at_a_cycle_only_that_cycle_counts():
    weights = blend_weights(TREE, {"speed": CYCLE_SPEEDS[2], "step_frequency": 110.0})
    assert weights == {3 * len(CYCLE_SPEEDS) + 2: 1.0}


@given(st.floats(0.70, 1.42), st.floats(80.0, 120.0))
def test_weights_sum_to_one_and_give_back_what_was_asked(speed, step_frequency):
    weights = blend_weights(TREE, {"speed": speed, "step_frequency": step_frequency})
    assert len(weights) <= 4
    assert min(weights.values()) >= 0.0
    assert sum(weights.values()) == pytest.approx(1.0, abs=1e-12)
    speeds = sum(w * CYCLE_SPEEDS[cycle % 5] for cycle, w in weights.items())
    frequencies = sum(w * METRONOME[cycle // 5] for cycle, w in weights.items())
    assert speeds == pytest.approx(speed, abs=1e-9)
    assert frequencies == pytest.approx(step_frequency, abs=1e-6)


def test_trees_may_have_any_depth_and_parameters():
    sway = Branch("sway", "", (0.0, 2.0), (Leaf(0), Branch("age", "years", (20.0, 60.0), (Leaf(1), Leaf(2)))))
    assert blend_weights(sway, {"sway": 1.0, "age": 30.0}) == {0: 0.5, 1: 0.375, 2: 0.125}
    assert coverage(sway) == {"sway": (0.0, 2.0), "age": (20.0, 60.0)}


@pytest.mark.parametrize(("speed", "step_frequency"), [(0.5, 100.0), (1.0, 130.0), (1.0, 79.0), (float("nan"), 100.0)])
def test_outside_the_cycles_is_refused_in_a_sentence(speed, step_frequency):
    with pytest.raises(CoverageError, match="is outside the cycles there are"):
        blend_weights(TREE, {"speed": speed, "step_frequency": step_frequency})


def test_a_rotation_and_its_negative_blend_to_that_rotation():
    rotation = about_axis((0.0, 1.0, 0.0), np.array([0.7]))
    mean = blend_rotations(np.stack([rotation, -rotation]), np.array([0.6, 0.4]))
    np.testing.assert_allclose(np.abs(np.sum(mean * rotation)), 1.0, atol=1e-12)


def test_half_way_between_two_turns_about_one_axis_is_the_mean_angle():
    turns = about_axis((1.0, 0.0, 0.0), np.array([[0.2], [0.6]]))
    mean = blend_rotations(turns, np.array([0.5, 0.5]))
    np.testing.assert_allclose(mean[0], about_axis((1.0, 0.0, 0.0), 0.4), atol=1e-12)

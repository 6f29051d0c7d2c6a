"""Quaternion arithmetic against matrices (scipy's rotations) and against its own laws."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from stimuli import one_rotation
from stimuli import rotations as r

RNG = np.random.default_rng(20221)
SOME = Rotation.random(200, random_state=1).as_quat()
OTHERS = Rotation.random(200, random_state=2).as_quat()

quaternions = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1).map(r.normalise)


def same_rotation(first, second):
    return np.allclose(r.angle_between(first, second), 0, atol=1e-7)


def test_multiplying_turns_by_the_second_first():
    expected = (Rotation.from_quat(SOME) * Rotation.from_quat(OTHERS)).as_matrix()
    np.testing.assert_allclose(r.to_matrix(r.multiply(SOME, OTHERS)), expected, atol=1e-12)


def test_rotating_a_vector_is_the_matrix_product():
    vectors = RNG.normal(size=(200, 3))
    np.testing.assert_allclose(r.rotate(SOME, vectors), Rotation.from_quat(SOME).apply(vectors), atol=1e-12)


def test_matrices_come_back_as_the_same_rotation_even_for_half_turns():
    half_turns = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0.6, 0.8, 0, 0]], dtype=float)
    for q in (SOME, half_turns):
        assert same_rotation(r.from_matrix(r.to_matrix(q)), q)


@pytest.mark.parametrize("order", ["XYZ", "ZXY", "ZYX", "YXZ", "XZY", "YZX"])
def test_euler_angles_turn_about_the_moving_axes_in_the_order_written(order):
    angles = RNG.uniform(-3, 3, size=(50, 3))
    expected = Rotation.from_euler(order, angles).as_quat()  # capital letters: intrinsic
    assert same_rotation(r.from_euler(order, angles), expected)


def test_no_euler_letters_are_no_rotation():
    np.testing.assert_array_equal(r.from_euler("", np.zeros((5, 0))), np.tile(r.IDENTITY, (5, 1)))


def test_the_exponential_map_and_the_logarithm_undo_each_other():
    assert same_rotation(r.from_exponential(r.to_exponential(SOME)), SOME)
    np.testing.assert_allclose(r.to_exponential(SOME), Rotation.from_quat(SOME).as_rotvec(), atol=1e-9)
    np.testing.assert_allclose(r.to_exponential(r.from_exponential([[1e-13, 0, 0]])), [[1e-13, 0, 0]], rtol=1e-6)


@given(quaternions, quaternions, st.floats(0, 1))
@settings(deadline=None)
def test_slerp_turns_at_constant_speed_along_the_shorter_way(first, second, share):
    whole = r.angle_between(first, second)
    between = r.slerp(first, second, share)
    assert r.angle_between(first, between) == pytest.approx(share * whole, abs=1e-6)


@given(quaternions)
@settings(deadline=None)
def test_a_rotation_and_its_negative_have_that_rotation_as_their_mean(q):
    assert same_rotation(r.mean_rotation([q, -q]), q)


def test_the_shortest_arc_takes_one_direction_to_the_other():
    start, end = RNG.normal(size=(200, 3)), RNG.normal(size=(200, 3))
    turned = r.rotate(r.shortest_arc(start, end), start)
    np.testing.assert_allclose(np.cross(turned, end), 0, atol=1e-9)
    assert np.all(np.sum(turned * end, axis=1) > 0)


@pytest.mark.parametrize("axis", np.eye(3))
def test_opposite_directions_are_half_a_turn_apart(axis):
    arc = r.shortest_arc(axis, -axis)
    np.testing.assert_allclose(r.rotate(arc, axis), -axis, atol=1e-12)
    assert np.linalg.norm(arc) == pytest.approx(1)


def test_signs_are_chosen_so_that_neighbours_are_close():
    path = r.from_exponential(np.linspace(0, 9, 100)[:, None] * [0, 0.6, 0.8])
    broken = path * RNG.choice([-1, 1], size=(100, 1))
    steps = np.sum(r.continuous(broken)[1:] * r.continuous(broken)[:-1], axis=1)
    assert np.all(steps > 0)


def test_heading_left_is_positive_yaw():
    assert r.yaw(r.about_axis([0.0, 1.0, 0.0], 0.3)) == pytest.approx(0.3)


@given(quaternions, quaternions, st.tuples(*[st.floats(-2, 2)] * 3))
def test_one_rotation_in_plain_numbers_is_as_many(first, second, vector):
    a, b = tuple(first.tolist()), tuple(second.tolist())
    np.testing.assert_allclose(one_rotation.multiply(a, b), r.multiply(a, b), atol=1e-15)
    np.testing.assert_allclose(one_rotation.inverse(a), r.inverse(a), atol=1e-15)
    np.testing.assert_allclose(one_rotation.rotate(a, vector), r.rotate(a, vector), atol=1e-14)
    matrix = r.to_matrix(a)
    again = one_rotation.w_not_negative(one_rotation.from_columns(*map(tuple, matrix.T.tolist())))
    np.testing.assert_allclose(again, r.from_matrix(matrix), atol=1e-14)


@pytest.mark.parametrize("half_turn", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.6, 0.8, 0.0)])
def test_one_rotation_comes_back_from_its_columns_even_for_half_turns(half_turn):
    matrix = r.to_matrix((*half_turn, 0.0))
    assert same_rotation(one_rotation.from_columns(*map(tuple, matrix.T.tolist())), (*half_turn, 0.0))


@given(st.floats(-1.3, 1.3))
def test_toes_go_up_and_a_heading_goes_left(angle):
    ahead = (0.0, 0.0, 1.0)
    up = one_rotation.rotate(one_rotation.toes_up(angle), ahead)
    np.testing.assert_allclose(up, (0.0, np.sin(angle), np.cos(angle)), atol=1e-14)
    left = one_rotation.rotate(one_rotation.heading(angle), ahead)
    np.testing.assert_allclose(left, (np.sin(angle), 0.0, np.cos(angle)), atol=1e-14)

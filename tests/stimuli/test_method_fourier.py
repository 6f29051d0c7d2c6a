"""Fourier walks after Tilmanne & Dutoit: equations 1 to 6, 271 numbers, and the exponential map's continuity."""

from dataclasses import replace

import numpy as np
import pytest

from stimuli.actors import load_actor
from stimuli.methods.actor_walks import actor_walks
from stimuli.methods.delivery import joint_rmse
from stimuli.methods.fourier import (
    EIGHTEEN,
    between,
    exponential_signals,
    fourier_to_speed,
    fourier_walk,
    signals_at,
    synthesised,
    unwrapped,
    variance_kept,
)
from stimuli.methods.making import MethodError
from stimuli.rotations import angle_between, from_exponential, to_exponential


@pytest.fixture(scope="module")
def walks():
    return actor_walks(load_actor("F2"), (0.8, 1.06, 1.3))


@pytest.fixture(scope="module")
def two_harmonics(walks):
    """A synthetic walk that has two harmonics and nothing else; amplitudes and phases drawn at random."""
    random = np.random.default_rng(1)
    walk = walks[1]
    angle = 2 * np.pi * np.arange(128) / 128
    shape = (len(walk.joints), 3)
    signals = random.normal(0, 0.3, shape) + sum(
        random.uniform(0.05, 0.3, shape) * np.cos(order * angle[:, None, None] + random.uniform(-3, 3, shape))
        for order in (1, 2)
    )
    return replace(walk, rotations=from_exponential(signals))


def test_a_walk_is_271_numbers(walks):
    """54 signals x 5 + f0."""
    walk = fourier_walk(walks[1])
    assert len(EIGHTEEN) == len(walk.joints) == 18
    assert walk.numbers.shape == (271,)


def test_equation_1_of_equations_2_to_6_is_exact_to_1e_9_for_a_walk_of_two_harmonics(two_harmonics):
    walk = fourier_walk(two_harmonics)
    signals = exponential_signals(two_harmonics, walk.joints)
    assert np.abs(signals_at(walk, two_harmonics.phases) - signals).max() < 1e-9
    again = fourier_walk(synthesised(walk))
    assert np.abs(again.numbers - walk.numbers).max() < 1e-9
    assert all(share == pytest.approx(1.0) for share in variance_kept(walk).values())


def test_f0_is_one_over_twice_the_step_duration(walks):
    walk = fourier_walk(walks[1])
    assert walk.frequency == pytest.approx(walks[1].gait.step_frequency / 60 / 2)


def test_a_walk_of_any_length_repeats_every_cycle(walks):
    walk = fourier_walk(walks[1])
    times = np.linspace(0, 7, 500)
    np.testing.assert_allclose(signals_at(walk, times), signals_at(walk, times + 3), atol=1e-12)


def test_higher_orders_come_nearer_to_the_capture(walks):
    errors = [joint_rmse(synthesised(fourier_walk(walks[1], order)), walks[1], EIGHTEEN) for order in (1, 2, 4, 8)]
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 1.5


def test_variance_kept_is_given_for_every_joint(walks):
    kept = variance_kept(fourier_walk(walks[1]))
    assert set(kept) == set(EIGHTEEN)
    assert all(0.5 < share <= 1.0 for share in kept.values())


def test_a_joint_that_turns_past_half_a_turn_does_not_jump():
    angles = np.linspace(2.5, 5.0, 60)
    axis = np.array([0.6, 0.0, 0.8])
    rotations = from_exponential(angles[:, None] * axis)
    jumping = to_exponential(rotations)
    assert np.abs(np.diff(jumping, axis=0)).max() > 1.0
    smooth = unwrapped(jumping)
    np.testing.assert_allclose(smooth, angles[:, None] * axis, atol=1e-9)
    assert angle_between(from_exponential(smooth), rotations).max() < 1e-7


def test_styles_interpolate_and_extrapolate_and_meet_their_ends(walks):
    first, second = fourier_walk(walks[0]), fourier_walk(walks[2])
    np.testing.assert_allclose(between(first, second, 0.0).complex, first.complex, atol=1e-12)
    np.testing.assert_allclose(between(first, second, 1.0).mean, second.mean, atol=1e-12)
    beyond = between(first, second, 1.5)
    assert beyond.frequency == pytest.approx(first.frequency + 1.5 * (second.frequency - first.frequency))
    assert np.isfinite(synthesised(beyond).rotations).all()


def test_phases_of_359_and_1_degrees_meet_at_0(walks):
    walk = fourier_walk(walks[0])
    early = replace(walk, phase=np.full_like(walk.phase, np.radians(-1)))
    late = replace(walk, phase=np.full_like(walk.phase, np.radians(1)))
    assert np.abs(between(early, late, 0.5).phase[walk.amplitude > 1e-9]).max() < 1e-9


def test_a_fourier_walk_goes_at_the_speed_asked_for(walks):
    made = fourier_to_speed(walks[0], walks[2], 1.06)
    assert made.gait.speed == pytest.approx(1.06)
    assert made.provenance.format == "fourier"


def test_bad_input_is_a_sentence(walks):
    with pytest.raises(MethodError, match="harmonics"):
        fourier_walk(walks[0], harmonics=64)
    with pytest.raises(MethodError, match="different skeletons"):
        between(fourier_walk(walks[0]), fourier_walk(walks[1], joints=EIGHTEEN[:10]), 0.5)
    with pytest.raises(MethodError, match="one walk has 2"):
        between(fourier_walk(walks[0]), fourier_walk(walks[1], harmonics=3), 0.5)
    with pytest.raises(MethodError, match="captures at two speeds"):
        fourier_to_speed(walks[0], walks[0], 1.0)

"""A walk of the model on a body: captured angles kept, feet on the ground, legs within reach."""

import numpy as np
import pytest

from stimuli.bodies.known import load_body
from stimuli.gait_model import Step, WalkCurves, curves, load_gait_model
from stimuli.legs.contact import STANCE_END
from stimuli.legs.foot_paths import PHASES
from stimuli.retarget import Figure, scaled, walk_cycle


@pytest.fixture(params=["woman", "man"])
def figure(request):
    return Figure(load_body(request.param).skeleton)


def made(figure, speed, step_frequency):
    model = load_gait_model()
    step = Step.of(speed, step_frequency, figure.leg_length)
    coefficients = model.coefficients(step)
    return coefficients, walk_cycle(
        figure, WalkCurves.symmetric(coefficients, model.stance_share(step)), speed, step_frequency
    )


def test_the_standing_foot_has_no_clearance_and_no_travel_of_its_own(figure):
    _, cycle = made(figure, 1.1, 105.0)
    standing = PHASES < STANCE_END
    assert np.abs(cycle.feet[:, standing, 1]).max() == 0.0
    assert np.abs(cycle.feet[:, standing, 2]).max() < 1e-12
    assert cycle.feet[:, ~standing, 1].min() >= 0.0
    assert cycle.feet[:, :, 1].max() > 0.01


def test_the_chest_turns_in_the_world_as_the_model_says(figure):
    from stimuli.rotations import from_exponential, multiply

    coefficients, cycle = made(figure, 1.1, 105.0)
    curve = curves(coefficients, PHASES)
    wanted = from_exponential(np.stack([curve[f"chest_{axis}"] for axis in "xyz"], axis=1))
    chest = multiply(multiply(cycle.rotations[:, 0], cycle.rotations[:, 1]), cycle.rotations[:, 2])
    np.testing.assert_allclose(np.abs(np.sum(chest * wanted, axis=1)), 1.0, atol=1e-9)


def test_a_person_twice_as_large_walks_alike_at_the_same_dimensionless_step(figure):
    large = Figure(scaled(figure.skeleton, 2.0))
    _, small_walk = made(figure, 1.1, 105.0)
    _, large_walk = made(large, 1.1 * np.sqrt(2), 105.0 / np.sqrt(2))
    np.testing.assert_allclose(large_walk.rotations, small_walk.rotations, atol=1e-9)
    np.testing.assert_allclose(large_walk.hips[:, 1], 2 * small_walk.hips[:, 1], rtol=0.01)


def test_the_hips_ride_below_straight_legs_and_above_bent_ones(figure):
    _, cycle = made(figure, 1.1, 105.0)
    standing = figure.skeleton.positions[0, 1]
    assert cycle.hips[:, 1].max() < standing + 0.02
    assert cycle.hips[:, 1].min() > 0.9 * standing

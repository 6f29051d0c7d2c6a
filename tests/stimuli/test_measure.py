"""What is asked is what is drawn: speed, step frequency and standing feet, measured on the drawn skeleton."""

import numpy as np
import pytest

from stimuli.actors import actor_names, load_actor
from stimuli.measure import delivered_gait


@pytest.mark.parametrize("name", actor_names())
def test_what_is_asked_is_what_is_drawn(name):
    actor = load_actor(name)
    for speed in (0.8, 0.95, 1.2, actor.comfort_speed):
        for step_frequency in (80.0, 93.0, 105.0, 120.0):
            gait = delivered_gait(actor, speed, step_frequency, samples=120)
            assert gait.speed == pytest.approx(speed, rel=1e-3)
            assert gait.step_frequency == pytest.approx(step_frequency, rel=1e-3)
            assert gait.walk_ratio == pytest.approx(60 * speed / step_frequency**2, rel=2e-3)
            assert gait.slide_mean <= 5.0
            assert gait.slide_peak <= 10.0
            assert gait.sole_lowest >= -3.0
            assert gait.knee_least > 0.5


def test_the_measure_sees_a_wrong_speed():
    """A walker drawn for 1.0 m/s slides when it is carried at 1.1 m/s: drawn steps stay those of 1.0 m/s."""
    from stimuli.kinematics import world_matrices
    from stimuli.measure import _drifts, poses, sole_points

    actor = load_actor("M1")
    phases = np.arange(120) / 120
    world = world_matrices(actor.skeleton, poses(actor, 1.0, 100, phases))
    soles = sole_points(actor.skeleton, actor.figure.sole, world)
    assert _drifts(soles[:, 1], 1.1, phases * 1.2, 1.2).max() > 0.02

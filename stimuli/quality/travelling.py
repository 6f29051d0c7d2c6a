"""The walker's joints in the world over time, as drawn and travelling along +Z. Knows no file."""

from __future__ import annotations

import numpy as np

from stimuli.actors import Actor
from stimuli.kinematics import world_joints
from stimuli.measure import poses
from stimuli.skeleton import Floats


def travelling_joints(
    actor: Actor, speed: float, step_frequency: float, seconds: float, rate: float
) -> tuple[Floats, Floats]:
    """Times (T,) s and joint positions (T, 21, 3) m, Y up, X left, from a right heel strike at time 0.

    speed m/s; step_frequency steps/min; rate Hz. Raises CoverageError.
    """
    times = np.arange(round(seconds * rate)) / rate
    positions = world_joints(actor.skeleton, poses(actor, speed, step_frequency, times * step_frequency / 120.0))
    positions[..., 2] += (speed * times)[:, None]
    return times, positions

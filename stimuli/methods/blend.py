"""Blending two captures to a target speed (Niay 2022, section 5.3): weights from the speeds of the two nearest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stimuli.cycle import Cycle
from stimuli.methods.making import MethodError, check_same_skeleton, made_by, resampled
from stimuli.rotations import continuous, normalise
from stimuli.skeleton import Floats


def nearest_two(cycles: Sequence[Cycle], speed: float) -> tuple[Cycle, Cycle, float]:
    """The captures just below and above a speed (m/s), and the weight of the second, in [0, 1].

    Raises MethodError when the speed is not between two captures.
    """
    ordered = sorted(cycles, key=lambda cycle: cycle.gait.speed)
    if len(ordered) < 2:
        raise MethodError(f"blending needs captures at two speeds; there is {len(ordered)}")
    speeds = [cycle.gait.speed for cycle in ordered]
    if not speeds[0] - 1e-9 <= speed <= speeds[-1] + 1e-9:
        raise MethodError(
            f"{speed:.2f} m/s is outside the captures, {speeds[0]:.2f} to {speeds[-1]:.2f} m/s; blending does not "
            f"extrapolate"
        )
    above = min(max(int(np.searchsorted(speeds, speed)), 1), len(ordered) - 1)
    low, high = ordered[above - 1], ordered[above]
    span = high.gait.speed - low.gait.speed
    share = 0.0 if span < 1e-9 else (speed - low.gait.speed) / span
    return low, high, min(max(share, 0.0), 1.0)


def blend_to_speed(cycles: Sequence[Cycle], speed: float) -> Cycle:
    """The two nearest captures blended so that the walk has `speed` (m/s); phase with phase, feet with feet.

    Rotations by normalised linear blending, hips and stride length linearly; the stride time gives the speed.
    """
    low, high, share = nearest_two(cycles, speed)
    check_same_skeleton((low, high))
    samples = max(len(low.hips), len(high.hips))
    first, second = resampled(low, samples), resampled(high, samples)
    length = (1 - share) * low.stride_length + share * high.stride_length
    stance = [(1 - share) * a + share * b for a, b in zip(low.stance_share, high.stance_share, strict=True)]
    return replace(
        low,
        rotations=continuous(mixed(first.rotations, second.rotations, share)),
        hips=(1 - share) * first.hips + share * second.hips,
        stride_length=length,
        stride_time=length / speed,
        stance_share=(stance[0], stance[1]),
        provenance=made_by("blend", f"{100 * share:.0f} % of the second, to {speed:.2f} m/s", low, high),
    )


def mixed(first: Floats, second: Floats, share: float) -> Floats:
    """(..., 4) rotations between two by normalised linear blending, on the shorter way."""
    opposite = np.sum(first * second, axis=-1, keepdims=True) < 0
    return normalise((1 - share) * first + share * np.where(opposite, -second, second))

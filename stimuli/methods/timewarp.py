"""Time warping: the same motion played slower or faster (Niay 2022, section 5.3, equations 5.4 to 5.6)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stimuli.cycle import Cycle
from stimuli.methods.making import check_speed, hips_at, made_by, rotations_at

FRAME_RATE = 120.0
"""Hz of the captures of Niay (2022)."""


def frame_count(distance: float, frame_rate: float, speed: float) -> int:
    """N = d f / v (from equation 5.6), whole frames: d m of travel in one cycle, f Hz, v m/s."""
    return max(round(distance * frame_rate / speed), 2)


def timewarp(cycle: Cycle, speed: float, frame_rate: float = FRAME_RATE) -> Cycle:
    """The cycle in N = d f / v frames, slerp between its own, so that it travels at `speed` (m/s).

    Only the duration changes: stride length and every posture stay. N is a whole number, as in the source, so the
    delivered speed is d f / N, within v / (2 N) of the wanted one. Raises MethodError for a speed that is no walk.
    """
    check_speed(speed)
    frames = frame_count(cycle.stride_length, frame_rate, speed)
    phases = np.arange(frames) / frames
    return replace(
        cycle,
        rotations=rotations_at(cycle, phases),
        hips=hips_at(cycle, phases),
        stride_time=frames / frame_rate,
        provenance=made_by("timewarp", f"warped to {speed:.2f} m/s in {frames} frames", cycle),
    )

"""How the feet of a captured cycle behave before anything is done about them, on the captured skeleton itself.

A cycle taken out of a capture slides a little: its loop was closed, smoothed and straightened, and soles are not
captured. Drawn walkers do not: their feet are placed by the contact machinery (measure.delivered_gait). Here is the
measure of what was taken away.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stimuli.cycle import Cycle, cycle_positions
from stimuli.skeleton import Floats

FLAT = (0.12, 0.35)
"""Share of the cycle after the heel strike in which both ends of a foot stand still (foot flat to heel rise)."""


@dataclass(frozen=True)
class CycleContact:
    """slides: mm, drift of the ankle while the foot is flat, largest and mean over both feet; over the ground.
    sinking: mm, change of height of the ankle meanwhile, largest. knee_least: deg, least flexion of either knee.
    bones: largest relative change of a leg bone's length over the cycle."""

    slide_mean: float
    slide_peak: float
    sinking: float
    knee_least: float
    bones: float


def cycle_contact(cycle: Cycle) -> CycleContact:
    """Measured on the cycle's own skeleton, walking at its own speed. Needs both ankles."""
    positions = cycle_positions(cycle)
    speed = cycle.stride_length / cycle.stride_time
    slides, sinkings, knees, bones = [], [], [], []
    for side, shift in (("right", 0.0), ("left", cycle.left_strike)):
        hip, knee, ankle = (
            positions[:, cycle.joints.index(f"{side}{part}")] for part in ("UpperLeg", "LowerLeg", "Foot")
        )
        phase = (cycle.phases - shift) % 1.0
        order = np.argsort(phase)
        order = order[(phase[order] >= FLAT[0]) & (phase[order] <= FLAT[1])]
        standing = ankle[order] + np.outer(phase[order], [0.0, 0.0, speed * cycle.stride_time])
        slides.append(float(np.linalg.norm(standing[-1, [0, 2]] - standing[0, [0, 2]])))
        sinkings.append(float(np.ptp(standing[:, 1])))
        thigh, shank = knee - hip, ankle - knee
        knees.append(float(np.min(_angle(thigh, shank))))
        for bone in (thigh, shank):
            length = np.linalg.norm(bone, axis=1)
            bones.append(float(np.ptp(length) / length.mean()))
    return CycleContact(
        slide_mean=1e3 * float(np.mean(slides)),
        slide_peak=1e3 * max(slides),
        sinking=1e3 * max(sinkings),
        knee_least=min(knees),
        bones=max(bones),
    )


def _angle(thigh: Floats, shank: Floats) -> Floats:
    """(T,) deg between two bones; 0 is a straight knee."""
    cosine = np.sum(thigh * shank, axis=1) / np.linalg.norm(thigh, axis=1) / np.linalg.norm(shank, axis=1)
    return np.asarray(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))

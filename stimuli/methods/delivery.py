"""What a made cycle really does: measured on its joints alone, so that captures and all methods are measured alike.

Stance is found as the foot's way back under the hips (Zeni, Richards & Higginson, Gait & Posture 27, 2008): from the
foremost to the hindmost place of the foot. Knows no method.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stimuli.cycle import Cycle, cycle_pose
from stimuli.methods.making import MethodError, resampled
from stimuli.rotations import angle_between, rotate
from stimuli.skeleton import Floats

SAMPLES = 256
INNER = (0.15, 0.85)
"""Part of stance in which a foot should stand still; the rest is loading and push-off, where it rolls over its ends."""

LEGS = tuple(f"{side}{part}" for side in ("left", "right") for part in ("UpperLeg", "LowerLeg", "Foot"))


@dataclass(frozen=True)
class Delivered:
    """How a cycle walks.

    speed:          m/s, with which its standing feet go back under it; the walk slides if it is moved at another
    nominal_speed:  m/s, stride length over stride time
    step_frequency: steps/min
    slide:          mm a foot drifts over the ground in the inner 70 % of stance, mean of both, moved at nominal speed
    slide_peak:     mm, the same of the foot that drifts more
    knee_least:     deg, least flexion of either knee (negative is overstretched)
    double_support: share of the cycle with both feet in stance
    """

    speed: float
    nominal_speed: float
    step_frequency: float
    slide: float
    slide_peak: float
    knee_least: float
    double_support: float


def delivered(cycle: Cycle) -> Delivered:
    """Measures one cycle. Raises MethodError where it has no feet."""
    fine = resampled(cycle, SAMPLES)
    world, positions = cycle_pose(fine)
    step = cycle.stride_time / SAMPLES
    nominal = cycle.stride_length / cycle.stride_time
    backs, slides, standing, knees = [], [], [], []
    for side in ("left", "right"):
        points = foot_points(fine, world, positions, side)
        first, count = stance(points)
        standing.append(np.isin(np.arange(SAMPLES), (first + np.arange(count)) % SAMPLES))
        inner = (first + np.arange(round(INNER[0] * count), round(INNER[1] * count))) % SAMPLES
        moved = _pivot_steps(points, inner)
        backs.append(-float(np.mean(moved[:, 2])) / step if np.isfinite(step) else 0.0)
        ground = nominal * step if np.isfinite(step) else 0.0
        slides.append(float(np.abs(np.sum(np.hypot(moved[:, 0], moved[:, 2] + ground)))))
        knees.append(float(knee_flexion(fine, positions, side).min()))
    return Delivered(
        speed=float(np.mean(backs)),
        nominal_speed=nominal,
        step_frequency=120.0 / cycle.stride_time,
        slide=1e3 * float(np.mean(slides)),
        slide_peak=1e3 * float(np.max(slides)),
        knee_least=float(np.degrees(min(knees))),
        double_support=float(np.mean(standing[0] & standing[1])),
    )


def joint_rmse(made: Cycle, captured: Cycle, joints: tuple[str, ...] = LEGS) -> float:
    """deg: root mean square over phases and joints of the angle between the local rotations of two cycles."""
    chosen = [joint for joint in joints if joint in made.joints and joint in captured.joints]
    if not chosen:
        raise MethodError(f"{made.provenance.clip} and {captured.provenance.clip} share none of {', '.join(joints)}")
    a, b = resampled(made, SAMPLES).rotations, resampled(captured, SAMPLES).rotations
    angles = angle_between(
        a[:, [made.joints.index(joint) for joint in chosen]], b[:, [captured.joints.index(joint) for joint in chosen]]
    )
    return float(np.degrees(np.sqrt(np.mean(angles**2))))


def foot_points(cycle: Cycle, world: Floats, positions: Floats, side: str) -> Floats:
    """(N, 2, 3) m: heel and ball of a foot. The heel is as far behind the ankle as in contact.Sole, at sole height.

    A capture without toe joint has its ankle for both.
    """
    if f"{side}Foot" not in cycle.joints:
        raise MethodError(f"{cycle.provenance.clip} has no {side}Foot, so its feet cannot be measured")
    ankle = cycle.joints.index(f"{side}Foot")
    if f"{side}Toes" not in cycle.joints:
        return np.stack([positions[:, ankle]] * 2, axis=1)
    toes = cycle.joints.index(f"{side}Toes")
    offset = cycle.offsets[toes]
    heel = rotate(world[:, ankle], offset * np.array([-0.47, 1.0, -0.47]))
    return np.stack([positions[:, ankle] + heel, positions[:, toes]], axis=1)


def stance(points: Floats) -> tuple[int, int]:
    """First sample of stance and number of its samples, from foot points (N, 2, 3) of the walker on the spot."""
    count = len(points)
    strike = int(np.argmax(points[:, 0, 2]))
    off = int(np.argmin(points[:, 1, 2]))
    return strike, max((off - strike) % count, 2)


def knee_flexion(cycle: Cycle, positions: Floats, side: str) -> Floats:
    """(N,) rad: angle of the shank behind the thigh in the sagittal plane, negative when overstretched."""
    hip, knee, ankle = (positions[:, cycle.joints.index(f"{side}{part}")] for part in ("UpperLeg", "LowerLeg", "Foot"))
    thigh, shank = knee - hip, ankle - knee
    return np.asarray(np.arctan2(thigh[:, 2], -thigh[:, 1]) - np.arctan2(shank[:, 2], -shank[:, 1]))


def _pivot_steps(points: Floats, samples: np.ndarray) -> Floats:
    """(M, 3) m that the lower of heel and ball moves from each of these samples to the next."""
    lower = np.argmin(points[samples, :, 1], axis=1)
    return np.asarray(points[(samples + 1) % len(points), lower] - points[samples, lower])

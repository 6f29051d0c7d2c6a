"""What a drawn walker really does: speed, step frequency, slide and sole height, measured on the drawn skeleton.

Nothing here looks at the blend tree or the footprints the walker was drawn from: only at joint positions and
rotations over one cycle, as a camera would. Knows the walker's public functions only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stimuli.actors import Actor
from stimuli.kinematics import world_matrices
from stimuli.legs.contact import Sole
from stimuli.skeleton import JOINTS, Floats, Pose, Skeleton
from stimuli.walker import drawn_pose

TOUCHING = 0.002
"""m: a point of the sole this low is on the ground."""

STRIKE = 0.0001
"""m: a foot lower than this has struck."""


@dataclass(frozen=True)
class DeliveredGait:
    """How an actor walks as drawn.

    slide_mean, slide_peak: mm, how far a touching point of the sole drifts over the ground while it touches, mean and
                            largest over the stances of both feet
    sole_lowest:            mm, lowest point of either sole over the cycle (negative is below the ground)
    sole_stance:            mm, largest distance of the lowest point from the ground in stance
    knee_least:             deg, least flexion of either knee (0 straight, negative overstretched)
    step_length_left, step_length_right: m, of the steps that end with the left and the right heel strike
    left_strike:            phase of the left heel strike, counted from the right one; 0.5 where steps last alike
    """

    speed: float  # m/s
    step_frequency: float  # steps/min
    step_length: float  # m
    slide_mean: float
    slide_peak: float
    sole_lowest: float
    sole_stance: float
    knee_least: float
    step_length_left: float
    step_length_right: float
    left_strike: float

    @property
    def walk_ratio(self) -> float:
        """Step length over step frequency (m·min), as in Sekiya et al. 1996."""
        return self.step_length / self.step_frequency


def delivered_gait(actor: Actor, speed: float, step_frequency: float, samples: int = 240) -> DeliveredGait:
    """Draws one cycle at the wanted speed (m/s) and step frequency (steps/min) and measures it."""
    period = 120.0 / step_frequency
    times = np.arange(samples) / samples * period
    pose = poses(actor, speed, step_frequency, times / period)
    world = world_matrices(actor.skeleton, pose)
    soles = sole_points(actor.skeleton, actor.figure.sole, world)  # (T, 2, 3, 3)
    lowest = soles[..., 1].min(axis=2)
    strikes = [_strike(lowest[:, side], times, period) for side in (0, 1)]
    first, second = (strikes[0] - strikes[1]) % period, (strikes[1] - strikes[0]) % period
    frequency = 60.0 / (0.5 * (first + second))
    left, right = (_step_length(soles, lowest, times, strikes[side], side, actor.figure.sole) for side in (0, 1))
    length = 0.5 * (left + right)
    drifts = np.concatenate([_drifts(soles[:, side], speed, times, period) for side in (0, 1)])
    on_ground = lowest < TOUCHING
    knees = [_knee(world[..., :3, 3], side) for side in ("left", "right")]
    return DeliveredGait(
        speed=length * frequency / 60.0,
        step_frequency=frequency,
        step_length=length,
        slide_mean=float(np.mean(drifts)) * 1e3,
        slide_peak=float(np.max(drifts)) * 1e3,
        sole_lowest=float(lowest.min()) * 1e3,
        sole_stance=float(np.abs(lowest[on_ground]).max()) * 1e3,
        knee_least=float(np.min(knees)),
        step_length_left=left,
        step_length_right=right,
        left_strike=first / period,
    )


def poses(actor: Actor, speed: float, step_frequency: float, phases: Floats) -> Pose:
    """Poses at several phases (T,), as one Pose of arrays (T, 3) and (T, 21, 4)."""
    drawn = [drawn_pose(actor, speed, step_frequency, float(phase)) for phase in phases]
    return Pose(np.array([pose.hips for pose in drawn]), np.array([pose.rotations for pose in drawn]))


def sole_points(skeleton: Skeleton, sole: Sole, world: Floats) -> Floats:
    """(T, 2, 3, 3) m: heel, ball and tip of the left and the right sole, from world matrices (T, 21, 4, 4)."""
    points = np.empty((len(world), 2, 3, 3))
    for index, side in enumerate(("left", "right")):
        foot, toes = world[:, JOINTS.index(f"{side}Foot")], world[:, JOINTS.index(f"{side}Toes")]
        points[:, index, 0] = (foot @ [0.0, -sole.ankle_height, -sole.heel, 1.0])[:, :3]
        aside = skeleton.offsets[JOINTS.index(f"{side}Toes"), 0]
        points[:, index, 1] = (toes @ [-aside, -sole.ball_height, 0.0, 1.0])[:, :3]
        points[:, index, 2] = (toes @ [-aside, -sole.ball_height, sole.tip - sole.ball, 1.0])[:, :3]
    return points


def _strike(lowest: Floats, times: Floats, period: float) -> float:
    """Time (s) at which the foot's lowest point (T,) comes down to the ground, between two samples if need be."""
    before = np.roll(lowest, 1)
    falls = np.flatnonzero((before >= STRIKE) & (lowest < STRIKE))
    if len(falls) != 1:
        raise ValueError(f"the foot strikes {len(falls)} times in one cycle")
    frame = int(falls[0])
    share = (before[frame] - STRIKE) / (before[frame] - lowest[frame])
    return float((times[frame] - (1.0 - share) * times[1]) % period)


def _step_length(soles: Floats, lowest: Floats, times: Floats, strike: float, side: int, sole: Sole) -> float:
    """m: the striking foot's heel ahead of where the standing foot's heel stood, both on the ground just after.

    Where the standing foot has left its heel, its toes tell where that was, or all of a foot without any that bend.
    """
    frame = int(np.ceil(strike / times[1] + 0.02 * len(times))) % len(times)
    standing = soles[frame, 1 - side]
    if lowest[frame, 1 - side] > TOUCHING:
        raise ValueError("one foot leaves the ground before the other strikes")
    heel = standing[0]
    if heel[1] > TOUCHING:
        along = (standing[2] - standing[1 if sole.tip > sole.ball else 0]) * (1.0, 0.0, 1.0)
        heel = standing[2] - (sole.tip + sole.heel) * along / np.linalg.norm(along)
    return float(soles[frame, side, 0, 2] - heel[2])


def _drifts(soles: Floats, speed: float, times: Floats, period: float) -> Floats:
    """(3,) m: path of heel, ball and tip over the ground while each touches it in stance."""
    drifts = []
    standing = soles[..., 1].min(axis=1) < STRIKE
    for point in range(3):
        touching = standing & (soles[:, point, 1] < TOUCHING)
        both = touching & np.roll(touching, -1)
        ahead = np.roll(soles[:, point], -1, axis=0) - soles[:, point]
        over_ground = np.hypot(ahead[:, 0], ahead[:, 2] + speed * times[1])
        drifts.append(float(np.sum(over_ground[both])))
    return np.array(drifts)


def _knee(positions: Floats, side: str) -> float:
    """deg: least knee flexion over the cycle, from positions (T, 21, 3)."""
    hip, knee, ankle = (positions[:, JOINTS.index(f"{side}{part}")] for part in ("UpperLeg", "LowerLeg", "Foot"))
    thigh, shank = knee - hip, ankle - knee
    cosine = np.sum(thigh * shank, axis=1) / np.linalg.norm(thigh, axis=1) / np.linalg.norm(shank, axis=1)
    return float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)).min()))

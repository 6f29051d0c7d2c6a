"""The standing pose a clip's rotations are counted from, facing +Z.

Most captures stand when every rotation is zero; where they do not (Bandai Namco's bones all lie along X) the mean
posture of the walk is taken instead, its feet from stance only. Knows one clip; no character.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stimuli.clip import Clip, world_pose
from stimuli.rotations import about_axis, from_matrix, multiply, rotate, to_matrix, yaw

Floats = NDArray[np.floating]

UP = np.array([0.0, 1.0, 0.0])
FORWARD = np.array([0.0, 0.0, 1.0])
SLOWEST = 0.15  # share of frames, those in which a foot moves least: it stands


@dataclass(frozen=True, eq=False)
class RestPose:
    """One standing pose of a clip's skeleton, facing +Z.

    rotations: (J, 4) world; positions: (J, 3) m, world; standing_zero: True when it is the zero-rotation pose
    """

    rotations: Floats
    positions: Floats
    standing_zero: bool


def rest_pose(clip: Clip) -> RestPose:
    """The zero pose if it stands, else the walk's mean posture; either turned about Y to face +Z."""
    zero = np.tile([0.0, 0.0, 0.0, 1.0], (len(clip.joints), 1))
    positions = _positions(clip, zero)
    if stands(clip, positions):
        return _facing_forward(clip, zero, positions, True)
    rotations = _mean_posture(clip)
    return _facing_forward(clip, rotations, _positions(clip, rotations), False)


def stands(clip: Clip, positions: Floats) -> bool:
    """Whether positions (J, 3) are a person standing: trunk up, legs down, toes in front."""
    tests: list[bool] = []
    trunk = _direction(clip, positions, "hips", "neck" if "neck" in clip.roles else "head")
    tests.append(trunk is None or float(trunk @ UP) > 0.9)
    for side in ("left", "right"):
        thigh = _direction(clip, positions, side + "UpperLeg", side + "LowerLeg")
        shank = _direction(clip, positions, side + "LowerLeg", side + "Foot")
        tests.append(thigh is not None and float(thigh @ UP) < -0.8)
        tests.append(shank is not None and float(shank @ UP) < -0.7)
        toes = _direction(clip, positions, side + "Foot", side + "Toes")
        tests.append(toes is None or float(np.hypot(toes[0], toes[2])) > 0.3)
    return all(tests)


def _direction(clip: Clip, positions: Floats, start: str, end: str) -> Floats | None:
    if start not in clip.roles or end not in clip.roles:
        return None
    vector = positions[clip.roles[end]] - positions[clip.roles[start]]
    length = np.linalg.norm(vector)
    return vector / length if length > 0 else None


def _positions(clip: Clip, world: Floats) -> Floats:
    """(J, 3) m of the skeleton with its offsets and these world rotations (J, 4), its root at the origin."""
    positions = np.zeros((len(clip.joints), 3))
    for joint, parent in enumerate(clip.parents):
        if parent >= 0:
            positions[joint] = positions[parent] + rotate(world[parent], clip.offsets[joint])
    return positions


def _mean_posture(clip: Clip) -> Floats:
    """(J, 4): chordal mean of the world rotations with each frame's heading taken off (Hartley et al. 2013)."""
    world, positions = world_pose(clip)
    left = positions[:, clip.roles["leftUpperLeg"]] - positions[:, clip.roles["rightUpperLeg"]]
    heading = np.arctan2(-left[:, 2], left[:, 0])
    turned = multiply(about_axis(UP, -heading)[:, None], world)
    mean = _chordal_mean(turned)
    for side in ("left", "right"):
        foot = clip.roles[side + "Foot"]
        speed = np.linalg.norm(np.gradient(positions[:, foot], axis=0), axis=1) if clip.frame_count > 1 else np.zeros(1)
        still = speed <= np.quantile(speed, SLOWEST)
        for joint in (foot, *_below(clip, foot)):
            mean[joint] = _chordal_mean(turned[still, joint])
    return mean


def _chordal_mean(rotations: Floats) -> Floats:
    """Mean over the first axis of (T, ..., 4): the rotation nearest to the mean matrix."""
    u, _, v = np.linalg.svd(np.mean(to_matrix(rotations), axis=0))
    sign = np.sign(np.linalg.det(u @ v))
    u[..., :, 2] *= sign[..., None] if np.ndim(sign) else sign
    return from_matrix(u @ v)


def _below(clip: Clip, joint: int) -> list[int]:
    found = [joint]
    for index, parent in enumerate(clip.parents):
        if parent in found:
            found.append(index)
    return found[1:]


def _facing_forward(clip: Clip, rotations: Floats, positions: Floats, standing_zero: bool) -> RestPose:
    left = positions[clip.roles["leftUpperLeg"]] - positions[clip.roles["rightUpperLeg"]]
    turn = about_axis(UP, -np.arctan2(-left[2], left[0]))
    if abs(float(yaw(turn))) < 1e-9:
        return RestPose(rotations, positions, standing_zero)
    return RestPose(multiply(turn, rotations), rotate(turn, positions), standing_zero)

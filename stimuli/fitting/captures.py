"""CMU walks as Fourier coefficients: strides found, put in the walker's frame, made symmetric and averaged.

Knows clips and the model's list of signals; knows nothing of regression.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.signal import butter, filtfilt, find_peaks

from stimuli.clip import Clip, world_pose
from stimuli.gait_model import HARMONICS, MIDLINE, MIRROR_SIGN, MODEL_ARM, SIGNALS, basis
from stimuli.motion_files.bvh import read_bvh
from stimuli.rotations import about_axis, inverse, multiply, rotate, shortest_arc, to_exponential
from stimuli.skeleton import Floats

SAMPLES = 128
"""Phases per stride before the Fourier analysis."""

SIDES = ("left", "right")


@dataclass(frozen=True, eq=False)
class Walk:
    """One captured walk, averaged over its strides and made symmetric.

    coefficients: (S, C), nan for signals that the source does not hold
    """

    name: str
    person: str
    laboratory: str
    sex: float  # +0.5 woman, -0.5 man, 0 unknown
    leg_length: float  # m
    speed: float  # m/s
    step_frequency: float  # steps/min
    stance_share: float  # nan where not measured
    coefficients: Floats


def read_walks(folder: Path) -> list[Walk]:
    """Every CMU walk of a folder of BVH files named cmu_<subject>_<trial>.bvh, in order of name."""
    return [capture(read_bvh(path)) for path in sorted(folder.glob("cmu_*.bvh"))]


def capture(clip: Clip) -> Walk:
    """The average symmetric stride of one clip."""
    signals, forward, ankles, leg = _in_walker_frame(clip)
    strikes = {side: _strikes(ankles[side], clip.rate) for side in SIDES}
    strides = [pair for side in SIDES for pair in pairwise(strikes[side])]
    if not strides:
        raise ValueError(f"{clip.name}: no whole stride was found")
    periods = [(last - first) / clip.rate for first, last in strides]
    speeds = [(forward[last] - forward[first]) / (last - first) * clip.rate for first, last in strides]
    return Walk(
        name=clip.name,
        person="CMU-" + clip.name.split("_")[1],
        laboratory="CMU",
        sex=0.0,
        leg_length=leg,
        speed=float(np.mean(speeds)),
        step_frequency=120.0 / float(np.mean(periods)),
        stance_share=float("nan"),
        coefficients=average_stride(signals, strikes["right"], strikes["left"], leg),
    )


def average_stride(signals: dict[str, Floats], right: Sequence[int], left: Sequence[int], leg_length: float) -> Floats:
    """(S, C) coefficients of the mean of all strides, those begun by the left foot mirrored.

    signals: per frame; midline ones under their segment's name (T, 3), sided ones as "left..." and "right...";
             hips_shift and ...foot_shift are places to the left in m, in any frame that travels straight
    right, left: frames of the foot strikes
    """
    sides = []
    for strikes, mirrored in ((right, False), (left, True)):
        strides = [_stride(signals, first, last, mirrored, leg_length) for first, last in pairwise(strikes)]
        if strides:
            sides.append(np.mean(strides, axis=0))
    return symmetric(fourier(np.mean(sides, axis=0)))


def fourier(cycle: Floats) -> Floats:
    """(N, S) periodic samples -> (S, C) coefficients by least squares; nan where a signal is not there."""
    design = basis(np.arange(len(cycle)) / len(cycle))
    return np.asarray((np.linalg.pinv(design) @ cycle).T)


def symmetric(coefficients: Floats) -> Floats:
    """Coefficients (S, C) of a walk whose left half is the right half's mirror image.

    A midline signal that reflection leaves alone repeats every step, so it has even harmonics only; one that
    reflection turns round has odd ones only.
    """
    result = np.array(coefficients)
    for index in range(len(MIDLINE)):
        for harmonic in range(HARMONICS + 1):
            kept = (harmonic % 2 == 0) == (MIRROR_SIGN[index] > 0)
            if not kept:
                result[index, 0 if harmonic == 0 else slice(2 * harmonic - 1, 2 * harmonic + 1)] = 0.0
    return result


def close_cycle(samples: Floats) -> Floats:
    """(N + 1, ...) from one event to the next -> (N, ...), the difference of the ends spread over the cycle."""
    count = len(samples) - 1
    ramp = (np.arange(count + 1) / count - 0.5).reshape(-1, *[1] * (samples.ndim - 1))
    return np.asarray((samples - ramp * (samples[-1] - samples[0]))[:-1])


def _in_walker_frame(clip: Clip) -> tuple[dict[str, Floats], Floats, dict[str, Floats], float]:
    """Signals per frame with the heading removed; place along the path (m); ankles ahead of the hips (m); leg (m)."""
    world, places = world_pose(clip)
    roles = clip.roles
    path = places[:, roles["hips"]]
    low = butter(2, 1.0 / (clip.rate / 2))
    velocity = np.gradient(filtfilt(*low, path, axis=0), axis=0)
    heading = np.unwrap(np.arctan2(velocity[:, 0], velocity[:, 2]))
    line = np.polyfit(np.arange(len(heading)), heading, 1)
    heading = np.polyval(line, np.arange(len(heading)))  # a slow turn, if any
    turn_back = about_axis((0.0, 1.0, 0.0), -heading)
    signals: dict[str, Floats] = {}

    def vector(role: str) -> Floats:
        return to_exponential(multiply(turn_back, world[:, roles[role]]))

    for role in ("hips", "spine", "chest", "neck", "head"):
        signals[role] = vector(role)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        signals[f"{side}shoulder"] = vector(f"{side}Shoulder")
        arm = MODEL_ARM * (sign, 1.0, 1.0)
        hand = clip.joints.index(f"{side.capitalize()}FingerBase")
        chain = [roles[f"{side}{role}"] for role in ("UpperArm", "LowerArm", "Hand")] + [hand]
        for part, (near, far) in zip(("upperArm", "lowerArm", "hand"), pairwise(chain), strict=True):
            bone_of_arm = rotate(turn_back, places[:, far] - places[:, near])
            signals[side + part] = to_exponential(shortest_arc(np.broadcast_to(arm, bone_of_arm.shape), bone_of_arm))

        def bone(upper: str, lower: str) -> Floats:
            return rotate(turn_back, places[:, roles[lower]] - places[:, roles[upper]])

        thigh = bone(f"{side}UpperLeg", f"{side}LowerLeg")
        shank = bone(f"{side}LowerLeg", f"{side}Foot")
        foot = bone(f"{side}Foot", f"{side}Toes")
        signals[f"{side}thigh"] = np.arctan2(thigh[:, 2], -thigh[:, 1])
        signals[f"{side}shank"] = np.arctan2(shank[:, 2], -shank[:, 1])
        rest = clip.offsets[roles[f"{side}Toes"]]
        flat = np.arctan2(rest[1], np.hypot(rest[0], rest[2]))
        signals[f"{side}foot"] = np.arctan2(foot[:, 1], np.hypot(foot[:, 0], foot[:, 2])) - flat
        forward = rotate(world[:, roles[f"{side}UpperLeg"]], (0.0, 0.0, 1.0))
        forward = rotate(turn_back, forward)
        signals[f"{side}knee_yaw"] = np.arctan2(forward[:, 0], forward[:, 2])
        signals[f"{side}foot_yaw"] = np.arctan2(foot[:, 0], np.abs(foot[:, 2]) + 0.02)

    mean_heading = float(np.mean(heading))
    along = np.array([np.sin(mean_heading), 0.0, np.cos(mean_heading)])
    frames = np.arange(len(path))
    middle = np.stack([np.polyval(np.polyfit(frames, path[:, axis], 2), frames) for axis in range(3)], axis=1)
    turn = inverse(turn_back)
    leftward, ahead = rotate(turn, (1.0, 0.0, 0.0)), rotate(turn, (0.0, 0.0, 1.0))
    signals["hips_shift"] = np.sum((path - middle) * leftward, axis=1)
    ankles = {}
    for side in SIDES:
        ankle = places[:, roles[f"{side}Foot"]]
        signals[f"{side}foot_shift"] = np.sum((ankle - middle) * leftward, axis=1)
        ankles[side] = np.sum((ankle - path) * ahead, axis=1)
    bones = [clip.offsets[roles[f"{side}{end}"]] for side in SIDES for end in ("LowerLeg", "Foot")]
    leg = 0.5 * sum(float(np.linalg.norm(bone)) for bone in bones)
    return signals, path @ along, ankles, leg


def _strikes(ankle: Floats, rate: float) -> list[int]:
    """Frames at which the ankle is furthest ahead of the hips (Zeni et al. 2008), first and last parts included."""
    ahead = filtfilt(*butter(2, 8.0 / (rate / 2)), ankle)
    peaks, _ = find_peaks(ahead, distance=int(0.6 * rate), prominence=0.5 * np.ptp(ahead))
    return [int(peak) for peak in peaks]


def _stride(signals: dict[str, Floats], first: int, last: int, mirrored: bool, leg: float) -> Floats:
    """(SAMPLES, S) one stride of the signals, begun by the side that the model calls right."""
    frames = np.linspace(first, last, SAMPLES + 1)

    def sampled(name: str) -> Floats:
        values = signals[name].reshape(len(signals[name]), -1)
        grid = np.arange(len(values))
        return close_cycle(np.stack([np.interp(frames, grid, column) for column in values.T], axis=1))

    columns: list[Floats] = []
    for name in ("hips", "spine", "chest", "neck", "head", "hips_shift"):
        columns.append(sampled(name))
    side = "left" if mirrored else "right"
    for name in (
        "shoulder",
        "upperArm",
        "lowerArm",
        "hand",
        "thigh",
        "shank",
        "foot",
        "foot_yaw",
        "knee_yaw",
        "foot_shift",
    ):
        columns.append(sampled(side + name))
    stride = np.concatenate(columns, axis=1)
    assert stride.shape[1] == len(SIGNALS)
    hips, foot = SIGNALS.index("hips_shift"), SIGNALS.index("foot_shift")
    middle = np.mean(stride[:, hips])
    for column in (hips, foot):
        stride[:, column] = (stride[:, column] - middle) / leg
    return stride * MIRROR_SIGN if mirrored else stride

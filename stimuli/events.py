"""Where the feet are, and their heel strikes and toe-offs. Knows no file.

Toe-off: the toes are furthest behind the pelvis (Zeni et al., Gait & Posture 27, 2008), OFF_DELAY set on force-plate
events of 28 walks of Schreiber & Moissenet (Sci Data 6:111, 2019). Heel strikes: `stimuli.landings`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stimuli.clip import Clip, FootEvent, world_positions
from stimuli.curves import low_pass, stride_peaks, vertex
from stimuli.landings import FootMotion, heel_strikes
from stimuli.motion_files.errors import MotionFileError

Floats = NDArray[np.floating]

SIDES = ("left", "right")
CUTOFF = 12.0  # Hz; below the noise of skeletons fitted to markers, above the swing of a foot
LANDING_CUTOFFS = (
    50.0,
    20.0,
)  # Hz, of the pitch of a marked foot, quiet and noisy; more smoothed, it seems to land early
NOISY = 0.0015  # rad, standard deviation of a foot's pitch; 0.2 mm of noise in each marker
OFF_DELAY = 0.005  # s, median of toe-off minus furthest back
LEAST_REACH = 0.12  # m peak to peak, foot against pelvis, of the smallest step taken for walking
GOING = 0.25  # m/s: at twice that the pelvis' way alone tells the direction of walking, below it its facing


class GaitError(MotionFileError):
    """A motion holds no walk to measure; the message says what is missing."""


@dataclass(frozen=True, eq=False)
class FootPaths:
    """The points of the body events are found from, m, Y up; one value per frame.

    pelvis: (T, 3); left_axis: (T, 3) from the right to the left hip, any length;
    heels, toes: (2, T, 3), left then right; an ankle joint serves as a heel
    heel_markers: whether the heels are markers there, which tell more of a landing than a skeleton's joints
    """

    pelvis: Floats
    left_axis: Floats
    heels: Floats
    toes: Floats
    rate: float  # Hz
    heel_markers: bool = False

    def reach(self, foot: int) -> Floats:
        """(T,) m: how far a foot's heel is ahead of the pelvis along the heading, smoothed."""
        ahead = low_pass(self.heels[foot] - self.pelvis, CUTOFF, self.rate)
        return np.asarray(np.sum(ahead[:, [0, 2]] * self.heading, axis=1))

    @cached_property
    def heading(self) -> Floats:
        """(T, 2) unit horizontal (x, z) direction of walking, smoothed over about a stride.

        It is the way the pelvis goes, as a pelvis may be carried turned aside, and the way it faces where it stays.
        """
        facing = _unit(low_pass(_unit(np.cross(self.left_axis, [0.0, 1.0, 0.0])[:, [0, 2]]), 0.5, self.rate))
        if len(facing) < 2:
            return facing
        velocity = np.gradient(low_pass(self.pelvis[:, [0, 2]], 0.5, self.rate), axis=0) * self.rate
        going = np.clip(np.linalg.norm(velocity, axis=1, keepdims=True) / GOING - 1.0, 0.0, 1.0)
        return _unit((1.0 - going) * facing + going * _unit(velocity))


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9))


def foot_paths(clip: Clip, positions: Floats | None = None) -> FootPaths:
    """Pelvis, ankles and toes of a clip. Raises GaitError if a role is missing; toes may be the foot's end.

    positions: (T, J, 3) m, the clip's world_positions where they are at hand.
    """
    needed = ("hips", "leftUpperLeg", "rightUpperLeg", "leftFoot", "rightFoot")
    missing = [role for role in needed if role not in clip.roles]
    if missing:
        raise GaitError(f"{clip.name}: no joint plays {', '.join(missing)}; name it in a YAML file beside the motion")
    positions = world_positions(clip) if positions is None else positions
    toes = [positions[:, _toes_of(clip, side)] for side in SIDES]
    return FootPaths(
        pelvis=positions[:, clip.roles["hips"]],
        left_axis=positions[:, clip.roles["leftUpperLeg"]] - positions[:, clip.roles["rightUpperLeg"]],
        heels=np.stack([positions[:, clip.roles[side + "Foot"]] for side in SIDES]),
        toes=np.stack(toes),
        rate=clip.rate,
    )


def _toes_of(clip: Clip, side: str) -> int:
    if side + "Toes" in clip.roles:
        return clip.roles[side + "Toes"]
    foot = clip.roles[side + "Foot"]
    below = [joint for joint, parent in enumerate(clip.parents) if parent == foot]
    if not below:
        raise GaitError(f"{clip.name}: the {side} foot has no toes; name {side}Toes in a YAML file beside the motion")
    return below[0]


def find_events(paths: FootPaths) -> tuple[FootEvent, ...]:
    """All heel strikes and toe-offs, in order of time (s from the first frame); may be empty."""
    if len(paths.pelvis) < 5:
        return ()
    walking = [foot for foot in (0, 1) if np.ptp(paths.reach(foot)) >= LEAST_REACH]
    events: list[FootEvent] = []
    for foot, times in zip(walking, heel_strikes([_motion(paths, foot) for foot in walking], paths.rate), strict=True):
        events += [FootEvent(float(time), SIDES[foot], "strike") for time in times]
        events += [FootEvent(float(time), SIDES[foot], "off") for time in _offs(paths, foot)]
    return tuple(sorted(events))


def events_of(clip: Clip) -> tuple[FootEvent, ...]:
    """The events a clip's file holds, or else those found in its motion."""
    return told_or_found(clip.events, foot_paths(clip))


def told_or_found(told: tuple[FootEvent, ...], paths: FootPaths) -> tuple[FootEvent, ...]:
    """The events a file tells, if they hold a stride and the other foot's step; else those found, if these do.

    Laboratories often mark only what happens on a force plate, or one side only.
    """
    if _hold_a_stride(told):
        return told
    found = find_events(paths)
    return found if _hold_a_stride(found) or not told else told


def _hold_a_stride(events: tuple[FootEvent, ...]) -> bool:
    strikes = sorted(sum(e.side == side and e.kind == "strike" for e in events) for side in SIDES)
    return strikes[0] >= 1 and strikes[1] >= 2


def _motion(paths: FootPaths, foot: int) -> FootMotion:
    sole = paths.toes[foot] - paths.heels[foot]
    if not paths.heel_markers:
        return FootMotion(paths.reach(foot), _pitching_down(paths, sole, CUTOFF), None)
    quiet, noisy = LANDING_CUTOFFS
    cutoff = noisy if _noise(_pitch(paths, sole)) > NOISY else quiet
    height = low_pass(paths.heels[foot][:, 1], CUTOFF, paths.rate)
    lift = np.gradient(np.gradient(height)) * paths.rate**2
    return FootMotion(paths.reach(foot), _pitching_down(paths, sole, cutoff), lift)


def _pitch(paths: FootPaths, sole: Floats) -> Floats:
    """(T,) rad: angle of the toes above the heel, from (T, 3) heel to toes."""
    return np.unwrap(np.arctan2(sole[:, 1], np.sum(sole[:, [0, 2]] * paths.heading, axis=1)))


def _pitching_down(paths: FootPaths, sole: Floats, cutoff: float) -> Floats:
    return -np.gradient(_pitch(paths, low_pass(sole, cutoff, paths.rate))) * paths.rate


def _noise(curve: Floats) -> float:
    """Standard deviation of white noise on a smooth curve, from the median of its third differences.

    A third difference has 1 + 9 + 9 + 1 times the variance; a normal variable's median distance is 0.6745 of its SD.
    """
    return float(np.median(np.abs(np.diff(curve, 3))) / 0.6745 / 20**0.5)


def _offs(paths: FootPaths, foot: int) -> list[float]:
    """Times (s) of toe-offs: the toes furthest behind the pelvis, inside the recording."""
    behind = -np.sum(low_pass(paths.toes[foot] - paths.pelvis, CUTOFF, paths.rate)[:, [0, 2]] * paths.heading, axis=1)
    peaks = [peak for peak in stride_peaks(behind, paths.rate) if 0 < peak < len(behind) - 1]
    return [vertex(behind, peak) / paths.rate + OFF_DELAY for peak in peaks]

"""Heel strikes and toe-offs of both feet, and what follows from them: steps, widths, speed. Knows no file.

Heel strike: the foot pitches down fastest just after its heel has landed; the strike is where that turn first
reaches `STRIKE_SHARE` of its peak. Toe-off: the toes are furthest behind the pelvis (Zeni et al., Gait & Posture 27,
2008). Both constants were set on force-plate events of 28 walks of Schreiber & Moissenet (Sci Data 6:111, 2019).
Zeni's heel strike (heel furthest in front of the pelvis) is 35 ms early there and serves only to find the steps.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from stimuli.clip import Clip, FootEvent, world_positions
from stimuli.gait import Gait
from stimuli.motion_files.errors import MotionFileError

Floats = NDArray[np.floating]

SIDES = ("left", "right")
CUTOFF = 12.0  # Hz, 2nd-order zero-lag Butterworth; below the marker noise, above the foot's landing
STRIKE_SHARE = 0.8  # of the peak pitching-down speed
LEAST_PITCHING = 1.0  # rad/s; a foot put down flat pitches less, then the strike is FLAT_DELAY after the reach
FLAT_DELAY = 0.035  # s, median of strike minus furthest reach in the same 28 walks
OFF_DELAY = 0.005  # s, median of toe-off minus furthest back
BEFORE, AFTER = 0.06, 0.16  # s around the furthest reach in which a foot lands
FAR_REACH = 0.9  # of the range of reach: a foot less far forward at the first frame landed before it
LEAST_STRIDE_TIME = 0.5  # s; 240 steps/min is no walk
LEAST_REACH = 0.12  # m peak to peak, foot against pelvis, of the smallest step taken for walking
FASTEST = 4.5  # m/s; race walkers reach 4.4, so a faster stride is a jump in the data or a wrong unit
SAME_WALK = 0.6  # of the upper quartile of stride speeds: a slower stride is standing
SLOWER, LONGER = 0.15, 0.15  # of the others' medians: an end stride beyond either is setting off or stopping
BELOW_PACE = 0.26  # of the others' median at their strikes: a pelvis so much slower is only getting going, or stopping
PATH_CUTOFF = 2.0  # Hz, low-pass of the pelvis' path before its length is taken
GOING = 0.25  # m/s: at twice that the pelvis' way alone tells the direction of walking, below it its facing
STILL = 0.25  # of foot swing: a pelvis that travels less per stride is on a treadmill


class GaitError(MotionFileError):
    """A motion holds no walk to measure; the message says what is missing."""


@dataclass(frozen=True, eq=False)
class FootPaths:
    """The points of the body events are found from, m, Y up; one value per frame.

    pelvis: (T, 3); left_axis: (T, 3) from the right to the left hip, any length;
    heels, toes: (2, T, 3), left then right; an ankle joint serves as a heel.
    """

    pelvis: Floats
    left_axis: Floats
    heels: Floats
    toes: Floats
    rate: float  # Hz

    @property
    def heading(self) -> Floats:
        """(T, 2) unit horizontal (x, z) direction of walking, smoothed over about a stride.

        It is the way the pelvis goes, as a pelvis may be carried turned aside, and the way it faces where it stays.
        """
        facing = _unit(_low_pass(_unit(np.cross(self.left_axis, [0.0, 1.0, 0.0])[:, [0, 2]]), 0.5, self.rate))
        if len(facing) < 2:
            return facing
        velocity = np.gradient(_low_pass(self.pelvis[:, [0, 2]], 0.5, self.rate), axis=0) * self.rate
        going = np.clip(np.linalg.norm(velocity, axis=1, keepdims=True) / GOING - 1.0, 0.0, 1.0)
        return _unit((1.0 - going) * facing + going * _unit(velocity))


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9))


@dataclass(frozen=True)
class GaitMeasures:
    """What was measured on one walk, over whole strides of both feet."""

    gait: Gait
    speed: float  # m/s, from foot strike to the next strike of that foot, along the path
    steps_used: int
    step_length_left: float  # m, right heel to left heel at left heel strike, along the stride; nan if none
    step_length_right: float
    step_width: float  # m, heel to the line through the other foot's two placements (Huxham et al. 2006); nan if none
    stance_share_left: float  # of the stride, heel strike to toe-off; nan if no toe-off lies inside a stride
    stance_share_right: float
    steady: bool  # False: there is only one stride to tell from, or no two that are alike
    on_the_spot: bool  # a treadmill: speed is the stance feet's backward speed


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
    heading = paths.heading
    events: list[FootEvent] = []
    for index, side in enumerate(SIDES):
        heel, toes = (_low_pass(path[index], CUTOFF, paths.rate) for path in (paths.heels, paths.toes))
        pelvis = _low_pass(paths.pelvis, CUTOFF, paths.rate)
        reach = np.sum((heel - pelvis)[:, [0, 2]] * heading, axis=1)
        toe_reach = np.sum((toes - pelvis)[:, [0, 2]] * heading, axis=1)
        pitching = _pitching_down(toes - heel, heading, paths.rate)
        if np.ptp(reach) < LEAST_REACH:
            continue
        events += [FootEvent(float(t), side, "strike") for t in _strikes(reach, pitching, paths.rate)]
        events += [FootEvent(float(t), side, "off") for t in _offs(toe_reach, paths.rate)]
    return tuple(sorted(events))


def events_of(clip: Clip) -> tuple[FootEvent, ...]:
    """The events a clip's file holds, or else those found in its motion."""
    return clip.events or find_events(foot_paths(clip))


def _pitching_down(foot: Floats, heading: Floats, rate: float) -> Floats:
    """(T,) rad/s: how fast the toes (T, 3, from the heel) sink about the heel."""
    along = np.sum(foot[:, [0, 2]] * heading, axis=1)
    pitch = np.unwrap(np.arctan2(foot[:, 1], along))
    return -np.gradient(pitch) * rate


def _strikes(reach: Floats, pitching: Floats, rate: float) -> list[float]:
    """Times (s) of heel strikes, one per furthest reach; one at the very start needs to be seen landing."""
    times: list[float] = []
    far = np.min(reach) + FAR_REACH * np.ptp(reach)
    for peak in _peaks(reach, rate):
        if peak == len(reach) - 1 or (peak == 0 and reach[0] < far):
            continue
        landing = _landing(pitching, peak, rate)
        if landing is not None:
            times.append(landing / rate)
        elif 0 < peak < len(reach) - 1 - 2 * FLAT_DELAY * rate:
            times.append(_vertex(reach, peak) / rate + FLAT_DELAY)
    return times


def _landing(pitching: Floats, reach_peak: int, rate: float) -> float | None:
    """The frame (with fraction) at which pitching first passes its share of the peak near a furthest reach."""
    first = max(reach_peak - round(BEFORE * rate), 0)
    end = min(reach_peak + round(AFTER * rate) + 1, len(pitching))
    window = pitching[first:end]
    if len(window) < 3:
        return None
    top = int(np.argmax(window))
    level = STRIKE_SHARE * window[top]
    if window[top] < LEAST_PITCHING or (top == len(window) - 1 and end == len(pitching)):
        return None
    below = np.flatnonzero(window[:top] < level)
    if len(below) == 0:
        return None
    frame = int(below[-1])
    return first + frame + float((level - window[frame]) / (window[frame + 1] - window[frame]))


def _offs(reach: Floats, rate: float) -> list[float]:
    peaks = [peak for peak in _peaks(-reach, rate) if 0 < peak < len(reach) - 1]
    return [_vertex(-reach, peak) / rate + OFF_DELAY for peak in peaks]


def _peaks(values: Floats, rate: float) -> list[int]:
    """Frames of maxima at least a stride apart that stand out by a third of the whole range.

    Beyond its ends the curve counts as low, so the first and last frame can be maxima.
    """
    from scipy.signal import find_peaks  # here and below, because showing made cycles needs none of SciPy

    low = np.min(values)
    distance = max(int(LEAST_STRIDE_TIME * rate), 1)
    peaks, _ = find_peaks(np.concatenate([[low], values, [low]]), prominence=np.ptp(values) / 3, distance=distance)
    return [int(peak) - 1 for peak in peaks]


def _vertex(values: Floats, peak: int) -> float:
    """The frame, with fraction, of the top of the parabola through a maximum and its neighbours."""
    before, top, after = values[peak - 1 : peak + 2]
    bend = before - 2 * top + after
    return float(peak + (0.5 * (before - after) / bend if bend < 0 else 0.0))


def _low_pass(values: Floats, cutoff: float, rate: float) -> Floats:
    """Zero-lag 2nd-order Butterworth along the first axis, cut-off at most 0.4 of the rate."""
    from scipy.signal import sosfiltfilt

    sections = _sections(min(cutoff, 0.4 * rate) / (rate / 2))
    padding = min(len(values) - 1, int(1.5 * rate / min(cutoff, 0.4 * rate)) + 3)
    return sosfiltfilt(sections, values, axis=0, padlen=padding)


@cache
def _sections(cutoff: float) -> Floats:
    """2nd-order Butterworth low-pass; cutoff as a share of half the rate. Its design costs more than its use."""
    from scipy.signal import butter

    return np.asarray(butter(2, cutoff, output="sos"))


def measure(clip: Clip) -> GaitMeasures:
    """Speed, step frequency and the rest of a clip's walk. Raises GaitError if no foot strikes twice."""
    return measure_paths(foot_paths(clip), events_of(clip), clip.name)


def measure_paths(paths: FootPaths, events: Sequence[FootEvent], name: str = "the motion") -> GaitMeasures:
    """The gait over the steady strides of both feet.

    paths: the body's points; events: heel strikes and toe-offs, s from the first frame.
    raises: GaitError if no foot strikes twice, so that there is no whole stride
    """
    strides = _strides(paths, events)
    if not strides:
        raise GaitError(f"{name}: no foot strikes the ground twice, so there is no whole stride to measure")
    strides = [stride for stride in strides if stride.speed <= FASTEST]
    if not strides:
        raise GaitError(f"{name}: every stride is faster than {FASTEST:g} m/s, which is no walk; check unit_to_m")
    used, steady = _steady(strides)
    time = sum(stride.time for stride in used)
    travel = sum(stride.travel for stride in used)
    swing = np.median([np.ptp(_along(paths, index)) for index in (0, 1)])
    on_the_spot = bool(travel / len(used) < STILL * swing)
    speed = _belt_speed(paths, used) if on_the_spot else travel / time
    lengths, widths = _placements(paths, events, used, speed if on_the_spot else 0.0)
    shares = _stance_shares(events, used)
    return GaitMeasures(
        gait=Gait.at_speed(speed, 120.0 * len(used) / time),
        speed=speed,
        steps_used=len(used) + 1 if len({stride.side for stride in used}) == 2 else 2 * len(used),
        step_length_left=_mean(lengths[0]),
        step_length_right=_mean(lengths[1]),
        step_width=_mean(widths),
        stance_share_left=_mean(shares[0]),
        stance_share_right=_mean(shares[1]),
        on_the_spot=on_the_spot,
        steady=steady,
    )


@dataclass(frozen=True)
class _Stride:
    side: int  # index into SIDES
    start: float  # s
    end: float  # s
    travel: float  # m, along the pelvis' path
    first_speed: float  # m/s, of the pelvis at the first strike
    last_speed: float

    @property
    def time(self) -> float:
        return self.end - self.start

    @property
    def speed(self) -> float:
        return self.travel / self.time


def _strides(paths: FootPaths, events: Sequence[FootEvent]) -> list[_Stride]:
    """Strides of both feet in order of time, between strikes inside the recording."""
    frames = np.arange(len(paths.pelvis)) / paths.rate
    smooth = _low_pass(paths.pelvis[:, [0, 2]], PATH_CUTOFF, paths.rate)
    walked = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(smooth, axis=0), axis=1))])
    pace = np.gradient(walked) * paths.rate if len(walked) > 1 else np.zeros(1)
    strides = []
    for index, side in enumerate(SIDES):
        strikes = sorted(e.time for e in events if e.side == side and e.kind == "strike")
        strikes = [time for time in strikes if 0 <= time <= frames[-1]]
        for start, end in pairwise(strikes):
            if end - start > 0.5 * LEAST_STRIDE_TIME:
                travel = float(np.interp(end, frames, walked) - np.interp(start, frames, walked))
                ends = (float(np.interp(time, frames, pace)) for time in (start, end))
                strides.append(_Stride(index, start, end, travel, *ends))
    return sorted(strides, key=lambda stride: stride.start)


def _steady(strides: list[_Stride]) -> tuple[list[_Stride], bool]:
    """The longest run of walking strides without those of setting off and stopping, and whether that is two or more.

    A walk that is nothing but setting off and stopping, with no two strides alike, keeps all of its run.
    A stride much slower than the others is standing, which parts runs; at the ends of a run strides are dropped
    while they are slower, or last longer, than the rest by more than SLOWER and LONGER, or begin or end below pace.
    """
    pace = SAME_WALK * np.percentile([stride.speed for stride in strides], 75)
    runs: list[list[_Stride]] = [[]]
    for stride in strides:
        if stride.speed >= pace:
            runs[-1].append(stride)
        elif runs[-1]:
            runs.append([])
    whole = run = max(runs, key=len)
    while len(run) > 1:
        first = max(_unlike(run[0], run[1:]), _below_pace(run[0].first_speed, [s.first_speed for s in run[1:]]))
        last = max(_unlike(run[-1], run[:-1]), _below_pace(run[-1].last_speed, [s.last_speed for s in run[:-1]]))
        if max(first, last) <= 1.0:
            break
        run = run[1:] if first >= last else run[:-1]
    return (whole if len(run) == 1 < len(whole) - 1 else run), len(run) > 1


def _unlike(stride: _Stride, others: list[_Stride]) -> float:
    """Above 1 if a stride is slower or longer lasting than the median of others by more than is steady."""
    speed, time = np.median([s.speed for s in others]), np.median([s.time for s in others])
    slower = (1.0 - stride.speed / speed) / SLOWER if speed > 0.1 else 0.0
    longer = (stride.time / time - 1.0) / LONGER if len(others) > 1 else 0.0
    return float(max(slower, longer))


def _below_pace(speed: float, others: list[float]) -> float:
    """Above 1 if the pelvis is slower than at the others' strikes by more than BELOW_PACE; one other tells nothing."""
    usual = float(np.median(others))
    return (1.0 - speed / usual) / BELOW_PACE if len(others) > 1 and usual > 0.1 else 0.0


def _flat(path: Floats, time: float, paths: FootPaths) -> Floats:
    """(2,) horizontal place (x, z) at a time in s, between frames by straight lines."""
    frames = np.arange(len(path)) / paths.rate
    return np.array([np.interp(time, frames, path[:, axis]) for axis in (0, 2)])


def _along(paths: FootPaths, index: int) -> Floats:
    return np.sum((paths.heels[index] - paths.pelvis)[:, [0, 2]] * paths.heading, axis=1)


def _belt_speed(paths: FootPaths, strides: list[_Stride]) -> float:
    """m/s: median backward speed of the heels from a tenth to a third of each stride, when they are flat."""
    speeds = []
    for stride in strides:
        early, late = stride.start + 0.10 * stride.time, stride.start + 0.35 * stride.time
        moved = _flat(paths.heels[stride.side], late, paths) - _flat(paths.heels[stride.side], early, paths)
        speeds.append(np.linalg.norm(moved) / (late - early))
    return float(np.median(speeds))


def _placements(
    paths: FootPaths, events: Sequence[FootEvent], strides: list[_Stride], belt: float
) -> tuple[tuple[list[float], list[float]], list[float]]:
    """Step lengths (left, right) and widths in m from where the heels are set, the belt's travel added."""
    lengths: tuple[list[float], list[float]] = ([], [])
    widths: list[float] = []
    for stride in strides:
        index, start, end = stride.side, stride.start, stride.end
        other = [e.time for e in events if e.side == SIDES[1 - index] and e.kind == "strike" and start < e.time < end]
        if len(other) != 1:
            continue
        middle = int(np.clip(round(other[0] * paths.rate), 0, len(paths.pelvis) - 1))
        forward = np.asarray(paths.heading[middle]) if belt else np.zeros(2)
        first = _flat(paths.heels[index], start + 0.05, paths)
        second = _flat(paths.heels[1 - index], other[0] + 0.05, paths) + forward * belt * (other[0] - start)
        third = _flat(paths.heels[index], end, paths) + forward * belt * (end - start)
        line = third - first
        length = np.linalg.norm(line)
        if length < 1e-6:
            continue
        along = float(np.dot(second - first, line) / length)
        lengths[1 - index].append(along)
        lengths[index].append(float(length - along))
        across = (second - first) - along * line / length
        widths.append(float(np.linalg.norm(across)))
    return lengths, widths


def _stance_shares(events: Sequence[FootEvent], strides: list[_Stride]) -> tuple[list[float], list[float]]:
    shares: tuple[list[float], list[float]] = ([], [])
    for stride in strides:
        index, start, end = stride.side, stride.start, stride.end
        offs = [e.time for e in events if e.side == SIDES[index] and e.kind == "off" and start < e.time < end]
        if len(offs) == 1:
            shares[index].append((offs[0] - start) / (end - start))
    return shares


def _mean(values: list[float]) -> float:
    return float(np.mean(values)) if values else float("nan")

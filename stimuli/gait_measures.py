"""What follows from the events of the feet: speed, step frequency, step lengths and widths, stance shares."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stimuli.clip import Clip, FootEvent
from stimuli.events import SIDES, FootPaths, GaitError, events_of, foot_paths
from stimuli.gait import Gait
from stimuli.strides import Stride, between_spreads, steady_strides, strides_of, walked_path

Floats = NDArray[np.floating]

FASTEST = 4.5  # m/s; race walkers reach 4.4, so a faster stride is a jump in the data or a wrong unit
SET_DOWN = 0.05  # s after its strike at which a heel is taken to stand; at the strike it still moves by centimetres
STILL = 0.25  # of foot swing: a pelvis that travels less per stride is on a treadmill


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


def measure(clip: Clip) -> GaitMeasures:
    """Speed, step frequency and the rest of a clip's walk. Raises GaitError if no foot strikes twice."""
    return measure_paths(foot_paths(clip), events_of(clip), clip.name)


def measure_paths(paths: FootPaths, events: Sequence[FootEvent], name: str = "the motion") -> GaitMeasures:
    """The gait over the steady strides of both feet; speed and step frequency over one foot's where no two are alike.

    paths: the body's points; events: heel strikes and toe-offs, s from the first frame.
    raises: GaitError if no foot strikes twice, so that there is no whole stride
    """
    strides = strides_of(paths, events)
    if not strides:
        raise GaitError(f"{name}: no foot strikes the ground twice, so there is no whole stride to measure")
    strides = [stride for stride in strides if stride.speed <= FASTEST]
    if not strides:
        raise GaitError(f"{name}: every stride is faster than {FASTEST:g} m/s, which is no walk; check unit_to_m")
    used, steady = steady_strides(strides)
    timed = used if steady or len(used) == 1 else between_spreads(paths, used)
    time = sum(stride.time for stride in timed)
    travel = sum(stride.travel for stride in timed)
    on_the_spot = bool(travel / len(timed) < STILL * _swing(paths))
    speed = _belt_speed(paths, used) if on_the_spot else travel / time
    lengths, widths = _placements(paths, events, used, speed if on_the_spot else 0.0)
    shares = _stance_shares(events, used)
    return GaitMeasures(
        gait=Gait.at_speed(speed, 120.0 * len(timed) / time),
        speed=speed,
        steps_used=len(timed) + 1 if len({stride.side for stride in timed}) == 2 else 2 * len(timed),
        step_length_left=_mean(lengths[0]),
        step_length_right=_mean(lengths[1]),
        step_width=_mean(widths),
        stance_share_left=_mean(shares[0]),
        stance_share_right=_mean(shares[1]),
        on_the_spot=on_the_spot,
        steady=steady,
    )


def path_speed(paths: FootPaths) -> float | None:
    """m/s along the pelvis' path over a whole motion, where no stride can tell it; None on the spot."""
    travel = float(walked_path(paths)[-1])
    return travel * paths.rate / (len(paths.pelvis) - 1) if travel > STILL * _swing(paths) else None


def _swing(paths: FootPaths) -> float:
    """m, how far the feet swing along the heading: from furthest behind the pelvis to furthest ahead."""
    return float(np.median([np.ptp(_along(paths, index)) for index in (0, 1)]))


def _flat(path: Floats, time: float, paths: FootPaths) -> Floats:
    """(2,) horizontal place (x, z) at a time in s, between frames by straight lines."""
    frames = np.arange(len(path)) / paths.rate
    return np.array([np.interp(time, frames, path[:, axis]) for axis in (0, 2)])


def _along(paths: FootPaths, index: int) -> Floats:
    return np.sum((paths.heels[index] - paths.pelvis)[:, [0, 2]] * paths.heading, axis=1)


def _belt_speed(paths: FootPaths, strides: list[Stride]) -> float:
    """m/s: median backward speed of the heels from a tenth to a third of each stride, when they are flat."""
    speeds = []
    for stride in strides:
        early, late = stride.start + 0.10 * stride.time, stride.start + 0.35 * stride.time
        moved = _flat(paths.heels[stride.side], late, paths) - _flat(paths.heels[stride.side], early, paths)
        speeds.append(np.linalg.norm(moved) / (late - early))
    return float(np.median(speeds))


def _placements(
    paths: FootPaths, events: Sequence[FootEvent], strides: list[Stride], belt: float
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
        first = _flat(paths.heels[index], start + SET_DOWN, paths)
        second = _flat(paths.heels[1 - index], other[0] + SET_DOWN, paths) + forward * belt * (other[0] - start)
        third = _flat(paths.heels[index], end + SET_DOWN, paths) + forward * belt * (end - start)
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


def _stance_shares(events: Sequence[FootEvent], strides: list[Stride]) -> tuple[list[float], list[float]]:
    shares: tuple[list[float], list[float]] = ([], [])
    for stride in strides:
        index, start, end = stride.side, stride.start, stride.end
        offs = [e.time for e in events if e.side == SIDES[index] and e.kind == "off" and start < e.time < end]
        if len(offs) == 1:
            shares[index].append((offs[0] - start) / (end - start))
    return shares


def _mean(values: list[float]) -> float:
    return float(np.mean(values)) if values else float("nan")

"""Which strides of a motion are walking: their times, travel and pace, without setting off and stopping."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from stimuli.clip import FootEvent
from stimuli.curves import LEAST_STRIDE_TIME, low_pass, stride_peaks, vertex
from stimuli.events import SIDES, FootPaths

Floats = NDArray[np.floating]

SAME_WALK = 0.6  # of the upper quartile of stride speeds: a slower stride is standing
SLOWER, LONGER = 0.15, 0.15  # of the others' medians: an end stride beyond either is setting off or stopping
BELOW_PACE = 0.26  # of the others' median at their strikes: a pelvis so much slower is only getting going, or stopping
SPREAD_NEAR = 0.2  # s; feet are furthest apart within this of a heel strike
PATH_CUTOFF = 2.0  # Hz, low-pass of the pelvis' path before its length is taken


@dataclass(frozen=True)
class Stride:
    """From a foot's strike to its next."""

    side: int  # index into SIDES
    start: float  # s
    end: float  # s
    travel: float  # m, along the pelvis' path
    first_speed: float  # m/s, of the pelvis at the first strike
    last_speed: float

    @property
    def time(self) -> float:
        """s from a foot's strike to its next."""
        return self.end - self.start

    @property
    def speed(self) -> float:
        """m/s along the path."""
        return self.travel / self.time


def strides_of(paths: FootPaths, events: Sequence[FootEvent]) -> list[Stride]:
    """Strides of both feet in order of time, between strikes inside the recording."""
    frames = np.arange(len(paths.pelvis)) / paths.rate
    walked = walked_path(paths)
    pace = np.gradient(walked) * paths.rate if len(walked) > 1 else np.zeros(1)
    strides = []
    for index, side in enumerate(SIDES):
        strikes = sorted(e.time for e in events if e.side == side and e.kind == "strike")
        strikes = [time for time in strikes if 0 <= time <= frames[-1]]
        for start, end in pairwise(strikes):
            if end - start > 0.5 * LEAST_STRIDE_TIME:
                travel = float(np.interp(end, frames, walked) - np.interp(start, frames, walked))
                ends = (float(np.interp(time, frames, pace)) for time in (start, end))
                strides.append(Stride(index, start, end, travel, *ends))
    return sorted(strides, key=lambda stride: stride.start)


def walked_path(paths: FootPaths) -> Floats:
    """(T,) m that the pelvis has gone along its path since the first frame."""
    smooth = low_pass(paths.pelvis[:, [0, 2]], PATH_CUTOFF, paths.rate)
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(smooth, axis=0), axis=1))])


def steady_strides(strides: list[Stride]) -> tuple[list[Stride], bool]:
    """The longest run of walking strides without those of setting off and stopping, and whether that is two or more.

    A walk that is nothing but setting off and stopping, with no two strides alike, keeps all of its run.
    A stride much slower than the others is standing, which parts runs; at the ends of a run strides are dropped
    while they are slower, or last longer, than the rest by more than SLOWER and LONGER, or begin or end below pace.
    """
    pace = SAME_WALK * np.percentile([stride.speed for stride in strides], 75)
    runs: list[list[Stride]] = [[]]
    for stride in strides:
        if stride.speed >= pace:
            runs[-1].append(stride)
        elif runs[-1]:
            runs.append([])
    whole = run = max(runs, key=len)
    while len(run) > 1:
        starts, ends = [s.first_speed for s in run], [s.last_speed for s in run]
        first = max(_unlike(run[0], run[1:]), _below_pace(starts[0], starts[1:], ends[0]))
        last = max(_unlike(run[-1], run[:-1]), _below_pace(ends[-1], ends[:-1], starts[-1]))
        if max(first, last) <= 1.0:
            break
        run = run[1:] if first >= last else run[:-1]
    return (whole if len(run) == 1 < len(whole) - 1 else run), len(run) > 1


def _unlike(stride: Stride, others: list[Stride]) -> float:
    """Above 1 if a stride is slower or longer lasting than the median of others by more than is steady."""
    speed, time = np.median([s.speed for s in others]), np.median([s.time for s in others])
    slower = (1.0 - stride.speed / speed) / SLOWER if speed > 0.1 else 0.0
    longer = (stride.time / time - 1.0) / LONGER if len(others) > 1 else 0.0
    return float(max(slower, longer))


def _below_pace(speed: float, others: list[float], opposite: float) -> float:
    """Above 1 if the pelvis is slower than at the others' strikes by more than BELOW_PACE.

    One other stride is no measure of the pace, so that the stride's own opposite end stands in for it.
    """
    usual = float(np.median(others)) if len(others) > 1 else opposite
    return (1.0 - speed / usual) / BELOW_PACE if usual > 0.1 else 0.0


def between_spreads(paths: FootPaths, strides: list[Stride]) -> list[Stride]:
    """The strides of one foot of a walk without two alike, from one furthest spread of the feet to the next.

    Where somebody hops and kicks a heel strike is not where a step ends, but the feet still pass each other. Whole
    strides of one foot count no step twice; it is the foot with more of them, or else with the faster ones. Strides
    of a foot that has a strike further than SPREAD_NEAR from a spread stay as they are.
    """
    apart = paths.reach(0) - paths.reach(1)
    moved: list[list[Stride]] = []
    for side, ahead in enumerate((apart, -apart)):
        peaks = [peak for peak in stride_peaks(ahead, paths.rate) if 0 < peak < len(ahead) - 1]
        spreads = np.array([vertex(ahead, peak) / paths.rate for peak in peaks])
        own = [stride for stride in strides if stride.side == side]
        strikes = sorted({time for stride in own for time in (stride.start, stride.end)})
        near = [float(spreads[np.argmin(np.abs(spreads - time))]) for time in strikes] if peaks else []
        if len(set(near)) == len(strikes) and np.all(np.abs(np.subtract(near, strikes)) < SPREAD_NEAR):
            own = strides_of(paths, [FootEvent(time, SIDES[side], "strike") for time in near])
        moved.append(own)
    return max(moved, key=lambda own: (len(own), sum(s.travel for s in own) / sum(s.time for s in own) if own else 0.0))

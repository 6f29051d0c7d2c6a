"""When a foot lands, from how it moves. Knows no clip, no side and no file.

The foot pitches down fastest just after its heel has landed; the strike is where that turn reaches a share of its peak.
Zeni's heel strike (heel furthest in front of the pelvis; Gait & Posture 27, 2008) is 35 ms early and serves to find the
steps. A child's foot, and a lame one, may begin to pitch down in the air: where the heel carries a marker, there is no
strike before its fall is braked (Hreljac & Marshall, J Biomech 33, 2000) or its way forward has ended.

Delays are medians over 28 walks of Schreiber & Moissenet (Sci Data 6:111, 2019). How far strikes are from the events of
five laboratories, also with each left out of the choice of OF_MARKERS, is in docs/actors.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from stimuli.curves import last_rise, stride_peaks, vertex

Floats = NDArray[np.floating]

OF_MARKERS = 0.7, 0.004  # share of the peak pitching-down speed, and s from reaching it to the strike
OF_JOINTS = 0.8, 0.0  # the same for the smoother pitch of a skeleton
LEAST_PITCHING = 1.0  # rad/s; a foot put down flat pitches less, then the strike is FLAT_DELAY after the reach
LEAST_OF_USUAL = 0.5  # of the median peak: a landing that pitches less was flat, or began before the recording
FLAT_DELAY = 0.035  # s, median of strike minus furthest reach
BEFORE, AFTER = 0.06, 0.16  # s around the furthest reach in which a foot lands
FAR_REACH = 0.9  # of the range of reach: a foot less far forward at the first frame landed before it
BRAKED = 0.025  # s, median to 5 ms of the fall's hardest braking minus strike
STOPPED = 0.005  # s, median to 5 ms of the forward speed's fall to NEARLY_STILL minus strike
NEARLY_STILL = 0.4  # m/s over the ground
BRAKES, STOPS = (-0.02, 0.14), (-0.10, 0.16)  # s around the furthest reach in which the heel does so
STANDS = 0.2  # s after the furthest reach by which the heel has gone as slowly as the ground


@dataclass(frozen=True, eq=False)
class FootMotion:
    """How one foot moves, one value per frame.

    reach:    (T,) m, of the heel ahead of the pelvis along the direction of walking
    pitching: (T,) rad/s, how fast the toes sink about the heel
    lift:     (T,) m/s², upward acceleration of a marker on the heel; None where there is none
    """

    reach: Floats
    pitching: Floats
    lift: Floats | None


@dataclass(frozen=True, eq=False)
class _Landing:
    peak: int  # frame of the furthest reach
    first: int  # frame of the first value of `pitching`
    pitching: Floats  # rad/s, around the furthest reach
    whole: bool  # False: pitching still grows where the recording ends

    @property
    def fastest(self) -> float:
        return float(np.max(self.pitching))


def heel_strikes(feet: Sequence[FootMotion], rate: float) -> list[list[float]]:
    """Times of the heel strikes of each foot, s from the first frame, in order.

    There is one per furthest reach. A landing that the end of the recording cuts off is judged by the peaks of the
    foot's others, or else by those of all feet; one at the very start needs to be seen.
    """
    landings = [_landings(foot, rate) for foot in feet]
    usual = [_usual(own) or _usual([*chain(*landings)]) for own in landings]
    return [
        [time for landing in own if (time := _strike(foot, landing, peak, rate)) is not None]
        for foot, own, peak in zip(feet, landings, usual, strict=True)
    ]


def _landings(foot: FootMotion, rate: float) -> list[_Landing]:
    landings = []
    last = len(foot.reach) - 1
    far = np.min(foot.reach) + FAR_REACH * np.ptp(foot.reach)
    for peak in stride_peaks(foot.reach, rate):
        if peak == last or (peak == 0 and foot.reach[0] < far):
            continue
        first = max(peak - round(BEFORE * rate), 0)
        window = foot.pitching[first : peak + round(AFTER * rate) + 1]
        fastest = first + int(np.argmax(window))
        landings.append(_Landing(peak, first, window, fastest < last))
    return landings


def _usual(landings: Sequence[_Landing]) -> float | None:
    """rad/s: median peak of the landings that are seen whole and not flat."""
    peaks = [one.fastest for one in landings if one.whole and one.fastest >= LEAST_PITCHING]
    return float(np.median(peaks)) if peaks else None


def _strike(foot: FootMotion, landing: _Landing, usual: float | None, rate: float) -> float | None:
    share, delay = OF_JOINTS if foot.lift is None else OF_MARKERS
    time = _pitched(landing, usual, share, rate)
    if time is not None:
        return max(time + delay, _still_landing(foot, landing.peak, rate))
    if 0 < landing.peak < len(foot.reach) - 1 - 2 * FLAT_DELAY * rate:
        return vertex(foot.reach, landing.peak) / rate + FLAT_DELAY
    return None


def _pitched(landing: _Landing, usual: float | None, share: float, rate: float) -> float | None:
    """s: when a foot's pitching down reaches a share of its peak; None if it lands flat or is not seen to land."""
    fastest = landing.fastest
    if not landing.whole:
        if usual is None:
            return None
        fastest = usual
    if fastest < max(LEAST_PITCHING, LEAST_OF_USUAL * (usual or 0.0)):
        return None
    frame = last_rise(landing.pitching[: int(np.argmax(landing.pitching)) + 1], share * fastest)
    return None if frame is None else (landing.first + frame) / rate


def _still_landing(foot: FootMotion, peak: int, rate: float) -> float:
    """s: before this the heel is neither braked nor stopped, so that it has not landed; 0 where that is not seen."""
    if foot.lift is None:
        return 0.0
    start, end = (max(peak + round(after * rate), 1) for after in BRAKES)
    lift = foot.lift[: end + 1]
    tops = [k for k in range(start, len(lift) - 1) if lift[k - 1] < lift[k] >= lift[k + 1]]
    speed = np.gradient(foot.reach) * rate
    speed -= np.min(speed[peak : peak + round(STANDS * rate)])
    start, end = (max(peak + round(after * rate), 0) for after in STOPS)
    stopped = last_rise(-speed[start : end + 1], -NEARLY_STILL)
    if not tops or stopped is None:
        return 0.0
    braked = vertex(lift, max(tops, key=lambda frame: float(lift[frame])))
    return min(braked / rate - BRAKED, (start + stopped) / rate - STOPPED)

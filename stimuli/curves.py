"""Curves over time: smoothing, and the maxima that come once a stride. Knows no body and no unit but seconds."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating]

LEAST_STRIDE_TIME = 0.5  # s; 240 steps/min is no walk


def low_pass(values: Floats, cutoff: float, rate: float) -> Floats:
    """Zero-lag 2nd-order Butterworth along the first axis, cut-off in Hz, at most 0.4 of the rate."""
    from scipy.signal import sosfiltfilt  # here and below, because showing made cycles needs none of SciPy

    sections = _sections(min(cutoff, 0.4 * rate) / (rate / 2))
    padding = min(len(values) - 1, int(1.5 * rate / min(cutoff, 0.4 * rate)) + 3)
    return np.asarray(sosfiltfilt(sections, values, axis=0, padlen=padding))


@cache
def _sections(cutoff: float) -> Floats:
    """2nd-order Butterworth low-pass; cutoff as a share of half the rate. Its design costs more than its use."""
    from scipy.signal import butter

    return np.asarray(butter(2, cutoff, output="sos"))


def stride_peaks(values: Floats, rate: float) -> list[int]:
    """Frames of maxima at least a stride apart that stand out by a third of the whole range.

    Beyond its ends the curve counts as low, so the first and last frame can be maxima.
    """
    from scipy.signal import find_peaks

    low = np.min(values)
    distance = max(int(LEAST_STRIDE_TIME * rate), 1)
    peaks, _ = find_peaks(np.concatenate([[low], values, [low]]), prominence=np.ptp(values) / 3, distance=distance)
    return [int(peak) - 1 for peak in peaks]


def vertex(values: Floats, peak: int) -> float:
    """The frame, with fraction, of the top of the parabola through a maximum inside the curve and its neighbours."""
    before, top, after = values[peak - 1 : peak + 2]
    bend = before - 2 * top + after
    return float(peak + (0.5 * (before - after) / bend if bend < 0 else 0.0))


def last_rise(values: Floats, level: float) -> float | None:
    """The frame, with fraction, at which a curve last rises to a level from below it; None if it does not."""
    upward = np.flatnonzero((values[:-1] < level) & (values[1:] >= level))
    if len(upward) == 0:
        return None
    frame = int(upward[-1])
    return frame + float((level - values[frame]) / (values[frame + 1] - values[frame]))

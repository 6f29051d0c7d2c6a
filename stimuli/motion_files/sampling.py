"""The rate a file means by the rate it writes."""

from __future__ import annotations

COMMON_RATES = (24, 25, 30, 48, 50, 60, 75, 90, 100, 120, 125, 144, 150, 180, 200, 240, 250, 300, 360, 480, 500, 1000)
"""Hz, tried before other whole rates; broadcast rates such as 29.97 Hz stay as they are written."""


def rate_meant(frame_time: float, written: str) -> float:
    """Hz: the whole rate of which `frame_time` (s) is the rounding, else its plain inverse.

    written: the number as text; `0.008333` has six decimals and is 1/120 s rounded to them, `.033` is 1/30 s.
    """
    rate = 1.0 / frame_time
    mantissa, _, exponent = written.lower().partition("e")
    decimals = len(mantissa.partition(".")[2]) - int(exponent or 0)
    rounding = 0.5 * 10.0**-decimals * 1.02
    for whole in (*COMMON_RATES, round(rate)):
        if whole > 0 and (abs(rate / whole - 1) < 1e-4 or _is_rounded(frame_time, whole, rounding)):
            return float(whole)
    return rate


def _is_rounded(frame_time: float, whole: int, rounding: float) -> bool:
    return abs(1.0 / whole - frame_time) <= rounding and rounding < 0.1 * frame_time

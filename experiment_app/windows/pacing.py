"""When to draw the next frame and when it will be seen; plain arithmetic on flip times, no clock."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

ASSUMED_RATE = 60.0
"""Hz, where the display does not say (virtual displays report 0)."""


@dataclass(frozen=True)
class Pacing:
    """How frames follow each other on this display.

    period:    s between refreshes. throttled: the driver's swap waits for the refresh.
    """

    period: float
    throttled: bool

    def draw_time(self, last_flip: float, cost: float) -> float:
        """When to begin drawing (s): late enough to see the newest keys, early enough to be ready.

        cost: s that drawing took lately; a throttled swap is entered 2 ms early, an unthrottled one on time.
        """
        margin = 0.002 if self.throttled else 0.0
        return last_flip + self.period - min(cost + margin, self.period)

    def display_time(self, now: float, last_flip: float) -> float:
        """When a frame drawn now will be seen (s): the next refresh after now."""
        missed = max(int((now - last_flip) / self.period), 0)
        return last_flip + (missed + 1) * self.period


def measured(reported_rate: float, intervals: Sequence[float]) -> Pacing:
    """The pacing of a display from the rate it reports (Hz, 0 if unknown) and the times between bare swaps (s).

    The swap throttles when the median interval lies within 10 % of a refresh; the measured period then counts,
    not the reported one.
    """
    period = 1.0 / (reported_rate if reported_rate > 0 else ASSUMED_RATE)
    middle = median(intervals) if intervals else 0.0
    if reported_rate > 0 and abs(middle - period) < 0.1 * period:
        return Pacing(middle, True)
    return Pacing(period, False)

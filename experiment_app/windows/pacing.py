"""When to draw the next frame and when it will be seen; plain arithmetic on flip times, no clock."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from statistics import median

ASSUMED_RATE = 60.0
"""Hz, where the display does not say (virtual displays report 0)."""

MARGIN = 0.002
"""s between the expected end of drawing and the refresh."""

FOLLOWING = 0.1
"""How much of the difference between an expected and an observed refresh the expectation follows at once."""

REMEMBERED = 16
"""Frames whose cost of drawing is remembered."""


@dataclass(frozen=True)
class Pacing:
    """How frames follow each other on this display, at one moment.

    period:    s between refreshes. throttled: the driver's swap waits for the refresh.
    refresh:   s, the newest refresh: observed where the driver waits for it, else a deadline of our own, period by
               period from the first one, so that lateness never adds up.
    costs:     s that drawing the latest frames took.
    lead:      s by which to begin earlier still, grown by missed refreshes.
    """

    period: float
    throttled: bool
    refresh: float = 0.0
    costs: tuple[float, ...] = (0.004, 0.004)
    lead: float = MARGIN

    @property
    def cost(self) -> float:
        """s to allow for drawing: what was needed lately at most, but for one frame, as one stall is no rule."""
        return sorted(self.costs)[-2]

    def draw_time(self) -> float:
        """When to begin drawing (s): late enough to see the newest keys, early enough to be ready."""
        return self.refresh + self.period - min(self.cost + self.lead, self.period)

    def display_time(self, now: float) -> float:
        """When a frame whose drawing begins now will be seen (s): the first refresh for which it can be ready."""
        refreshes = math.ceil((now + self.cost - self.refresh) / self.period - 1e-6)
        return self.refresh + max(refreshes, 1) * self.period

    def after(self, flip: float, cost: float, predicted: float) -> Pacing:
        """The pacing once a frame that took `cost` s to draw and was predicted for `predicted` was seen at `flip`."""
        missed = flip > predicted + 0.5 * self.period
        lead = min(self.lead + 0.0005, self.period) if missed else max(0.999 * self.lead, MARGIN)
        costs = (*self.costs[1 - REMEMBERED :], cost)
        return replace(self, refresh=self._refresh(flip, predicted), costs=costs, lead=lead)

    def _refresh(self, flip: float, predicted: float) -> float:
        missed = max(round((flip - predicted) / self.period), 0)
        expected = predicted + missed * self.period
        if not self.throttled:
            return expected
        if abs(flip - expected) > 0.25 * self.period:
            return flip
        return expected + FOLLOWING * (flip - expected)


def measured(reported_rate: float, intervals: Sequence[float]) -> Pacing:
    """The pacing of a display from the rate it reports (Hz, 0 if unknown) and the times between bare swaps (s).

    The swap throttles when the median interval lies within 10 % of a refresh and nine of ten intervals within 20 % of
    the median; the measured period then counts, not the reported one.
    """
    period = 1.0 / (reported_rate if reported_rate > 0 else ASSUMED_RATE)
    middle = median(intervals) if intervals else 0.0
    even = sum(abs(interval - middle) < 0.2 * middle for interval in intervals) >= 0.9 * len(intervals)
    if reported_rate > 0 and abs(middle - period) < 0.1 * period and even:
        return Pacing(middle, True)
    return Pacing(period, False)

"""How alternatives are shown: side by side or one after the other, for how long, how often. Plain time, no clock."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

from protocols.stimulus import Walk
from protocols.tasks.task import Seen

Arrangement = Literal["side_by_side", "one_after_the_other"]


@dataclass(frozen=True)
class Showing:
    """How the alternatives of a task are shown.

    time_limit: s that they can be seen in one view (each of them, if one after the other); None: until the answer.
    gap:        s of nothing between two that come one after the other.
    views:      how often they may be seen; None: as often as wanted.
    """

    arrangement: Arrangement = "side_by_side"
    time_limit: float | None = None
    gap: float = 0.5
    views: int | None = 1


@dataclass(frozen=True)
class Viewing:
    """How much of a trial's alternatives has been seen.

    walks:    name to walk, from left to right or first to last.
    view:     which view this is, from 1; time: s of it so far.
    complete: every alternative had appeared before now; waited: s until then (summed over views).
    """

    showing: Showing
    walks: Mapping[str, Walk]
    view: int = 1
    time: float = 0.0
    complete: bool = False
    waited: float = 0.0

    def after(self, elapsed: float) -> Viewing:
        """The viewing `elapsed` s later."""
        left = 0.0 if self.complete else max(self.start_of(-1) - self.time, 0.0)
        later = replace(self, time=self.time + elapsed, waited=self.waited + min(elapsed, left))
        return replace(later, complete=later.every_one_seen)

    @property
    def may_repeat(self) -> bool:
        """True while another view is allowed."""
        return self.showing.views is None or self.view < self.showing.views

    def again(self) -> Viewing:
        """The viewing from its beginning, where another view is allowed; otherwise the same."""
        return replace(self, view=self.view + 1, time=0.0) if self.may_repeat else self

    @property
    def every_one_seen(self) -> bool:
        """True once every alternative has appeared."""
        return self.complete or self.time >= self.start_of(-1)

    def start_of(self, index: int) -> float:
        """s into a view at which an alternative appears."""
        if self.showing.arrangement == "side_by_side":
            return 0.0
        index = range(len(self.walks))[index]
        return index * ((self.showing.time_limit or 0.0) + self.showing.gap)

    @property
    def seen(self) -> tuple[Seen, ...]:
        """The alternatives that can be seen now, from left to right."""
        limit = self.showing.time_limit
        seen = []
        for index, (name, walk) in enumerate(self.walks.items()):
            time = self.time - self.start_of(index)
            if time >= 0.0 and (limit is None or time < limit):
                seen.append(Seen(walk, name, time, walk.speed * time))
        return tuple(seen)

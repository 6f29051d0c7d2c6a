"""The rating task as a value: walks in step, a mark on a scale moved by keys or the pointer, then confirmed.

Time and keys are arguments; there is no clock, no frame and no walker in here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

from protocols.events import Clicked, Event, FocusLost, KeyDown, KeyUp, Shown
from protocols.parts import Level
from protocols.tasks.showing import Showing, Viewing
from protocols.tasks.task import Scale, Setup, View

Direction = Literal["lower", "raise"]

SWEEP = 0.25
"""Share of a continuous scale that the mark moves per second of holding a key."""

DECIMALS = 9
"""Of a point of a discrete scale: 3 steps of 0.1 are 0.3, as a condition of the study file writes it."""

ON_SCALE = "scale:"
"""Beginning of the target of a click on the scale; the value follows."""

CONFIRM = "confirm"
"""Target of a click on the button."""


@dataclass(frozen=True)
class RatingTask:
    """What stays the same over trials.

    scale:                without a mark.
    minimum_looking_time: s after onset before a rating is accepted.
    """

    showing: Showing
    scale: Scale
    minimum_looking_time: float = 0.0


@dataclass(frozen=True)
class RatingTrial:
    """One rating at one moment.

    keys:   lower, raise, confirm and replay: what each key is.
    time:   s on the run's clock up to which the trial has come; began: s, flip of the first frame, None before it.
    looked: s since onset, pauses excluded; early: confirmations that came too early, or before there was a mark.
    mark:   the rating so far, None before; held: the keys among lower and raise that are down.
    wanted_on: whether the participant wanted to confirm before there was a mark.
    """

    task: RatingTask
    viewing: Viewing
    keys: Mapping[str, str]
    question: str = ""
    time: float = 0.0
    began: float | None = None
    looked: float = 0.0
    mark: float | None = None
    holding: frozenset[Direction] = frozenset()
    key_presses: int = 0
    early: int = 0
    wanted_on: bool = False
    done: bool = False

    @property
    def onset(self) -> float:
        """s, flip of the first frame."""
        return self.began or 0.0

    @property
    def held(self) -> bool:
        """True while a key that moves the mark is down."""
        return bool(self.holding)

    @property
    def view(self) -> View:
        """The walks that are seen now, the question and the scale; what is missing once it was missed."""
        scale = replace(self.task.scale, mark=self.mark)
        return View(self.viewing.seen, self.question, scale, unanswered=self.wanted_on and self.mark is None)

    @property
    def response(self) -> Mapping[str, Level]:
        """rating, and views: how often the walks were begun. Empty before the rating is confirmed."""
        if not self.done or self.mark is None:
            return {}
        return {"rating": self.mark, "views": self.viewing.view}

    @property
    def counts(self) -> Mapping[str, int]:
        """key_presses, reversals (none) and early_confirms so far."""
        return {"key_presses": self.key_presses, "reversals": 0, "early_confirms": self.early}

    def hears(self, event: Event) -> bool:
        """True for the task's keys, digits on the scale and clicks on it, while the rating is open."""
        if self.began is None or self.done:
            return False
        if isinstance(event, (KeyDown, KeyUp)):
            return event.key in self.keys.values() or self._digit(event.key) is not None
        return isinstance(event, Clicked) and (event.target == CONFIRM or event.target.startswith(ON_SCALE))

    def advance(self, until: float) -> RatingTrial:
        """The trial at time `until` (s), the mark of a continuous scale moved while a key is held."""
        elapsed = until - self.time
        if self.began is None or self.done or elapsed <= 0.0:
            return self
        trial = replace(self, time=until, looked=self.looked + elapsed, viewing=self.viewing.after(elapsed))
        direction = ("raise" in self.holding) - ("lower" in self.holding)
        if direction and self.mark is not None and self.task.scale.step is None:
            length = self.task.scale.maximum - self.task.scale.minimum
            trial = replace(trial, mark=self._inside(self.mark + direction * SWEEP * length * elapsed))
        return trial

    def handle(self, event: Event) -> RatingTrial:
        """The trial once `event` has happened; what is not for this task changes nothing."""
        if isinstance(event, Shown) and self.began is None:
            return replace(self, began=event.time, time=event.time)
        if self.began is None or self.done:
            return self
        trial = self.advance(event.time)
        if isinstance(event, FocusLost):
            return replace(trial, holding=frozenset())
        if not self.hears(event):
            return trial
        if isinstance(event, KeyUp):
            return replace(trial, holding=frozenset(d for d in self.holding if self.keys[d] != event.key))
        if isinstance(event, KeyDown):
            return trial._pressed(event.key)
        return trial._clicked(event.target) if isinstance(event, Clicked) else trial

    def paused(self) -> RatingTrial:
        """The trial with nothing held."""
        return replace(self, holding=frozenset())

    def resumed(self, time: float) -> RatingTrial:
        """The trial after a pause: nothing is held, and the time of the pause is not counted."""
        return replace(self, holding=frozenset(), time=time)

    def _pressed(self, key: str) -> RatingTrial:
        trial = replace(self, key_presses=self.key_presses + 1)
        if key == self.keys["confirm"]:
            return trial._confirmed()
        if key == self.keys.get("replay"):
            return replace(trial, viewing=self.viewing.again())
        if key == self.keys["lower"]:
            return trial._moved("lower", -1)
        if key == self.keys["raise"]:
            return trial._moved("raise", 1)
        return replace(trial, mark=self._digit(key))

    def _clicked(self, target: str) -> RatingTrial:
        if target == CONFIRM:
            return self._confirmed()
        return replace(self, mark=self._inside(float(target.removeprefix(ON_SCALE))))

    def _confirmed(self) -> RatingTrial:
        if self.mark is None or self.looked < self.task.minimum_looking_time or not self.viewing.every_one_seen:
            return replace(self, early=self.early + 1, wanted_on=self.wanted_on or self.mark is None)
        return replace(self, done=True, holding=frozenset())

    def _moved(self, direction: Direction, sign: int) -> RatingTrial:
        """The first press puts the mark at the near end of a discrete scale, in the middle of a continuous one."""
        scale = self.task.scale
        if scale.step is None:
            middle = (scale.minimum + scale.maximum) / 2.0
            mark = middle if self.mark is None else self.mark
            return replace(self, mark=mark, holding=self.holding | {direction})
        if self.mark is None:
            return replace(self, mark=scale.minimum if sign > 0 else scale.maximum)
        return replace(self, mark=self._inside(self.mark + sign * scale.step))

    def _inside(self, mark: float) -> float:
        """The nearest value of the scale."""
        scale = self.task.scale
        if scale.step is not None:
            mark = round(scale.minimum + round((mark - scale.minimum) / scale.step) * scale.step, DECIMALS)
        return min(max(mark, scale.minimum), scale.maximum)

    def _digit(self, key: str) -> float | None:
        """The point of a discrete scale that a digit key names, or None."""
        scale = self.task.scale
        if scale.step is None or not key.isdigit():
            return None
        value = float(key)
        return value if scale.minimum <= value <= scale.maximum and self._inside(value) == value else None


def begin(task: RatingTask, setup: Setup) -> RatingTrial:
    """A rating waiting for its first frame."""
    return RatingTrial(task, Viewing(task.showing, setup.walks), setup.keys, setup.question)

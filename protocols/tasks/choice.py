"""The choice task as a value: two walks, side by side or one after the other; a key chooses one of them.

Time and keys are arguments; there is no clock, no frame and no walker in here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from protocols.events import Event, KeyDown, KeyUp, Shown
from protocols.parts import Level
from protocols.tasks.showing import Showing, Viewing
from protocols.tasks.task import Setup, View

SIDES = ("left", "right")
PLACES = ("first", "second")


@dataclass(frozen=True)
class ChoiceTask:
    """What stays the same over trials.

    original:             the alternative that choosing another is a confusion of; "" where none is right.
    minimum_looking_time: s after onset before a choice is accepted.
    """

    showing: Showing
    original: str = ""
    minimum_looking_time: float = 0.0


@dataclass(frozen=True)
class ChoiceTrial:
    """One choice at one moment.

    keys:   first, second and replay: what each key is.
    time:   s on the run's clock up to which the trial has come; onset: s, flip of the first frame, None before it.
    looked: s since onset, pauses excluded; early: choices that came too early to count.
    chosen: the name of the alternative that was chosen, "" before.
    """

    task: ChoiceTask
    viewing: Viewing
    keys: Mapping[str, str]
    question: str = ""
    time: float = 0.0
    began: float | None = None
    looked: float = 0.0
    key_presses: int = 0
    early: int = 0
    chosen: str = ""

    @property
    def done(self) -> bool:
        """True once one was chosen."""
        return bool(self.chosen)

    @property
    def onset(self) -> float:
        """s, flip of the first frame."""
        return self.began or 0.0

    @property
    def held(self) -> bool:
        """False: holding a key does nothing here."""
        return False

    @property
    def view(self) -> View:
        """The walks that are seen now, and the question."""
        return View(self.viewing.seen, self.question)

    @property
    def response(self) -> Mapping[str, Level]:
        """chosen; where it and the other were; original and whether it was chosen (1 or 0); views.

        side: left or right, first or second. decision_time: s since both had appeared, of walks one after the other.
        Empty before the choice.
        """
        if not self.done:
            return {}
        places = SIDES if self.task.showing.arrangement == "side_by_side" else PLACES
        where = dict(zip(self.viewing.walks, places, strict=True))
        response: dict[str, Level] = {"chosen": self.chosen, "side": where[self.chosen]}
        response |= {place: name for name, place in where.items()}
        if self.task.original:
            response |= {"original": self.task.original, "correct": int(self.chosen == self.task.original)}
        if places is PLACES:
            response["decision_time"] = self.looked - self.viewing.waited
        return response | {"views": self.viewing.view}

    @property
    def counts(self) -> Mapping[str, int]:
        """key_presses, reversals (none) and early_confirms so far."""
        return {"key_presses": self.key_presses, "reversals": 0, "early_confirms": self.early}

    @property
    def ready(self) -> bool:
        """True once a choice is accepted: every walk has appeared and the minimum looking time is over."""
        return self.viewing.every_one_seen and self.looked >= self.task.minimum_looking_time

    def hears(self, event: Event) -> bool:
        """True for the task's keys while a choice is open."""
        running = self.began is not None and not self.done
        return running and isinstance(event, (KeyDown, KeyUp)) and event.key in self.keys.values()

    def advance(self, until: float) -> ChoiceTrial:
        """The trial at time `until` (s); earlier times change nothing."""
        elapsed = until - self.time
        if self.began is None or self.done or elapsed <= 0.0:
            return self
        return replace(self, time=until, looked=self.looked + elapsed, viewing=self.viewing.after(elapsed))

    def handle(self, event: Event) -> ChoiceTrial:
        """The trial once `event` has happened; what is not a key of this task changes nothing."""
        if isinstance(event, Shown) and self.began is None:
            return replace(self, began=event.time, time=event.time)
        if self.began is None or self.done:
            return self
        trial = self.advance(event.time)
        if not isinstance(event, KeyDown) or not self.hears(event):
            return trial
        return trial._pressed(event.key)

    def _pressed(self, key: str) -> ChoiceTrial:
        trial = replace(self, key_presses=self.key_presses + 1)
        if key == self.keys.get("replay"):
            return replace(trial, viewing=self.viewing.again())
        if not self.ready:
            return replace(trial, early=self.early + 1)
        first, second = self.viewing.walks
        return replace(trial, chosen=first if key == self.keys["first"] else second)

    def paused(self) -> ChoiceTrial:
        """The same: nothing is held."""
        return self

    def resumed(self, time: float) -> ChoiceTrial:
        """The trial after a pause, whose time is not counted."""
        return replace(self, time=time)


def begin(task: ChoiceTask, setup: Setup) -> ChoiceTrial:
    """A choice waiting for its first frame; raises ValueError when there are not two alternatives."""
    if len(setup.walks) != 2:
        raise ValueError(f"a choice is between two alternatives, not {len(setup.walks)}")
    return ChoiceTrial(task, Viewing(task.showing, setup.walks), setup.keys, setup.question)

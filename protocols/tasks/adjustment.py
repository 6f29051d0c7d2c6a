"""The adjustment task as a value: hold a key to change step frequency, confirm when the walk looks most natural.

Time and keys are arguments; there is no clock, no frame and no walker in here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Literal

from protocols.events import Event, FocusLost, KeyDown, KeyUp, Shown
from protocols.parts import Level
from protocols.stimulus import Walk
from protocols.tasks.task import Seen, View

Direction = Literal["lower", "raise"]


@dataclass(frozen=True)
class AdjustmentTask:
    """What stays the same over trials.

    minimum, maximum:     steps/min that can be reached.
    rate:                 steps/min per second of holding a key.
    minimum_looking_time: s after onset before the confirm key is accepted.
    """

    minimum: float
    maximum: float
    rate: float
    minimum_looking_time: float
    lower_key: str = "left"
    raise_key: str = "right"
    confirm_key: str = "enter"


class Stage(Enum):
    """Where a trial is: waiting for its first frame, being adjusted, confirmed."""

    WAITING = "waiting"
    ADJUSTING = "adjusting"
    CONFIRMED = "confirmed"


@dataclass(frozen=True)
class AdjustmentTrial:
    """One adjustment trial at one moment.

    walk:      whose step frequency is adjusted; its speed is constant.
    start, setting: steps/min, at onset and now.
    time:      s on the run's clock up to which the trial has been integrated.
    onset:     s, flip of the first frame; looked: s of looking since (pauses excluded).
    strides:   gait cycles walked since onset (summed, so that a change of setting never moves the legs).
    distance:  m walked since onset (summed).
    holding:   the keys among lower and raise that are down.
    key_presses, reversals: presses that changed direction of travel count as reversals.
    """

    task: AdjustmentTask
    walk: Walk
    start: float
    setting: float
    stage: Stage = Stage.WAITING
    time: float = 0.0
    onset: float = 0.0
    looked: float = 0.0
    strides: float = 0.0
    distance: float = 0.0
    holding: frozenset[Direction] = frozenset()
    key_presses: int = 0
    reversals: int = 0
    early_confirms: int = 0
    last_direction: int = 0

    @property
    def done(self) -> bool:
        """True once the participant has confirmed."""
        return self.stage is Stage.CONFIRMED

    @property
    def held(self) -> bool:
        """True while a key that changes step frequency is down."""
        return bool(self.holding)

    @property
    def direction(self) -> int:
        """-1 while step frequency falls, 1 while it rises, 0 when no key or both are held."""
        return ("raise" in self.holding) - ("lower" in self.holding)

    @property
    def step_length(self) -> float:
        """m: speed over step frequency, v = SL * SF / 60."""
        return 60.0 * self.walk.speed / self.setting

    @property
    def walk_ratio(self) -> float:
        """m·min: step length over step frequency (Sekiya et al. 1996)."""
        return self.step_length / self.setting

    @property
    def response(self) -> Mapping[str, Level]:
        """step_frequency (steps/min), step_length (m) and walk_ratio (m·min) now."""
        return {"step_frequency": self.setting, "step_length": self.step_length, "walk_ratio": self.walk_ratio}

    @property
    def counts(self) -> Mapping[str, int]:
        """key_presses, reversals and early_confirms so far."""
        return {
            "key_presses": self.key_presses, "reversals": self.reversals, "early_confirms": self.early_confirms,
        }  # fmt: skip

    @property
    def view(self) -> View:
        """The walker, at the step frequency of now."""
        walk = replace(self.walk, step_frequency=self.setting)
        return View((Seen(walk, "", self.looked, self.distance, self.strides),))

    def hears(self, event: Event) -> bool:
        """True for the task's keys while step frequency can be adjusted."""
        task = self.task
        return (
            self.stage is Stage.ADJUSTING
            and isinstance(event, (KeyDown, KeyUp))
            and event.key in (task.lower_key, task.raise_key, task.confirm_key)
        )

    def advance(self, until: float) -> AdjustmentTrial:
        """The trial at time `until` (s), keys unchanged since `time`; earlier times change nothing.

        Step frequency moves linearly while a key is held and stops at the range's ends; strides are its
        integral, steps/min / 60 / 2 per second, exactly, so the number of frames drawn does not matter.
        """
        elapsed = until - self.time
        if self.stage is not Stage.ADJUSTING or elapsed <= 0.0:
            return self
        setting, moved = self._moved(elapsed)
        steps_per_minute_seconds = (self.setting + setting) / 2.0 * moved + setting * (elapsed - moved)
        return replace(
            self,
            time=until,
            setting=setting,
            looked=self.looked + elapsed,
            strides=self.strides + steps_per_minute_seconds / 120.0,
            distance=self.distance + self.walk.speed * elapsed,
        )

    def handle(self, event: Event) -> AdjustmentTrial:
        """The trial once `event` has happened; what is not a key of this task changes nothing."""
        if isinstance(event, Shown) and self.stage is Stage.WAITING:
            return replace(self, stage=Stage.ADJUSTING, onset=event.time, time=event.time)
        if self.stage is not Stage.ADJUSTING:
            return self
        trial = self.advance(event.time)
        if isinstance(event, FocusLost):
            return trial.paused()
        if isinstance(event, KeyUp):
            return replace(trial, holding=frozenset(d for d in trial.holding if trial._key(d) != event.key))
        if isinstance(event, KeyDown):
            return trial._pressed(event.key)
        return trial

    def paused(self) -> AdjustmentTrial:
        """The trial with nothing held."""
        return replace(self, holding=frozenset())

    def resumed(self, time: float) -> AdjustmentTrial:
        """The trial after a pause: nothing is held, and the time of the pause is not counted."""
        return replace(self, holding=frozenset(), time=time)

    def _moved(self, elapsed: float) -> tuple[float, float]:
        """The setting after `elapsed` seconds, and for how many of them it moved before reaching an end."""
        if self.direction == 0:
            return self.setting, 0.0
        end = self.task.maximum if self.direction > 0 else self.task.minimum
        until_end = abs(end - self.setting) / self.task.rate
        if elapsed >= until_end:
            return end, until_end
        return self.setting + self.direction * self.task.rate * elapsed, elapsed

    def _key(self, direction: Direction) -> str:
        return self.task.lower_key if direction == "lower" else self.task.raise_key

    def _pressed(self, key: str) -> AdjustmentTrial:
        task = self.task
        if key == task.confirm_key:
            if self.looked < task.minimum_looking_time:
                return replace(self, early_confirms=self.early_confirms + 1)
            return replace(self, stage=Stage.CONFIRMED, holding=frozenset())
        if key not in (task.lower_key, task.raise_key):
            return self
        direction: Direction = "lower" if key == task.lower_key else "raise"
        if direction in self.holding:
            return self
        sign = 1 if direction == "raise" else -1
        return replace(
            self,
            holding=self.holding | {direction},
            key_presses=self.key_presses + 1,
            reversals=self.reversals + (self.last_direction == -sign),
            last_direction=sign,
        )


def begin(task: AdjustmentTask, walk: Walk, start: float) -> AdjustmentTrial:
    """A trial waiting for its first frame.

    Raises ValueError when the start lies outside the task's range.
    """
    if not task.minimum <= start <= task.maximum:
        raise ValueError(
            f"start {start:g} steps/min is outside the range {task.minimum:g} to {task.maximum:g} steps/min"
        )
    return AdjustmentTrial(task, walk, start, setting=start)

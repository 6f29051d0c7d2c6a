"""The adjustment task as a value: hold a key to change step frequency, confirm when the walk looks most natural.

Time and keys are arguments; there is no clock, no frame and no walker in here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from typing import Literal

from protocols.events import Event, FocusLost, KeyDown, KeyUp, Shown

Direction = Literal["lower", "raise"]


@dataclass(frozen=True)
class AdjustmentTask:
    """What stays the same over trials.

    minimum, maximum:     steps/min that can be reached.
    rate:                 steps/min per second of holding a key.
    minimum_looking_time: s after onset before the confirm key is accepted.
    keys:                 (lower, raise, confirm).
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

    speed:     m/s, constant.
    setting:   steps/min, now.
    time:      s on the run's clock up to which the trial has been integrated.
    onset:     s, flip of the first frame; looked: s of looking since (pauses excluded).
    strides:   gait cycles walked since onset (summed, so that a change of setting never moves the legs).
    distance:  m walked since onset (summed).
    held:      the keys among lower and raise that are down.
    key_presses, reversals: presses that changed direction of travel count as reversals.
    """

    task: AdjustmentTask
    speed: float
    start: float
    setting: float
    stage: Stage = Stage.WAITING
    time: float = 0.0
    onset: float = 0.0
    looked: float = 0.0
    strides: float = 0.0
    distance: float = 0.0
    held: frozenset[Direction] = frozenset()
    key_presses: int = 0
    reversals: int = 0
    early_confirms: int = 0
    last_direction: int = 0

    @property
    def done(self) -> bool:
        """True once the participant has confirmed."""
        return self.stage is Stage.CONFIRMED

    @property
    def phase(self) -> float:
        """Phase of the gait cycle in [0, 1), 0 at right heel strike."""
        return self.strides % 1.0

    @property
    def direction(self) -> int:
        """-1 while step frequency falls, 1 while it rises, 0 when no key or both are held."""
        return ("raise" in self.held) - ("lower" in self.held)

    @property
    def step_length(self) -> float:
        """m: speed over step frequency, v = SL * SF / 60."""
        return 60.0 * self.speed / self.setting

    @property
    def walk_ratio(self) -> float:
        """m·min: step length over step frequency (Sekiya et al. 1996)."""
        return self.step_length / self.setting


def begin(task: AdjustmentTask, speed: float, start: float) -> AdjustmentTrial:
    """A trial waiting for its first frame.

    Raises ValueError when the start lies outside the task's range.
    """
    if not task.minimum <= start <= task.maximum:
        raise ValueError(
            f"start {start:g} steps/min is outside the range {task.minimum:g} to {task.maximum:g} steps/min"
        )
    return AdjustmentTrial(task, speed, start, setting=start)


def advance(trial: AdjustmentTrial, until: float) -> AdjustmentTrial:
    """The trial at time `until` (s), keys unchanged since `trial.time`; earlier times change nothing.

    Step frequency moves linearly while a key is held and stops at the range's ends; strides are its
    integral, steps/min / 60 / 2 per second, exactly, so the number of frames drawn does not matter.
    """
    elapsed = until - trial.time
    if trial.stage is not Stage.ADJUSTING or elapsed <= 0.0:
        return trial
    setting, moved = _moved(trial, elapsed)
    steps_per_minute_seconds = (trial.setting + setting) / 2.0 * moved + setting * (elapsed - moved)
    return replace(
        trial,
        time=until,
        setting=setting,
        looked=trial.looked + elapsed,
        strides=trial.strides + steps_per_minute_seconds / 120.0,
        distance=trial.distance + trial.speed * elapsed,
    )


def _moved(trial: AdjustmentTrial, elapsed: float) -> tuple[float, float]:
    """The setting after `elapsed` seconds, and for how many of them it moved before reaching an end."""
    if trial.direction == 0:
        return trial.setting, 0.0
    end = trial.task.maximum if trial.direction > 0 else trial.task.minimum
    until_end = abs(end - trial.setting) / trial.task.rate
    if elapsed >= until_end:
        return end, until_end
    return trial.setting + trial.direction * trial.task.rate * elapsed, elapsed


def handle(trial: AdjustmentTrial, event: Event) -> AdjustmentTrial:
    """The trial once `event` has happened; what is not a key of this task changes nothing."""
    if isinstance(event, Shown) and trial.stage is Stage.WAITING:
        return replace(trial, stage=Stage.ADJUSTING, onset=event.time, time=event.time)
    if trial.stage is not Stage.ADJUSTING:
        return trial
    trial = advance(trial, event.time)
    if isinstance(event, FocusLost):
        return replace(trial, held=frozenset())
    if isinstance(event, KeyUp):
        return replace(trial, held=trial.held - {d for d in trial.held if _key(trial.task, d) == event.key})
    if isinstance(event, KeyDown):
        return _pressed(trial, event.key)
    return trial


def resumed(trial: AdjustmentTrial, time: float) -> AdjustmentTrial:
    """The trial after a pause: nothing is held, and the time of the pause is not counted."""
    return replace(trial, held=frozenset(), time=time)


def _key(task: AdjustmentTask, direction: Direction) -> str:
    return task.lower_key if direction == "lower" else task.raise_key


def _pressed(trial: AdjustmentTrial, key: str) -> AdjustmentTrial:
    task = trial.task
    if key == task.confirm_key:
        if trial.looked < task.minimum_looking_time:
            return replace(trial, early_confirms=trial.early_confirms + 1)
        return replace(trial, stage=Stage.CONFIRMED, held=frozenset())
    if key not in (task.lower_key, task.raise_key):
        return trial
    direction: Direction = "lower" if key == task.lower_key else "raise"
    if direction in trial.held:
        return trial
    sign = 1 if direction == "raise" else -1
    return replace(
        trial,
        held=trial.held | {direction},
        key_presses=trial.key_presses + 1,
        reversals=trial.reversals + (trial.last_direction == -sign),
        last_direction=sign,
    )

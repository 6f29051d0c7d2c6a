"""The adjustment task as a study file gives it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from pydantic import Field

from protocols.mistakes.mistake import Mistake
from protocols.mistakes.possible import Possible, Span
from protocols.parts import Key, Level, Part, StepFrequency
from protocols.setting import StepFrequencySetting, leaves, value_of
from protocols.stimulus import Stimulus, Walk
from protocols.tasks import adjustment
from protocols.tasks.adjustment import AdjustmentTask, AdjustmentTrial
from protocols.tasks.task import Setup
from protocols.tasks.task_part import TASK, TaskKeys, TaskPart

if TYPE_CHECKING:
    from protocols.study import Study

TYPICAL = 9.0
"""s a participant typically takes per adjustment (Niay 2022: 96 trials in about a quarter of an hour)."""


class AdjustmentKeys(TaskKeys):
    """Keys of the adjustment task."""

    lower: Key = "left"
    raise_: Key = Field("right", alias="raise")
    confirm: Key = "enter"
    take_break: Key = Field("b", alias="break")
    counterbalanced: bool = Field(False, description="Swap lower and raise for every second participant.")


class AdjustmentRange(Part):
    """The step frequencies the participant can reach."""

    minimum: StepFrequency = Field(80.0, description="steps/min")
    maximum: StepFrequency = Field(120.0, description="steps/min")


class Adjustment(TaskPart):
    """Method of adjustment: hold a key to change step frequency at constant speed, confirm when most natural."""

    responses: ClassVar[tuple[str, ...]] = ("walk_ratio", "step_frequency", "step_length")
    measures: ClassVar[tuple[str, ...]] = (*responses, "response_time", "normalised_walk_ratio")

    kind: Literal["adjustment"]
    start: StepFrequencySetting = Field(description="Step frequency at onset, steps/min, or $factor.")
    range: AdjustmentRange = AdjustmentRange()
    rate: float = Field(10.0, strict=True, gt=0.0, le=200.0, description="steps/min per second of holding.")
    minimum_looking_time: float = Field(
        1.0, strict=True, ge=0.0, le=60.0, description="s before the confirm key is accepted."
    )
    keys: AdjustmentKeys = AdjustmentKeys()

    @property
    def recorded(self) -> dict[str, Possible]:
        """The gait that was set; its step frequency lies in the range."""
        return {**super().recorded, "step_frequency": Span(self.range.minimum, self.range.maximum)}

    @classmethod
    def takes(cls) -> dict[str, Any]:
        """Field to the type of its values."""
        return {"start": StepFrequency}

    def seconds(self, stimulus: Stimulus) -> float:
        """s that a participant typically takes for a trial, whatever is walking."""
        return max(TYPICAL, self.minimum_looking_time)

    @property
    def key_part(self) -> TaskKeys:
        """The task's keys."""
        return self.keys

    def keys_for(self, participant_number: int) -> dict[str, str]:
        """What lower, raise, confirm and break are for a participant, whose number decides counterbalanced keys."""
        keys = self.keys.named()
        if self.keys.counterbalanced and participant_number % 2 == 0:
            keys["lower"], keys["raise"] = keys["raise"], keys["lower"]
        return keys

    def extremes(self, stimulus: Stimulus, levels: Mapping[str, Level]) -> list[Walk]:
        """The walk at both ends of the range."""
        walk = stimulus.walk(levels)
        return [replace(walk, step_frequency=end) for end in (self.range.minimum, self.range.maximum)]

    def begin(self, setup: Setup) -> AdjustmentTrial:
        """A trial waiting for its first frame."""
        task = AdjustmentTask(
            minimum=self.range.minimum,
            maximum=self.range.maximum,
            rate=self.rate,
            minimum_looking_time=self.minimum_looking_time,
            lower_key=setup.keys["lower"],
            raise_key=setup.keys["raise"],
            confirm_key=setup.keys["confirm"],
        )
        (walk,) = setup.walks.values()
        return adjustment.begin(task, walk, float(value_of(self.start, setup.levels)))

    def mistakes(self, study: Study) -> Iterator[Mistake]:
        """Starts outside the range, keys used twice, counterbalanced keys that the instructions do not name."""
        reach = self.range
        if reach.minimum >= reach.maximum:
            where = (*TASK, "range")
            yield Mistake(where, f"minimum {reach.minimum:g} is not below maximum {reach.maximum:g}")
            return
        yield from self._starts(study)
        told = study.pages.told
        if self.keys.counterbalanced and not ("{lower}" in told and "{raise}" in told):
            message = "the instructions must name the keys as {lower} and {raise}, which differ between participants"
            yield Mistake((*TASK, "keys", "counterbalanced"), message)
        yield from super().mistakes(study)

    def _starts(self, study: Study) -> Iterator[Mistake]:
        """Starts out of reach: the setting itself, in its tables, and as levels of the design or of training trials."""
        reach = self.range
        inside = f"outside the range {reach.minimum:g} to {reach.maximum:g} steps/min of task.range"
        given = [*leaves(self.start, (*TASK, "start"), study.factors)]
        taken = {str(place[1]) for _, place in given if place[0] == "factors"}
        given += [
            (level, ("practice", i, factor))
            for i, trial in enumerate(study.practice)
            for factor, level in trial.levels.items()
            if factor in taken
        ]
        for start, place in given:
            if isinstance(start, (int, float)) and not reach.minimum <= start <= reach.maximum:
                yield Mistake(place, f"{start:g} is {inside}")

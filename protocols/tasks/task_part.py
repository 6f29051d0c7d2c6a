"""What every task's part of a study file answers, so that plan, session, check and simulation know no task.

A new task is three things: a trial as a value (protocols.tasks.task.TaskTrial), a part of the study file that begins
it, named in protocols.study.Task, and what a simulated observer does in it (experiment_app.simulated.behaviour).
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, ClassVar

from pydantic import Field

from protocols.mistakes.mistake import Mistake, Place
from protocols.mistakes.possible import Possible, Span
from protocols.parts import Key, Level, Part
from protocols.setting import SettingsPart
from protocols.stimulus import Stimulus, Walk
from protocols.tasks.task import Setup, TaskTrial

if TYPE_CHECKING:
    from protocols.study import Study

TASK: Place = ("task",)


class TaskKeys(Part):
    """Keys of a task; every task has one for a break."""

    take_break: Key = Field("b", alias="break")

    def named(self) -> dict[str, str]:
        """What each key is for, as pages and questions name it, to the key."""
        keys = {f.alias or name: getattr(self, name) for name, f in type(self).model_fields.items()}
        named = {name: key for name, key in keys.items() if isinstance(key, str)}
        return {**{name: key for name, key in named.items() if name != "break"}, "break": self.take_break}


class TaskPart(SettingsPart):
    """A task as the study file gives it.

    responses: columns of a trial that its response fills. measures: what of a trial can be analysed.
    """

    responses: ClassVar[tuple[str, ...]] = ()
    measures: ClassVar[tuple[str, ...]] = ()

    @property
    def recorded(self) -> Mapping[str, Possible]:
        """Columns that the response fills in this study, to what they can hold."""
        return dict.fromkeys(self.responses, Span())

    @property
    def ranges(self) -> Mapping[str, Span]:
        """Measures to the numbers that each can be in a trial of this study."""
        return dict.fromkeys(self.measures, Span())

    @property
    def asked(self) -> str:
        """The question under the walks, "" for none."""
        return ""

    @abstractmethod
    def seconds(self, stimulus: Stimulus) -> float:
        """s that a participant typically takes for a trial with this stimulus."""

    @property
    def balanced(self) -> bool:
        """True when the places of the alternatives are balanced over trials, False when they stay as written."""
        return False

    @property
    @abstractmethod
    def key_part(self) -> TaskKeys:
        """The task's keys."""

    def keys_for(self, participant_number: int) -> dict[str, str]:
        """What each key is for to the key, for the participant of this number (from 1)."""
        return self.key_part.named()

    def walks(self, stimulus: Stimulus, levels: Mapping[str, Level]) -> dict[str, Walk]:
        """Name of every alternative to its walk in a trial with these levels; "" where there is only one."""
        return {"": stimulus.walk(levels)}

    def extremes(self, stimulus: Stimulus, levels: Mapping[str, Level]) -> list[Walk]:
        """Every walk that must be possible for a trial with these levels."""
        return list(self.walks(stimulus, levels).values())

    @abstractmethod
    def begin(self, setup: Setup) -> TaskTrial:
        """A trial waiting for its first frame."""

    def mistakes(self, study: Study) -> Iterator[Mistake]:
        """What is wrong with the task in this study, beside its settings: here, keys used twice."""
        used: dict[str, str] = {}
        for name, key in self.key_part.named().items():
            if key == "escape":
                yield Mistake((*TASK, "keys", name), "escape is kept for the pause page; choose another key")
            if key in used:
                yield Mistake((*TASK, "keys", name), f"{key} is also the key for {used[key]}; choose another")
            used[key] = name

"""The choice task as a study file gives it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar, Literal

from pydantic import Field

from protocols.mistakes.mistake import Mistake, no_such
from protocols.mistakes.possible import Possible, Span
from protocols.parts import Key, Name
from protocols.tasks import choice
from protocols.tasks.choice import ChoiceTask, ChoiceTrial
from protocols.tasks.pair_part import PairPart
from protocols.tasks.task import Setup
from protocols.tasks.task_part import TASK, TaskKeys

if TYPE_CHECKING:
    from protocols.study import Study


class ChoiceKeys(TaskKeys):
    """Keys of the choice task: first is the left walk, or the one shown first."""

    first: Key = "left"
    second: Key = "right"
    replay: Key = "r"
    take_break: Key = Field("b", alias="break")


class Choice(PairPart):
    """Two-alternative forced choice: which of two walks."""

    responses: ClassVar[tuple[str, ...]] = (
        "chosen", "side", "left", "right", "first", "second", "original", "correct", "decision_time", "views",
    )  # fmt: skip
    measures: ClassVar[tuple[str, ...]] = ("confusion_rate", "correct", "response_time", "decision_time")

    kind: Literal["choice"]
    original: Name | None = Field(
        None, description="The alternative that choosing another is a confusion of; none if left out."
    )
    keys: ChoiceKeys = ChoiceKeys()

    @property
    def recorded(self) -> dict[str, Possible]:
        """Columns that a choice fills as it is shown here, to what they can hold."""
        names, apart = tuple(self.alternatives), self.arrangement == "one_after_the_other"
        places = choice.PLACES if apart else choice.SIDES
        columns: dict[str, Possible] = {"chosen": names, "side": places, **dict.fromkeys(places, names)}
        columns |= {"original": names, "correct": (0, 1)} if self.original is not None else {}
        return columns | ({"decision_time": Span()} if apart else {}) | {"views": self.seen}

    @property
    def ranges(self) -> dict[str, Span]:
        """Confusion in percent, correct answers as a share."""
        return {**super().ranges, "confusion_rate": Span(0.0, 100.0), "correct": Span(0.0, 1.0)}

    @property
    def key_part(self) -> TaskKeys:
        """The task's keys."""
        return self.keys

    def begin(self, setup: Setup) -> ChoiceTrial:
        """A choice waiting for its first frame."""
        return choice.begin(ChoiceTask(self.showing, self.original or "", self.minimum_looking_time), setup)

    def mistakes(self, study: Study) -> Iterator[Mistake]:
        """Too few alternatives, an original that is none of them, and what every pair can have wrong."""
        if len(self.alternatives) < 2:
            yield Mistake((*TASK, "alternatives"), "a choice needs two alternatives")
        if self.original is not None and self.original not in self.alternatives:
            yield Mistake((*TASK, "original"), no_such(self.original, self.alternatives, "alternative"))
        yield from super().mistakes(study)

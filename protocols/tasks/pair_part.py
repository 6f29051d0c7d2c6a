"""What choice and rating have in common in a study file: alternatives, how they are shown, the question."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field

from protocols.mistakes.mistake import Mistake, Place
from protocols.mistakes.possible import Span
from protocols.parts import Level, Name, Text
from protocols.setting import Given
from protocols.stimulus import Alternative, Stimulus, Walk
from protocols.tasks.showing import Showing
from protocols.tasks.task_part import TASK, TaskPart

if TYPE_CHECKING:
    from protocols.study import Study

DECIDING = 4.0
"""s a participant typically takes to decide once both alternatives can be seen."""

SEARCHING = 28.0
"""s that two crowds are looked at where nothing ends them: as long as the crowds of Niay (2022, section 6.1) walk."""


class PairPart(TaskPart):
    """Alternatives shown side by side or one after the other, and a question about them."""

    question: Text = Field(description="Asked under the walks; {first}, {replay}, ... become the participant's keys.")
    arrangement: Literal["side_by_side", "one_after_the_other"] = "side_by_side"
    alternatives: dict[Name, Alternative] = Field(
        min_length=1, max_length=2, description="Name: what differs from `stimulus`."
    )
    time_limit: float | None = Field(
        None,
        strict=True,
        ge=0.1,
        le=600.0,
        description="s the walks can be seen in a view; then only the question stays. Until the answer if left out.",
    )
    gap: float = Field(0.5, strict=True, ge=0.0, le=60.0, description="s between walks one after the other.")
    views: int | None = Field(
        1, strict=True, ge=1, le=100, description="How often the walks may be seen; null: as often as wanted."
    )
    sides: Literal["balanced", "as_written"] = Field(
        "balanced", description="balanced: every alternative equally often on either side, by the run's seed."
    )
    minimum_looking_time: float = Field(0.0, strict=True, ge=0.0, le=60.0, description="s before an answer counts.")

    @classmethod
    def takes(cls) -> dict[str, Any]:
        """No setting of its own; those of the alternatives come with them."""
        return {}

    def settings(self, place: Place) -> Iterator[Given]:
        """Every setting of every alternative."""
        for name, alternative in self.alternatives.items():
            yield from alternative.settings((*place, "alternatives", name))

    @property
    def asked(self) -> str:
        """The question under the walks."""
        return self.question

    @property
    def balanced(self) -> bool:
        """True when the places of the alternatives are balanced over trials."""
        return self.sides == "balanced"

    @property
    def showing(self) -> Showing:
        """How the alternatives are shown."""
        return Showing(self.arrangement, self.time_limit, self.gap, self.views)

    @property
    def seen(self) -> Span:
        """How often the alternatives can have been seen when the answer is given."""
        return Span(1.0, math.inf if self.views is None else float(self.views), 1.0)

    def seconds(self, stimulus: Stimulus) -> float:
        """s that a participant typically takes for a trial.

        With a limit, half of it if that is longer: a pair of walkers is soon told apart. Crowds are searched for as
        long as they walk; without a limit, for SEARCHING.
        """
        limit = self.time_limit or 0.0
        crowds = stimulus.crowd is not None
        if self.arrangement == "one_after_the_other":
            typical = len(self.alternatives) * (limit + self.gap) + DECIDING
        elif crowds:
            typical = limit or SEARCHING
        else:
            typical = max(DECIDING, limit / 2.0)
        return max(typical, self.minimum_looking_time)

    def walks(self, stimulus: Stimulus, levels: Mapping[str, Level]) -> dict[str, Walk]:
        """Name of every alternative to its walk in a trial with these levels, in the order of the file."""
        return {name: stimulus.walk(levels, alternative) for name, alternative in self.alternatives.items()}

    def mistakes(self, study: Study) -> Iterator[Mistake]:
        """Successions without an end, keys without use or used twice."""
        if self.arrangement == "one_after_the_other" and self.time_limit is None:
            message = "one after the other needs time_limit: how many s each walk is shown"
            yield Mistake((*TASK, "arrangement"), message)
        yield from super().mistakes(study)

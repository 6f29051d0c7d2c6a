"""The rating task as a study file gives it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar, Literal

from pydantic import Field

from protocols.mistakes.mistake import Mistake
from protocols.mistakes.possible import Possible, Span
from protocols.parts import Key, Number, Part, Text
from protocols.tasks import rating
from protocols.tasks.pair_part import PairPart
from protocols.tasks.rating import RatingTask, RatingTrial
from protocols.tasks.task import Scale, Setup
from protocols.tasks.task_part import TASK, TaskKeys

if TYPE_CHECKING:
    from protocols.study import Study

MOST_POINTS = 21
"""Points of a discrete scale; more cannot be told apart on a screen."""


class RatingKeys(TaskKeys):
    """Keys of the rating task; the digits on a discrete scale work too."""

    lower: Key = "left"
    raise_: Key = Field("right", alias="raise")
    confirm: Key = "enter"
    replay: Key = "r"
    take_break: Key = Field("b", alias="break")


class ScalePart(Part):
    """A rating scale with labelled ends."""

    minimum: Number = 0.0
    maximum: Number = 4.0
    step: float | None = Field(
        1.0, strict=True, gt=0.0, allow_inf_nan=False, description="Between two points; null: a continuous scale."
    )
    low: Text = Field(description="What the lowest value means.")
    high: Text = Field(description="What the highest value means.")


class Rating(PairPart):
    """Rating of a walk, or of one beside another, on a scale."""

    responses: ClassVar[tuple[str, ...]] = ("rating", "views")
    measures: ClassVar[tuple[str, ...]] = ("rating", "response_time")

    kind: Literal["rating"]
    scale: ScalePart
    views: int | None = Field(
        None, strict=True, ge=1, le=100, description="How often the walks may be seen; as often as wanted if left out."
    )
    sides: Literal["balanced", "as_written"] = Field(
        "as_written", description="as_written: the first alternative is always on the left, or first."
    )
    keys: RatingKeys = RatingKeys()

    @property
    def recorded(self) -> dict[str, Possible]:
        """The rating, on its scale, and how often the walks were seen."""
        return {"rating": Span(self.scale.minimum, self.scale.maximum, self.scale.step), "views": self.seen}

    @property
    def ranges(self) -> dict[str, Span]:
        """A rating lies on its scale."""
        return {**super().ranges, "rating": Span(self.scale.minimum, self.scale.maximum)}

    @property
    def key_part(self) -> TaskKeys:
        """The task's keys."""
        return self.keys

    def begin(self, setup: Setup) -> RatingTrial:
        """A rating waiting for its first frame."""
        part = self.scale
        scale = Scale(part.minimum, part.maximum, part.step, part.low, part.high)
        return rating.begin(RatingTask(self.showing, scale, self.minimum_looking_time), setup)

    def mistakes(self, study: Study) -> Iterator[Mistake]:
        """Scales without a length, steps that miss the end, and what every pair can have wrong."""
        scale, where = self.scale, (*TASK, "scale")
        if scale.minimum >= scale.maximum:
            yield Mistake(where, f"minimum {scale.minimum:g} is not below maximum {scale.maximum:g}")
        elif scale.step is not None:
            steps = (scale.maximum - scale.minimum) / scale.step
            if abs(steps - round(steps)) > 1e-6 or steps < 1.0:
                message = f"steps of {scale.step:g} do not lead from {scale.minimum:g} to {scale.maximum:g}"
                yield Mistake((*where, "step"), message)
            elif steps + 1.0 > MOST_POINTS:
                message = f"{round(steps) + 1} points are too many; at most {MOST_POINTS}, or step: null"
                yield Mistake((*where, "step"), message)
        yield from super().mistakes(study)

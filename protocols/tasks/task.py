"""What a session, the screen and a simulated participant ask of a trial, whatever its task.

A trial is a value: `handle(event)`, `advance(until)` and `resumed(time)` give the next one. There is no clock, frame
or walker in here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol, Self

from protocols.events import Event
from protocols.parts import Level
from protocols.stimulus import Walk


@dataclass(frozen=True)
class Seen:
    """One walk as it is seen at an instant.

    name:     of the alternative, "" where there is only one.
    time:     s walked since it appeared; distance: m walked since then.
    strides:  gait cycles walked; None where the walk's own step frequency decides, which this room does not know.
    """

    walk: Walk
    name: str = ""
    time: float = 0.0
    distance: float = 0.0
    strides: float | None = None


@dataclass(frozen=True)
class Scale:
    """A rating scale as it is seen: labelled ends, a mark where the rating is (None: not yet).

    step: between two points of a discrete scale; None where every value between the ends can be marked.
    """

    minimum: float
    maximum: float
    step: float | None
    low: str
    high: str
    mark: float | None = None


@dataclass(frozen=True)
class View:
    """What a trial shows at an instant.

    walks:    from left to right; none while there is nothing to see.
    question: asked under the walks, "" for none; scale: where it is answered, None where keys do.
    unanswered: the participant wanted to go on and has not answered yet, which the screen says.
    """

    walks: tuple[Seen, ...] = ()
    question: str = ""
    scale: Scale | None = None
    unanswered: bool = False


@dataclass(frozen=True)
class Setup:
    """What a task needs to know to begin one trial.

    walks:    name of every alternative to its walk, from left to right or first to last; "" where there is one.
    keys:     what each of the task's keys is for this participant.
    question: in the words this participant reads.
    """

    walks: Mapping[str, Walk]
    levels: Mapping[str, Level]
    keys: Mapping[str, str]
    question: str = ""


class TaskTrial(Protocol):
    """One trial of a task at one moment; times are s on the run's clock."""

    @property
    def done(self) -> bool:
        """True once the participant has answered."""

    @property
    def onset(self) -> float:
        """s, flip of the first frame."""

    @property
    def looked(self) -> float:
        """s since onset, pauses excluded: once done, the response time."""

    @property
    def held(self) -> bool:
        """True while a key that changes something is down."""

    @property
    def response(self) -> Mapping[str, Level]:
        """The answer, by column of the tables."""

    @property
    def counts(self) -> Mapping[str, int]:
        """key_presses, reversals and early_confirms so far."""

    @property
    def view(self) -> View:
        """What is shown now."""

    def hears(self, event: Event) -> bool:
        """True for an event that belongs into the record of this trial."""

    def handle(self, event: Event) -> Self:
        """The trial once `event` has happened; what is not for this task changes nothing."""

    def advance(self, until: float) -> Self:
        """The trial at time `until`, nothing pressed since; earlier times change nothing."""

    def paused(self) -> Self:
        """The trial with nothing held."""

    def resumed(self, time: float) -> Self:
        """The trial after a pause: nothing is held, and the time of the pause is not counted."""

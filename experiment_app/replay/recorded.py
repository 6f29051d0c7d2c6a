"""The recorded trials of a journal: each one's lines, from its first frame to its answer. Knows no walker."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from protocols.events import Clicked, Event, FocusLost, KeyDown, KeyUp, Shown

Line = Mapping[str, Any]


@dataclass(frozen=True)
class RecordedTrial:
    """One finished trial as the journal tells it.

    begun:  the line of its first frame; frames: of its frame log; answer: of its record.
    events: what happened between, oldest first, each with the number of the first frame that showed it.
    """

    begun: Line
    frames: Line
    answer: Line
    events: tuple[tuple[int, Event], ...]

    @property
    def name(self) -> str:
        """As `trial 7` or `training trial 1`."""
        return f"{'training trial' if self.begun['practice'] else 'trial'} {self.begun['number']}"


def recorded_trials(lines: Sequence[Line]) -> Iterator[RecordedTrial]:
    """The trials of a run that have a frame log, in the order they were finished.

    A trial that was interrupted and shown again counts by its last attempt; simulated ones without a picture have none.
    """
    since: list[Line] = []
    for line in lines:
        if line["kind"] == "begin":
            since = []
        since.append(line)
        frames = [one for one in since if one["kind"] == "frames" and "poses" in one]
        if line["kind"] == "trial" and since[0]["kind"] == "begin" and frames:
            yield RecordedTrial(since[0], frames[0], line, tuple(_events(since)))


def _events(lines: Sequence[Line]) -> Iterator[tuple[int, Event]]:
    """Every event with the number of the first frame that showed it; the flip of the first frame is itself one."""
    yield 1, Shown(lines[0]["time"])
    for line in lines:
        time = line["time"]
        if line["kind"] == "key":
            yield line["frame"], _key(line)
        elif line["kind"] == "click":
            yield line["frame"], Clicked(time, line["target"])
        elif line["kind"] in ("pause", "resume"):
            yield line["frame"], KeyDown(time, "escape")


def _key(line: Line) -> Event:
    if line["key"] == "focus":
        return FocusLost(line["time"])
    return KeyDown(line["time"], line["key"]) if line["down"] else KeyUp(line["time"], line["key"])

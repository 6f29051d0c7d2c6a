"""Step frequency over the time of an adjustment trial, rebuilt exactly from the key events of the journal.

The law is the task's (protocols.tasks.adjustment): while one of the two keys is held, step frequency moves at `rate`
steps/min per second and stops at the ends of the range. So the course is a chain of straight lines, and its corners
are all of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from analysis.errors import AnalysisError
from analysis.exports.runs import ExportedRun, Timed
from protocols.setting import value_of


@dataclass(frozen=True)
class Course:
    """One attempt at a trial: corners (s since the run began, steps/min), straight lines between; pauses are gaps.

    end: the step frequency of the response, steps/min, or None when the trial was never confirmed.
    """

    number: int
    practice: bool
    attempt: int
    sitting: int
    stretches: tuple[tuple[tuple[float, float], ...], ...]
    end: float | None

    @property
    def corners(self) -> Iterator[tuple[float, float]]:
        """Every corner, in order."""
        for stretch in self.stretches:
            yield from stretch

    def at(self, time: float) -> float | None:
        """steps/min at `time` (s since the run began); None before, after and in pauses."""
        for stretch in self.stretches:
            for (t0, f0), (t1, f1) in pairwise(stretch):
                if t0 <= time <= t1:
                    return f0 if t1 == t0 else f0 + (f1 - f0) * (time - t0) / (t1 - t0)
        return None


def courses(run: ExportedRun) -> list[Course]:
    """The course of every attempt at an adjustment trial, in the order they were begun; other tasks have none."""
    task = run.study.get("task") or {}
    if task.get("kind") != "adjustment":
        return []
    found, since = [], None
    for place, timed in enumerate(run.records):
        if timed.record["kind"] == "begin":
            since = place
        elif since is not None and timed.record["kind"] in ("trial", "continue", "end"):
            found.append(_course(run, task, run.records[since : place + 1]))
            since = None
    if since is not None:  # killed in the middle of a trial
        found.append(_course(run, task, run.records[since:]))
    return found


def _course(run: ExportedRun, task: Mapping[str, Any], records: Sequence[Timed]) -> Course:
    begun = records[0].record
    reach, keys = task.get("range") or {}, run.header["keys"]
    walk = _Setting(
        time=records[0].onset,
        value=float(value_of(task["start"], {**(run.header.get("group") or {}), **begun["factors"]})),
        low=float(reach.get("minimum", 80.0)),
        high=float(reach.get("maximum", 120.0)),
        rate=float(task.get("rate", 10.0)),
    )
    end = None
    for timed in records[1:]:
        record = timed.record
        if record["kind"] in ("continue", "end") or timed.sitting != records[0].sitting:
            break
        if record["kind"] == "key":
            walk.move(timed.onset)
            walk.press({keys["lower"]: -1, keys["raise"]: 1}.get(record["key"], 0), bool(record["down"]))
            if record["key"] == "focus":
                walk.held.clear()
        elif record["kind"] == "pause":
            walk.move(timed.onset)
            walk.held.clear()
            walk.rest()
        elif record["kind"] == "resume":
            walk.begin(timed.onset)
        elif record["kind"] == "trial":
            walk.move(timed.onset)
            end = record["response"].get("step_frequency")
    walk.rest()
    return Course(begun["number"], begun["practice"], begun["attempt"], records[0].sitting, tuple(walk.stretches), end)


class _Setting:
    """The step frequency while a trial is played again; time in s since the run began, value in steps/min."""

    def __init__(self, time: float, value: float, low: float, high: float, rate: float) -> None:
        self._value, self._low, self._high, self._rate = value, low, high, rate
        self.held: set[int] = set()
        self.stretches: list[tuple[tuple[float, float], ...]] = []
        self._corners: list[tuple[float, float]] = []
        self.begin(time)

    def begin(self, time: float) -> None:
        """Begins a stretch of looking."""
        self._corners = [(time, self._value)]

    def rest(self) -> None:
        """Ends a stretch of looking."""
        if self._corners:
            self.stretches.append(tuple(self._corners))
        self._corners = []

    def press(self, direction: int, down: bool) -> None:
        """A key went down or up; direction 0 is any other key."""
        if direction and down:
            self.held.add(direction)
        elif direction:
            self.held.discard(direction)

    def move(self, until: float) -> None:
        """On to `until` (s); a corner where the range ends, and one there."""
        if not self._corners:
            return
        since = self._corners[-1][0]
        slope = self._rate * sum(self.held)
        if slope:
            edge = self._high if slope > 0 else self._low
            reached = since + (edge - self._value) / slope
            if since < reached < until:
                self._corners.append((round(reached, 6), edge))
            self._value = edge if until >= reached else self._value + slope * (until - since)
        self._corners.append((until, self._value))


def sampled(found: Sequence[Course], rate: float) -> tuple[float, list[tuple[Course, float] | None]]:
    """The courses at `rate` Hz from the first onset to the last end: that onset (s), and at each sample the course
    that was on and its steps/min, None between trials. Raises AnalysisError when there is nothing to sample.
    """
    if not found:
        raise AnalysisError("there is no adjustment trial to sample.")
    start = min(corner[0] for course in found for corner in course.corners)
    last = max(corner[0] for course in found for corner in course.corners)
    samples: list[tuple[Course, float] | None] = [None] * (math.floor((last - start) * rate + 1e-9) + 1)
    for course in found:
        for (t0, f0), (t1, f1) in (pair for stretch in course.stretches for pair in pairwise(stretch)):
            first, behind = math.ceil((t0 - start) * rate - 1e-9), math.floor((t1 - start) * rate + 1e-9)
            for i in range(first, min(behind, len(samples) - 1) + 1):
                share = 0.0 if t1 == t0 else min(max((start + i / rate - t0) / (t1 - t0), 0.0), 1.0)
                samples[i] = (course, f0 + (f1 - f0) * share)
    return start, samples

"""How far a run is, folded from the lines of its journal one by one; knows no file, clock or terminal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from statistics import median
from typing import Any

SHOWN_RESPONSES = 5
PACE = 20
"""Trials whose median length tells how long the others will take."""


@dataclass(frozen=True)
class Watched:
    """What is known of a run so far.

    total:     trials of the plan, training left out. done: numbers of the finished ones.
    doing:     what is on, in words. paused: why, "" while nothing is paused.
    lengths:   s from one response to the next, pauses included. since: s, the last response, on the sitting's clock.
    responses: the newest, oldest first. frames, late, late_now: frames of all trials, late ones, and of the last trial.
    """

    total: int
    participant: str = ""
    doing: str = "beginning"
    paused: str = ""
    ended: str = ""
    time: float = 0.0
    done: frozenset[int] = frozenset()
    lengths: tuple[float, ...] = ()
    since: float | None = None
    responses: tuple[str, ...] = ()
    frames: int = 0
    late: int = 0
    late_now: int = 0

    @property
    def minutes_left(self) -> float | None:
        """Minutes the remaining trials will take at the pace of the last ones; None before the second and after all."""
        if not self.lengths or len(self.done) >= self.total:
            return None
        return (self.total - len(self.done)) * median(self.lengths[-PACE:]) / 60.0


def after(watched: Watched, line: Mapping[str, Any]) -> Watched:
    """What is known once one more line of the journal is there."""
    kind = line["kind"]
    time = float(line.get("time", watched.time))
    watched = replace(watched, time=time)
    if kind == "header":
        return replace(watched, participant=str(line["participant"]))
    if kind == "continue":
        return replace(watched, doing="continued", paused="", ended="", since=None)
    if kind == "page":
        return replace(watched, doing=f"has read {line['page']}")
    if kind == "begin":
        what = "training trial" if line["practice"] else "trial"
        again = f", attempt {line['attempt']}" if line["attempt"] > 1 else ""
        return replace(watched, doing=f"{what} {line['number']} ({_values(line['factors'])}{again})")
    if kind == "pause":
        return replace(watched, paused=str(line["why"]))
    if kind == "resume":
        return replace(watched, paused="")
    if kind == "end":
        return replace(watched, ended=str(line["reason"]), paused="")
    return _answered(watched, line, time) if kind == "trial" else watched


def _answered(watched: Watched, line: Mapping[str, Any], time: float) -> Watched:
    named = ", ".join(f"{name.replace('_', ' ')} {_value(value)}" for name, value in line["response"].items())
    response = f"{_values(line['factors'])}: {named}; {line['response_time']:.1f} s"
    lengths = watched.lengths if watched.since is None else (*watched.lengths, time - watched.since)
    done = watched.done if line["practice"] else watched.done | {int(line["number"])}
    name = f"{'training ' if line['practice'] else ''}{line['number']}"
    return replace(
        watched,
        doing="between trials",
        since=time,
        lengths=lengths[-PACE:],
        done=done,
        responses=(*watched.responses, f"{name:>12}  {response}")[-SHOWN_RESPONSES:],
        frames=watched.frames + int(line.get("frames", 0)),
        late=watched.late + int(line.get("late_frames", 0)),
        late_now=int(line.get("late_frames", 0)),
    )


def _values(values: Mapping[str, Any]) -> str:
    """As `F1 1.2 80`: the levels of a condition."""
    return " ".join(_value(value) for value in values.values())


def _value(value: Any) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def status(watched: Watched) -> str:
    """One line: participant, trials done, minutes left, late frames, what is on."""
    left = watched.minutes_left
    about = "" if left is None else f"  about {max(left, 0.0):.0f} min left"
    now = (
        f"ended: {watched.ended}"
        if watched.ended
        else f"paused ({watched.paused})"
        if watched.paused
        else watched.doing
    )
    line = (
        f"{watched.participant}  {len(watched.done)} of {watched.total} trials{about}  "
        f"{watched.late} of {watched.frames} frames late  {now}"
    )
    return "".join(sign if sign.isprintable() else " " for sign in line)

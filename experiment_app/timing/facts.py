"""What is known about the timing of a run or a computer, gathered from a journal's lines or a doctor's measurements.

Numbers only; `certificate` judges them and puts them into words.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from statistics import quantiles
from typing import Any

from protocols.record import OPENINGS

SOFTWARE = ("llvmpipe", "softpipe", "swiftshader", "software", "gdi generic", "basic render")
"""Words in an OpenGL renderer's name that mean the processor draws."""


def is_software(renderer: str) -> bool:
    """Whether an OpenGL renderer of this name draws with the processor."""
    return any(word in renderer.lower() for word in SOFTWARE)


@dataclass(frozen=True)
class Timing:
    """How frames and keys were timed.

    about:      what the window said of display, driver and inputs (`DesktopWindow.description`).
    intervals:  s between flips inside trials. period: s between refreshes, as measured at the start.
    errors:     s, flip minus the moment its poses were drawn for. cpu_ms: per frame, of the drawing thread.
    late:       (trial, frames more than 1.5 periods after the one before) of the trials that have such; trials: all.
    sources:    how many key times came from where; uncertainties: ms, of each key time.
    keys:       the error of injected keys, where it was measured (`KeyErrors.summary`).
    sittings:   how often the run was opened; what: "run" or "computer".
    """

    what: str
    about: Mapping[str, Any]
    intervals: tuple[float, ...]
    period: float
    errors: tuple[float, ...] = ()
    cpu_ms: tuple[float, ...] = ()
    late: tuple[tuple[str, int], ...] = ()
    trials: int = 0
    sources: Mapping[str, int] = field(default_factory=dict)
    uncertainties: tuple[float, ...] = ()
    keys: Mapping[str, Any] | None = None
    sittings: int = 1
    who: str = ""

    @property
    def frames(self) -> int:
        """How many frames were timed."""
        return len(self.errors) or len(self.intervals) + 1

    @property
    def late_frames(self) -> int:
        """How many of them were late."""
        return sum(count for _, count in self.late)

    @property
    def synchronised(self) -> bool:
        """Whether the driver was seen to wait for the display."""
        return bool(self.about.get("swap_waits_for_display"))

    @property
    def drawn_by_processor(self) -> bool:
        """Whether there is no graphics card at work."""
        return is_software(str(self.about.get("gl_renderer", "")))


def timing_of_run(lines: Sequence[Mapping[str, Any]]) -> Timing:
    """The timing of a whole run from its journal's lines; of the display, what the newest sitting said of it."""
    header = lines[0]
    openings = [line for line in lines if line["kind"] in OPENINGS]
    logs = [line for line in lines if line["kind"] == "frames"]
    keys = [line for line in lines if line["kind"] == "key" and line["key"] != "focus"]
    return Timing(
        what="run",
        about=openings[-1]["display"],
        intervals=tuple(interval for log in logs for interval in _intervals(log)),
        period=logs[-1]["period"] if logs else float(openings[-1]["display"].get("period_s", 0.0)),
        errors=tuple(f - p for log in logs for f, p in zip(log["flips"], log["predicted"], strict=True)),
        cpu_ms=tuple(cost for log in logs for cost in log["cpu_ms"]),
        late=tuple((_trial(log), len(log["late"])) for log in logs if log["late"]),
        trials=len(logs),
        sources=Counter(str(line["source"]) for line in keys),
        uncertainties=tuple(float(line["uncertainty_ms"]) for line in keys),
        sittings=len(openings),
        who=f"{header['study']}, participant {header['participant']}, run {header['run']}",
    )


def _trial(log: Mapping[str, Any]) -> str:
    attempt = f", attempt {log['attempt']}" if log["attempt"] > 1 else ""
    return f"{'training ' if log['practice'] else ''}{log['number']}{attempt}"


def _intervals(log: Mapping[str, Any]) -> Iterable[float]:
    """s between the flips of one trial, pauses left out."""
    begins = set(log["stretches"])
    for number, (earlier, later) in enumerate(pairwise(log["flips"]), start=1):
        if number not in begins:
            yield later - earlier


def percentile_90(values: Sequence[float]) -> float:
    """The value below which nine tenths lie, interpolated."""
    return quantiles(values, n=10, method="inclusive")[-1] if len(values) > 1 else values[0]

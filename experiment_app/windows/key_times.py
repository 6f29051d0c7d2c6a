"""When a key went down or up: the best time stamp this computer has, with its source and how far it may be off.

GLFW says which key and in what order, but not when (glfw#1186). A source of times notes stamps as events come in;
`take` hands out the stamp that belongs to the event GLFW has just reported. Where there is none, the moment of
arrival counts. All times are s on CLOCK_MONOTONIC (`time.perf_counter`).
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, Protocol

from experiment_app.errors import UsageError

Keyboard = Literal["auto", "x-server", "psychtoolbox", "arrival"]


@dataclass(frozen=True)
class Stamp:
    """A time (s), what gave it, and how far it may be off (ms)."""

    time: float
    source: str
    uncertainty_ms: float


class KeyTimes(Protocol):
    """A source of key times."""

    name: str
    notes_repeats: bool
    """Whether the repeats of a held key have stamps too."""

    def collect(self) -> None:
        """Notes the times of key events that have come in; called just before GLFW handles them."""

    def take(self, keycode: int, down: bool) -> Stamp | None:
        """The stamp of the oldest event of this key that was noted and not taken; None when there is none."""

    def forget(self) -> None:
        """GLFW has handled its events: what it did not report, as duplicates from an input method, has no event."""

    def description(self) -> dict[str, Any]:
        """What a journal says about this source: its resolution and its error as measured when it was opened."""

    def close(self) -> None:
        """Gives the source back."""


class NotedTimes:
    """Stamps by key and direction, oldest first, until each is taken."""

    def __init__(self) -> None:
        self._noted: dict[tuple[int, bool], deque[Stamp]] = defaultdict(deque)

    def note(self, keycode: int, down: bool, stamp: Stamp) -> None:
        """Adds the stamp of an event."""
        self._noted[keycode, down].append(stamp)

    def take(self, keycode: int, down: bool) -> Stamp | None:
        """The oldest stamp of this key and direction, once."""
        stamps = self._noted[keycode, down]
        return stamps.popleft() if stamps else None

    def forget(self, before: float = float("inf")) -> None:
        """Drops the stamps before a moment (s)."""
        for stamps in self._noted.values():
            while stamps and stamps[0].time < before:
                stamps.popleft()


class ArrivalTimes:
    """No source at all: events count from when they reach the program."""

    name = "arrival"
    notes_repeats = False

    def collect(self) -> None:
        """Nothing to note."""

    def take(self, keycode: int, down: bool) -> Stamp | None:
        """None: the caller knows when the event arrived."""
        return None

    def forget(self) -> None:
        """Nothing was noted."""

    def description(self) -> dict[str, Any]:
        """Only the name: how late an arrival may be is known event by event."""
        return {"source": self.name}

    def close(self) -> None:
        """Nothing to give back."""


def open_key_times(wanted: Keyboard, glfw_display: int | None) -> KeyTimes:
    """The source asked for; auto takes the X server's times where there are any, else arrival.

    glfw_display: the X connection of GLFW (address), None where there is no X server. Raises UsageError when a
    source was asked for by name and cannot be had.
    """
    if wanted == "arrival":
        return ArrivalTimes()
    sources: dict[str, Callable[[], KeyTimes]] = {
        "x-server": lambda: _x_server(glfw_display),
        "psychtoolbox": _psychtoolbox,
    }
    if wanted != "auto":
        try:
            return sources[wanted]()
        except (OSError, ImportError, RuntimeError) as error:
            raise UsageError(f"--keyboard {wanted}: {error}; leave --keyboard out to take the best there is.") from None
    try:
        return sources["x-server"]()
    except (OSError, RuntimeError):
        return ArrivalTimes()


def _x_server(glfw_display: int | None) -> KeyTimes:
    from experiment_app.windows.x_server_times import XServerTimes

    if glfw_display is None:
        raise RuntimeError("there is no X server here")
    return XServerTimes(glfw_display)


def _psychtoolbox() -> KeyTimes:
    from experiment_app.windows.psychtoolbox_times import PsychtoolboxTimes

    return PsychtoolboxTimes()

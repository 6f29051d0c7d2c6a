"""What can happen to a session, as values with times in seconds on the run's clock. Knows no keyboard or window."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class KeyDown:
    """A key went down; key repeats of the operating system are not events.

    source: what gave the time, as in `protocols.record.Key`; uncertainty_ms: how far it may be off.
    """

    time: float
    key: str
    source: str = "simulated"
    uncertainty_ms: float = 0.0


@dataclass(frozen=True)
class KeyUp:
    """A key went up; the fields are those of KeyDown."""

    time: float
    key: str
    source: str = "simulated"
    uncertainty_ms: float = 0.0


@dataclass(frozen=True)
class Typed:
    """A character was typed (after the keyboard layout, so in any script)."""

    time: float
    text: str


@dataclass(frozen=True)
class Clicked:
    """A box of the page was clicked with the pointer."""

    time: float
    target: str


@dataclass(frozen=True)
class FocusLost:
    """The window lost the keyboard: every held key counts as released."""

    time: float


@dataclass(frozen=True)
class Shown:
    """The scene last asked for became visible: the flip time of its first frame."""

    time: float


@dataclass(frozen=True)
class Saved:
    """Every record emitted so far is safe on disk."""

    time: float


@dataclass(frozen=True)
class Closed:
    """The window was closed, or the computer asked the program to end."""

    time: float
    reason: str = "window closed"


@dataclass(frozen=True)
class Asked:
    """The experimenter asked, from a console, that the session pause, go on or stop."""

    time: float
    what: Literal["pause", "resume", "stop"]


Event = KeyDown | KeyUp | Typed | Clicked | FocusLost | Shown | Saved | Closed | Asked

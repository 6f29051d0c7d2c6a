"""What the loop asks of a place to show scenes: desktop, off-screen, video and simulation are such places."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from experiment_app.scene import Scene
from protocols.events import Event
from protocols.session import Session


@dataclass(frozen=True)
class Flip:
    """What became of a frame.

    time:   s, when it appeared. cpu_ms: processor time of drawing it.
    pose:   checksum of the walkers as drawn (`walkers.pose_checksum`), "" when nothing was drawn.
    """

    time: float
    cpu_ms: float = 0.0
    pose: str = ""


class Window(Protocol):
    """Three verbs; times are seconds on one clock that never goes back."""

    def poll(self, session: Session) -> tuple[float, Sequence[Event]]:
        """The time now (s), and the events since the last poll, oldest first.

        A window with a person before it ignores the session; a simulated participant looks at it.
        """

    def next_display_time(self) -> float:
        """When the frame about to be drawn will be seen (s)."""

    def show(self, scene: Scene) -> Flip:
        """Draws, waits for the display, and returns when the frame appeared and what it was."""

    def measure(self, scene: Scene) -> dict[str, float]:
        """Speed, step frequency, step length, walk ratio and foot slide of the scene's walker as it is drawn.

        Empty when nothing is drawn.
        """

    @property
    def period(self) -> float:
        """The refresh period (s), for calling a frame late; 0 when nothing is drawn."""

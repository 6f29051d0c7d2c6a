"""A window nobody looks at: simulated time jumps from event to event, nothing is drawn."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from experiment_app.scene import Scene
from experiment_app.simulated.observer import SimulatedParticipant
from experiment_app.windows.window import Flip
from protocols.events import Event
from protocols.session import Interval, Session


class UndrawnWindow:
    """Simulated time with a simulated participant.

    until_saved: called when the session waits for its records to be safe.
    """

    period = 0.0

    def __init__(self, participant: SimulatedParticipant, until_saved: Callable[[], None]) -> None:
        self._participant = participant
        self._until_saved = until_saved
        self._now = 0.0

    def poll(self, session: Session) -> tuple[float, Sequence[Event]]:
        """The time of the next thing to happen, and what happens."""
        if isinstance(session.stage, Interval):
            if not session.stage.saved:
                self._until_saved()
            self._now = max(self._now, session.stage.until)
            self._participant.take(self._now)  # keys let go in the interval mean nothing
            return self._now, ()
        self._participant.look(session)
        following = self._participant.next_time()
        if following is not None:
            self._now = max(self._now, following)
        return self._now, self._participant.take(self._now)

    def next_display_time(self) -> float:
        """Now: there is no display."""
        return self._now

    def show(self, scene: Scene) -> Flip:
        """Draws nothing; returns the simulated time (s)."""
        return Flip(self._now)

    def measure(self, scene: Scene) -> dict[str, float]:
        """Empty: nothing is drawn."""
        return {}

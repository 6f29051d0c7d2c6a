"""`python -m tests.benchmarks.console`: what listening to the experimenter's console costs the loop, each frame."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from experiment_app.console.asking import listening
from experiment_app.scene import Scene
from experiment_app.windows.window import Flip
from protocols.events import Event
from protocols.plan import make_plan
from protocols.session import Session, begin
from tests.benchmarks.measuring import fastest, machine, row
from tests.protocols.studies import short


class Still:
    """A window that does nothing, so that only the listening is timed."""

    period = 1 / 60

    def poll(self, session: Session) -> tuple[float, Sequence[Event]]:
        """Nothing happens."""
        return 0.0, ()

    def next_display_time(self) -> float:
        """Now."""
        return 0.0

    def show(self, scene: Scene) -> Flip:
        """Draws nothing."""
        return Flip(0.0)

    def measure(self, scene: Scene) -> dict[str, float]:
        """Nothing to measure."""
        return {}


def main() -> None:
    """Prints how much longer a frame's poll takes with the console's ear, its thread at work."""
    print(machine())
    session, window = begin(make_plan(short().study, 1, 1)), Still()
    with tempfile.TemporaryDirectory() as folder, listening(window, Path(folder)) as heard:
        with_ear = fastest(lambda: heard.poll(session), 9, 20_000)
        without = fastest(lambda: window.poll(session), 9, 20_000)
    row("listening to the console, per frame", with_ear - without, 1e-5)


if __name__ == "__main__":
    main()

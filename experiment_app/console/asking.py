"""From the console to a run: words appended to a file beside the journal, looked at by a thread of the run.

The loop itself only looks at a queue in memory, once a frame. A file works on every system, needs no port and leaves a
trace of who asked what.
"""

from __future__ import annotations

import os
import threading
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Literal, get_args

from experiment_app.scene import Scene
from experiment_app.windows.window import Flip, Window
from protocols.events import Asked, Event
from protocols.session import Session

Word = Literal["pause", "resume", "stop"]
WORDS: tuple[Word, ...] = get_args(Word)

FILE = "console.txt"
"""In the run's folder; one word a line."""

EVERY = 0.1
"""s between two looks at the file."""


def ask(run_folder: Path, word: Word) -> None:
    """Asks the run in a folder to pause, resume or stop."""
    with open(run_folder / FILE, "a", encoding="utf-8") as file:
        file.write(f"{word}\n")


class Listening:
    """A window whose events include what the experimenter asked for; everything else is the window's own."""

    def __init__(self, window: Window, asked: deque[Word]) -> None:
        self._window, self._asked = window, asked

    def poll(self, session: Session) -> tuple[float, Sequence[Event]]:
        """The window's time and events, and after them what was asked meanwhile."""
        now, events = self._window.poll(session)
        if not self._asked:
            return now, events
        asked = [Asked(now, self._asked.popleft()) for _ in range(len(self._asked))]
        return now, [*events, *asked]

    def next_display_time(self) -> float:
        """The window's."""
        return self._window.next_display_time()

    def show(self, scene: Scene) -> Flip:
        """The window's."""
        return self._window.show(scene)

    def measure(self, scene: Scene) -> dict[str, float]:
        """The window's."""
        return self._window.measure(scene)

    @property
    def period(self) -> float:
        """The window's."""
        return self._window.period


@contextmanager
def listening(window: Window, run_folder: Path) -> Iterator[Listening]:
    """The window with an ear for the console, as long as the context lasts; words of earlier sittings count no more."""
    path, asked, over = run_folder / FILE, deque[Word](), threading.Event()
    begin = path.stat().st_size if path.exists() else 0

    def look() -> None:
        place = begin
        while not over.wait(EVERY):
            with suppress(OSError):
                if os.stat(path).st_size > place:
                    words, place = _words(path, place)
                    asked.extend(words)

    thread = threading.Thread(target=look, name="console", daemon=True)
    thread.start()
    try:
        yield Listening(window, asked)
    finally:
        over.set()
        thread.join()


def _words(path: Path, place: int) -> tuple[list[Word], int]:
    """The known words of the whole lines after a place of the file, and the place behind them."""
    with open(path, "rb") as file:
        file.seek(place)
        whole, newline, _ = file.read(10_000).rpartition(b"\n")
    lines = whole.decode("utf-8", "replace").split("\n")
    known: dict[str, Word] = {word: word for word in WORDS}
    return [known[line.strip()] for line in lines if line.strip() in known], place + len(whole) + len(newline)

"""The line that `gaitlab run` keeps up to date in its terminal, written by a thread: a slow terminal waits alone."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from queue import SimpleQueue
from typing import TextIO

from experiment_app.console.progress import Watched, after, status
from experiment_app.loop import Recorder
from protocols.record import Record, TrialBegun, TrialRecord

WIDTH = 110


class Telling:
    """A recorder that hands every record on, and those that matter to the status line."""

    def __init__(self, recorder: Recorder, queue: SimpleQueue[Record | None]) -> None:
        self._recorder, self._queue = recorder, queue

    def write(self, records: list[Record]) -> None:
        """Hands the records on first; then tells of them."""
        self._recorder.write(records)
        for record in records:
            if isinstance(record, (TrialBegun, TrialRecord)) or record.kind in ("page", "pause", "resume", "end"):
                self._queue.put(record)

    @property
    def saved(self) -> bool:
        """Whether the recorder's records are safe."""
        return self._recorder.saved


@contextmanager
def status_line(recorder: Recorder, watched: Watched, terminal: TextIO) -> Iterator[Recorder]:
    """The recorder, with a line about its records in the terminal; the recorder alone where that is no terminal."""
    if not terminal.isatty():
        yield recorder
        return
    queue: SimpleQueue[Record | None] = SimpleQueue()

    def tell() -> None:
        known = watched
        while (record := queue.get()) is not None:
            known = after(known, {"kind": record.kind, **vars(record)})
            if queue.empty():
                _write(terminal, known)
        _write(terminal, known)
        terminal.write("\n")

    thread = threading.Thread(target=tell, name="status line", daemon=True)
    thread.start()
    try:
        yield Telling(recorder, queue)
    finally:
        queue.put(None)
        thread.join(timeout=1.0)  # a terminal that hangs must not keep the participant waiting


def _write(terminal: TextIO, watched: Watched) -> None:
    terminal.write(f"\r{status(watched)[:WIDTH]:<{WIDTH}}")
    terminal.flush()

"""The journal of a run: an append-only file written by its own thread, so that the disk never holds up a frame.

`write` queues; `saved` says how many records are safe. A trial's record is forced to the disk, all else is
flushed to the operating system at once, which survives the death of this process.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from queue import SimpleQueue
from typing import IO

from experiment_app.durable import force_folder
from experiment_app.errors import RunError, UsageError
from experiment_app.run_folder import Run, journal_lines, journal_text, lock
from protocols.record import Ended, Header, Record, TrialRecord, checksum_of, encode_line
from stimuli.whole_file import force_file

DURABLE = (Header, TrialRecord, Ended)
"""Records after which the file is forced to the disk."""


class Journal:
    """An open journal. Use as a context manager; leaving it writes what is queued and closes the file.

    Leaving it by an exception, or when the disk refuses a record, is written down as an end with its reason.
    last: checksum of the line the file ends with, "" when it is empty; the next line names it.
    """

    def __init__(self, file: IO[bytes], path: Path, last: str = "") -> None:
        self.path = path
        self._file = file
        self._last = last
        self._queue: SimpleQueue[Record | None] = SimpleQueue()
        self._time = 0.0
        self._queued = 0
        self._saved = 0
        self._failure: Exception | None = None
        self._idle = threading.Condition()
        self._thread = threading.Thread(target=self._write_all, name="journal", daemon=True)
        self._thread.start()

    def write(self, records: Iterable[Record]) -> None:
        """Queues records in order; raises RunError when an earlier one could not be written."""
        self._check()
        for record in records:
            self._time = getattr(record, "time", self._time)
            self._queued += 1
            self._queue.put(record)

    @property
    def saved(self) -> bool:
        """True when everything written so far is safe; raises RunError when it never will be."""
        self._check()
        return self._saved == self._queued

    def wait(self) -> None:
        """Returns when everything written so far is safe; raises RunError when it never will be."""
        with self._idle:
            self._idle.wait_for(lambda: self._failure is not None or self._saved == self._queued)
        self._check()

    def close(self) -> None:
        """Writes what is queued, closes the file, releases the lock; raises RunError when writing failed."""
        self._queue.put(None)
        self._thread.join()
        self._file.close()
        self._check()

    def __enter__(self) -> Journal:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: object) -> None:
        try:
            if kind is not None and self._failure is None:
                self.write([Ended(self._time, f"failed: {kind.__name__}: {error}"[:300])])
            self.close()
        except RunError:
            if kind is None:
                raise

    def _check(self) -> None:
        if self._failure is not None:
            raise RunError(
                f"{self.path} can no longer be written ({_reason(self._failure)}); everything up to the last "
                "finished trial is safe. Make room or repair the disk, then give the same command again to go on.",
                reason=_reason(self._failure),
            )

    def _write_all(self) -> None:
        while (record := self._queue.get()) is not None:
            if self._failure is None:
                try:
                    self._append(record)
                    if isinstance(record, DURABLE):
                        force_file(self._file.fileno())
                except Exception as error:  # whatever it is, the loop must learn of it and not wait for ever
                    self._failure = error
                    self._last_words(error)
            with self._idle:
                self._saved += self._failure is None
                self._idle.notify_all()

    def _last_words(self, failure: Exception) -> None:
        """Tries once to add why the run ends here; a full disk often has room for one short line.

        Not without a header before it: the file would then be no journal, and the run could never be begun.
        """
        if not self._last:
            return
        with suppress(Exception):
            self._append(Ended(self._time, f"not written: {_reason(failure)}"[:120]))
            force_file(self._file.fileno())

    def _append(self, record: Record) -> None:
        line = encode_line(record, self._last)
        append_line(self._file, line)
        self._last = checksum_of(line)


def append_line(file: IO[bytes], line: str) -> None:
    """Adds a whole line to an unbuffered file; when that cannot be done, none of it, and OSError is raised.

    A nearly full disk takes part of a write without an error, so the rest is written until it is taken or refused.
    """
    end = file.tell()
    rest = memoryview(line.encode("utf-8") + b"\n")
    try:
        while rest:
            rest = rest[file.write(rest) or 0 :]
    except OSError:
        file.truncate(end)
        file.seek(end)
        raise


def _reason(failure: Exception) -> str:
    return str(getattr(failure, "strerror", None) or failure)


def create_journal(run: Run, header: Header) -> Journal:
    """The journal of a new run, its header on disk; raises UsageError when one is there already."""
    journal = Journal(_empty_file(run), run.journal)
    try:
        journal.write([header])
        journal.wait()
        force_folder(run.folder)
    except RunError as error:
        with suppress(RunError):
            journal.close()
        raise UsageError(
            f"{run.journal} cannot be written ({error.reason}); make room or choose another folder with --data."
        ) from None
    return journal


def _empty_file(run: Run) -> IO[bytes]:
    """The locked file of a new run's journal; what a kill in a run's first moment left in it is set aside.

    Nothing is renamed or removed, as Windows lets nobody do that to an open file.
    """
    try:
        new = not run.journal.exists()
        file = open(run.journal, "xb" if new else "r+b", buffering=0)  # noqa: SIM115 - the Journal closes it
    except FileExistsError:
        raise UsageError(f"{run.journal} exists already; nothing is ever overwritten.") from None
    except OSError as error:
        raise UsageError(
            f"{run.journal} cannot be made ({error.strerror}); choose another folder with --data."
        ) from None
    try:
        lock(file, run.journal)
        if journal_lines(run.journal)[0]:
            raise UsageError(f"{run.journal} exists already; nothing is ever overwritten.")
        if not new:
            _set_aside(file, run.folder, 0)
    except BaseException:
        file.close()
        raise
    return file


def _torn_name(folder: Path) -> Path:
    taken = [int(p.name[13:]) for p in folder.glob("journal.torn-*") if p.name[13:].isdigit()]
    return folder / f"journal.torn-{max(taken, default=0) + 1}"


def reopen_journal(run: Run) -> tuple[Journal, Run, int]:
    """An unfinished run's journal ready to append, the run as it is now, and the bytes of a torn line set aside.

    The journal is read again once it is locked: another gaitlab may have gone on with the run meanwhile. Torn
    bytes are copied to `journal.torn-<n>` before they are cut off, so nothing is lost. Raises UsageError.
    """
    try:
        file = open(run.journal, "r+b", buffering=0)  # noqa: SIM115 - the Journal closes it
    except OSError as error:
        raise UsageError(f"{run.journal} cannot be written ({error.strerror}); make it writable.") from None
    try:
        lock(file, run.journal)
        text = journal_text(run.journal)
        run = replace(run, lines=text.records)
        if run.end:
            raise UsageError(f"the run in {run.folder} has {run.end} meanwhile; there is nothing to go on with.")
        end = file.seek(0, os.SEEK_END)
        if text.torn:
            _set_aside(file, run.folder, end - text.torn)
    except UsageError:
        file.close()
        raise
    except OSError as error:
        file.close()
        raise UsageError(
            f"{run.folder} cannot be written ({error.strerror}); nothing was changed. Make room, then try again."
        ) from None
    return Journal(file, run.journal, text.last), run, text.torn


def _set_aside(file: IO[bytes], folder: Path, begin: int) -> None:
    """Copies the bytes of a journal from a place on to `journal.torn-<n>`, then cuts them off."""
    file.seek(begin)
    name = _torn_name(folder)
    try:
        with open(name, "xb") as copy:
            copy.write(file.read())
            copy.flush()
            force_file(copy.fileno())
    except OSError:
        name.unlink(missing_ok=True)
        raise
    file.truncate(begin)
    file.seek(begin)

"""Where a run lives on disk: DATA/<study>/sourcedata/sub-<ID>/run-<N>/journal.jsonl; never overwritten.

Creating is exclusive, an open run is locked against a second process, and a torn last line is set aside
before anything is added.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path
from typing import IO, Any

from experiment_app.crash_note import crash_reason
from experiment_app.errors import UsageError
from protocols.journal_text import DamagedJournalError, JournalText, read_text
from protocols.record import FORMAT, OPENINGS
from protocols.resuming import Progress, over
from protocols.session import answer_columns

PARTICIPANT = re.compile(r"[A-Za-z0-9]{1,32}")
"""Participant IDs: letters and digits only, as the labels of BIDS."""

JOURNAL = "journal.jsonl"


@dataclass(frozen=True)
class Run:
    """One run on disk and what its journal says; lines is empty for a run that is new."""

    folder: Path
    study: str
    participant: str
    number: int
    lines: tuple[dict[str, Any], ...] = ()

    @property
    def journal(self) -> Path:
        """The journal's path."""
        return self.folder / JOURNAL

    @property
    def header(self) -> dict[str, Any]:
        """The journal's first line; an empty dict when the run is new."""
        return self.lines[0] if self.lines else {}

    @property
    def end(self) -> str:
        """Why the run ended ("finished", "declined", "dropped out"), or "" while it can be continued."""
        return over(line["reason"] for line in self.lines if line["kind"] == "end")

    @property
    def sittings(self) -> int:
        """How often the run was opened: once, and once more for every time it was continued."""
        return sum(line["kind"] in OPENINGS for line in self.lines)

    @property
    def interruption(self) -> str:
        """Why the latest sitting ended, as far as can be known from the journal or from a native fault's note."""
        last = self._last_sitting
        reasons = [line["reason"] for line in last if line["kind"] == "end"]
        if reasons:
            return str(reasons[-1])
        crash = crash_reason(self.folder, self.sittings)
        return f"crashed: {crash}" if crash else "no end was recorded: killed, or the power failed"

    @property
    def last_written(self) -> datetime | None:
        """The wall clock's time (UTC) of the latest record; None when the journal does not tell."""
        last = self._last_sitting
        try:
            begun = datetime.fromisoformat(last[0]["started"])
            return begun + timedelta(seconds=max(line.get("time", 0.0) for line in last))
        except (IndexError, KeyError, TypeError, ValueError, OverflowError):
            return None

    @property
    def _last_sitting(self) -> tuple[dict[str, Any], ...]:
        begun = [place for place, line in enumerate(self.lines) if line["kind"] in OPENINGS]
        return self.lines[begun[-1] :] if begun else ()


def check_participant(participant: str) -> str:
    """The ID itself; raises UsageError when it holds anything but letters and digits."""
    if not PARTICIPANT.fullmatch(participant):
        raise UsageError(
            f"--participant {participant!r}: an ID is 1 to 32 letters and digits without accents, "
            "as P01; it becomes the name of a folder."
        )
    return participant


def study_folder(data: Path, study: str) -> Path:
    """The folder of one study's data."""
    return data / study


def participant_runs(data: Path, study: str, participant: str) -> list[Run]:
    """The runs of a participant, oldest first; raises UsageError for an unreadable journal.

    A folder whose journal has no whole line never began and does not count.
    """
    folder = study_folder(data, study) / "sourcedata" / f"sub-{participant}"
    numbers = run_numbers(data, study, participant)
    runs = [_read(folder / f"run-{number}", study, participant, number) for number in numbers]
    return [run for run in runs if run.lines]


def run_numbers(data: Path, study: str, participant: str) -> list[int]:
    """The numbers of the runs a participant has folders for, in order."""
    folder = study_folder(data, study) / "sourcedata" / f"sub-{participant}"
    try:
        return sorted(int(p.name[4:]) for p in folder.glob("run-*") if p.name[4:].isdigit())
    except OSError as error:
        raise UsageError(f"{folder} cannot be read: {error.strerror}.") from None


def new_run(data: Path, study: str, participant: str, number: int) -> Run:
    """A run that does not exist yet, its folder made; raises UsageError when that cannot be done."""
    folder = study_folder(data, study) / "sourcedata" / f"sub-{participant}" / f"run-{number}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(
            f"{folder} cannot be made ({error.strerror}); choose another folder with --data, or make it writable."
        ) from None
    return Run(folder, study, participant, number)


def journal_text(path: Path) -> JournalText:
    """What a journal says, and its torn end; raises UsageError naming file and line when a line is damaged."""
    try:
        return read_text(path.read_bytes())
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror}.") from None
    except DamagedJournalError as error:
        raise UsageError(
            f"{path}: line {error.line}: {error}. Restore the file from a copy, or start a new run with --new-run."
        ) from None


def journal_lines(path: Path) -> tuple[tuple[dict[str, Any], ...], int]:
    """The whole lines of a journal and the number of bytes of a torn last line; UsageError as `journal_text`."""
    text = journal_text(path)
    return text.records, text.torn


def run_at(place: Path) -> Run:
    """The run at a path, its folder (.../sub-P01/run-1) or the journal in it; raises UsageError when there is none."""
    folder = place.parent if place.name == JOURNAL else place
    lines = journal_lines(folder / JOURNAL)[0] if (folder / JOURNAL).is_file() else ()
    if not lines:
        raise UsageError(
            f"{folder} holds no journal of a run; name a run, as data/walk_ratio/sourcedata/sub-P01/run-1."
        )
    _require_header(lines, folder / JOURNAL)
    return Run(folder, lines[0]["study"], lines[0]["participant"], lines[0]["run"], lines)


def _require_header(lines: tuple[dict[str, Any], ...], path: Path) -> None:
    if lines[0]["kind"] != "header":
        raise UsageError(
            f"{path} does not begin with its header, so nothing is known of the run; restore it from a copy."
        )
    if lines[0].get("format", 1) > FORMAT:
        raise UsageError(
            f"{path} was written in format {lines[0]['format']} by a later gaitlab; this one knows formats up to "
            f"{FORMAT}. Update gaitlab."
        )


def _read(folder: Path, study: str, participant: str, number: int) -> Run:
    path = folder / JOURNAL
    lines = journal_lines(path)[0] if path.exists() else ()
    if lines:
        _require_header(lines, path)
    return Run(folder, study, participant, number, lines)


def progress(run: Run) -> Progress:
    """What a run's journal says is done."""
    left: set[str] = set()
    begun: dict[str, int] = {}
    consented = False
    answers: dict[int, dict[str, Any]] = {}
    for line in run.lines:
        kind = line["kind"]
        if kind == "page":
            left.add(line["page"])
        elif kind == "consent":
            consented = bool(line["agreed"])
        elif kind in ("begin", "trial"):
            step = f"{'practice' if line['practice'] else 'trial'}-{line['number']}"
            if kind == "begin":
                begun[step] = begun.get(step, 0) + 1
            else:
                left.add(step)
                if not line["practice"]:
                    answers.pop(line["number"], None)  # a trial done again counts as what was answered last
                    answers[line["number"]] = answer_columns(line)
    return Progress(frozenset(left), begun, consented, bool(run.end), tuple(answers.items()))


def lock(file: IO[bytes], path: Path) -> None:
    """Keeps other processes off an open journal until it is closed; raises UsageError when one has it."""
    try:
        if os.name == "nt":  # pragma: no cover - exercised on Windows only
            import msvcrt

            place = file.tell()
            file.seek(0x7FFFFFFF)  # Windows locks bytes, not files: one far behind the journal's end
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined]
            file.seek(place)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        raise UsageError(
            f"{path.parent} is in use by another gaitlab; end that session first, or use another participant ID."
        ) from None


def in_use(journal: Path) -> bool:
    """Whether a gaitlab of this computer has the journal open; one at another computer need not be seen."""
    try:
        with open(journal, "rb") as file:
            lock(file, journal)
    except UsageError:
        return True
    except OSError:
        pass
    return False

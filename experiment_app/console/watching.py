"""A run's journal as it grows, read from outside: no lock, no write, only what is new since the last look."""

from __future__ import annotations

from pathlib import Path

from experiment_app.console.progress import Watched, after
from experiment_app.errors import UsageError
from experiment_app.opening import recorded_plan
from experiment_app.run_folder import JOURNAL, Run, in_use, run_at
from protocols.record import DamagedLineError, decode_line


class Watching:
    """The journal of one run and what it has said so far."""

    def __init__(self, run: Run) -> None:
        self.run = run
        plan = recorded_plan(run)
        self.title = plan.study.title
        self.watched = Watched(plan.total)
        self._place = 0

    def look(self) -> Watched:
        """What is known now: whole lines written since the last look are read, one that is being written is not yet."""
        with open(self.run.journal, "rb") as file:
            file.seek(self._place)
            whole, newline, _ = file.read().rpartition(b"\n")
        self._place += len(whole) + len(newline)
        for line in whole.decode("utf-8", "replace").split("\n") if whole else ():
            try:
                self.watched = after(self.watched, decode_line(line))
            except DamagedLineError:
                continue  # the run itself will say so; here it is only left out
        return self.watched


def watched_so_far(run: Run, total: int) -> Watched:
    """What the lines of a run tell that are there before a sitting."""
    watched = Watched(total, participant=run.participant)
    for line in run.lines:
        watched = after(watched, line)
    return watched


def newest_run(folder: Path, participant: str = "") -> Run:
    """The run of a study's folder that is going on, else that was written to last; of a participant if one is named.

    Raises UsageError when there is none.
    """
    found = folder.glob(f"sourcedata/sub-{participant or '*'}/run-*/{JOURNAL}")
    journals = sorted(found, key=lambda path: path.stat().st_mtime)
    if not journals:
        whose = f" of participant {participant}" if participant else ""
        raise UsageError(f"{folder} holds no run{whose}; name a study's folder of data, as data/walk_ratio.")
    newest = next(filter(in_use, reversed(journals)), journals[-1])  # copying and unzipping make old files new
    if not newest.stat().st_size:
        raise UsageError(f"{newest} is empty yet; try again in a moment.")
    return run_at(newest)

"""Says that a participant will not come back: the place is free for somebody else, everything recorded stays."""

from __future__ import annotations

from pathlib import Path

from experiment_app.errors import UsageError
from experiment_app.journal import reopen_journal
from experiment_app.participants.arrivals import unknown_participant
from experiment_app.run_folder import Run, check_participant, participant_runs
from protocols.record import Ended


def drop_out(folder: Path, participant: str) -> Run:
    """The participant's latest run, ended as "dropped out"; raises UsageError when there is nothing to give back.

    folder: DATA/<study>.
    """
    check_participant(participant)
    runs = participant_runs(folder.parent, folder.name, participant)
    if not runs:
        raise unknown_participant(folder, participant)
    run = runs[-1]
    if run.end:
        reasons = {"finished": "has finished, so the place is filled"}
        raise UsageError(f"participant {participant} {reasons.get(run.end, 'has given the place back already')}.")
    journal, run, _ = reopen_journal(run)
    with journal:
        journal.write([Ended(max((line.get("time", 0.0) for line in run.lines), default=0.0), "dropped out")])
    return run

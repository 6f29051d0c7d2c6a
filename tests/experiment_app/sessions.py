"""Short simulated sessions for tests of the application."""

from __future__ import annotations

from pathlib import Path

from experiment_app.loop import run_session
from experiment_app.opening import OpenRun, open_new, open_unfinished, unfinished_run
from experiment_app.simulated.observer import SimulatedParticipant, draw_observer
from experiment_app.windows.undrawn import UndrawnWindow
from protocols.session import Session, begin
from protocols.study_file import StudyFile
from tests.protocols.studies import short


def opened(data: Path, participant: str = "P01", study: StudyFile | None = None) -> OpenRun:
    """A new run of the short study, or the unfinished one of this participant again."""
    file = study or short()
    old = unfinished_run(data, file.study.study, participant)
    if old is not None:
        return open_unfinished(old, display={})
    return open_new(file, participant, data, display={}, simulated=True)


def play(run: OpenRun) -> Session:
    """Plays an open run to its end with a simulated participant."""
    observer = draw_observer(run.plan.study, run.participant_number, run.seed)
    person = SimulatedParticipant(run.plan.study, observer, run.seed)
    with run.journal as journal:
        return run_session(begin(run.plan), UndrawnWindow(person, journal.wait), journal)

"""Simulated participants through the same trials, loop and journal as real ones, without window or waiting."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from experiment_app.errors import UsageError
from experiment_app.loop import run_session
from experiment_app.opening import open_new, open_unfinished, refuse_mixed, unfinished_run
from experiment_app.run_folder import Run, participant_runs
from experiment_app.simulated.observer import SimulatedParticipant, draw_observer
from experiment_app.windows.undrawn import UndrawnWindow
from protocols.orders.design import default_seed
from protocols.session import begin
from protocols.study_file import StudyFile

DISPLAY = {"window": "undrawn"}


def simulate(study: StudyFile, participants: int, data: Path, seed: int = 0, first: int = 1) -> Iterator[Run]:
    """Runs participants S001, S002, ... to the end and yields each run; finished ones are left as they are.

    seed: the same seed gives the same participants, answers and responses. first: number of the first.
    Raises UsageError when real participants are in the folder, or the same ones simulated in another way.
    """
    refuse_mixed(data, study.study.study, "simulated")
    for number in range(first, first + participants):
        participant = f"S{number:03d}"
        own_seed = default_seed(f"{study.study.study}/{seed}", participant, 1)
        runs = participant_runs(data, study.study.study, participant)
        if runs:
            _refuse_stale(runs[-1], study, own_seed)
        yield runs[-1] if runs and runs[-1].end else _one(study, participant, data, own_seed)


def _one(study: StudyFile, participant: str, data: Path, seed: int) -> Run:
    unfinished = unfinished_run(data, study.study.study, participant)
    if unfinished is not None:
        opened = open_unfinished(unfinished, display=DISPLAY)
    else:
        opened = open_new(study, participant, data, display=DISPLAY, simulated=True, seed=seed)
    observer = draw_observer(opened.plan.study, opened.participant_number, opened.seed)
    with opened.journal as journal:
        person = SimulatedParticipant(opened.plan.study, observer, opened.seed)
        run_session(begin(opened.plan), UndrawnWindow(person, journal.wait), journal)
    return opened.run


def _refuse_stale(run: Run, study: StudyFile, seed: int) -> None:
    """Raises UsageError when a participant was simulated with another study file or seed."""
    for what, same in (("another version of the study file", run.header["study_hash"] == study.hash),
                       ("another seed", run.header["seed"] == seed)):  # fmt: skip
        if not same:
            raise UsageError(
                f"{run.folder} was simulated with {what}; choose another folder with --data, or remove that one."
            )

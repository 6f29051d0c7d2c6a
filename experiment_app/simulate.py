"""Simulated participants through the same trials, loop and journal as real ones, without window or waiting."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from experiment_app.errors import UsageError
from experiment_app.loop import run_session
from experiment_app.observer import SimulatedParticipant, draw_observer
from experiment_app.opening import open_new, open_unfinished, unfinished_run
from experiment_app.run_folder import Run, participant_runs
from experiment_app.windows.undrawn import UndrawnWindow
from protocols.design import default_seed
from protocols.session import begin
from protocols.study_file import Mistake, StudyFile

DISPLAY = {"window": "undrawn"}


def simulate(study: StudyFile, participants: int, data: Path, seed: int = 0, first: int = 1) -> Iterator[Run]:
    """Runs participants S001, S002, ... to the end and yields each run; finished ones are left as they are.

    seed: the same seed gives the same participants, answers and responses. first: number of the first.
    Raises StudyFileError when the study describes no simulated observers, UsageError when real participants
    are in the folder.
    """
    if study.study.simulation is None:
        message = "is missing; add simulation: preferred_walk_ratio: {ACTOR: {mean: ..., sd: ...}} to simulate"
        raise study.error([Mistake(("simulation",), message, on_key=True)])
    refuse_mixed(data, study.study.study, simulated=True)
    for number in range(first, first + participants):
        participant = f"S{number:03d}"
        runs = participant_runs(data, study.study.study, participant)
        if runs and runs[-1].end:
            yield runs[-1]
            continue
        yield _one(study, participant, data, default_seed(f"{study.study.study}/{seed}", participant, 1))


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


def refuse_mixed(data: Path, study: str, *, simulated: bool) -> None:
    """Raises UsageError when the folder holds runs of the other kind: simulated among real or real among simulated."""
    folder = data / study / "sourcedata"
    for person in sorted(folder.glob("sub-*")):
        runs = participant_runs(data, study, person.name.removeprefix("sub-"))
        if runs and bool(runs[0].header.get("simulated")) != simulated:
            here, wanted = ("real", "simulated") if simulated else ("simulated", "real")
            raise UsageError(
                f"{data / study} holds {here} participants ({person.name}); {wanted} ones must not be mixed "
                "with them: choose another folder with --data."
            )

"""Opens a run: decides new or continued, writes the header, makes the plan. Knows no window and no command."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from experiment_app.errors import UsageError
from experiment_app.imports import imported
from experiment_app.journal import Journal, create_journal, reopen_journal
from experiment_app.participants.arrivals import first_headers, participant_number
from experiment_app.run_folder import Run, new_run, participant_runs, progress, run_numbers
from protocols import resuming
from protocols.mistakes.consistency import shown_walks
from protocols.orders.assignment import group_of
from protocols.orders.design import default_seed
from protocols.plan import Plan, make_plan
from protocols.record import Continued, Header
from protocols.study import Study
from protocols.study_file import StudyFile, parse_study

RECORDED_VERSIONS = ("gaitlab", "numpy", "scipy", "moderngl", "glfw", "pydantic")


@dataclass(frozen=True)
class OpenRun:
    """A run ready to play: its journal is open and locked."""

    run: Run
    plan: Plan
    journal: Journal
    seed: int
    participant_number: int
    continued: bool
    group: Mapping[str, str] = field(default_factory=dict)  # that the program assigned
    torn: int = 0  # bytes of a line that was cut off, set aside when the run was opened again


def unfinished_run(data: Path, study: str, participant: str) -> Run | None:
    """The participant's latest run when it can be continued, else None."""
    runs = participant_runs(data, study, participant)
    return runs[-1] if runs and not runs[-1].end else None


def open_new(
    study: StudyFile,
    participant: str,
    data: Path,
    *,
    display: Mapping[str, Any],
    simulated: bool,
    pilot: bool = False,
    seed: int | None = None,
    again: bool = False,
) -> OpenRun:
    """A new run; raises UsageError when the participant has finished one and `again` is not set.

    Raises UsageError too when the folder holds runs of another kind: real, pilot and simulated ones never mix.
    """
    name = study.study.study
    refuse_mixed(data, name, kind_of(simulated, pilot))
    runs = [] if again else participant_runs(data, name, participant)
    if runs:
        how = {"": "has an unfinished run", "finished": "has already finished", "declined": "has declined"}
        raise UsageError(
            f"participant {participant} {how.get(runs[-1].end, 'has a run')} ({runs[-1].folder}); "
            "use another ID, or --new-run to record another run beside it."
        )
    number = max(run_numbers(data, name, participant), default=0) + 1 if again else 1
    order = participant_number(data, name, participant)
    group = group_of(study.study, order)
    run = new_run(data, name, participant, number)
    if seed is None:
        seed = default_seed(name, participant, number)
    header = Header(
        study=name,
        study_hash=study.hash,
        study_text=study.text,
        participant=participant,
        participant_number=order,
        run=number,
        seed=seed,
        simulated=simulated,
        keys=study.study.task.keys_for(order),
        versions=recorded_versions(),
        display=display,
        started=_utc_now(),
        walkers=_provenance(study.study),
        pilot=pilot,
        group=group,
        imported=imported(study.study),
    )
    plan = make_plan(study.study, seed, order, group)
    return OpenRun(run, plan, create_journal(run, header), seed, order, False, group)


def open_unfinished(run: Run, *, display: Mapping[str, Any]) -> OpenRun:
    """An unfinished run again, from its own copy of the study, at the first thing its policy has to be done."""
    header, plan = run.header, recorded_plan(run)
    journal, run, torn = reopen_journal(run)
    journal.write([Continued(0.0, _utc_now(), torn, display, recorded_versions(), run.interruption)])
    plan = resuming.remaining(plan, resuming.again(plan, progress(run)))
    return OpenRun(
        run, plan, journal, header["seed"], header["participant_number"], True, header.get("group") or {}, torn
    )


def recorded_plan(run: Run) -> Plan:
    """The whole plan of a recorded run, which follows from its header: the study it holds, the seed, the number."""
    header = run.header
    study = parse_study(f"{run.journal} (the study file it holds)", header["study_text"]).study
    return make_plan(study, header["seed"], header["participant_number"], header.get("group"))


def kind_of(simulated: bool, pilot: bool) -> str:
    """What a run is: "simulated", "pilot" or "real"."""
    return "simulated" if simulated else "pilot" if pilot else "real"


def refuse_mixed(data: Path, study: str, kind: str) -> None:
    """Raises UsageError when the folder holds runs of another kind: real, pilot and simulated runs never mix."""
    for header in first_headers(data, study):
        here = kind_of(bool(header.get("simulated")), bool(header.get("pilot")))
        if here != kind:
            raise UsageError(
                f"{data / study} holds {here} participants ({header['participant']}); {kind} ones must not be "
                "mixed with them: choose another folder with --data."
            )


def _provenance(study: Study) -> dict[str, str]:
    """Actor to where the walk comes from, and `style <name>` to where a style does, for all that the study shows."""
    from stimuli.actors import provenance_of
    from stimuli.methods.styles import style_named

    walks = [walk for walk in shown_walks(study) if walk.crowd is None]
    actors = {name: provenance_of(name) for name in {walk.actor for walk in walks}}
    styles = {walk.making.style for walk in walks if walk.making.style is not None}
    return dict(sorted(actors.items())) | {f"style {name}": style_named(name).provenance for name in sorted(styles)}


def _utc_now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds").replace("+00:00", "Z")


def recorded_versions() -> dict[str, str]:
    """Program to version, here and now, as a journal's header holds them."""
    versions = {"python": platform.python_version(), "system": platform.platform()}
    return versions | {name: _installed(name) for name in RECORDED_VERSIONS}


@cache
def _installed(name: str) -> str:
    """The version of a package, looked up once: simulated participants open many runs in one program."""
    try:
        return version(name)
    except PackageNotFoundError:
        return "unknown"

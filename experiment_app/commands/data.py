"""The commands about recorded data: export them, watch them grow, and note who drops out or withdraws."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter
from rich.console import Console

from experiment_app.errors import UsageError
from experiment_app.participants.derived import Derived, note_derived
from experiment_app.terminal import out, problems, say, typed

StudyFolder = Annotated[Path, Parameter(help="The study's folder of data, as data/walk_ratio.")]


def export(
    folder: StudyFolder,
    *,
    to: Annotated[
        Literal["bids", "psych-ds", "parquet", "csv"],
        Parameter(help="BIDS and Psych-DS are whole data sets to share; csv and parquet one table a file."),
    ],
    out_folder: Annotated[Path, Parameter(name="--out", help="Folder of the data set; new, or an earlier export.")],
) -> int:
    """Make a data set that others can read from the recorded runs: tables, courses, frames and a data dictionary.

    The journals stay as they are; made again from the same journals it is the same to the byte.
    """
    from analysis.exports.exporting import export as write_export

    with problems.status("Exporting"):
        done = write_export(folder, to, out_folder)
    for note in done.notes:
        problems.print(f"Note: {note}", style="yellow", markup=False)
    out.print(
        f"Participants: {done.participants}, runs: {done.runs}, files: {len(done.paths)}, in {out_folder}", markup=False
    )
    if to == "bids":
        out.print(
            f"Check it with: bids-validator-deno {typed(out_folder)}  (pip install 'gaitlab[validate]')", markup=False
        )
    note_derived(folder, "export", to, out_folder)
    return 0


def console(
    folder: StudyFolder,
    *,
    participant: Annotated[str, Parameter(help="The ID of who is to be watched; by default the newest run's.")] = "",
    once: Annotated[bool, Parameter(negative="", help="One line about the run, then end; for scripts.")] = False,
    ask_for: Annotated[
        Literal["pause", "resume", "stop"] | None, Parameter(name="--ask", help="Ask the run for this, then end.")
    ] = None,
) -> int:
    """Watch a participant at work, from another terminal: progress, time left, late frames, last responses.

    Keys pause the session, let it go on, or stop it. The run is never held up: the console reads the journal.
    """
    from experiment_app.console.asking import ask
    from experiment_app.console.progress import status
    from experiment_app.console.screen import show
    from experiment_app.console.watching import Watching, newest_run
    from experiment_app.run_folder import in_use

    run = newest_run(folder, participant)
    watching = Watching(run)
    if not watching.look().ended and not in_use(run.journal):
        problems.print(
            "Note: no gaitlab on this computer has this run open; it was killed, or goes on at another computer.",
            style="yellow", markup=False,
        )  # fmt: skip
    if ask_for is not None:
        ended = watching.look().ended
        if ended:
            raise UsageError(f"participant {run.participant}'s run is not going on ({ended}); nothing was asked of it.")
        ask(run.folder, ask_for)
        out.print(f"Asked the run of participant {run.participant} to {ask_for}.", markup=False)
    elif once:
        out.print(status(watching.look()), markup=False)
    else:
        show(watching, Console())
    return 0


def drop_out(
    folder: StudyFolder,
    *,
    participant: Annotated[str, Parameter(help="The ID of who will not come back.")],
) -> int:
    """Give back the place of a participant who will not come back; everything recorded stays.

    The next new participant takes the place: its group, its row of the square, its keys.
    """
    from experiment_app.participants.dropping_out import drop_out as give_place_back

    run = give_place_back(folder, participant)
    place = run.header["participant_number"]
    out.print(f"Participant {participant} has dropped out; place {place} is free again.", markup=False)
    return 0


def withdraw(
    folder: StudyFolder,
    *,
    participant: Annotated[str, Parameter(help="The ID of who withdraws.")],
    yes: Annotated[bool, Parameter(negative="", help="Do it without asking.")] = False,
) -> int:
    """Remove a participant who withdraws: journals, exports and reports. It cannot be undone.

    All that stays is that a place in the order of arrival is free again, for the next new participant.
    """
    from experiment_app.participants.withdrawal import plan_withdrawal
    from experiment_app.participants.withdrawal import withdraw as carry_out

    plan = plan_withdrawal(folder, participant)
    out.print(f"Everything of participant {participant} in {plan.person} will be deleted.", markup=False)
    for copy in plan.copies:
        out.print(f"So will the copy in {copy}.", markup=False)
    for made in plan.made:
        out.print(f"Then made again without {participant}: the {made.sentence}", markup=False)
    if not yes and not _sure(participant):
        out.print("Nothing was changed.", markup=False)
        return 1
    return 0 if carry_out(plan, lambda made: _make_again(folder, made), say) else 1


def _make_again(folder: Path, made: Derived) -> None:
    """Makes an export or a report again from the journals that are left; removes one nobody is left in."""
    from analysis.derived_files import export_of, names_written, remove_derived, report_of
    from analysis.exports.exporting import export as write_export
    from analysis.planned_analysis import PLAN, analyse
    from experiment_app.participants.arrivals import journals

    folder_of_it = Path(made.out)
    if not journals(folder):
        remove_derived(folder_of_it, report_of({}) if made.what == "report" else export_of({}))
    elif made.what == "report":
        own_plan = PLAN in names_written(folder_of_it, report_of({}))
        plan = (folder_of_it / PLAN).read_bytes().decode("utf-8") if own_plan else None
        analyse(folder, folder_of_it, over_edits=True, plan_text=plan)
    else:
        write_export(folder, made.to, folder_of_it, over_edits=True)


def _sure(participant: str) -> bool:
    """Whether the experimenter types the ID again; raises UsageError where nobody can answer."""
    if not sys.stdin.isatty():
        raise UsageError("nobody can be asked here; say --yes to delete the participant's data.")
    try:
        return input(f"This cannot be undone. Type {participant} to go on: ").strip() == participant
    except EOFError:
        return False

"""The commands about study files: copy one, check it, simulate it, see a demo of it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from experiment_app.commands.arguments import StudyArgument, require_ending
from experiment_app.errors import UsageError
from experiment_app.terminal import out, problems, say, typed, with_progress


def copy(
    study: Annotated[str, Parameter(help="Name of a shipped study.")],
    path: Annotated[Path, Parameter(help="The new file; never overwritten.")],
) -> int:
    """Copy a shipped study file, to change it into your own, and the schema beside it."""
    from experiment_app.checking.check import schema_text
    from protocols.study_file import find_study

    _, text = find_study(study)
    try:
        with open(path, "xb") as file:
            file.write(text)
    except FileExistsError:
        raise UsageError(f"{path} exists already; choose another name.") from None
    except OSError as error:
        raise UsageError(f"{path} cannot be made ({error.strerror}); is its folder there?") from None
    beside = path.parent / "study.schema.json"
    if not beside.exists():
        beside.write_text(schema_text(), encoding="utf-8")
    out.print(f"Copied to {path}. Edit it, then: gaitlab check {typed(path)}", markup=False)
    return 0


def schema(
    *, path: Annotated[Path, Parameter(name="--out", help="Where to write it.")] = Path("study.schema.json")
) -> int:
    """Write the JSON Schema of study files, with which editors complete and check them."""
    from experiment_app.checking.check import schema_text

    require_ending("--out", path, "a schema is JSON", "study.schema.json")
    path.write_text(schema_text(), encoding="utf-8")
    out.print(f"Schema written to {path}; name it in a study file's first line:", markup=False)
    out.print(f"# yaml-language-server: $schema={path.name}", markup=False)
    return 0


def check(
    study: StudyArgument,
    *,
    picture: Annotated[Path | None, Parameter(help="Also write the balance of the design as a picture (PNG).")] = None,
    participant_number: Annotated[
        int | None, Parameter(help="Also print what the participant with this number of arrival will see, as 7.")
    ] = None,
    seed: Annotated[int | None, Parameter(help="Seed of that participant's order; by default that of P07.")] = None,
) -> int:
    """Check a study file: every mistake with its line, the number of trials, how long it takes, the balance."""
    from experiment_app.checking.balance import what_participant_sees
    from experiment_app.checking.check import checked_study, notes_on, summary
    from experiment_app.checking.design_picture import write_design_picture

    require_ending("--picture", picture, "the picture is a PNG", "balance.png")
    if participant_number is not None and participant_number < 1:
        raise UsageError(f"--participant-number {participant_number}: numbers of arrival begin at 1.")
    file = checked_study(study)
    for note in notes_on(file):
        problems.print(f"Note: {note}", style="yellow", markup=False)
    for line in summary(file):
        out.print(line, markup=False)
    if participant_number is not None:
        for line in ["", *what_participant_sees(file.study, participant_number, seed)]:
            out.print(line, markup=False)
    if picture is not None:
        write_design_picture(file.study, picture)
        out.print(f"Picture of the balance: {picture}", markup=False)
    return 0


def simulate(
    study: StudyArgument,
    *,
    participants: Annotated[int | None, Parameter(help="How many; by default as many as the study plans.")] = None,
    data: Annotated[Path, Parameter(help="Folder of all data; not the one of real participants.")] = Path("simulated"),
    seed: Annotated[int, Parameter(help="The same seed gives the same participants and responses.")] = 0,
) -> int:
    """Run a study with simulated participants, without a window and without waiting."""
    from experiment_app.checking.check import checked_study
    from experiment_app.simulated.simulate import simulate as simulated_runs

    file = checked_study(study)
    count = file.study.participants.planned if participants is None else participants
    if count < 1:
        raise UsageError(f"--participants {count}: at least 1 is needed.")
    if data == Path("data"):
        raise UsageError("--data data: that is where real participants go; choose another folder, as simulated.")
    for _ in with_progress(simulated_runs(file, count, data, seed), count, "Simulating participants"):
        pass
    out.print(f"{count} simulated participants in {data / file.study.study}", markup=False)
    out.print(f"Analyse them with: gaitlab analyse {typed(data / file.study.study)} --out report", markup=False)
    return 0


def demo(
    study: StudyArgument = "walk_ratio",
    *,
    folder: Annotated[Path, Parameter(help="Where the demo writes its data, pictures and report.")] = Path(
        "gaitlab-demo"
    ),
    off_screen: Annotated[
        bool, Parameter(negative="", help="Do not open a window even where there is a screen.")
    ] = False,
) -> int:
    """See it work in a minute: a short session, simulated participants, the analysis and its report.

    With a screen you take part yourself; without one a simulated participant does, off-screen.
    """
    from experiment_app.demonstration.demo import run_demo

    return run_demo(study, folder, off_screen=off_screen, say=say, progress=with_progress)

"""The `gaitlab` command: reads arguments, prints sentences, chooses the exit status; heavy imports stay inside.

Exit status: 0 fine, 1 something failed, 2 wrong usage or study file.
"""

from __future__ import annotations

import sys
from fractions import Fraction
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import App, Parameter

from experiment_app.commands.bodies import body_commands
from experiment_app.commands.data import StudyFolder, console, drop_out, export, withdraw
from experiment_app.commands.motion import actor_commands, clip
from experiment_app.commands.styles import style_commands
from experiment_app.errors import RunError, UsageError
from experiment_app.terminal import out, problems, say, typed, with_progress

app = App(
    name="gaitlab",
    help="Perceptual experiments on walking virtual humans: from a study file to a report.",
    version=lambda: _version(),
    version_flags=["--version"],
    help_format="plaintext",  # markdown would cost a fifth of a second at every --help
)
app.command(clip)
app.command(actor_commands)
app.command(body_commands)
app.command(style_commands)
app.command(console)
app.command(export)
app.command(drop_out)
app.command(withdraw)

SHIPPED = sorted(p.name.removesuffix(".yaml") for p in (files("protocols") / "studies").iterdir() if ".yaml" in p.name)
StudyArgument = Annotated[
    str, Parameter(help=f"A study file (YAML), or the name of a shipped study: {', '.join(SHIPPED)}.")
]


def main() -> None:
    """Runs the command of sys.argv and exits."""
    sys.exit(run(sys.argv[1:]))


def run(arguments: list[str]) -> int:
    """Runs one command and returns its exit status; every foreseeable problem is one sentence, never a traceback."""
    try:
        result = app(arguments, exit_on_error=False, print_error=True, result_action="return_value")
        return result if isinstance(result, int) else 0
    except UsageError as error:
        problems.print(f"gaitlab: {error}", style="red", markup=False)
        return 2
    except KeyboardInterrupt:
        problems.print("gaitlab: interrupted; everything recorded so far is kept.", markup=False)
        return 1
    except RunError as error:
        problems.print(f"gaitlab: {error}", style="red", markup=False)
        return 1
    except OSError as error:
        problems.print(f"gaitlab: {_of_the_system(error)}", style="red", markup=False)
        return 2 if isinstance(error, FileNotFoundError) else 1
    except Exception as error:
        status = _status_of_named_error(error)
        if status is None:
            raise
        return status


def _of_the_system(error: OSError) -> str:
    """What the operating system refused, as "file: reason." without its number; our own sentences stay as they are."""
    if error.filename is None or not error.strerror:
        return str(error)
    files = [str(name) for name in (error.filename, error.filename2) if name is not None]
    return f"{' to '.join(files)}: {error.strerror[0].lower()}{error.strerror[1:]}."


def _status_of_named_error(error: Exception) -> int | None:
    """The exit status for an error of another room that is a sentence already; None for one that is a bug."""
    kinds = {base.__name__ for base in type(error).__mro__}
    if "CycloptsError" in kinds:
        return 2
    if "StudyFileError" in kinds:
        problems.print(str(error), style="red", markup=False)
        return 2
    if kinds & {"ActorError", "BodyError", "CoverageError", "AnalysisError", "MotionFileError"}:
        problems.print(f"gaitlab: {error}", style="red", markup=False)
        return 1 if "AnalysisError" in kinds else 2
    return None


@app.command(name="run")
def run_study(
    study: StudyArgument,
    *,
    participant: Annotated[str, Parameter(help="The participant's ID: letters and digits, as P01.")],
    data: Annotated[
        Path | None,
        Parameter(help="Folder of all data; each study has its own folder in it. By default data, or pilot."),
    ] = None,
    pilot: Annotated[
        bool, Parameter(negative="", help="A pilot run: kept in a folder of its own, never among real data.")
    ] = False,
    window: Annotated[bool, Parameter(negative="", help="In a window instead of full screen.")] = False,
    size: Annotated[str, Parameter(help="Size of the window.")] = "1280x720",
    display: Annotated[int, Parameter(help="Number of the display, from 1.")] = 1,
    refresh: Annotated[
        float, Parameter(help="Refresh rate in Hz, where the display reports none or a wrong one.")
    ] = 0.0,
    keyboard: Annotated[
        Literal["auto", "x-server", "psychtoolbox", "arrival"],
        Parameter(help="Where the times of keys come from; auto takes the best there is."),
    ] = "auto",
    devices: Annotated[
        list[Literal["mouse", "gamepad"]] | None,
        Parameter(name="--also", negative="", consume_multiple=True, help="What else answers, beside the keyboard."),
    ] = None,
    photodiode: Annotated[
        Literal["top-left", "top-right", "bottom-left", "bottom-right"] | None,
        Parameter(help="Corner for a square that is white while a walker is shown, for a photodiode."),
    ] = None,
    trigger: Annotated[
        str, Parameter(help="Line for trigger pulses, as serial:/dev/ttyUSB0 or parallel:/dev/parport0.")
    ] = "",
    lsl: Annotated[
        bool, Parameter(negative="", help="Announce trials, pauses and the end on a Lab Streaming Layer marker stream.")
    ] = False,
    seed: Annotated[
        int | None, Parameter(help="Seed of the trial order; by default made from study, ID and run.")
    ] = None,
    new_run: Annotated[bool, Parameter(negative="", help="Record another run of a participant who has one.")] = False,
    resume: Annotated[
        Literal["ask", "yes", "no"], Parameter(help="What to do with an unfinished run of this participant.")
    ] = "ask",
) -> int:
    """Run a study with a participant at the screen.

    An unfinished run is offered to be continued at the first unfinished trial, with the same order.
    """
    from experiment_app.live import ScreenOptions, run_live

    if not 0 <= refresh <= 1000:
        raise UsageError(f"--refresh {refresh:g}: write the display's rate in Hz, as 60, or leave it out.")
    screen = ScreenOptions(
        full_screen=not window, size=_size(size), display=display, refresh=refresh, keyboard=keyboard,
        devices=tuple(devices or ()), photodiode=photodiode,
    )  # fmt: skip
    return run_live(
        study, participant, data or Path("pilot" if pilot else "data"), screen=screen, trigger=trigger, lsl=lsl,
        seed=seed, new_run=new_run, pilot=pilot, resume=resume, ask=_ask, say=say,
    )  # fmt: skip


@app.command
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
    from experiment_app.commands.balance import what_participant_sees
    from experiment_app.commands.check import checked_study, design_picture, summary, text_notes

    if picture is not None and picture.suffix.lower() != ".png":
        raise UsageError(f"--picture {picture}: the picture is a PNG; let its name end in .png, as balance.png.")
    if participant_number is not None and participant_number < 1:
        raise UsageError(f"--participant-number {participant_number}: numbers of arrival begin at 1.")
    file = checked_study(study)
    for note in text_notes(file):
        problems.print(f"Note: {note}", style="yellow", markup=False)
    for line in summary(file):
        out.print(line, markup=False)
    if participant_number is not None:
        for line in ["", *what_participant_sees(file.study, participant_number, seed)]:
            out.print(line, markup=False)
    if picture is not None:
        design_picture(file, picture)
        out.print(f"Picture of the balance: {picture}", markup=False)
    return 0


@app.command
def simulate(
    study: StudyArgument,
    *,
    participants: Annotated[int | None, Parameter(help="How many; by default as many as the study plans.")] = None,
    data: Annotated[Path, Parameter(help="Folder of all data; not the one of real participants.")] = Path("simulated"),
    seed: Annotated[int, Parameter(help="The same seed gives the same participants and responses.")] = 0,
) -> int:
    """Run a study with simulated participants, without a window and without waiting."""
    from experiment_app.commands.check import checked_study
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


@app.command
def analyse(
    folder: StudyFolder,
    *,
    out_folder: Annotated[Path, Parameter(name="--out", help="Folder for tables, figures and report.")] = Path(
        "report"
    ),
) -> int:
    """Follow the study file's planned analysis: tables, figures and one self-contained report."""
    from analysis.planned_analysis import analyse as planned_analysis
    from experiment_app.participants.derived import Derived, note_derived

    with out.status("Analysing"):
        outcome = planned_analysis(folder, out_folder)
    for warning in outcome.warnings:
        problems.print(f"Note: {warning}", style="yellow", markup=False)
    for sentence in outcome.headlines:
        out.print(sentence, markup=False)
    for path in outcome.paths:
        out.print(f"  {path}", markup=False)
    names = tuple(path.relative_to(out_folder).as_posix() for path in outcome.paths)
    note_derived(folder, Derived("report", "", str(out_folder.resolve()), names))
    return 0


@app.command
def power(
    study: StudyArgument,
    *,
    participants: Annotated[
        list[int] | None,
        Parameter(negative="", consume_multiple=True, help="Numbers of participants; by default the planned one."),
    ] = None,
    experiments: Annotated[int, Parameter(help="How many experiments to simulate.")] = 10_000,
    seed: Annotated[int, Parameter(help="The same seed gives the same table, however the work is split.")] = 1,
    shard: Annotated[str, Parameter(help="Do the i-th of n parts only, as 1/8, for many machines.")] = "1/1",
    part: Annotated[Path | None, Parameter(name="--out", help="Write this part's counts (JSON) for --combine.")] = None,
    combine: Annotated[
        list[Path] | None,
        Parameter(negative="", consume_multiple=True, help="Join parts written with --out; nothing is simulated."),
    ] = None,
    plot: Annotated[Path | None, Parameter(help="Also draw power against participants (PNG).")] = None,
    workers: Annotated[int, Parameter(help="Processes; 0 for as many as there are cores.")] = 0,
    dask: Annotated[str, Parameter(help="Address of a dask scheduler that spreads the work over a cluster.")] = "",
) -> int:
    """How often each planned test would be significant, for the study's simulated observers.

    Every experiment goes through the study's own design and planned analysis.
    """
    import os

    from analysis.power.study import (
        dask_client,
        join_parts,
        power_figure,
        power_notes,
        read_part,
        simulate_power,
        write_part,
    )
    from experiment_app.commands.check import checked_study

    file = checked_study(study)
    notes = power_notes(file.text)
    if combine:
        result, missing = join_parts([read_part(path) for path in combine])
        notes += missing
    else:
        first, slash, last = shard.partition("/")
        if not (slash and first.isdecimal() and last.isdecimal() and 1 <= int(first) <= int(last)):
            raise UsageError(f"--shard {shard}: write i/n with i from 1 to n, as 1/8.")
        result = simulate_power(
            file.text, participants or (), experiments=experiments, seed=seed, shard=(int(first), int(last)),
            workers=workers or os.cpu_count() or 1, client=dask_client(dask) if dask else None,
            progress=lambda parts, count: with_progress(parts, count, "Simulating experiments"),
        )  # fmt: skip
    for row in result.table.to_dict("records"):
        name = f"t test of {row['name']}" if row["test"] == "t" else row["name"].replace(":", " x ")
        limits = f"[{row['ci_low']:.3f}, {row['ci_high']:.3f}]"
        out.print(f"{row['participants']:>5} participants  {name:<28} {row['power']:.3f}  {limits}", markup=False)
    out.print(f"Power with 95 % limits from {result.table['experiments'].iloc[0]} experiments.", markup=False)
    for note in notes:
        problems.print(f"Note: {note}", style="yellow", markup=False)
    for path in (part and write_part(part, result), plot and power_figure(plot, result)):
        if path:
            out.print(f"  {path}", markup=False)
    return 0


@app.command
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
    from experiment_app.commands.demo import run_demo

    return run_demo(study, folder, off_screen=off_screen, say=say, progress=with_progress)


@app.command
def doctor(
    *,
    off_screen: Annotated[bool, Parameter(negative="", help="Draw off-screen even where there is a display.")] = False,
    display: Annotated[int, Parameter(help="Number of the display, from 1.")] = 1,
    keys: Annotated[bool, Parameter(help="Measure how injected keys are stamped (X11).")] = True,
) -> int:
    """What this computer's graphics, display and keyboard give, measured: whether timing can be published, and why."""
    from experiment_app.commands.doctor import examine, lines

    for line in lines(examine(off_screen, display=display, keys=keys)):
        out.print(line, markup=False)
    return 0


@app.command
def certificate(
    run_folder: Annotated[Path, Parameter(help="A run, as data/walk_ratio/sourcedata/sub-P01/run-1.")],
    *,
    path: Annotated[Path | None, Parameter(name="--out", help="Write it to a file (Markdown) instead.")] = None,
) -> int:
    """The timing certificate of a run: frames, late frames, key times, a verdict, a paragraph for the paper."""
    from experiment_app.timing.page import certificate_of

    text = certificate_of(run_folder)
    if path is None:
        out.print(text, markup=False, end="")
    else:
        path.write_text(text, encoding="utf-8")
        out.print(f"  {path}", markup=False)
    return 0


@app.command
def film(
    study: StudyArgument,
    *,
    condition: Annotated[
        list[str] | None,
        Parameter(consume_multiple=True, help="factor=level, as actor=F1 speed=1.0; left out: the first level."),
    ] = None,
    seconds: Annotated[float, Parameter(help="Length of the film, s.")] = 4.0,
    rate: Annotated[str, Parameter(help="Frames per second, exactly; 60, 59.94 or 60000/1001.")] = "60",
    size: Annotated[str, Parameter(help="Size of the film; even numbers for videos.")] = "1280x720",
    lod: Annotated[int | None, Parameter(help="Level of detail for every frame, 0 the finest.")] = None,
    path: Annotated[
        Path, Parameter(name="--out", help="clip.mp4 (needs PyAV), clip.webp, or a folder for PNG pictures.")
    ] = Path("clip.mp4"),
) -> int:
    """Film a condition of a study off-screen at an exact frame rate; the frame times are read back and verified."""
    from experiment_app.commands.check import checked_study
    from experiment_app.pictures.film import condition_of, film_scenes, walking, write_film

    frame_rate = _frame_rate(rate)
    if not 0 < seconds <= 3600:
        raise UsageError(f"--seconds {seconds:g}: a film lasts up to an hour.")
    width, height = _size(size)
    if path.suffix.lower() in (".mp4", ".mkv", ".mov", ".webm") and (width % 2 or height % 2):
        raise UsageError(f"--size {size}: videos need an even width and height.")
    read = checked_study(study).study
    trial = condition_of(read, condition or ())
    count = max(round(seconds * frame_rate), 1)
    scenes = (walking(read, trial, float(number / frame_rate), lod) for number in range(count))
    frames = with_progress(film_scenes(scenes, (width, height)), count, "Drawing")
    said = write_film(iter(frames), frame_rate, path)
    out.print(f"{path}: {said}", markup=False)
    return 0


@app.command
def replay(
    run: Annotated[
        Path, Parameter(help="A run's folder, as data/walk_ratio/sourcedata/sub-P01/run-1, or its journal.")
    ],
    *,
    trial: Annotated[int | None, Parameter(help="Only the trial with this number; by default all.")] = None,
    practice: Annotated[bool, Parameter(negative="", help="Training trials instead.")] = False,
    path: Annotated[
        Path | None, Parameter(name="--film", help="Also film what was seen, with the response under it: clip.mp4.")
    ] = None,
    rate: Annotated[str, Parameter(help="Frames per second of the film.")] = "60",
    size: Annotated[str, Parameter(help="Size of the walker's picture in the film.")] = "1280x720",
) -> int:
    """Make again what a participant saw, frame by frame, and check that it is what was drawn.

    A film shows each frame for as long as it was on the screen, late ones too.
    """
    from experiment_app.replay.command import changed_versions, check_trial, film_trials, opened

    recorded, plan, trials = opened(run, trial, practice)
    if path is not None:
        width, height = _size(size)
        said = film_trials(plan, trials, path, _frame_rate(rate), (width, height), with_progress)
        out.print(f"{path}: {said}", markup=False)
    checked = list(with_progress((check_trial(plan, one) for one in trials), len(trials), "Checking"))
    for one in checked:
        out.print(one.sentence, markup=False)
    different = [one for one in checked if one.different]
    if different:
        for note in changed_versions(recorded):
            problems.print(f"Note: {note}.", style="yellow", markup=False)
        raise RunError(f"{len(different)} of {len(checked)} trials are not what was drawn.")
    return 0


@app.command
def gallery(
    *, folder: Annotated[Path, Parameter(name="--out", help="Folder for the pictures.")] = Path("docs/images")
) -> int:
    """Make every picture of the documentation's gallery page."""
    from experiment_app.pictures.gallery import make_gallery

    for path in make_gallery(folder):
        out.print(f"  {path}", markup=False)
    return 0


@app.command
def schema(
    *, path: Annotated[Path, Parameter(name="--out", help="Where to write it.")] = Path("study.schema.json")
) -> int:
    """Write the JSON Schema of study files, with which editors complete and check them."""
    from experiment_app.commands.check import schema_text

    path.write_text(schema_text(), encoding="utf-8")
    out.print(f"Schema written to {path}; name it in a study file's first line:", markup=False)
    out.print(f"# yaml-language-server: $schema={path.name}", markup=False)
    return 0


@app.command
def copy(
    study: Annotated[str, Parameter(help="Name of a shipped study.")],
    path: Annotated[Path, Parameter(help="The new file; never overwritten.")],
) -> int:
    """Copy a shipped study file, to change it into your own, and the schema beside it."""
    from experiment_app.commands.check import schema_text
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


@app.command(name="compare-methods")
def compare_methods_command(
    *actors: Annotated[str, Parameter(help="Names of actors, or folders of one person's captures.")],
    captures: Annotated[
        Path | None,
        Parameter(help="Folder of captures on which the poulaine's rebuilding is tested; by default the shared ones."),
    ] = None,
    out_folder: Annotated[Path, Parameter(name="--out", help="Folder for tables, figures and report.")] = Path(
        "methods"
    ),
) -> int:
    """Compare the ways of making a walk with captured walks: joint angles, foot slide, rebuilt poulaines, pictures."""
    from experiment_app.commands.methods import compare_methods

    if not actors:
        raise UsageError("name at least one actor, as gaitlab compare-methods F1.")
    report = compare_methods(actors, out_folder, captures, say, with_progress)
    for sentence in report.headlines:
        out.print(sentence, markup=False)
    for path in report.paths:
        out.print(f"  {path}", markup=False)
    return 0


def _size(text: str) -> tuple[int, int]:
    """Width and height from a text such as 1280x720; raises UsageError."""
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal() and 320 <= int(width) <= 16384 and 200 <= int(height) <= 16384):
        raise UsageError(f"--size {text}: write width x height in pixels, at least 320x200, as 1280x720.")
    return int(width), int(height)


def _frame_rate(text: str) -> Fraction:
    """Frames per second from a text such as 60, 59.94 or 60000/1001; raises UsageError."""
    try:
        rate = Fraction(text)
    except (ValueError, ZeroDivisionError):
        raise UsageError(f"--rate {text}: write a number, as 60, 59.94 or 60000/1001.") from None
    if not 1 <= rate <= 1000:
        raise UsageError(f"--rate {text}: a film has 1 to 1000 frames per second.")
    return rate


def _version() -> str:
    from importlib.metadata import version

    return version("gaitlab")


def _ask(question: str) -> bool:
    """Asks on the terminal; raises UsageError where nobody can answer."""
    if not sys.stdin.isatty():
        raise UsageError(f"{question} Nobody can answer here: say --resume yes or --resume no.")
    try:
        return input(f"{question} [Y/n] ").strip().lower() in ("", "y", "yes")
    except EOFError:
        return False

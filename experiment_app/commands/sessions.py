"""The commands about a participant at the screen: run, replay, and how good the timing is."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from experiment_app.commands.arguments import StudyArgument, frame_rate, picture_size, require_ending
from experiment_app.errors import RunError, UsageError
from experiment_app.terminal import out, problems, say, with_progress


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
        full_screen=not window, size=picture_size(size), display=display, refresh=refresh, keyboard=keyboard,
        devices=tuple(devices or ()), photodiode=photodiode,
    )  # fmt: skip
    return run_live(
        study, participant, data, screen=screen, trigger=trigger, lsl=lsl,
        seed=seed, new_run=new_run, pilot=pilot, resume=resume, ask=_ask, say=say,
    )  # fmt: skip


def doctor(
    *,
    off_screen: Annotated[bool, Parameter(negative="", help="Draw off-screen even where there is a display.")] = False,
    display: Annotated[int, Parameter(help="Number of the display, from 1.")] = 1,
    keys: Annotated[bool, Parameter(help="Measure how injected keys are stamped (X11).")] = True,
) -> int:
    """What this computer's graphics, display and keyboard give, measured: whether timing can be published, and why."""
    from experiment_app.timing.doctor import examine, lines

    for line in lines(examine(off_screen, display=display, keys=keys)):
        out.print(line, markup=False)
    return 0


def certificate(
    run_folder: Annotated[Path, Parameter(help="A run, as data/walk_ratio/sourcedata/sub-P01/run-1.")],
    *,
    path: Annotated[Path | None, Parameter(name="--out", help="Write it to a file (Markdown) instead.")] = None,
) -> int:
    """The timing certificate of a run: frames, late frames, key times, a verdict, a paragraph for the paper."""
    from experiment_app.timing.page import certificate_of

    require_ending("--out", path, "a certificate is Markdown", "certificate.md")
    text = certificate_of(run_folder)
    if path is None:
        out.print(text, markup=False, end="")
    else:
        path.write_text(text, encoding="utf-8")
        out.print(f"  {path}", markup=False)
    return 0


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
    from experiment_app.imports import other_imports
    from experiment_app.replay.command import changed_versions, check_trial, film_trials, opened

    recorded, plan, trials = opened(run, trial, practice)
    for note in other_imports(recorded.header.get("imported", {}), plan.study):
        problems.print(f"Note: {note}.", style="yellow", markup=False)
    if path is not None:
        width, height = picture_size(size)
        said = film_trials(plan, trials, path, frame_rate(rate), (width, height), with_progress)
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


def _ask(question: str) -> bool:
    """Asks on the terminal; raises UsageError where nobody can answer."""
    if not sys.stdin.isatty():
        raise UsageError(f"{question} Nobody can answer here: say --resume yes or --resume no.")
    try:
        return input(f"{question} [Y/n] ").strip().lower() in ("", "y", "yes")
    except EOFError:
        return False

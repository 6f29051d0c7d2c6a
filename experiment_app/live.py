"""A run with a person at the screen: new or continued run, window, signals, a clear word at the end."""

from __future__ import annotations

import gc
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal

from experiment_app.checking.check import check_names, checked_study, refuse_mistakes
from experiment_app.console.asking import listening
from experiment_app.console.status_line import status_line
from experiment_app.console.watching import watched_so_far
from experiment_app.crash_note import crash_note, leave_note
from experiment_app.crowds import plan_of
from experiment_app.errors import RunError, UsageError
from experiment_app.gaze.recording import gaze_watched, recording_gaze
from experiment_app.imports import other_imports
from experiment_app.loop import run_session
from experiment_app.markers.lsl import import_pylsl
from experiment_app.markers.stream import announcing
from experiment_app.markers.triggers import trigger_line, triggering
from experiment_app.opening import (
    OpenRun,
    kind_of,
    open_new,
    open_unfinished,
    recorded_plan,
    refuse_mixed,
    unfinished_run,
)
from experiment_app.participants.arrivals import first_headers
from experiment_app.participants.earlier import default_data, refuse_another_study, refuse_lookalike, tell_changes
from experiment_app.run_folder import Run, check_participant
from experiment_app.staging import crowd_of, differing_scenes, making_of
from experiment_app.terminal import typed
from experiment_app.timing.page import write_certificate
from experiment_app.walkers import cast, own_step_frequency
from experiment_app.windows.desktop import DesktopWindow, Device
from experiment_app.windows.display_loss import display_loss
from experiment_app.windows.key_times import Keyboard
from experiment_app.windows.patch import Corner, Patch
from protocols import resuming
from protocols.plan import Plan, TrialStep, walks_of
from protocols.session import STOPPED_BY_EXPERIMENTER, begin
from protocols.study_file import StudyFile, parse_study

SIGNALS = ("SIGTERM", "SIGINT", "SIGHUP", "SIGBREAK")


@dataclass(frozen=True)
class ScreenOptions:
    """Where and how a study is shown, and what gives keys; the arguments of `DesktopWindow`."""

    full_screen: bool = True
    size: tuple[int, int] = (1280, 720)
    display: int = 1
    refresh: float = 0.0
    keyboard: Keyboard = "auto"
    devices: tuple[Device, ...] = ()
    photodiode: Corner | None = None


def open_window(title: str, screen: ScreenOptions) -> DesktopWindow:
    """The window the options ask for."""
    return DesktopWindow(
        title=title,
        full_screen=screen.full_screen,
        size=screen.size,
        display=screen.display,
        refresh=screen.refresh,
        keyboard=screen.keyboard,
        devices=screen.devices,
        patch=Patch(screen.photodiode) if screen.photodiode else None,
    )


def run_live(
    study: str,
    participant: str,
    data: Path | None,
    *,
    screen: ScreenOptions,
    trigger: str = "",
    lsl: bool = False,
    seed: int | None,
    new_run: bool,
    pilot: bool = False,
    resume: Literal["ask", "yes", "no"],
    ask: Callable[[str], bool],
    say: Callable[[str], None],
) -> int:
    """Runs the study with a participant and returns the exit status; see the command's help for the arguments."""
    check_participant(participant)
    file = checked_study(study)
    data = data or default_data(study, file.study.study, pilot)
    refuse_mixed(data, file.study.study, kind_of(False, pilot))
    headers = first_headers(data, file.study.study)
    refuse_lookalike(headers, participant)
    old = None if new_run else unfinished_run(data, file.study.study, participant)
    if old is None:
        refuse_another_study(headers, file, data)
    tell_changes([header for header in headers if header["participant"] != participant], file, say)
    if old is not None and seed is not None:
        raise UsageError(f"--seed: participant {participant} has an unfinished run, which keeps its own order.")
    if old is not None and not _continues(old, file, resume, ask, say):
        return 2
    study_played = file.study if old is None else recorded_plan(old).study
    if lsl:
        import_pylsl()  # what is missing is said before a run is begun
    with (
        trigger_line(trigger) as line,
        open_window(file.study.title, screen) as window,
        gaze_watched(study_played.gaze, window) as gaze,
    ):
        if old is not None:
            opened = open_unfinished(old, display=window.description())
            if opened.torn:
                say(f"The last line was cut off; its {opened.torn} bytes were set aside beside {old.journal}.")
        else:
            opened = open_new(
                file,
                participant,
                data,
                display=window.description(),
                simulated=False,
                pilot=pilot,
                seed=seed,
                again=new_run,
            )
        say(f"Participant {participant} is number {opened.participant_number}{_group(opened)}.")
        number = opened.run.sittings + 1
        sitting = crash_note(opened.run.folder, number)
        kind = " --pilot" if pilot else ""
        command = f"gaitlab run {typed(study)} --participant {participant} --data {typed(data)}{kind}"

        def last_words(reason: str) -> None:
            leave_note(opened.run.folder, number, reason)
            print(f"\ngaitlab: {_early(opened.run, reason, command)}", file=sys.stderr, flush=True)

        with (
            sitting,
            opened.journal as journal,
            announcing(journal, lsl, opened.run, file.hash, window.now) as announced,
            status_line(
                triggering(announced, line, trigger, window.now),
                watched_so_far(opened.run, opened.plan.total),
                sys.stderr,
            ) as told,
            listening(window, opened.run.folder) as heard,
            ending_signals(window.request_end),
            display_loss(window.request_end, last_words),
            preparing(opened.plan, say),
            without_collection(),
        ):
            window.prepare(differing_scenes(opened.plan))
            session = run_session(begin(opened.plan), heard, recording_gaze(told, gaze))
    _certify(opened.run, say)
    return _farewell(opened, command, session.ended, say)


def _certify(run: Run, say: Callable[[str], None]) -> None:
    """Writes the timing certificate; where it cannot be, that is said, as it can be made from the journal any time."""
    try:
        say(f"Timing: {write_certificate(run)}")
    except OSError as error:
        say(
            f"The timing certificate was not written ({error.strerror}); "
            f"gaitlab certificate {typed(run.folder)} makes it."
        )


def _continues(old: Run, file: StudyFile, resume: str, ask: Callable[[str], bool], say: Callable[[str], None]) -> bool:
    """Whether the unfinished run is to be continued; says how to go on when it is not.

    Raises UsageError when the study file that the run was begun with does not let it go on.
    """
    kept = parse_study(f"{old.journal} (the study file it holds)", old.header["study_text"])
    gap = _minutes_since(old, say)
    why_not = resuming.refusal(kept.study.resume, gap)
    if why_not:
        raise UsageError(
            f"participant {old.participant}'s run in {old.folder} cannot be continued: {why_not}. It stays as it is; "
            f"--new-run records another run for {old.participant}."
        )
    done = len({line["number"] for line in old.lines if line["kind"] == "trial" and not line["practice"]})
    begins = " Its last block begins again." if kept.study.resume.policy == "block" else ""
    question = (
        f"Participant {old.participant} has an unfinished run with {done} trials done ({old.interruption}).{begins} "
        "Continue it?"
    )
    if resume == "no" or (resume == "ask" and not ask(question)):
        say(f"Nothing was changed. Use --new-run to record a new run for {old.participant}.")
        return False
    if others := other_imports(old.header.get("imported", {}), kept.study):
        raise UsageError(
            f"participant {old.participant}'s run cannot go on here: {'; '.join(others)}. Copy the file from the "
            f"computer where the run began, or say --new-run to record another run for {old.participant}."
        )
    if old.header["study_hash"] != file.hash:
        refuse_mistakes(kept, check_names(kept))
        say("The study file has changed since; the run goes on with the study it was begun with.")
    return True


def _minutes_since(old: Run, say: Callable[[str], None]) -> float:
    """Minutes of the wall clock since the run's latest record; 0 with a note when the clock was set back since."""
    if old.last_written is None:
        return 0.0
    gap = (datetime.now(UTC) - old.last_written).total_seconds() / 60.0
    if gap < -1.0:
        say("Note: the computer's clock reads earlier than the run's last record; how long ago that was is not known.")
    return max(gap, 0.0)


def _group(opened: OpenRun) -> str:
    """The group that the program assigned, for the experimenter, as " (viewing headset)"."""
    return f" ({', '.join(f'{name} {level}' for name, level in opened.group.items())})" if opened.group else ""


@contextmanager
def preparing(plan: Plan, say: Callable[[str], None]) -> Iterator[None]:
    """Makes every walker the plan will show while the participant reads, so that nothing is loaded between trials.

    Whoever is shown first is made first, so that a participant who reads fast need not wait. Crowds take some seconds
    and are made before. What cannot be made is refused before a run opens (`check_names`).
    """
    steps = [step for step in plan.steps if isinstance(step, TrialStep)]
    walks = list(dict.fromkeys(walk for step in steps for walk in walks_of(plan.study, step).values()))
    crowds = [walk.crowd for walk in walks if walk.crowd is not None]
    if crowds:
        say("Making the walks of the crowds, which takes some seconds.")
    for crowd in crowds:
        plan_of(crowd_of(crowd))

    def make() -> None:
        for walk in walks:
            if walk.crowd is None:
                cast(walk.actor, walk.body)
                own_step_frequency(walk.actor, walk.body, making_of(walk), walk.speed)

    thread = threading.Thread(target=make, name="walkers")
    thread.start()
    try:
        yield
    finally:
        thread.join()


@contextmanager
def without_collection() -> Iterator[None]:
    """Keeps Python's garbage collector out of trials; the loop collects between them."""
    was_on = gc.isenabled()
    gc.collect()
    gc.freeze()
    gc.disable()
    try:
        yield
    finally:
        gc.unfreeze()
        if was_on:
            gc.enable()


@contextmanager
def ending_signals(request_end: Callable[[str], None]) -> Iterator[None]:
    """Turns SIGTERM, SIGINT and SIGHUP into a request to end, so that the end is recorded like any other.

    A SIGHUP that is ignored stays so: nohup asks that a closed terminal ends nothing.
    """

    def end(number: int, _: object) -> None:
        request_end(signal.Signals(number).name)

    known = {name: getattr(signal, name) for name in SIGNALS if hasattr(signal, name)}
    if "SIGHUP" in known and signal.getsignal(known["SIGHUP"]) == signal.SIG_IGN:
        del known["SIGHUP"]
    before = {number: signal.signal(number, end) for number in known.values()}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _farewell(opened: OpenRun, again: str, ended: str, say: Callable[[str], None]) -> int:
    run = opened.run
    if ended == "finished":
        say(f"Participant {run.participant} has finished: {run.journal}")
        return 0
    if ended == "declined":
        say(f"Participant {run.participant} declined; only the refusal is stored.")
        return 0
    why = f"the computer asked it to end, {ended}" if ended.startswith("SIG") else ended
    message = _early(run, why, again)
    if ended in ("stopped", STOPPED_BY_EXPERIMENTER):
        say(message[0].upper() + message[1:])
        return 1
    raise RunError(message)


def _early(run: Run, why: str, again: str) -> str:
    return f"the run ended early ({why}); everything recorded is in {run.journal}. To go on: {again}"

"""`gaitlab demo`: a study in a minute, with you at a screen or with a simulated participant without."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from experiment_app.demonstration.short_study import short_study
from experiment_app.errors import UsageError
from experiment_app.live import ScreenOptions, run_live
from experiment_app.loop import run_session
from experiment_app.opening import open_new
from experiment_app.pictures.film import save_film, save_picture, save_strip
from experiment_app.scene import Scene
from experiment_app.simulated.observer import SimulatedParticipant, draw_observer
from experiment_app.simulated.simulate import simulate
from experiment_app.terminal import ShowProgress
from experiment_app.windows.offscreen import OffscreenWindow
from experiment_app.windows.screen import has_screen
from protocols.orders.assignment import group_of
from protocols.orders.design import default_seed
from protocols.plan import TrialStep
from protocols.record import Record
from protocols.session import begin
from protocols.study_file import StudyFile

SIZE = (640, 360)
FRAME_RATE = 6.0
"""Hz of the whole off-screen session: enough to exercise every page and trial within the minute."""

FILM_SIZE = (800, 450)
FILM_RATE = 25.0
PARTICIPANTS = 22
SEED = 2022


def run_demo(name: str, folder: Path, *, off_screen: bool, say: Callable[[str], None], progress: ShowProgress) -> int:
    """Runs the demo of a study into a folder that did not exist before, and says where everything is."""
    from analysis.planned_analysis import analyse

    study = short_study(name)
    folder = _fresh(folder)
    if off_screen or not has_screen() or not _take_part(study, folder, say):
        say("A simulated participant takes the study off-screen; every page and trial is drawn.")
        pictures = _watch_simulated(study, folder)
        say(f"  pages and a trial: {', '.join(p.name for p in pictures)} in {folder / 'pictures'}")
    film_trial(study, folder / "pictures")
    say(f"Film of a trial: {folder / 'pictures' / 'trial.webp'}, and its frames: trial-strip.png beside it")
    runs = simulate(study, PARTICIPANTS, folder / "data", SEED)
    for _ in progress(runs, PARTICIPANTS, "Simulating participants"):
        pass
    say(f"{PARTICIPANTS} simulated participants: {folder / 'data' / study.study.study}")
    outcome = analyse(folder / "data" / study.study.study, folder / "report")
    for sentence in outcome.headlines:
        say(f"  {sentence}")
    say("Tables and figures:")
    for path in outcome.paths:
        if path.suffix in (".csv", ".png"):
            say(f"  {path}")
    say(f"Report: {folder / 'report' / 'report.html'}")
    return 0


def _fresh(folder: Path) -> Path:
    """The folder, or folder-2, folder-3, ... : the first that does not exist, made."""
    chosen, number = folder, 1
    while chosen.exists():
        number += 1
        chosen = folder.with_name(f"{folder.name}-{number}")
    try:
        (chosen / "pictures").mkdir(parents=True)
    except OSError as error:
        raise UsageError(f"{chosen} cannot be made ({error.strerror}); choose another with --folder.") from None
    return chosen


def _take_part(study: StudyFile, folder: Path, say: Callable[[str], None]) -> bool:
    """The short study for the person at the screen; False when no window could be opened after all."""
    from experiment_app.errors import RunError

    say("Your turn: a short version of the study opens now. Press Escape to pause or to stop.")
    file = folder / study.name
    file.write_text(study.text, encoding="utf-8")
    try:
        run_live(
            str(file), "YOU", folder / "your-data", screen=ScreenOptions(full_screen=False), seed=None,
            new_run=False, resume="no", ask=lambda _: False, say=say,
        )  # fmt: skip
    except RunError as error:
        say(str(error))
    except UsageError as error:
        say(f"No window could be opened: {error}")
        return False
    return True


def _watch_simulated(study: StudyFile, folder: Path) -> list[Path]:
    """The first simulated participant's whole session, drawn off-screen; the pictures it saved."""
    saved: dict[str, Path] = {}
    seen: dict[str, int] = {}

    def look(_: float, scene: Scene, pixels: Callable[[], NDArray[np.uint8]]) -> None:
        name = _name(scene)
        seen[name] = seen.get(name, 0) + 1
        if name and name not in saved and seen[name] >= (20 if scene.visible else 2):
            saved[name] = folder / "pictures" / f"{name}.png"
            save_picture(pixels(), saved[name])

    seed = default_seed(f"{study.study.study}/{SEED}", "S001", 1)
    display = {"window": "off-screen", "pixels": list(SIZE), "frame_rate_hz": FRAME_RATE}
    opened = open_new(study, "S001", folder / "data", display=display, simulated=True, seed=seed)
    observer = draw_observer(study.study, opened.participant_number, seed)
    person = SimulatedParticipant(study.study, observer, seed)
    with (
        opened.journal as journal,
        OffscreenWindow(person, journal.wait, SIZE, FRAME_RATE, look, samples=2) as window,
    ):
        run_session(begin(opened.plan), window, journal)
    return list(saved.values())


def _name(scene: Scene) -> str:
    """A file name for what the scene shows, "" for an empty screen."""
    if scene.visible and (scene.page is None or scene.page.strip):
        return "trial"
    if scene.page is None:
        return ""
    if not scene.page.lines:
        return ""
    words = "".join(c if c.isalnum() else " " for c in scene.page.lines[0].text.lower()).split()
    return "page-" + "-".join(words)[:40]


class _Forgetful:
    """A recorder that keeps nothing, for a film that belongs to no run."""

    saved = True

    def write(self, records: list[Record]) -> None:
        """Drops the records."""


def film_trial(study: StudyFile, folder: Path) -> None:
    """A film and a strip of the first seconds of a simulated trial at 25 frames/s, drawn off-screen."""
    from protocols.plan import make_plan

    plan = make_plan(study.study, SEED, 1, group_of(study.study, 1))
    trial = next(step for step in plan.steps if isinstance(step, TrialStep) and not step.trial.practice)
    plan = replace(plan, steps=(trial,))
    person = SimulatedParticipant(study.study, draw_observer(study.study, 1, SEED), SEED)
    frames: list[NDArray[np.uint8]] = []

    def keep(_: float, scene: Scene, pixels: Callable[[], NDArray[np.uint8]]) -> None:
        if scene.visible:
            frames.append(pixels())

    with OffscreenWindow(person, lambda: None, FILM_SIZE, FILM_RATE, keep) as window:
        run_session(begin(plan), window, _Forgetful())
    count, share = (4, 1.0) if len(trial.order) > 1 else (8, 0.42)  # two walks need the whole width
    save_strip(frames[: int(2 * FILM_RATE)], folder / "trial-strip.png", count, share)
    save_film(frames, FILM_RATE, folder / "trial.webp")

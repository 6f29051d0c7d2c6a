"""Session after session through the off-screen window with the real renderer, and what the process keeps of them."""

from __future__ import annotations

import gc
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from experiment_app.loop import run_session
from experiment_app.opening import open_new
from experiment_app.simulated.observer import SimulatedParticipant, draw_observer
from experiment_app.windows.offscreen import OffscreenWindow
from protocols.session import begin
from protocols.study_file import parse_study
from tests.protocols.studies import changed

SIZE, FRAME_RATE = (64, 36), 3.0
"""Pixels and frames/s of simulated time: small and few, so that sessions, not pixels, take the time."""


@dataclass(frozen=True)
class Use:
    """What the process holds after so many trials: resident memory, MiB, and open file handles."""

    trials: int
    memory: float
    handles: int


def soak(folder: Path, trials: int, per_session: int) -> Iterator[Use]:
    """Plays sessions of `per_session` trials (a multiple of 24), a new window and journal each, until `trials`."""
    text = changed(
        ("repetitions: 4  ", f"repetitions: {per_session // 24}  "),
        ("minimum_looking_time: 2 ", "minimum_looking_time: 0.1 "),
    )
    study = parse_study("soak.yaml", text)
    done = number = 0
    while done < trials:
        number += 1
        participant = f"S{number:03d}"
        opened = open_new(study, participant, folder, display={"window": "off-screen"}, simulated=True, seed=number)
        observer = draw_observer(study.study, number, number)
        person = SimulatedParticipant(study.study, observer, number)
        with (
            opened.journal as journal,
            OffscreenWindow(person, journal.wait, SIZE, FRAME_RATE, lambda *_: None, samples=1) as window,
        ):
            session = run_session(begin(opened.plan), window, journal)
        assert session.ended == "finished"
        done += per_session
        gc.collect()
        yield Use(done, resident_memory(), open_handles())


def resident_memory() -> float:
    """MiB of memory that is in use by this process now (Linux)."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20


def open_handles() -> int:
    """Open file handles of this process (Linux)."""
    return len(os.listdir("/proc/self/fd"))


def growth(uses: list[Use]) -> float:
    """MiB per 1000 trials: the slope of memory over trials by least squares, the first use left out as warming up."""
    later = uses[1:]
    mean_trials = sum(use.trials for use in later) / len(later)
    mean_memory = sum(use.memory for use in later) / len(later)
    top = sum((use.trials - mean_trials) * (use.memory - mean_memory) for use in later)
    return 1000.0 * top / sum((use.trials - mean_trials) ** 2 for use in later)

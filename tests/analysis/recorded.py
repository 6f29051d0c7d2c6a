"""Journals for the tests, written with the same lines as a real run, from made-up participants."""

from __future__ import annotations

import itertools
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from protocols.record import Answered, Consented, Ended, Header, TrialRecord, encode_line
from tests.journals import rechained

CAPTURED = {"F1": 0.00690, "F2": 0.00560, "M1": 0.00700, "M2": 0.00700}
PERCEIVED = {
    "F1": (0.00573, 0.00065),
    "F2": (0.00595, 0.00062),
    "M1": (0.00658, 0.00051),
    "M2": (0.00651, 0.00058),
}


def study_text() -> str:
    return (files("protocols.studies") / "walk_ratio.yaml").read_text(encoding="utf-8")


def journal_lines(
    participant: str,
    number: int,
    text: str | None = None,
    *,
    study: str = "walk_ratio",
    sex: str | None = None,
    simulated: bool = True,
    reason: str | None = "finished",
    trials: int | None = None,
) -> list[str]:
    """A run of walk_ratio by somebody who prefers the walk ratios of Niay 2022, table 3.4."""
    rng = np.random.default_rng([7, number])
    preferred = {actor: rng.normal(mean, sd) for actor, (mean, sd) in PERCEIVED.items()}
    records: list[Any] = [
        Header(
            study,
            "c0ffee" * 10,
            text or study_text(),
            participant,
            number,
            1,
            number,
            simulated,
            {"lower": "left", "raise": "right", "confirm": "enter", "break": "b"},
            {"gaitlab": "0.1.0", "python": "3.11"},
            {"width": 1920},
            "2026-11-22T10:00:00Z",
            walkers={"F1": "modelled", "F2": "4 cycles captured, 21 modelled", "M1": "modelled", "M2": "modelled"},
        ),
        Consented(1.0, True),
        Answered(2.0, "age", 20 + number % 13),
        Answered(3.0, "sex", sex or ("female", "male")[number % 2]),
        Answered(4.0, "vision", "yes"),
    ]
    conditions = list(itertools.product(CAPTURED, (0.8, 1.0, 1.2), (80, 120))) * 4
    order = rng.permutation(len(conditions))
    for place, index in enumerate(order[:trials], start=1):
        actor, speed, start = conditions[index]
        ratio = max(0.002, preferred[actor] + rng.normal(0, 0.0005))
        frequency = float(np.clip(np.sqrt(60 * speed / ratio), 80, 120))
        length = 60 * speed / frequency
        records.append(
            TrialRecord(
                10.0 * place,
                place,
                False,
                1,
                1,
                int(index) // 24 + 1,
                {"actor": actor, "speed": speed, "start": start},
                {"step_frequency": frequency, "step_length": length, "walk_ratio": length / frequency},
                10.0 * place - 8,
                float(rng.gamma(4, 2)),
                int(rng.integers(1, 6)),
                1,
                0,
                0,
                {"speed": speed, "step_frequency": frequency},
                480,
                0,
            )
        )
    if reason:
        records.append(Ended(2000.0, reason))
    return rechained(encode_line(record) for record in records)


def write_run(folder: Path, participant: str, lines: list[str], run: int = 1) -> Path:
    path = folder / "sourcedata" / f"sub-{participant}" / f"run-{run}" / "journal.jsonl"
    path.parent.mkdir(parents=True)
    path.write_text("".join(line + "\n" for line in lines), encoding="utf-8")
    return path


def write_study(folder: Path, participants: int, text: str | None = None, **options: Any) -> Path:
    for number in range(1, participants + 1):
        write_run(folder, f"P{number:02d}", journal_lines(f"P{number:02d}", number, text, **options))
    return folder

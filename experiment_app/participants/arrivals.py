"""Who takes part in a study, from all journals of its folder: the order of arrival and the places given back.

Only first and last lines are read, so that a folder of hundreds of runs is looked through in a moment.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from experiment_app.errors import UsageError
from experiment_app.run_folder import JOURNAL, journal_lines, run_numbers, study_folder
from protocols.orders.assignment import Arrival, place_of
from protocols.record import DamagedLineError, decode_line

END_BYTES = 4096
"""Bytes at the end of a journal that hold its last line when that is an end."""

WITHDRAWN = "withdrawn.jsonl"
"""Beside sourcedata: one line for every place given back, and nothing else of those who withdrew."""


def journals(folder: Path) -> list[Path]:
    """Every journal in a study's folder (DATA/<study>), sorted."""
    return sorted(folder.glob(f"sourcedata/sub-*/run-*/{JOURNAL}"))


def unknown_participant(folder: Path, participant: str) -> UsageError:
    """The error for an ID that a study's folder (DATA/<study>) does not hold; it names those there are."""
    data = folder / "sourcedata"
    if not data.is_dir():
        return UsageError(f"{folder} is no study's folder of data; name one, as data/walk_ratio.")
    known = ", ".join(sorted(person.name.removeprefix("sub-") for person in data.glob("sub-*")))
    return UsageError(f"there is no participant {participant} in {folder}; there are: {known or 'none'}.")


def header_of(journal: Path) -> dict[str, Any] | None:
    """The header of a journal from its first line alone; None where it cannot be read, as of a run that never began."""
    try:
        with open(journal, encoding="utf-8") as file:
            line = decode_line(file.readline())
    except (OSError, ValueError):
        return None
    return line if line["kind"] == "header" else None


def participant_number(data: Path, study: str, participant: str) -> int:
    """The participant's place in the order of arrival, from 1; the same in every run of the participant.

    A place that somebody who declined, withdrew or dropped out has given back is filled first, so that the design
    stays balanced.
    """
    return place_of(participant, arrivals(data, study), places_given_back(study_folder(data, study)))


def arrivals(data: Path, study: str) -> list[Arrival]:
    """Who has a place in the order of arrival, and how each participant's latest run ended."""
    known = []
    for person in sorted((study_folder(data, study) / "sourcedata").glob("sub-*")):
        numbers = run_numbers(data, study, person.name.removeprefix("sub-"))
        for latest in [person / f"run-{number}" / JOURNAL for number in reversed(numbers)]:
            header = header_of(latest)
            if header is None:
                continue
            known.append(Arrival(person.name.removeprefix("sub-"), int(header["participant_number"]), last_end(latest)))
            break
    return known


def last_end(journal: Path) -> str:
    """Why a run ended, from the last line of its journal alone; "" when that is no end."""
    with open(journal, "rb") as file:
        file.seek(max(file.seek(0, os.SEEK_END) - END_BYTES, 0))
        tail = file.read().rstrip(b"\n").split(b"\n")[-1]
    try:
        line = decode_line(tail.decode("utf-8"))
    except (DamagedLineError, UnicodeDecodeError):
        return ""
    return str(line["reason"]) if line["kind"] == "end" else ""


def places_given_back(folder: Path) -> list[int]:
    """The places in the order of arrival that participants of a study's folder gave back by withdrawing."""
    path = folder / WITHDRAWN
    if not path.exists():
        return []
    return [int(line["participant_number"]) for line in journal_lines(path)[0]]


def first_headers(data: Path, study: str) -> list[dict[str, Any]]:
    """The header of every participant's first run, by participant; only first lines are read, damaged ones skipped."""
    headers = []
    for person in sorted((study_folder(data, study) / "sourcedata").glob("sub-*")):
        for path in sorted(person.glob(f"run-*/{JOURNAL}"))[:1]:
            header = header_of(path)
            if header is not None:
                headers.append(header)
    return headers

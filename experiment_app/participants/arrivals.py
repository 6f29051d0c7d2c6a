"""Who takes part in a study, from all journals of its folder: the order of arrival and the places given back.

Only first lines and ends are read, so that a folder of hundreds of runs is looked through in a moment.
"""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import Any

from experiment_app.errors import UsageError
from experiment_app.run_folder import JOURNAL, journal_lines, run_numbers, study_folder
from protocols.orders.assignment import Arrival, place_of
from protocols.record import DamagedLineError, decode_line
from protocols.resuming import over

END_BYTES = 4096
"""Bytes at the end of a journal that hold its last lines where the run is over."""

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
            known.append(Arrival(person.name.removeprefix("sub-"), int(header["participant_number"]), why_over(latest)))
            break
    return known


def why_over(journal: Path) -> str:
    """Why a run is over, from the end of its journal alone; "" while it can go on.

    The last line need not be the one: the pulse that announced the end, or what went wrong after it, may follow.
    """
    with open(journal, "rb") as file:
        file.seek(max(file.seek(0, os.SEEK_END) - END_BYTES, 0))
        tail = file.read().split(b"\n")
    reasons = []
    for part in (part for part in tail if b'"end"' in part):  # all are looked at for every participant who arrives
        with suppress(DamagedLineError, UnicodeDecodeError):  # cut off by this reader, or by a kill
            line = decode_line(part.decode("utf-8"))
            reasons += [str(line["reason"])] if line["kind"] == "end" else []
    return over(reasons)


def places_given_back(folder: Path) -> list[int]:
    """The places in the order of arrival that participants of a study's folder gave back by withdrawing."""
    path = folder / WITHDRAWN
    if not path.exists():
        return []
    return [int(line["participant_number"]) for line in journal_lines(path)[0]]


def first_headers(data: Path, study: str) -> list[dict[str, Any]]:
    """The header of every participant's first run that has one, by participant; only first lines are read."""
    headers = []
    for person in sorted((study_folder(data, study) / "sourcedata").glob("sub-*")):
        numbers = run_numbers(data, study, person.name.removeprefix("sub-"))
        found = (header_of(person / f"run-{number}" / JOURNAL) for number in numbers)
        headers += [header for header in found if header is not None][:1]
    return headers

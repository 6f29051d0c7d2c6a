"""Takes a participant out of a study: journals, exports and reports; only a free place in the order stays.

The order of steps is such that a kill between any two of them leaves nothing that the same command would not finish.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from experiment_app.journal import append_line
from experiment_app.participants.arrivals import (
    WITHDRAWN,
    arrivals,
    header_of,
    journals,
    places_given_back,
    unknown_participant,
)
from experiment_app.participants.derived import Derived, derived
from experiment_app.run_folder import JOURNAL, check_participant, journal_text, lock
from protocols.record import Withdrawn, encode_line
from stimuli.whole_file import force_file

LEAVING = ".withdrawing-sub-"
"""Start of the name that a participant's folder has between the first and the last step."""


@dataclass(frozen=True)
class Withdrawal:
    """What a withdrawal will touch.

    folder: DATA/<study>; person: the participant's folder, there or half removed; copies: folders of the same runs
    elsewhere in the study's folder; files: how many these hold.
    made: exports and reports that are made again from those who stay; gone: those that are not where they were made.
    """

    folder: Path
    participant: str
    person: Path
    copies: tuple[Path, ...]
    files: int
    made: tuple[Derived, ...]
    gone: tuple[Derived, ...]


def plan_withdrawal(folder: Path, participant: str) -> Withdrawal:
    """What a withdrawal will touch; raises UsageError when there is no such participant or their run is going on."""
    check_participant(participant)
    data = folder / "sourcedata"
    person = data / f"sub-{participant}"
    if not person.is_dir():
        person = data / f"{LEAVING}{participant}"  # a withdrawal that was killed half-way is finished
    if not person.is_dir():
        raise unknown_participant(folder, participant)
    copies = _copies(folder, person)
    for journal in [*person.glob(f"run-*/{JOURNAL}"), *(copy / JOURNAL for copy in copies)]:
        with open(journal, "rb") as file:
            lock(file, journal)
    files = sum(path.is_file() for place in (person, *copies) for path in place.rglob("*"))
    made, gone = derived(folder)
    return Withdrawal(folder, participant, person, tuple(copies), files, tuple(made), tuple(gone))


def _copies(folder: Path, person: Path) -> list[Path]:
    """Folders of runs elsewhere in the study's folder that hold the same recording as one of the participant's."""
    own = [header for journal in person.glob(f"run-*/{JOURNAL}") if (header := header_of(journal)) is not None]
    others = [journal for journal in journals(folder) if journal.parent.parent != person]
    return [journal.parent for journal in others if header_of(journal) in own]


def withdraw(plan: Withdrawal, remake: Callable[[Derived], None], say: Callable[[str], None]) -> bool:
    """Carries a withdrawal out; False when something made from the participant's data could not be made again.

    remake: makes one export or report again from the journals that are left, or removes it where none is; its
    problem is told, not raised.
    """
    place = _place(plan)
    for number, copy in enumerate(plan.copies, start=1):  # into the folder that is removed, which a kill does not stop
        os.rename(copy, _free_name(plan.person / f"copy-{number}"))
        with suppress(OSError):
            copy.parent.rmdir()
    leaving = plan.person.with_name(f"{LEAVING}{plan.participant}")
    if plan.person != leaving:
        os.rename(plan.person, leaving)
    if place is not None and place not in places_given_back(plan.folder):
        _give_back(plan.folder / WITHDRAWN, place)
    shutil.rmtree(leaving)
    say(f"Removed participant {plan.participant} from {plan.folder / 'sourcedata'} (files: {plan.files}).")
    if place is not None:
        say(_what_becomes_of(plan.folder, place))
    whole, nobody = True, not journals(plan.folder)
    done = "Removed, since nobody is left in it" if nobody else f"Made again without participant {plan.participant}"
    for made in plan.made:
        try:
            remake(made)
            say(f"{done}: {made.sentence}.")
        except Exception as error:  # whatever it is, the others must still be made again
            whole = False
            why = str(error).rstrip(".")
            say(f"NOT made again: {made.sentence} ({why}). It may still hold {plan.participant}: delete it.")
    for made in plan.gone:
        say(f"No longer there: {made.sentence}. If it was moved, it still holds {plan.participant}: delete it.")
    say("Copies made by hand, backups and anything published are out of reach; ask whoever keeps them.")
    return whole


def _give_back(path: Path, place: int) -> None:
    """Adds a place to those given back; what a power cut left of a line, which this command adds again, goes first."""
    torn = journal_text(path).torn if path.exists() else 0
    with open(path, "ab", buffering=0) as file:
        file.truncate(file.tell() - torn)
        file.seek(0, os.SEEK_END)
        append_line(file, encode_line(Withdrawn(place)))
        force_file(file.fileno())


def _what_becomes_of(folder: Path, place: int) -> str:
    """What is said of a place that was given back; where data of several computers meet, another may have it too."""
    others = [one.participant for one in arrivals(folder.parent, folder.name) if one.place == place]
    if others:
        return f"Place {place} in the order of arrival stays taken, by {', '.join(others)}."
    return f"Place {place} in the order of arrival is free again; the next new participant takes it."


def _free_name(path: Path) -> Path:
    """The path, or with the first letters added to it that make it new."""
    while path.exists():
        path = path.with_name(f"{path.name}x")
    return path


def _place(plan: Withdrawal) -> int | None:
    """The participant's place in the order of arrival; None when no header can be read any more."""
    for journal in sorted(plan.person.glob(f"run-*/{JOURNAL}")):
        header = header_of(journal)
        if header is not None:
            return int(header["participant_number"])
    return None

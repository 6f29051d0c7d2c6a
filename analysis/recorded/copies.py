"""Journals that stand elsewhere than where they were recorded: folders that were copied, renamed, or put together
from several computers.

A journal does not say that it is a copy, so data would count twice; and two computers may have given one ID to two
people. Runs with the same header are one recording. A recording counts as its folder says, so that whoever puts
folders together decides, by renaming, whose is whose; as its journal says where the folder's name is no ID.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any, ClassVar, Protocol, TypeVar

from analysis.errors import AnalysisError, listed


class Recorded(Protocol):
    """A run that was read: its journal's path and header, and whose run it is; a dataclass."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def path(self) -> Path:
        """Of the journal."""

    @property
    def header(self) -> Mapping[str, Any]:
        """The journal's first line."""

    @property
    def participant(self) -> str:
        """The participant's ID."""

    @property
    def number(self) -> int:
        """Of the run, from 1."""


R = TypeVar("R", bound=Recorded)

FOLDER = re.compile(r"sub-([A-Za-z0-9]+)/run-([1-9][0-9]*)")


def without_copies(runs: Sequence[R]) -> tuple[list[R], list[tuple[R, str]], list[str]]:
    """The runs, each recording once; the others, with why they are left out; and sentences on runs in folders of
    other names.

    Raises AnalysisError where two recordings claim to be the same run and no folder's name tells them apart.
    """
    copies: dict[Path, str] = {}
    counted: dict[Path, R] = {}
    for same in _recordings(runs):
        kept = max(same, key=lambda run: run.path.stat().st_size)
        copies |= {run.path: _copy(run, kept) for run in same if run is not kept}
        counted[kept.path] = kept if any(map(_at_home, same)) else _as_its_folder_says(kept)
    once = [counted[run.path] for run in runs if run.path in counted]
    _refuse_clash(once)
    moved = [_moved(run, counted[run.path]) for run in runs if run.path in counted and not _at_home(run)]
    return once, [(run, copies[run.path]) for run in runs if run.path in copies], moved


def not_read(folder: Path, read: Sequence[Path]) -> list[str]:
    """A sentence on journals under a study's sourcedata that stand where none is looked for, as synchronising and
    unpacking leave them; read: those that were found. Hidden folders, which hold old versions, are passed over.
    """
    others = sorted(set((folder / "sourcedata").rglob("journal*.jsonl")) - set(read))
    inside = [other.relative_to(folder) for other in others]
    named = [place.as_posix() for place in inside if not any(part.startswith(".") for part in place.parts)]
    if not named:
        return []
    names = listed(named, 3)
    return [
        f"Not read: {names}. A recording counts when it is called journal.jsonl and lies in a run's folder of its own, "
        "as sourcedata/sub-P01/run-2."
    ]


def _recordings(runs: Sequence[R]) -> Iterator[list[R]]:
    """The runs that hold the same recording, one at home first."""
    for _, alike in groupby(sorted(runs, key=_header), key=_header):
        yield sorted(alike, key=lambda run: not _at_home(run))


def _copy(copy: Recorded, kept: Recorded) -> str:
    if kept.path.read_bytes().startswith(copy.path.read_bytes()):
        return f"a copy of run {copy.number} in {_folder(copy)}"
    return f"a copy of run {copy.number} in {_folder(copy)}, which went on otherwise than the one in {_folder(kept)}"


def _as_its_folder_says(run: R) -> R:
    named = FOLDER.fullmatch(_folder(run))
    return replace(run, participant=named[1], number=int(named[2])) if named else run


def _refuse_clash(runs: Sequence[Recorded]) -> None:
    known: dict[tuple[str, int], Recorded] = {}
    for run in runs:
        other = known.setdefault((run.participant, run.number), run)
        if other is not run:
            raise AnalysisError(
                f"{_folder(other)} and {_folder(run)} hold two recordings, begun {_begun(other)} and {_begun(run)}, "
                f"that both are run {run.number} of participant {run.participant}. Rename the folder of one of them, "
                f"sub-{run.participant}B if it is another person's, run-{run.number + 1} if it is the same person "
                "again; it then counts as what its folder says."
            )


def _moved(before: Recorded, after: Recorded) -> str:
    whose = f"{_folder(before)} holds run {before.number} of participant {before.participant}"
    if (before.participant, before.number) == (after.participant, after.number):
        return f"{whose}; it counts as that."
    return f"{whose}; as its folder says, it counts as run {after.number} of participant {after.participant}."


def _header(run: Recorded) -> str:
    return json.dumps(run.header, sort_keys=True)


def _begun(run: Recorded) -> str:
    return str(run.header.get("started", "at an unknown time"))


def _folder(run: Recorded) -> str:
    return "/".join(run.path.parts[-3:-1])


def _at_home(run: Recorded) -> bool:
    return _folder(run) == f"sub-{run.header.get('participant')}/run-{run.header.get('run')}"

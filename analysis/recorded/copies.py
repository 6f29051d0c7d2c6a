"""Journals that stand elsewhere than where they were recorded: folders that were copied, renamed, or put together
from several computers.

A journal does not say that it is a copy, so data would count twice; and two computers may have given one ID to two
people. Runs with the same header are one recording. Two recordings under one ID and number are told apart by the
names of their folders, so that whoever merges folders decides, by renaming, whose is whose.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any, ClassVar, Protocol, TypeVar

from analysis.errors import AnalysisError


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
    once, copies = _each_recording(runs)
    clashing = _clashing(once)
    told = [_as_its_folder_says(run) if run in clashing and not _at_home(run) else run for run in once]
    if still := _clashing(told):
        raise AnalysisError(_not_told_apart(still[0], still[1]))
    moved = [_moved(before, after) for before, after in zip(once, told, strict=True) if not _at_home(before)]
    return told, copies, moved


def _each_recording(runs: Sequence[R]) -> tuple[list[R], list[tuple[R, str]]]:
    """One run of each recording, in the order given, and its copies: the longest counts, of equals the one at home."""
    kept: dict[int, R] = {}
    copies: dict[int, str] = {}
    places = sorted(range(len(runs)), key=lambda place: (_claimed(runs[place]), str(runs[place].header)))
    for _, group in groupby(places, key=lambda place: (_claimed(runs[place]), runs[place].header)):
        same = sorted(group, key=lambda place: (-runs[place].path.stat().st_size, not _at_home(runs[place]), place))
        kept[same[0]] = runs[same[0]]
        copies |= {place: _copy(runs[place], runs[same[0]]) for place in same[1:]}
    return [kept[place] for place in sorted(kept)], [(runs[place], copies[place]) for place in sorted(copies)]


def _copy(copy: Recorded, kept: Recorded) -> str:
    if kept.path.read_bytes().startswith(copy.path.read_bytes()):
        return f"a copy of run {copy.number} in {_folder(copy)}"
    return f"a copy of run {copy.number} in {_folder(copy)}, which went on otherwise than the one in {_folder(kept)}"


def _clashing(runs: Sequence[R]) -> list[R]:
    """The runs that claim to be the same run as another one, side by side."""
    return [run for run in sorted(runs, key=_claimed) if sum(_claimed(run) == _claimed(other) for other in runs) > 1]


def _as_its_folder_says(run: R) -> R:
    named = FOLDER.fullmatch(_folder(run))
    return replace(run, participant=named[1], number=int(named[2])) if named else run


def _not_told_apart(one: Recorded, other: Recorded) -> str:
    return (
        f"{_folder(one)} and {_folder(other)} hold two recordings, begun {_begun(one.header)} and "
        f"{_begun(other.header)}, that both are run {one.number} of participant {one.participant}. Rename the folder "
        f"of one of them, sub-{one.participant}B if it is another person's, run-{one.number + 1} if it is the same person "
        "again; it then counts as what its folder says."
    )


def _moved(before: Recorded, after: Recorded) -> str:
    was = f"{_folder(before)} holds run {before.number} of participant {before.participant}"
    if _claimed(before) == _claimed(after):
        return f"{was}; it counts as that."
    return (
        f"{was}, of which there is another recording; as its folder says it counts as run {after.number} of "
        f"participant {after.participant}."
    )


def _claimed(run: Recorded) -> tuple[str, int]:
    return run.participant, run.number


def _begun(header: Mapping[str, Any]) -> str:
    return str(header.get("started", "at an unknown time"))


def _folder(run: Recorded) -> str:
    return "/".join(run.path.parts[-3:-1])


def _at_home(run: Recorded) -> bool:
    return _folder(run) == f"sub-{run.participant}/run-{run.number}"

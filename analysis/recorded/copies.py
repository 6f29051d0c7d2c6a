"""Journals that stand twice in a study's folder, or elsewhere than where they were recorded: copied or renamed folders.

Nothing says in such a journal that it is a copy, so data would count twice. What counts is where the run was recorded.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol, TypeVar


class Recorded(Protocol):
    """A run that was read: its journal's path, and whose run it is by its header."""

    @property
    def path(self) -> Path:
        """Of the journal."""

    @property
    def participant(self) -> str:
        """The participant's ID."""

    @property
    def number(self) -> int:
        """Of the run, from 1."""


R = TypeVar("R", bound=Recorded)


def without_copies(runs: Sequence[R]) -> tuple[list[R], list[tuple[R, str]], list[str]]:
    """The runs, each once; the others, with why they are left out; and sentences on runs in folders of other names."""
    kept: dict[tuple[str, int], R] = {}
    for run in sorted(runs, key=lambda run: not _at_home(run)):
        kept.setdefault((run.participant, run.number), run)
    once = [run for run in runs if kept[run.participant, run.number] is run]
    copies = [
        (run, f"run {run.number} stands twice; the copy in {_folder(run)} is left out")
        for run in runs
        if kept[run.participant, run.number] is not run
    ]
    moved = [
        f"{_folder(run)} holds run {run.number} of participant {run.participant}; it counts as that."
        for run in once
        if not _at_home(run)
    ]
    return once, copies, moved


def _folder(run: Recorded) -> str:
    return "/".join(run.path.parts[-3:-1])


def _at_home(run: Recorded) -> bool:
    return _folder(run) == f"sub-{run.participant}/run-{run.number}"

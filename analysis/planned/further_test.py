"""The result of one planned test beside the analysis of variance."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import pandas as pd


@dataclass(frozen=True)
class FurtherTest:
    """One such test: its table (with a column `sentence`), a second table where there is one, its checks."""

    kind: str  # its name in the plan, and of its table
    table: pd.DataFrame
    more: pd.DataFrame = field(default_factory=pd.DataFrame)  # diagnostics, contrasts, participants
    facts: dict[str, float] = field(default_factory=dict)  # of the fit and its checks
    notes: tuple[str, ...] = ()
    complaints: tuple[str, ...] = ()  # on what of it could not be run


def worth_saying(notes: Iterable[str]) -> tuple[str, ...]:
    """Notes once each, without those on averaging over trials, which every test does."""
    return tuple(dict.fromkeys(note for note in notes if "were averaged" not in note))

"""From trials to one mean per participant and cell, which is what every ANOVA here starts from.

Checks the design on the way: who is in which group, who has an empty cell, who is left out.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from analysis.errors import AnalysisError, AnalysisWarning, listed
from analysis.statistics.columns import labels, numbers, require, require_no_colon

Levels = Mapping[str, Sequence[Any]]


@dataclass(frozen=True)
class CellMeans:
    """Complete participants x within-participant cells, and the groups the participants belong to."""

    measure: str
    values: np.ndarray  # (N, c) mean of each participant in each within cell, first factor slowest
    subjects: tuple[str, ...]  # (N,)
    within: dict[str, tuple[str, ...]]  # factor -> levels
    between: dict[str, tuple[str, ...]]
    groups: np.ndarray  # (N, number of between factors) level of each participant
    left_out: dict[str, str]  # participant -> the first cell without data
    notes: tuple[str, ...]

    @property
    def factors(self) -> tuple[str, ...]:
        """Within factors, then between factors, each in the order they were named."""
        return (*self.within, *self.between)

    def levels(self, factor: str) -> tuple[str, ...]:
        """Levels of a within or between factor, in the order of the design."""
        return self.within[factor] if factor in self.within else self.between[factor]


def names_of(factors: str | Sequence[str]) -> tuple[str, ...]:
    """One name or several, as a tuple."""
    return (factors,) if isinstance(factors, str) or not isinstance(factors, Iterable) else tuple(factors)


def cell_means(
    data: pd.DataFrame,
    dv: str,
    subject: str,
    within: str | Sequence[str] = (),
    between: str | Sequence[str] = (),
    levels: Levels | None = None,
) -> CellMeans:
    """Average `dv` over the rows of each participant and within cell.

    data: one row per observation; within, between: names of factor columns; levels: the order of a
    factor's levels where it should not be natural order. Participants with an empty cell are left out
    with a warning. Raises AnalysisError for every design that cannot be analysed.
    """
    within, between = names_of(within), names_of(between)
    factors = (*within, *between)
    _check_names(dv, subject, factors)
    require(data, [dv, subject, *factors])
    require_no_colon(factors)
    order = dict(levels or {})
    values = numbers(data, dv)
    people = labels(data, subject)
    columns = {name: labels(data, name, order.get(name)) for name in factors}
    notes = [note for column in columns.values() for note in column.notes]
    for name, column in {subject: people, **columns}.items():
        gaps = np.flatnonzero(column.codes < 0)
        if gaps.size:
            raise AnalysisError(f"Column {name!r} is empty in row {gaps[0] + 1} ({gaps.size} such row(s)); fill it in.")
        if name in factors and len(column.levels) < 2:
            raise AnalysisError(
                f"Factor {name!r} has only one level in the data ({column.levels[0]!r}); "
                f"leave {name!r} out of the analysis."
            )
    groups = _groups(people, {name: columns[name] for name in between})

    shape = [len(columns[name].levels) for name in within]
    cells = math.prod(shape)
    cell = np.zeros(len(values), dtype=np.intp)
    for name in within:
        cell = cell * len(columns[name].levels) + columns[name].codes
    have = ~np.isnan(values)
    if not have.all():
        notes.append(f"{int((~have).sum())} of {len(values)} rows have no {dv} and were left out.")
    index = people.codes[have] * cells + cell[have]
    size = len(people.levels) * cells
    counts = np.bincount(index, minlength=size).reshape(-1, cells)
    sums = np.bincount(index, weights=values[have], minlength=size).reshape(-1, cells)
    if counts.max(initial=0) > 1:
        low, high = int(counts[counts > 0].min()), int(counts.max())
        trials = f"{low}" if low == high else f"{low} to {high}"
        notes.append(f"Cells with several rows were averaged (over {trials} trials each) before the analysis.")

    complete = np.asarray((counts > 0).all(axis=1))
    left_out: dict[str, str] = {}
    for row in np.flatnonzero(~complete):
        gap = np.unravel_index(int(np.argmin(counts[row] > 0)), shape) if shape else ()
        left_out[people.levels[row]] = " × ".join(columns[n].levels[i] for n, i in zip(within, gap, strict=True))
    kept = int(complete.sum())
    if left_out:
        described = [f"{who} (no data in {where})" if where else who for who, where in left_out.items()]
        note = (
            f"{len(left_out)} participant(s) with missing cells were left out: {listed(described)}; "
            f"the result is for n = {kept}. A mixed model would use all their trials."
        )
        notes.append(note)
        if kept:
            warnings.warn(note, AnalysisWarning, stacklevel=3)
    if kept == 0:
        raise AnalysisError(f"No participant has data in every cell of {' × '.join(within) or dv}. {notes[-1]}")
    means = CellMeans(
        measure=dv,
        values=sums[complete] / counts[complete],
        subjects=tuple(who for who, whole in zip(people.levels, complete, strict=True) if whole),
        within={name: columns[name].levels for name in within},
        between={name: columns[name].levels for name in between},
        groups=groups[complete],
        left_out=left_out,
        notes=tuple(notes),
    )
    _check_groups(means)
    return means


def _check_names(dv: str, subject: str, factors: Sequence[str]) -> None:
    named = [dv, subject, *factors]
    twice = [name for name in dict.fromkeys(named) if named.count(name) > 1]
    if twice:
        raise AnalysisError(f"{listed(map(repr, twice))} is named twice; measure, participant and factors differ.")
    if not factors:
        raise AnalysisError("Name at least one within or between factor.")


def _groups(people: Any, between: Mapping[str, Any]) -> np.ndarray:
    """(participants, factors) group of each participant; AnalysisError if someone is in two."""
    groups = np.zeros((len(people.levels), len(between)), dtype=np.intp)
    for place, (name, column) in enumerate(between.items()):
        groups[people.codes, place] = column.codes
        mixed = np.unique(people.codes[groups[people.codes, place] != column.codes])
        if mixed.size:
            both = []
            for who in mixed:
                found = np.unique(column.codes[people.codes == who])
                both.append(f"{people.levels[who]} ({listed(column.levels[i] for i in found)})")
            raise AnalysisError(
                f"{len(both)} participant(s) are in more than one level of the between factor {name!r}: "
                f"{listed(both)}. Does numbering restart in each group? Give everyone an identifier "
                f"of their own."
            )
    return groups


def _check_groups(means: CellMeans) -> None:
    shape = [len(levels) for levels in means.between.values()]
    counts = np.zeros(shape, dtype=int)
    np.add.at(counts, tuple(means.groups.T), 1)
    if not means.between:
        counts = np.array([len(means.subjects)])
    empty = np.argwhere(counts == 0)
    if means.between and len(empty):
        combinations = [
            " × ".join(f"{name} = {levels[i]}" for i, (name, levels) in zip(place, means.between.items(), strict=True))
            for place in empty
        ]
        rest = listed([repr(name) for name in means.between])
        advice = f"analyse {rest} one at a time" if len(shape) > 1 else f"leave that level of {rest} out"
        raise AnalysisError(
            f"No participant with complete data is in {listed(combinations)}, so type III tests are "
            f"not defined; "
            f"{advice}, or recruit for the empty cell."
        )
    if len(means.subjects) <= counts.size:
        raise AnalysisError(
            f"{len(means.subjects)} participant(s) with complete data are too few for {counts.size} "
            f"group(s): "
            f"at least {counts.size + 1} are needed."
        )

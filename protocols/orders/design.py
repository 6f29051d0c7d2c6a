"""Factors to trials: every condition as often as the study says, in an order that seed and participant decide."""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field
from random import Random

from protocols.orders.latin import balanced_latin_square, latin_square
from protocols.orders.limits import Limit, limited_order
from protocols.orders.order import AdaptiveOrder, ListOrder
from protocols.study import Level, Study

Conditions = list[dict[str, Level]]


@dataclass(frozen=True)
class Trial:
    """One trial of the design.

    number: from 1 over the whole run (training trials: from 1 among themselves).
    block:  from 1; repetition: from 1, how often this condition has been shown including now.
    levels: factor to level; of an adaptively placed factor, the level its track starts with.
    group:  levels of the between-participant factors that the program assigned.
    track:  from 1, whose answers place the level; 0 where nothing is placed.
    """

    number: int
    block: int
    repetition: int
    levels: Mapping[str, Level]
    practice: bool = False
    group: Mapping[str, str] = field(default_factory=dict)
    track: int = 0

    @property
    def values(self) -> dict[str, Level]:
        """Everything that a `$factor` may name in this trial: the levels and the assigned group's."""
        return {**self.group, **self.levels}


def conditions(study: Study) -> Conditions:
    """Every combination of the factors' levels, first factor slowest."""
    return _combinations(study.factors)


def _combinations(factors: Mapping[str, list[Level]]) -> Conditions:
    return [dict(zip(factors, levels, strict=True)) for levels in itertools.product(*factors.values())]


def default_seed(study: str, participant: str, run: int) -> int:
    """The seed of a run when none is given: 48 bits of the SHA-256 of study, participant and run number."""
    return int.from_bytes(hashlib.sha256(f"{study}/{participant}/{run}".encode()).digest()[:6], "big")


def make_trials(study: Study, seed: int, number: int = 1, group: Mapping[str, str] | None = None) -> list[Trial]:
    """The experimental trials of one run; the same arguments give the same list.

    seed: decides what is shuffled. number: of the participant, from 1; decides the row of a square. group: levels
    of the assigned between-participant factors. Training trials are not included. Raises ValueError when no order
    keeps the study's limits (`protocols.orders.feasibility` finds that out beforehand, in words).
    """
    rng = Random(f"{study.study}/order/{seed}")
    group = dict(group or {})
    if isinstance(study.order, AdaptiveOrder):
        return _interleaved(study, study.order, rng, group)
    seen: dict[tuple[Level, ...], int] = {}
    trials: list[Trial] = []
    for block, levels in _ordered(study, study.order, rng, number):
        cell = tuple(levels.values())
        seen[cell] = seen.get(cell, 0) + 1
        trials.append(Trial(len(trials) + 1, block, seen[cell], levels, group=group))
    return trials


def _ordered(study: Study, order: ListOrder, rng: Random, number: int) -> list[tuple[int, dict[str, Level]]]:
    """Block number and condition of every trial."""
    blocks = blocks_of(study, number)
    if order.limited:
        found = limited_order(blocks, limits_of(study), rng)
        if found is None:
            raise ValueError(f"no order of {study.study} keeps its limits; gaitlab check says which to loosen")
        ordered = iter(found)
        return [(place, dict(next(ordered))) for place, block in enumerate(blocks, start=1) for _ in block]
    if shuffled(order):
        for block in blocks:
            rng.shuffle(block)
    return [(place, levels) for place, block in enumerate(blocks, start=1) for levels in block]


def shuffled(order: ListOrder) -> bool:
    """Whether chance has a say in an order: not in that of the file, nor in a square of the conditions themselves."""
    return order.kind in ("random", "blocked") or order.of is not None


def blocks_of(study: Study, number: int = 1) -> list[Conditions]:
    """The conditions of every block before shuffling; of squares, in the order of the participant's row.

    A square without `of` goes through the conditions once per repetition, each time by the next row.
    """
    assert isinstance(study.order, ListOrder)
    every = conditions(study)
    if study.order.kind == "random":
        return [[condition for _ in range(study.repetitions) for condition in every]]
    if study.order.kind in ("blocked", "sequential"):
        return [list(every) for _ in range(study.repetitions)]
    parts = square_parts(study)
    if study.order.of is None:
        rows = [square_row(study, number + again) for again in range(study.repetitions)]
        return [[every[part] for part in row] for row in rows]
    return [
        [c for _ in range(study.repetitions) for c in every if parts[part].items() <= c.items()]
        for part in square_row(study, number)
    ]


def square_parts(study: Study) -> Conditions:
    """What the square orders: the levels of the factors in `of`, or every condition."""
    assert isinstance(study.order, ListOrder)
    names = study.order.of or list(study.factors)
    return _combinations({name: study.factors[name] for name in names})


def square_rows(study: Study) -> list[list[int]]:
    """The square itself: in each row, which part of `square_parts` stands in each place."""
    assert isinstance(study.order, ListOrder)
    size = len(square_parts(study))
    return balanced_latin_square(size) if study.order.kind == "balanced_latin_square" else latin_square(size)


def square_row(study: Study, number: int) -> list[int]:
    """The row of a participant by number, from 1; after the last row comes the first again."""
    rows = square_rows(study)
    return rows[(number - 1) % len(rows)]


def limits_of(study: Study) -> list[Limit]:
    """The limits of the study's order, in the order of the file."""
    order = study.order
    assert isinstance(order, ListOrder)
    limits = [Limit(f"at_most_in_a_row {f}", _feature(f), most=most) for f, most in order.at_most_in_a_row.items()]
    limits += [Limit(f"at_least_apart {f}", _feature(f), apart=apart) for f, apart in order.at_least_apart.items()]
    if order.repeats_at_least_apart is not None:
        whole = Limit("repeats_at_least_apart", lambda c: tuple(c.values()), apart=order.repeats_at_least_apart)
        limits.append(whole)
    return limits


def _feature(factor: str):  # type: ignore[no-untyped-def]
    return lambda condition: condition[factor]


def tracks(study: Study) -> list[dict[str, Level]]:
    """The conditions of every adaptive track, its starting level among them; several tracks of one are interleaved."""
    order = study.order
    assert isinstance(order, AdaptiveOrder)
    levels = study.factors[order.of]
    starts = getattr(order.rule, "start", None) or [levels[-1]]
    others = {name: [None] if name == order.of else levels for name, levels in study.factors.items()}
    return [{**c, order.of: start} for c in _combinations(others) for start in starts]  # type: ignore[arg-type]


def _interleaved(study: Study, order: AdaptiveOrder, rng: Random, group: Mapping[str, str]) -> list[Trial]:
    """One trial of every track per block, in a new random order; repetitions are the trials of a track."""
    every = list(enumerate(tracks(study), start=1))
    trials: list[Trial] = []
    for block in range(1, study.repetitions + 1):
        rng.shuffle(every)
        trials += [
            Trial(len(trials) + i, block, block, levels, group=group, track=track)
            for i, (track, levels) in enumerate(every, start=1)
        ]
    return trials


def practice_trials(study: Study, group: Mapping[str, str] | None = None) -> list[Trial]:
    """The training trials in the order of the file, numbered from 1 among themselves."""
    return [
        Trial(i, block=0, repetition=1, levels=training.levels, practice=True, group=dict(group or {}))
        for i, training in enumerate(study.practice, start=1)
    ]

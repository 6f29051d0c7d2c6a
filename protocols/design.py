"""Factors to trials: every condition as often as the study says, in an order that a seed decides."""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from random import Random

from protocols.study import Level, Study


@dataclass(frozen=True)
class Trial:
    """One trial of the design.

    number: from 1 over the whole run (training trials: from 1 among themselves).
    block:  from 1; repetition: from 1, how often this condition has been shown including now.
    levels: factor to level.
    """

    number: int
    block: int
    repetition: int
    levels: Mapping[str, Level]
    practice: bool = False


def conditions(study: Study) -> list[dict[str, Level]]:
    """Every combination of the factors' levels, first factor slowest."""
    names = list(study.factors)
    return [dict(zip(names, levels, strict=True)) for levels in itertools.product(*study.factors.values())]


def default_seed(study: str, participant: str, run: int) -> int:
    """The seed of a run when none is given: 48 bits of the SHA-256 of study, participant and run number."""
    return int.from_bytes(hashlib.sha256(f"{study}/{participant}/{run}".encode()).digest()[:6], "big")


def make_trials(study: Study, seed: int) -> list[Trial]:
    """The experimental trials of one run; the same study and seed give the same list.

    random: all trials shuffled together. blocked: each block holds every condition once, shuffled.
    sequential: the conditions in the order of the file, repeated. Training trials are not included.
    """
    rng = Random(f"{study.study}/order/{seed}")
    every = conditions(study)
    blocks: list[list[dict[str, Level]]] = [list(every) for _ in range(study.repetitions)]
    if study.order == "random":
        everything = [condition for block in blocks for condition in block]
        rng.shuffle(everything)
        blocks = [everything]
    elif study.order == "blocked":
        for block in blocks:
            rng.shuffle(block)
    seen: dict[tuple[Level, ...], int] = {}
    trials: list[Trial] = []
    for number, block in enumerate(blocks, start=1):
        for levels in block:
            cell = tuple(levels.values())
            seen[cell] = seen.get(cell, 0) + 1
            trials.append(Trial(len(trials) + 1, number, seen[cell], levels))
    return trials


def practice_trials(study: Study) -> list[Trial]:
    """The training trials in the order of the file, numbered from 1 among themselves."""
    return [
        Trial(i, block=0, repetition=1, levels=training.levels, practice=True)
        for i, training in enumerate(study.practice, start=1)
    ]

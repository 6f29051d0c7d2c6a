"""The levels of a study's trials, and where in its file each stands, so that a mistake can stand at its cause."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

from protocols.mistakes.mistake import Place
from protocols.orders.assignment import groups
from protocols.parts import Level
from protocols.setting import FACTOR, TABLE, kind_of
from protocols.study import Study


@dataclass(frozen=True)
class Shown:
    """The levels of a condition or a training trial, with an assigned group's; place: of a factor's level in it."""

    levels: Mapping[str, Level]
    place: Callable[[str], Place]


def shown_trials(study: Study, among: Collection[str] | None = None) -> Iterator[Shown]:
    """Every condition and training trial; among: the factors that matter, every other is left out of conditions."""
    names = [name for name in study.factors if among is None or name in among]

    def in_factors(levels: Mapping[str, Level]) -> Callable[[str], Place]:
        return lambda factor: ("factors", factor, study.factors[factor].index(levels[factor]))

    for group in groups(study):
        for combination in product(*(study.factors[name] for name in names)):
            levels = dict(zip(names, combination, strict=True))
            yield Shown({**group, **levels}, in_factors(levels))
        for i, trial in enumerate(study.practice):
            yield Shown({**group, **trial.levels}, lambda factor, i=i: ("practice", i, factor))  # type: ignore[misc]


def value_place(study: Study, shown: Shown, setting: object, place: Place) -> Place:
    """Where the value that a setting has in a trial stands: itself, in a table, or as a factor's level."""
    kind = kind_of(setting)
    if kind == FACTOR:
        factor = str(setting)[1:]
        return shown.place(factor) if factor in study.factors else place
    if kind == TABLE:
        assert isinstance(setting, Mapping)
        ((factor, values),) = setting.items()
        level: Any = shown.levels[factor[1:]]
        return value_place(study, shown, values[level], (*place, factor, level))
    return place

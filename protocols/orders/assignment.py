"""Places in the order of arrival, given back by those who drop out, and the group that belongs to each place.

Pure: what the data folder says (who arrived, whose run ended how) is an argument.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from random import Random

from protocols.study import Study

GIVEN_BACK = ("declined", "withdrawn", "dropped out")
"""Ends of a run after which the participant's place is free for somebody else."""


@dataclass(frozen=True)
class Arrival:
    """A participant who has a place; ended: why the latest run ended, "" while it can go on."""

    participant: str
    place: int
    ended: str = ""


def place_of(participant: str, arrivals: Iterable[Arrival], given_back: Iterable[int] = ()) -> int:
    """The place of a participant, from 1: the one held already, else the first one given back, else the next new one.

    given_back: places of participants who are no longer in the folder. Whoever gave a place back and returns keeps
    it unless somebody else has taken it.
    """
    known = list(arrivals)
    held = {a.place for a in known if a.ended not in GIVEN_BACK}
    own = [a for a in known if a.participant == participant]
    if own and (own[-1].ended not in GIVEN_BACK or own[-1].place not in held):
        return own[-1].place
    back = {*given_back, *(a.place for a in known if a.ended in GIVEN_BACK)}
    free = sorted(back - held)
    return free[0] if free else max([*held, *back], default=0) + 1


def groups(study: Study) -> list[dict[str, str]]:
    """Every combination of the levels of the assigned factors; one empty group where nothing is assigned."""
    names = study.participants.assigned
    levels = [study.participants.between[name] for name in names]
    return [dict(zip(names, combination, strict=True)) for combination in itertools.product(*levels)]


def group_of(study: Study, place: int) -> dict[str, str]:
    """The group of a place: in every row of as many places as there are groups each group stands once, shuffled.

    Randomly permuted blocks (Pocock 1983, Clinical Trials, chapter 5): groups never differ by more than one
    participant while everybody stays, and a place given back brings its group back.
    """
    every = groups(study)
    block, within = divmod(place - 1, len(every))
    Random(f"{study.study}/assignment/{block}").shuffle(every)
    return every[within]


def place_in_group(study: Study, place: int) -> int:
    """How many places of the same group come before a place."""
    own = group_of(study, place)
    return sum(group_of(study, earlier) == own for earlier in range(1, place))


def counts(study: Study, places: Sequence[int]) -> list[tuple[dict[str, str], int]]:
    """How many of the places each group has."""
    given = [group_of(study, place) for place in places]
    return [(group, given.count(group)) for group in groups(study)]

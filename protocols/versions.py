"""In what two versions of a study file differ. Knows no journal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from io import StringIO
from typing import Any

DEPTH = 2
"""Keys of a place that are named, as in `factors.speed`."""


def differences(one: str, other: str) -> tuple[str, ...]:
    """Places in which the texts of two study files differ, as `pages.consent`; none where only comments do."""
    return tuple(dict.fromkeys(".".join(place) for place in _differing(_read(one), _read(other))))


def what_differs(one: str, other: str) -> str:
    """The same for a sentence, as "pages.consent and factors.speed", or "comments only"."""
    places = differences(one, other)
    if len(places) > 4:
        places = (*places[:3], f"{len(places) - 3} more places")
    return f"{', '.join(places[:-1])} and {places[-1]}" if len(places) > 1 else "".join(places) or "comments only"


def another_study(one: str, other: str) -> str:
    """Why two study files are no versions of one study, as "its task is rating, here choice"; "" where they may be.

    Runs with another task or other factors have other columns, and stand in no table together.
    """
    first, second = _read(one), _read(other)
    tasks = [str(study["task"]["kind"]) for study in (first, second)]
    if tasks[0] != tasks[1]:
        return f"its task is {tasks[0]}, here {tasks[1]}"
    factors = [", ".join(study["factors"]) for study in (first, second)]
    same = set(first["factors"]) == set(second["factors"])
    return "" if same else f"its factors are {factors[0]}, here {factors[1]}"


def _read(text: str) -> Any:
    from ruamel.yaml import YAML

    return YAML(typ="safe", pure=True).load(StringIO(text))


def _differing(one: Any, other: Any, place: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    if not (isinstance(one, Mapping) and isinstance(other, Mapping)) or len(place) == DEPTH:
        if one != other:
            yield place
        return
    for key in dict.fromkeys([*one, *other]):
        yield from _differing(one.get(key), other.get(key), (*place, str(key)))

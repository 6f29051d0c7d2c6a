"""One thing wrong in a study file, and where. Knows neither YAML nor the parts of a study."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass

Place = tuple[str | int, ...]
"""Keys and list positions from the top of the file, as ("factors", "speed", 0)."""


@dataclass(frozen=True)
class Mistake:
    """One thing wrong in a study file.

    where: its place; on_key: the key itself is at fault; line, column: from 1, once they are known.
    """

    where: Place
    message: str
    on_key: bool = False
    line: int = 1
    column: int = 1


def no_such(name: str, known: Iterable[str], what: str) -> str:
    """The sentence for a name that is not known: the nearest one that is, or all of them."""
    known = list(known)
    near = difflib.get_close_matches(name, known, n=1)
    way = f"did you mean {near[0]}?" if near else f"there are: {', '.join(known) or 'none'}"
    return f"{name} is no {what}; {way}"

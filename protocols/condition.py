"""A condition on one column of a trial, as `rating >= 3` or `chosen == $original`: read once, asked of every trial."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    ">": operator.gt,
}


@dataclass(frozen=True)
class Condition:
    """column compared with a value; a value that begins with $ names another column."""

    column: str
    comparison: str
    value: str

    def holds(self, columns: Mapping[str, object]) -> bool:
        """Whether it is true of a trial; numbers compare as numbers, everything else as text.

        Raises KeyError for a column that the trial does not have.
        """
        left, right = columns[self.column], self.value
        other: object = columns[right[1:]] if right.startswith("$") else right
        numbers = number_of(left), number_of(other)
        if None not in numbers:
            return COMPARISONS[self.comparison](*numbers)
        if self.comparison in ("==", "!="):
            return COMPARISONS[self.comparison](str(left), str(other))
        return False


def read_condition(text: str) -> Condition | None:
    """The condition in a text, or None when it is none."""
    parts = re.fullmatch(r"\s*(\w+)\s*(<=|>=|==|!=|<|>)\s*(\S.*?)\s*", text)
    return Condition(parts[1], parts[2], parts[3].strip("'\"")) if parts else None


def number_of(value: object) -> float | None:
    """A value or its text as a number, True as 1; None for what is none, as the words nan and inf."""
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return None
    return number if math.isfinite(number) else None

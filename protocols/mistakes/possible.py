"""What a column of a trial can hold, and conditions on it that no trial, or every one, would meet."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from protocols.condition import Condition, number_of, read_condition
from protocols.mistakes.mistake import Mistake, Place, no_such
from protocols.parts import Level


@dataclass(frozen=True)
class Span:
    """Numbers from minimum to maximum, every one of them or in steps from the minimum."""

    minimum: float = 0.0
    maximum: float = math.inf
    step: float | None = None

    def __str__(self) -> str:
        if self.maximum == math.inf:
            return f"{self.minimum:g} or more"
        steps = "" if self.step is None else f" in steps of {self.step:g}"
        return f"{self.minimum:g} to {self.maximum:g}{steps}"

    def among(self, value: str) -> list[float]:
        """Numbers of the span that tell what a comparison with a value can come out as: its ends, and the nearest."""
        top = self.minimum + 1.0 if self.maximum == math.inf else self.maximum
        wanted = number_of(value)
        if wanted is None:
            return [self.minimum, top]
        top = max(top, wanted + 1.0) if self.maximum == math.inf else top
        near = min(max(wanted, self.minimum), top)
        if self.step is None:
            return [self.minimum, near, top]
        point = self.minimum + round((near - self.minimum) / self.step) * self.step
        return [self.minimum, wanted if math.isclose(point, wanted, rel_tol=1e-9, abs_tol=1e-9) else point, top]


Possible = Span | tuple[Level, ...]
"""What a column can hold: numbers, or one of some words or levels."""


def condition_mistakes(
    text: str,
    where: Place,
    columns: Mapping[str, Possible | None],
    what: str = "column",
    example: str = "late_frames > 5",
    both_ways: bool = True,
) -> Iterator[Mistake]:
    """What is wrong with one condition of a study file.

    columns: that it may name, to what each can hold, None where that is not known; what: they are called.
    both_ways: a condition that every trial meets is a mistake, too, as an answer that is always yes.
    """
    condition = read_condition(text)
    if " or " in text:
        yield Mistake(
            where, f"{text!r} joins conditions by or, which cannot be; write one condition, or two exclusions"
        )
        return
    if condition is None:
        yield Mistake(where, f"{text!r} is no condition; write one as `{example}`")
        return
    named = [condition.column, *([condition.value[1:]] if condition.value.startswith("$") else [])]
    unknown = [Mistake(where, no_such(column, columns, what)) for column in named if column not in columns]
    yield from unknown
    possible = None if unknown else columns[condition.column]
    if possible is not None and len(named) == 1 and (why := _foregone(condition, possible, both_ways)):
        yield Mistake(where, why)


def _foregone(condition: Condition, possible: Possible, both_ways: bool) -> str:
    """Why a condition need not be asked of any trial, as a sentence; "" when it must."""
    column, sign, value = condition.column, condition.comparison, condition.value
    values = possible.among(value) if isinstance(possible, Span) else possible
    met = {condition.holds({column: one}) for one in values}
    can_be = str(possible) if isinstance(possible, Span) else ", ".join(map(str, possible))
    if isinstance(possible, Span) and number_of(value) is None:
        return f"{column} is a number, and {value} is none; it can be: {can_be}"
    if True not in met:
        if sign == "==":
            return f"{column} is never {value}; it can be: {can_be}"
        return f"{column} {sign} {value} is never true; {column} can be: {can_be}"
    if False not in met and both_ways:
        return f"{column} {sign} {value} is true of every trial; {column} can be: {can_be}"
    return ""

"""Mistakes in the numbers that a measure is compared with: reference values and bounds that it can never reach."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from protocols.mistakes.mistake import Mistake, Place
from protocols.mistakes.possible import Span
from protocols.study import FurtherAnalysis, Level


def unreachable(
    plan: FurtherAnalysis, at: Place, within: Mapping[str, Sequence[Level]], span: Span
) -> Iterator[Mistake]:
    """Reference values outside what the plan's measure can be, and bounds that no difference can exceed.

    within: within-participant factors and their levels; span: what every trial's measure, and so any mean, lies in.
    """
    if span.minimum >= span.maximum:  # a mistake in the task, told there
        return
    for i, test in enumerate(plan.t_tests):
        where: Place = (*at, "t_tests", i, "against")
        if isinstance(test.against, dict):
            shown = {str(level) for level in within.get(test.each or "", test.against)}
            values = [(value, (*where, level)) for level, value in test.against.items() if level in shown]
        else:
            values = [] if test.against is None else [(test.against, where)]
        for value, place in values:
            if not span.minimum <= value <= span.maximum:
                message = f"{plan.measure} can be {span}, so its mean is never {value:g}"
                yield Mistake(place, message + _as_share(value, span))
    widest = span.maximum - span.minimum
    for i, same in enumerate(plan.equivalence):
        if same.bound >= widest:
            message = f"{plan.measure} can be {span}, so differences are never more than {same.bound:g}"
            yield Mistake((*at, "equivalence", i, "bound"), message + _as_share(same.bound, span))


def _as_share(value: float, span: Span) -> str:
    """What a percentage is as a share, where one was expected."""
    return f"; {value:g} % is {value / 100:g}" if span == Span(0.0, 1.0) and 1.0 < value <= 100.0 else ""

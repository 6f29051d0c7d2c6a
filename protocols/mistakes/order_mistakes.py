"""Mistakes in a study's order and in its assignment of participants: factors, levels and limits named in vain."""

from __future__ import annotations

from collections.abc import Iterator

from protocols.mistakes.mistake import Mistake, Place, no_such
from protocols.mistakes.possible import Possible, Span, condition_mistakes
from protocols.orders.feasibility import order_limits_mistakes
from protocols.orders.order import AdaptiveOrder, ListOrder, QuestPlusRule, StaircaseRule
from protocols.orders.staircase import fewest_trials
from protocols.study import ChoiceQuestion, Study

LARGEST_SQUARE = 100
"""Parts of the largest square: more are a slip, as every participant would see another order anyway."""


def order_mistakes(study: Study) -> Iterator[Mistake]:
    """Everything wrong with `order` and `participants.assigned`."""
    yield from _assigned(study)
    if isinstance(study.order, AdaptiveOrder):
        yield from _adaptive(study, study.order)
        return
    named = list(_list_order(study, study.order))
    yield from named
    if not named:
        yield from order_limits_mistakes(study)


def _list_order(study: Study, order: ListOrder) -> Iterator[Mistake]:
    if order.of is not None and not order.is_square:
        yield Mistake(("order", "of"), f"only squares have parts; remove it from an order of kind {order.kind}", True)
    if order.limited and (order.kind == "sequential" or (order.is_square and order.of is None)):
        message = (
            f"the order of kind {order.kind} is fixed, so no limit can be kept; take random or blocked, or squares of"
        )
        yield Mistake(("order", "kind"), f"{message} one factor")
    for i, name in enumerate(order.of or []):
        if name not in study.factors:
            yield Mistake(("order", "of", i), no_such(name, study.factors, "factor"))
        elif name in (order.of or [])[:i]:
            yield Mistake(("order", "of", i), f"{name} stands twice; remove one")
    for field in ("at_most_in_a_row", "at_least_apart"):
        for name in getattr(order, field):
            if name not in study.factors:
                yield Mistake(("order", field, name), no_such(name, study.factors, "factor"), on_key=True)
    names = order.of or list(study.factors)
    if order.is_square and all(name in study.factors for name in names):
        size = 1
        for name in names:
            size *= len(study.factors[name])
        if not 2 <= size <= LARGEST_SQUARE:
            message = f"a square orders 2 to {LARGEST_SQUARE} things, not {size}; name the factor(s) it orders in `of`"
            yield Mistake(("order", "kind"), message)


def _adaptive(study: Study, order: AdaptiveOrder) -> Iterator[Mistake]:
    if order.of not in study.factors:
        yield Mistake(("order", "of"), no_such(order.of, study.factors, "factor"))
        return
    levels = study.factors[order.of]
    for i, level in enumerate(levels):
        if not isinstance(level, (int, float)):
            yield Mistake(("factors", order.of, i), f"{level!r} is not a number, and the order places {order.of}")
    if len(levels) < 2:
        yield Mistake(
            ("factors", order.of), f"{order.of} has one level; a placed factor needs the levels to choose from"
        )
    for i, start in enumerate(getattr(order.rule, "start", None) or []):
        if start not in levels:
            listed = ", ".join(str(level) for level in levels)
            yield Mistake(("order", "rule", "start", i), f"{start:g} is no level of {order.of}; there are: {listed}")
    if order.stops_after is not None:
        staircase = order.rule if isinstance(order.rule, StaircaseRule) else None
        fewest = fewest_trials(
            order.stops_after, *((staircase.down_after, staircase.up_after) if staircase else (1, 1))
        )
        if study.repetitions < fewest:
            message = (
                f"a track cannot turn {order.stops_after} times within its {study.repetitions} trials (repetitions); "
                f"it needs {fewest} at least, and usually two or three times as many"
            )
            yield Mistake(("order", "rule", "reversals"), message)
    columns: dict[str, Possible | None] = {**study.task.recorded, "response_time": Span()}
    columns |= {name: tuple(values) for name, values in study.factors.items()}
    example = "side == left` or `rating >= 3"
    yield from condition_mistakes(order.yes, ("order", "yes"), columns, "factor or part of a response", example)
    if isinstance(order.rule, QuestPlusRule) and order.rule.function == "weibull":
        for field, values in (("levels", levels), ("thresholds", order.rule.thresholds or [])):
            if any(isinstance(value, (int, float)) and value <= 0 for value in values):
                where: Place = ("factors", order.of) if field == "levels" else ("order", "rule", "thresholds")
                yield Mistake(where, f"weibull needs {field} above 0; shift them, or take logistic or normal")


def _assigned(study: Study) -> Iterator[Mistake]:
    questions = [q.id for q in study.participants.questions if isinstance(q, ChoiceQuestion)]
    for i, name in enumerate(study.participants.assigned):
        where: Place = ("participants", "assigned", i)
        if name not in study.participants.between:
            yield Mistake(where, no_such(name, study.participants.between, "between-participant factor"))
        elif name in questions:
            yield Mistake(where, f"{name} is also a question; assign it or ask it, not both")
        elif name in study.participants.assigned[:i]:
            yield Mistake(where, f"{name} stands twice; remove one")

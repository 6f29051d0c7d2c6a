"""Whether a study's limits on the order can be kept, and a sentence on which to loosen when they cannot."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from random import Random

from protocols.mistakes.mistake import Mistake, Place
from protocols.orders.design import Conditions, blocks_of, limits_of
from protocols.orders.limits import Limit, limited_order
from protocols.orders.order import ListOrder
from protocols.study import Study

QUICK = 4
"""Searches begun for each loosened limit that is tried out."""

NO_LIMIT = 10**6
"""A distance that nothing reaches."""

FURTHER = 12
"""How far a limit on trials in a row is loosened before another is tried."""


def order_limits_mistakes(study: Study) -> Iterator[Mistake]:
    """A sentence for every limit that cannot be kept on its own, or one for limits that exclude each other."""
    order = study.order
    if not isinstance(order, ListOrder) or not order.limited:
        return
    limits, blocks = limits_of(study), blocks_of(study)
    alone = [mistake for limit in limits for mistake in _alone(study, limit, blocks)]
    yield from alone
    if not alone and limited_order(blocks, limits, Random(f"{study.study}/feasible")) is None:
        yield Mistake(("order",), _together(blocks, limits))


def _place(limit: Limit) -> Place:
    return ("order", *limit.name.split(" "))


def _alone(study: Study, limit: Limit, blocks: list[Conditions]) -> Iterator[Mistake]:
    """What is impossible by counting: too many trials of one level for the places there are."""
    for block in blocks:
        counts = Counter(limit.feature(condition) for condition in block)
        (commonest, most), places = counts.most_common(1)[0], len(block)
        if limit.most is not None and most > limit.most * (places - most + 1):
            why = f"{most} of the {places} trials {_of_block(blocks)}share it, with {places - most} others between them"
            message = f"level {commonest} would stand at least {_least_run(most, places)} times in a row: {why}"
            yield Mistake(_place(limit), f"{message}; allow {_least_run(most, places)}, or another kind of order")
            return
        furthest = _furthest(counts, places)
        if limit.apart > furthest:
            what = "a condition returns" if limit.name == "repeats_at_least_apart" else "a level returns"
            way = f"ask for {furthest} at most" if furthest > 1 else "leave the limit out"
            why = f"{len(counts)} different ones share {places} trials{_of_block(blocks, ' ')}"
            yield Mistake(_place(limit), f"{what} after at most {furthest} trials, as {why.rstrip()}; {way}")
            return


def _of_block(blocks: list[Conditions], before: str = "") -> str:
    return f"{before}of a block " if len(blocks) > 1 else before


def _least_run(count: int, places: int) -> int:
    """The shortest longest run of `count` alike among `places`: parted by the others into count / (others + 1)."""
    return -(-count // (places - count + 1))


def _furthest(counts: Counter[object], places: int) -> int:
    """The largest least distance that counting allows: (most - 1) distances and the last of every commonest level."""
    most = max(counts.values())
    as_common = sum(count == most for count in counts.values())
    return NO_LIMIT if most == 1 else (places - as_common) // (most - 1)


def _together(blocks: list[Conditions], limits: list[Limit]) -> str:
    """Limits that can be kept one by one but not together, and which single change would do."""
    names = [f"{limit.name} ({limit.most if limit.most is not None else limit.apart})" for limit in limits]
    ways = []
    for i, limit in enumerate(limits):
        for looser in _looser(limit):
            if limited_order(blocks, [*limits[:i], looser, *limits[i + 1 :]], Random("looser"), QUICK) is not None:
                value = looser.most if looser.most is not None else looser.apart
                ways.append(f"with {limit.name} {value}" if value != 1 or looser.most else f"without {limit.name}")
                break
    way = f"an order is found {' or '.join(ways)}" if ways else "loosen more than one of them"
    together = " together" if len(names) > 1 else ""
    return f"no order was found that keeps {' and '.join(names)}{together}; {way}"


def _looser(limit: Limit) -> Iterator[Limit]:
    if limit.most is not None:
        yield from (replace(limit, most=most) for most in range(limit.most + 1, limit.most + FURTHER))
    else:
        yield from (replace(limit, apart=apart) for apart in range(limit.apart - 1, 0, -1))

"""Which alternative stands left and which right (or comes first) in every trial, balanced by a seed."""

from __future__ import annotations

from collections.abc import Sequence
from random import Random

from protocols.orders.design import Trial


def balanced_orders(trials: Sequence[Trial], names: Sequence[str], seed: str) -> list[tuple[str, ...]]:
    """For every trial, two names in the order they are shown; the same seed gives the same orders.

    Within each condition the two orders take turns over its trials; which comes first is drawn so that over all
    conditions both begin equally often. Fewer or more than two names stay as they are.
    """
    if len(names) != 2:
        return [tuple(names)] * len(trials)
    rng = Random(seed)
    conditions = list(dict.fromkeys(tuple(trial.levels.items()) for trial in trials))
    starts = [bool(i % 2) for i in range(len(conditions))]
    if len(starts) % 2 and rng.random() < 0.5:
        starts = [not start for start in starts]
    rng.shuffle(starts)
    turned = dict(zip(conditions, starts, strict=True))
    orders: list[tuple[str, ...]] = []
    for trial in trials:
        condition = tuple(trial.levels.items())
        first, second = names
        orders.append((second, first) if turned[condition] else (first, second))
        turned[condition] = not turned[condition]
    return orders

"""Random orders under limits: no more than n in a row of a level, a least distance between repeats.

A depth-first search in random order that turns back as soon as what is left cannot be placed. Knows conditions
only as mappings of factor to level.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from random import Random

from protocols.parts import Level

Condition = Mapping[str, Level]

ATTEMPTS = 20
"""Searches begun anew before an order counts as not to be found."""

STEPS = 10
"""Steps of one search, for each trial of the list."""


@dataclass(frozen=True)
class Limit:
    """One rule about the trials that share a feature, as the same actor or the same condition.

    name:  as the study file calls it. most: trials in a row with one feature, or None; apart: least distance
    from one to the next (1 is the next trial).
    """

    name: str
    feature: Callable[[Condition], object]
    most: int | None = None
    apart: int = 1

    def allowed(self, recent: Sequence[object], wanted: object) -> bool:
        """Whether `wanted` may follow the features shown so far, oldest first."""
        if self.most is not None and len(recent) >= self.most and all(f == wanted for f in recent[-self.most :]):
            return False
        return wanted not in recent[max(len(recent) - self.apart + 1, 0) :] if self.apart > 1 else True

    def possible(self, recent: Sequence[object], left: Counter[object], places: int) -> bool:
        """False when some feature has more trials left than its limit can fit into the places left."""
        return all(not count or self._fits(recent, wanted, count, places) for wanted, count in left.items())

    def _fits(self, recent: Sequence[object], wanted: object, count: int, places: int) -> bool:
        others = places - count
        if self.most is not None:
            run = _run_at_end(recent, wanted)
            if count > max(self.most - run, 0) + self.most * others:
                return False
        if self.apart > 1:
            since = next((i for i, f in enumerate(reversed(recent[-self.apart :]), start=1) if f == wanted), self.apart)
            wait = max(self.apart - since, 0)
            if wait + (count - 1) * self.apart + 1 > places:
                return False
        return True


def _run_at_end(recent: Sequence[object], wanted: object) -> int:
    run = 0
    for feature in reversed(recent):
        if feature != wanted:
            break
        run += 1
    return run


def limited_order(
    blocks: Sequence[Sequence[Condition]], limits: Sequence[Limit], rng: Random, attempts: int = ATTEMPTS
) -> list[Condition] | None:
    """All conditions, block after block, in a random order that keeps every limit also across blocks.

    returns: the list, or None when no order was found; the same generator state gives the same list.
    """
    for _ in range(attempts):
        found = _Search(blocks, limits, rng).run()
        if found is not None:
            return found
    return None


class _Search:
    """One depth-first search; conditions that are alike are tried once at each place."""

    def __init__(self, blocks: Sequence[Sequence[Condition]], limits: Sequence[Limit], rng: Random) -> None:
        self._limits, self._rng = limits, rng
        self._kinds = list({_key(c): c for block in blocks for c in block}.values())
        self._features = [[limit.feature(kind) for limit in limits] for kind in self._kinds]
        index = {_key(kind): i for i, kind in enumerate(self._kinds)}
        self._left = [Counter(index[_key(c)] for c in block) for block in blocks]
        self._block_of = [b for b, block in enumerate(blocks) for _ in block]
        self._recent: list[list[object]] = [[] for _ in limits]
        self._of_feature = [
            [Counter(dict.fromkeys((row[n] for row in self._features), 0)) for n in range(len(limits))] for _ in blocks
        ]
        for b, left in enumerate(self._left):
            for kind, count in left.items():
                for n, feature in enumerate(self._features[kind]):
                    self._of_feature[b][n][feature] += count

    def run(self) -> list[Condition] | None:
        """The list, or None when the steps run out or every order fails."""
        total = len(self._block_of)
        chosen: list[int] = []
        waiting = [self._candidates(0)]
        for _ in range(STEPS * total + 1):
            if len(chosen) == total:
                return [self._kinds[kind] for kind in chosen]
            while waiting and not waiting[-1]:
                waiting.pop()
                if not chosen:
                    return None
                self._undo(chosen.pop(), len(chosen))
            kind = waiting[-1].pop()
            self._do(kind, len(chosen))
            chosen.append(kind)
            waiting.append(self._candidates(len(chosen)) if len(chosen) < total and self._hopeful(len(chosen)) else [])
            if len(chosen) == total:
                return [self._kinds[kind] for kind in chosen]
        return None

    def _candidates(self, place: int) -> list[int]:
        """What may stand at a place, in a random order weighted by how many are left (Efraimidis & Spirakis 2006)."""
        left = self._left[self._block_of[place]]
        keyed = [
            (self._rng.random() ** (1.0 / count), kind)
            for kind, count in left.items()
            if count
            and all(
                limit.allowed(recent, feature)
                for limit, recent, feature in zip(self._limits, self._recent, self._features[kind], strict=True)
            )
        ]
        return [kind for _, kind in sorted(keyed)]

    def _hopeful(self, place: int) -> bool:
        block = self._block_of[place]
        places = self._left[block].total()
        return all(
            limit.possible(recent, left, places)
            for limit, recent, left in zip(self._limits, self._recent, self._of_feature[block], strict=True)
        )

    def _do(self, kind: int, place: int) -> None:
        block = self._block_of[place]
        self._left[block][kind] -= 1
        for n, feature in enumerate(self._features[kind]):
            self._recent[n].append(feature)
            self._of_feature[block][n][feature] -= 1

    def _undo(self, kind: int, place: int) -> None:
        block = self._block_of[place]
        self._left[block][kind] += 1
        for n, feature in enumerate(self._features[kind]):
            self._recent[n].pop()
            self._of_feature[block][n][feature] += 1


def _key(condition: Condition) -> tuple[Level, ...]:
    return tuple(condition.values())

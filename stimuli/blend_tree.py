"""Blend trees: which cycles, and how much of each, give a wanted parameter value. Any depth, any parameters.

A branch orders its children along one parameter and mixes the two neighbours of the wanted value; what lies below a
child is a cycle or another branch over another parameter. The trees of Niay (2022, section 3.1.2) are a branch over
step frequency whose children are branches over speed. Weights only: knows no pose.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


class CoverageError(ValueError):
    """A wanted value lies outside what the cycles of a tree cover.

    sentence: what is wrong; the message goes on with a drawing of what the tree covers, where it can be drawn
    """

    def __init__(self, sentence: str, drawing: str = "") -> None:
        super().__init__(f"{sentence}\n{drawing}" if drawing else sentence)
        self.sentence, self.drawing = sentence, drawing

    def of(self, name: str) -> CoverageError:
        """The same of an actor by name, where several are asked."""
        return CoverageError(f"{name}: {self.sentence}", self.drawing)


@dataclass(frozen=True)
class Leaf:
    """A cycle, by its index in the actor's table."""

    cycle: int


@dataclass(frozen=True)
class Branch:
    """Children along one parameter.

    parameter: "speed", "step_frequency", ...
    unit:      for messages
    places:    value of the parameter at each child, increasing
    follows:   steps/min at each child of a branch over speed whose captures leave the step frequency no choice;
               empty where step frequency is free
    """

    parameter: str
    unit: str
    places: tuple[float, ...]
    children: tuple[Leaf | Branch, ...]
    follows: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if len(self.places) != len(self.children) or not self.children:
            raise ValueError(f"a branch over {self.parameter} needs one place per child")
        if any(b <= a for a, b in zip(self.places, self.places[1:], strict=False)):
            raise ValueError(f"the places of a branch over {self.parameter} must increase: {self.places}")


Tree = Leaf | Branch


def blend_weights(tree: Tree, wanted: Mapping[str, float]) -> dict[int, float]:
    """Cycle index -> weight, not negative and summing to 1.

    wanted: parameter -> value, for every parameter of the tree. Raises CoverageError, which draws what is covered.
    """
    try:
        return _weights(tree, wanted)
    except CoverageError as error:
        raise _drawn(error, tree, wanted) from None


def _weights(tree: Tree, wanted: Mapping[str, float]) -> dict[int, float]:
    if isinstance(tree, Leaf):
        return {tree.cycle: 1.0}
    low, high, share = _neighbours(tree, wanted)
    if tree.follows:
        _check_following(tree, wanted, low, high, share)
    if share == 0.0:
        return _weights(tree.children[low], wanted)
    if share == 1.0:
        return _weights(tree.children[high], wanted)
    weights: dict[int, float] = {}
    for child, part in ((low, 1.0 - share), (high, share)):
        for cycle, weight in _weights(tree.children[child], wanted).items():
            weights[cycle] = weights.get(cycle, 0.0) + part * weight
    return weights


def covers(tree: Tree, wanted: Mapping[str, float]) -> bool:
    """Whether `blend_weights` gives weights for what is wanted."""
    try:
        _weights(tree, wanted)
    except CoverageError:
        return False
    return True


def _drawn(error: CoverageError, tree: Tree, wanted: Mapping[str, float]) -> CoverageError:
    from stimuli.coverage_drawing import coverage_drawing  # only when something is refused

    return CoverageError(error.sentence, coverage_drawing(tree, wanted))


def many_weights(tree: Tree, wanted: Mapping[str, NDArray[Any]]) -> tuple[NDArray[np.intp], NDArray[np.floating]]:
    """`blend_weights` for N walkers at once: cycle indices and weights, both (N, M); unused places weigh nothing.

    wanted: parameter -> (N,) values. Raises CoverageError, which draws what is covered and a walker outside it.
    """
    try:
        return _many_weights(tree, wanted)
    except CoverageError:
        for walker in range(len(next(iter(wanted.values())))):
            blend_weights(tree, _of_one(wanted, walker))  # raises for the first walker outside
        raise


def _many_weights(tree: Tree, wanted: Mapping[str, NDArray[Any]]) -> tuple[NDArray[np.intp], NDArray[np.floating]]:
    if isinstance(tree, Leaf):
        count = len(next(iter(wanted.values())))
        return np.full((count, 1), tree.cycle, np.intp), np.ones((count, 1))
    values, places = np.asarray(wanted[tree.parameter]), np.array(tree.places)
    for extreme in (values.min(), values.max()):
        _neighbours(tree, {tree.parameter: float(extreme)})
    low = np.searchsorted(places[1:-1], values, side="right")
    high = np.minimum(low + 1, len(places) - 1)
    widths = np.diff(places) if len(places) > 1 else np.ones(1)
    share = np.minimum(np.maximum((values - places[low]) / widths[low], 0.0), 1.0)
    if tree.follows:
        follows = np.array(tree.follows)
        off = np.abs(wanted["step_frequency"] - (1.0 - share) * follows[low] - share * follows[high])
        worst = int(np.argmax(off))
        one = _of_one(wanted, worst)
        _check_following(tree, one, int(low[worst]), int(high[worst]), float(share[worst]))
    pairs, parts = np.column_stack([low, high]), np.column_stack([1.0 - share, share])
    leaves = [node.cycle for node in tree.children if isinstance(node, Leaf)]
    if len(leaves) == len(tree.children):
        return np.array(leaves, np.intp)[pairs], parts
    return _of_children(tree.children, pairs, parts, wanted)


def _of_one(wanted: Mapping[str, NDArray[Any]], walker: int) -> dict[str, float]:
    return {parameter: float(values[walker]) for parameter, values in wanted.items()}


def _of_children(
    children: tuple[Leaf | Branch, ...],
    pairs: NDArray[np.intp],
    parts: NDArray[Any],
    wanted: Mapping[str, NDArray[Any]],
) -> tuple[NDArray[np.intp], NDArray[np.floating]]:
    """Cycles and weights (N, M) that walkers take from their pairs of children (N, 2), of each of which a part (N, 2).

    Every child is asked once, for all walkers that want a part of it.
    """
    taken = np.where(parts > 0.0, pairs, -1)
    found = []
    for number, child in enumerate(children):
        own, place = np.nonzero(taken == number)
        if len(own):
            found.append((own, place, *_many_weights(child, {name: v[own] for name, v in wanted.items()})))
    width = max(cycles.shape[1] for _, _, cycles, _ in found)
    cycles, weights = np.zeros((*pairs.shape, width), np.intp), np.zeros((*pairs.shape, width))
    for own, place, chosen, shares in found:
        cycles[own, place, : chosen.shape[1]] = chosen
        weights[own, place, : chosen.shape[1]] = parts[own, place, None] * shares
    return cycles.reshape(len(pairs), -1), weights.reshape(len(pairs), -1)


def coverage(tree: Tree) -> dict[str, tuple[float, float]]:
    """Parameter -> (lowest, highest) value that every branch over it covers."""
    ranges: dict[str, tuple[float, float]] = {}
    if isinstance(tree, Branch):
        ranges[tree.parameter] = (tree.places[0], tree.places[-1])
        for child in tree.children:
            for parameter, (low, high) in coverage(child).items():
                known = ranges.get(parameter, (low, high))
                ranges[parameter] = (max(low, known[0]), min(high, known[1]))
    return ranges


def followed_step_frequency(tree: Tree, speed: float) -> float | None:
    """steps/min that goes with a speed (m/s) where captures leave no choice; None where step frequency is free.

    Raises CoverageError outside the tree.
    """
    if isinstance(tree, Leaf) or not tree.follows:
        return None
    low, high, share = _neighbours(tree, {tree.parameter: speed})
    return (1.0 - share) * tree.follows[low] + share * tree.follows[high]


def _check_following(branch: Branch, wanted: Mapping[str, float], low: int, high: int, share: float) -> None:
    """Raises CoverageError for a step frequency that no capture goes with (half a step/min is allowed for)."""
    there = (1.0 - share) * branch.follows[low] + share * branch.follows[high]
    asked = wanted["step_frequency"]
    if abs(asked - there) > 0.5:
        raise CoverageError(
            f"step_frequency {asked:g} steps/min was not captured at {wanted[branch.parameter]:g} {branch.unit}: there "
            f"it is {there:.1f} steps/min; an import with `complete: true` leaves it free"
        )


def _neighbours(branch: Branch, wanted: Mapping[str, float]) -> tuple[int, int, float]:
    value = wanted[branch.parameter]
    places = branch.places
    slack = 1e-9 * max(1.0, abs(places[-1]))
    if not places[0] - slack <= value <= places[-1] + slack:
        raise CoverageError(
            f"{branch.parameter} {value:g} {branch.unit} is outside the cycles there are: "
            f"{places[0]:g} to {places[-1]:g} {branch.unit}"
        )
    high = min(max(bisect_right(places, value), 1), len(places) - 1) if len(places) > 1 else 0
    low = max(high - 1, 0)
    if low == high:
        return low, high, 0.0
    share = (value - places[low]) / (places[high] - places[low])
    return low, high, min(max(share, 0.0), 1.0)

"""Latin squares: who sees which condition first, second, ..., so that places (and successors) are balanced."""

from __future__ import annotations


def latin_square(size: int) -> list[list[int]]:
    """The cyclic square: `size` rows, in which every condition 0 ... size - 1 stands once in every place."""
    return [[(row + place) % size for place in range(size)] for row in range(size)]


def balanced_latin_square(size: int) -> list[list[int]]:
    """A square balanced for carry-over: every condition follows every other equally often (Williams 1949).

    returns: `size` rows when size is even, 2 x size when it is odd (the square and its mirror image); every
    condition stands equally often in every place. The first row is 0, 1, size - 1, 2, size - 2, ..., as in
    Bradley (1958), and every further row adds 1 to the one before.
    """
    first, low, high = [0], 1, size - 1
    while len(first) < size:
        first.append(low if len(first) % 2 else high)
        low, high = (low + 1, high) if len(first) % 2 == 0 else (low, high - 1)
    square = [[(row + condition) % size for condition in first] for row in range(size)]
    return square if size % 2 == 0 or size == 1 else square + [list(reversed(row)) for row in square]

"""Codings of factors: sum-to-zero between participants, orthonormal within.

Sum-to-zero codes make the test of each term a type III test (Maxwell & Delaney, Designing Experiments).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache, reduce
from itertools import combinations

import numpy as np


@lru_cache(maxsize=64)
def sum_to_zero(levels: int) -> np.ndarray:
    """(levels, levels - 1) codes whose columns sum to zero; the last level is -1 throughout."""
    codes = np.vstack([np.eye(levels - 1), -np.ones(levels - 1)])
    codes.setflags(write=False)
    return codes


@lru_cache(maxsize=64)
def orthonormal(levels: int) -> np.ndarray:
    """(levels, levels - 1) Helmert contrasts of unit length: columns orthogonal to each other and to 1."""
    contrasts = np.zeros((levels, levels - 1))
    for j in range(levels - 1):
        contrasts[: j + 1, j] = 1
        contrasts[j + 1, j] = -(j + 1)
        contrasts[:, j] /= np.sqrt((j + 1) * (j + 2))
    contrasts.setflags(write=False)
    return contrasts


def kronecker(parts: Sequence[np.ndarray], start: np.ndarray) -> np.ndarray:
    """start ⊗ parts[0] ⊗ parts[1] ..."""
    return reduce(lambda left, right: np.kron(left, right), parts, start)


def within_contrasts(levels: Sequence[int], chosen: Sequence[bool]) -> np.ndarray:
    """(c, q) contrasts among the c within cells for the interaction of the chosen factors.

    The Kronecker product over all within factors (first slowest) of orthonormal contrasts where the
    factor is chosen and of the mean direction 1/sqrt(k) where it is not, so that C'C = I.
    """
    parts = [orthonormal(k) if choose else np.full((k, 1), k**-0.5) for k, choose in zip(levels, chosen, strict=True)]
    return kronecker(parts, np.ones((1, 1)))


def subsets(names: Sequence[str]) -> list[tuple[str, ...]]:
    """Every subset of `names`, the empty one first, smaller before larger, in the order named."""
    return [combination for size in range(len(names) + 1) for combination in combinations(names, size)]

"""The multivariate linear model behind the ANOVA: participants x cells, regressed on the groups."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analysis.statistics.cells import CellMeans
from analysis.statistics.contrasts import subsets, sum_to_zero

NO_VARIANCE = 1e-26
"""Share of a sum of squares under which a part of it is rounding noise: about a thousand roundings, squared."""


@dataclass(frozen=True)
class LinearFit:
    """Y = X B + E, with X the sum-to-zero coding of every between factor and interaction."""

    coefficients: np.ndarray  # B, (p, c)
    residuals: np.ndarray  # E, (N, c)
    unscaled: np.ndarray  # (X'X)^-1, (p, p)
    terms: dict[tuple[str, ...], slice]  # between term -> its columns of X; () is the intercept
    df: int  # N - p
    scale: float  # sum of squares of Y, against which rounding is judged

    @property
    def no_variance_below(self) -> float:
        """A sum of squares under this is rounding noise."""
        return NO_VARIANCE * self.scale


def fit(means: CellMeans) -> LinearFit:
    """Least squares fit of all within cells at once."""
    X, terms = design_matrix(means)
    Q, R = np.linalg.qr(X)
    inverse = np.linalg.inv(R)
    B = inverse @ (Q.T @ means.values)
    return LinearFit(
        coefficients=B,
        residuals=means.values - X @ B,
        unscaled=inverse @ inverse.T,
        terms=terms,
        df=X.shape[0] - X.shape[1],
        scale=float(np.sum(means.values**2)),
    )


def design_matrix(means: CellMeans) -> tuple[np.ndarray, dict[tuple[str, ...], slice]]:
    """(N, p) coding of the participants' groups, and which columns belong to which between term."""
    n = len(means.subjects)
    coded = {
        name: sum_to_zero(len(levels))[means.groups[:, place]]
        for place, (name, levels) in enumerate(means.between.items())
    }
    blocks, terms, start = [], {}, 0
    for term in subsets(tuple(means.between)):
        block = np.ones((n, 1))
        for name in term:
            block = (block[:, :, None] * coded[name][:, None, :]).reshape(n, -1)
        blocks.append(block)
        terms[term] = slice(start, start + block.shape[1])
        start += block.shape[1]
    return np.hstack(blocks), terms

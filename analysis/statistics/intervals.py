"""Confidence intervals to draw around means: ordinary ones, and within-participant ones."""

from __future__ import annotations

import numpy as np
from scipy import stats


def ordinary(values: np.ndarray, level: float = 0.95) -> np.ndarray:
    """Half widths (c,) of the t intervals of the columns of `values` (n, c)."""
    n = len(values)
    if n < 2:
        return np.full(values.shape[1], np.nan)
    return stats.t.ppf((1 + level) / 2, n - 1) * values.std(axis=0, ddof=1) / np.sqrt(n)


def within_participant(values: np.ndarray, level: float = 0.95) -> np.ndarray:
    """Half widths (c,) of Cousineau-Morey intervals (Morey 2008) of the columns of `values` (n, c).

    Each participant's own mean is taken out, and the variance corrected by c / (c - 1), so that the
    intervals show how well differences within participants are known, not how participants differ.
    """
    cells = values.shape[1]
    if cells < 2:
        return ordinary(values, level)
    centred = values - values.mean(axis=1, keepdims=True) + values.mean()
    return ordinary(centred, level) * np.sqrt(cells / (cells - 1))

"""Corrections of a family of p values for its size."""

from __future__ import annotations

import numpy as np

METHODS = ("tukey", "bonferroni", "holm", "none")


def bonferroni(p: np.ndarray) -> np.ndarray:
    """Each p times the number of tests in the family, at most 1; nan tests count for nothing."""
    return np.minimum(1.0, p * np.sum(~np.isnan(p)))


def holm(p: np.ndarray) -> np.ndarray:
    """Holm 1979: step-down Bonferroni, never decreasing from the smallest p upward."""
    known = np.flatnonzero(~np.isnan(p))
    order = known[np.argsort(p[known], kind="stable")]
    steps = p[order] * np.arange(len(order), 0, -1)
    adjusted = np.full(p.shape, np.nan)
    adjusted[order] = np.minimum(1.0, np.maximum.accumulate(steps)) if len(order) else steps
    return adjusted

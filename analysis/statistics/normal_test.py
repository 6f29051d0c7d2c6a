"""Shapiro and Wilk's test (Biometrika 52, 1965), also of more values than its p is known for."""

from __future__ import annotations

import numpy as np
from scipy import stats

MOST = 5000
"""Values up to which p is known (Royston 1995, Applied Statistics 44)."""


def normal_test(values: np.ndarray) -> tuple[float, float]:
    """W and p of at least three values that differ; of more than MOST, those of a random sample of MOST.

    Every so many-th value would not do: rows stand in the order of participants and conditions, and the same few
    conditions would be taken again and again. The same values give the same sample.
    """
    if len(values) > MOST:
        values = np.random.default_rng(MOST).choice(values, MOST, replace=False)
    w, p = stats.shapiro(values)
    return float(w), float(p)


def sampled(count: int) -> list[str]:
    """The note that a test of `count` residuals rests on a sample of them; none where it rests on all."""
    if count <= MOST:
        return []
    return [
        f"Normality of the residuals is tested on {MOST} of the {count}, drawn at random: its p is known up to there."
    ]

"""Jeffreys-Zellner-Siow Bayes factors for t tests (Rouder, Speckman, Sun, Morey & Iverson 2009).

pingouin's agrees to 1e-11 (a test compares them); importing it would cost every planned analysis about 2 s.
"""

from __future__ import annotations

import numpy as np

DEFAULT_SCALE = 2**0.5 / 2  # of the Cauchy prior on the standardised effect, as R's BayesFactor


def jzs(t: float, df: float, effective_n: float, scale: float = DEFAULT_SCALE) -> float:
    """BF10, the evidence for an effect over none, of a two-sided t test.

    effective_n: n for one sample or paired, n1 n2 / (n1 + n2) for two groups. The integral over g is
    taken in log g and scaled by its peak, so that large t neither overflows nor vanishes.
    """
    if not (np.isfinite(t) and df > 0):
        return float("nan")
    step = 0.02
    u = np.arange(-20, 40, step)  # log g; equal steps converge fast where both ends have died away
    g = np.exp(u)
    log_integrand = (
        -0.5 * np.log1p(effective_n * scale**2 * g)
        - (df + 1) / 2 * np.log1p(t**2 / ((1 + effective_n * scale**2 * g) * df))
        - 0.5 * np.log(2 * np.pi)
        - 1.5 * u
        - 1 / (2 * g)
        + u
    )
    peak = log_integrand.max()
    log_marginal = peak + np.log(step * np.sum(np.exp(log_integrand - peak)))
    log_bf = log_marginal + (df + 1) / 2 * np.log1p(t**2 / df)
    return float(np.exp(min(log_bf, 700.0)))

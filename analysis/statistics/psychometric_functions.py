"""Psychometric functions: how often one answer is given along a stimulus scale."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import optimize, special

from analysis.errors import AnalysisError
from analysis.statistics.cells import names_of
from analysis.statistics.columns import numbers, require, require_filled, require_other_names

SHAPES = ("logistic", "normal")
COLUMNS = ("n", "intercept", "slope", "threshold", "threshold_se", "jnd", "lapse", "deviance", "df")
BOOTSTRAP_COLUMNS = ("threshold_low", "threshold_high", "slope_low", "slope_high")

FLAT = 1e-9
"""Of the argument of F, from the lowest level to the highest: less is rounding, not a slope."""


@dataclass(frozen=True)
class _Fit:
    intercept: float
    slope: float
    lapse: float
    deviance: float
    covariance: np.ndarray  # of intercept and slope

    @property
    def threshold(self) -> float:
        return -self.intercept / self.slope

    def flat(self, x: np.ndarray) -> bool:
        """Whether it neither rises nor falls along x, so that no level is its threshold."""
        return abs(self.slope) * float(np.ptp(x)) < FLAT


def psychometric(
    data: pd.DataFrame,
    level: str,
    successes: str,
    trials: str | None = None,
    *,
    by: str | Sequence[str] = (),
    shape: str = "logistic",
    guess: float = 0.0,
    lapse: float | None = 0.0,
    bootstrap: int = 0,
    seed: int = 1,
) -> pd.DataFrame:
    """Maximum likelihood fit of P(success) = guess + (1 - guess - lapse) F(intercept + slope x level).

    level: the stimulus scale; successes: 0/1 per trial, or counts out of `trials`; by: a fit for each
    combination (the participant, say); shape: F, "logistic" or "normal" (cumulative Gaussian); guess:
    0 for a choice between two answers, 0.5 for right or wrong out of two; lapse: a fixed rate, or None
    to estimate it between 0 and 0.06 (Wichmann & Hill 2001); bootstrap: number of parametric bootstrap
    samples for the limits, 0 for none; the same seed gives the same limits.

    Returns the columns of `by`, n, intercept, slope, threshold (level where F = .5), threshold_se
    (delta method), jnd (level from F = .5 to F = .75), lapse, deviance, df, and with bootstrap
    threshold_low, threshold_high, slope_low, slope_high (95 %, percentiles). nan where answers do not
    determine a function (all the same, a perfect step, or as often yes at every level); `attrs["notes"]` names those.
    """
    by = names_of(by)
    if shape not in SHAPES:
        raise AnalysisError(f"shape must be one of {', '.join(SHAPES)}, not {shape!r}.")
    if not (0 <= guess < 1 and (lapse is None or 0 <= lapse < 1 - guess)):
        raise AnalysisError(
            f"guess and lapse are shares of answers, from 0 up and together below 1, not {guess!r} and {lapse!r}."
        )
    if bootstrap < 0:
        raise AnalysisError(f"bootstrap is a number of samples, 0 for no limits, not {bootstrap!r}.")
    require(data, [level, successes, *([trials] if trials else []), *by])
    require_other_names(by, (*COLUMNS, *BOOTSTRAP_COLUMNS))
    require_filled(data, by)
    table = pd.DataFrame({name: data[name] for name in by})
    table["_x"], table["_k"] = numbers(data, level), numbers(data, successes)
    table["_n"] = numbers(data, trials) if trials else 1.0
    table = table.dropna()
    if ((table["_k"] < 0) | (table["_k"] > table["_n"])).any():
        raise AnalysisError(f"{successes!r} must lie between 0 and the number of trials.")
    table = table[table["_n"] > 0]
    if not len(table):
        raise AnalysisError(f"{successes!r} has no trials, so there is no function to fit.")
    rows, notes = [], []
    for names, part in table.groupby(list(by), sort=True, observed=True) if by else [((), table)]:
        counts = part.groupby("_x", sort=True)[["_k", "_n"]].sum()
        x, k, n = counts.index.to_numpy(float), counts["_k"].to_numpy(float), counts["_n"].to_numpy(float)
        row = dict(zip(by, names, strict=True)) | {"n": int(n.sum())}
        fitted = _fit(x, k, n, shape, guess, lapse) if _determined(x, k, n) else None
        if fitted is None or fitted.flat(x):
            who = " × ".join(map(str, names)) or "the data"
            notes.append(f"No psychometric function can be fitted to {who}: the answers form no gradual rise or fall.")
            rows.append(row)
            continue
        rows.append(
            row
            | _described(fitted, x, k, n, shape, lapse)
            | _bootstrapped(fitted, x, n, shape, guess, lapse, bootstrap, seed)
        )
    columns = [*by, *COLUMNS, *(BOOTSTRAP_COLUMNS if bootstrap else ())]
    result = pd.DataFrame(rows).reindex(columns=columns)
    result.attrs["notes"] = notes
    return result


def _rise(shape: str, z: np.ndarray) -> np.ndarray:
    return special.expit(z) if shape == "logistic" else special.ndtr(z)


def _density(shape: str, z: np.ndarray) -> np.ndarray:
    if shape == "normal":
        return np.exp(-z * z / 2) / np.sqrt(2 * np.pi)
    p = special.expit(z)
    return p * (1 - p)


def _determined(x: np.ndarray, k: np.ndarray, n: np.ndarray) -> bool:
    """Whether the maximum of the likelihood is at a finite slope: the answers overlap on the scale."""
    if len(x) < 2 or k.sum() in (0, n.sum()):
        return False
    yes, no = x[k > 0], x[k < n]
    return not (yes.min() >= no.max() or no.min() >= yes.max())


def _fit(x: np.ndarray, k: np.ndarray, n: np.ndarray, shape: str, guess: float, lapse: float | None) -> _Fit:
    """Fisher scoring in standardised x for a fixed lapse rate; the lapse rate by golden section around it."""
    if lapse is not None:
        return _scored(x, k, n, shape, guess, lapse)
    best = optimize.minimize_scalar(
        lambda rate: _scored(x, k, n, shape, guess, float(rate)).deviance,
        bounds=(0.0, 0.06),
        method="bounded",
        options={"xatol": 1e-6},
    )
    candidates = [_scored(x, k, n, shape, guess, rate) for rate in (0.0, float(best.x), 0.06)]
    return min(candidates, key=lambda fit: fit.deviance)


def _scored(x: np.ndarray, k: np.ndarray, n: np.ndarray, shape: str, guess: float, lapse: float) -> _Fit:
    centre, spread = float(np.average(x, weights=n)), float(np.sqrt(np.cov(x, aweights=n, bias=True))) or 1.0
    design = np.column_stack([np.ones_like(x), (x - centre) / spread])
    share = 1 - guess - lapse

    def deviance(b: np.ndarray) -> float:
        p = np.clip(guess + share * _rise(shape, design @ b), 1e-12, 1 - 1e-12)
        return float(2 * np.sum(special.xlogy(k, k / n / p) + special.xlogy(n - k, (1 - k / n) / (1 - p))))

    rough = np.clip((k / n - guess) / share, 0.05, 0.95)
    b = np.linalg.lstsq(design, special.logit(rough) if shape == "logistic" else special.ndtri(rough), rcond=None)[0]
    current = deviance(b)
    information = np.eye(2)
    for _ in range(200):
        z = design @ b
        p = np.clip(guess + share * _rise(shape, z), 1e-12, 1 - 1e-12)
        slope = share * _density(shape, z)
        information = design.T @ (design * (n * slope**2 / (p * (1 - p)))[:, None])
        step = np.linalg.lstsq(information, design.T @ (slope * (k - n * p) / (p * (1 - p))), rcond=None)[0]
        size = 1.0
        while (changed := deviance(b + size * step)) > current + 1e-12 and size > 1e-6:
            size /= 2
        b, finished = (
            b + size * step,
            abs(current - changed) < 1e-13 * (1 + abs(changed)) and np.abs(step).max() < 1e-9,
        )
        current = changed
        if finished:
            break
    back = np.array([[1, -centre / spread], [0, 1 / spread]])
    covariance = back @ np.linalg.pinv(information) @ back.T
    intercept, slope_of_x = back @ b
    return _Fit(float(intercept), float(slope_of_x), lapse, current, covariance)


def _described(
    fitted: _Fit, x: np.ndarray, k: np.ndarray, n: np.ndarray, shape: str, lapse: float | None
) -> dict[str, float]:
    gradient = np.array([-1 / fitted.slope, fitted.intercept / fitted.slope**2])
    quarter = float(special.logit(0.75) if shape == "logistic" else special.ndtri(0.75))
    return {
        "intercept": fitted.intercept,
        "slope": fitted.slope,
        "threshold": fitted.threshold,
        "threshold_se": float(np.sqrt(gradient @ fitted.covariance @ gradient)),
        "jnd": quarter / fitted.slope,
        "lapse": fitted.lapse,
        "deviance": fitted.deviance,
        "df": len(x) - 2 - (lapse is None),
    }


def _bootstrapped(
    fitted: _Fit,
    x: np.ndarray,
    n: np.ndarray,
    shape: str,
    guess: float,
    lapse: float | None,
    samples: int,
    seed: int,
) -> dict[str, float]:
    if not samples:
        return {}
    rng = np.random.default_rng(seed)
    p = guess + (1 - guess - fitted.lapse) * _rise(shape, fitted.intercept + fitted.slope * x)
    found = []
    for _ in range(samples):
        k = rng.binomial(n.astype(int), p).astype(float)
        if _determined(x, k, n):
            one = _fit(x, k, n, shape, guess, lapse)
            if not one.flat(x):
                found.append((one.threshold, one.slope))
    if len(found) < samples / 2:
        return {}
    low, high = np.percentile(np.array(found), [2.5, 97.5], axis=0)
    return {
        "threshold_low": float(low[0]),
        "threshold_high": float(high[0]),
        "slope_low": float(low[1]),
        "slope_high": float(high[1]),
    }

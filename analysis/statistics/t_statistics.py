"""Single t tests from values or from published moments, with effect sizes, Bayes factor and rank test."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy import special, stats

from analysis.errors import AnalysisError
from analysis.statistics.bayes_factor import jzs
from analysis.statistics.effect_size import hedges_factor, t_noncentrality_limits
from analysis.statistics.normal_test import normal_test


def one_sample(values: np.ndarray, against: float) -> dict[str, Any]:
    """One-sample t test of values (n,) against a value in their unit; raises AnalysisError for fewer than two."""
    if len(values) < 2:
        raise AnalysisError(f"A t test needs at least 2 participants; there is {len(values)}.")
    flat = _flat(values)
    test = from_moments("one-sample", values.mean(), 0.0 if flat else values.std(ddof=1), len(values), against)
    return {**test, **shapiro(values), **_wilcoxon(values - against, values)}


def paired_test(x: np.ndarray, y: np.ndarray) -> dict[str, Any]:
    """Paired t test of x and y (n,), which are the same participants in the same order."""
    difference = x - y
    flat = float(np.sum((difference - difference.mean()) ** 2)) <= 1e-26 * float(np.sum(x**2) + np.sum(y**2))
    sd = 0.0 if flat else difference.std(ddof=1)
    test = from_moments("paired", difference.mean(), sd, len(difference), 0.0)
    return {**test, "against": math.nan, **shapiro(difference), **_wilcoxon(difference, np.concatenate([x, y]))}


def from_moments(test: str, mean: float, sd: float, n: int, against: float) -> dict[str, Any]:
    """t test from mean, SD (divisor n - 1) and n: t, p, limits, d and Bayes factor; no t without variance."""
    estimate, df, root = mean - against, n - 1, math.sqrt(n)
    row: dict[str, Any] = {
        "test": test,
        "n": n,
        "mean": mean,
        "sd": sd,
        "against": against,
        "estimate": estimate,
    }
    if not sd > 0:
        return row
    t = estimate / (sd / root)
    low, high = t_noncentrality_limits(t, df)
    half = stats.t.ppf(0.975, df) * sd / root
    return row | {
        "ci_low": estimate - half,
        "ci_high": estimate + half,
        "t": t,
        "df": float(df),
        "p": _p(t, df),
        "d": estimate / sd,
        "d_low": low / root,
        "d_high": high / root,
        "g": hedges_factor(df) * estimate / sd,
        "bf10": jzs(t, df, n),
    }


def independent_tests(x: np.ndarray, y: np.ndarray) -> list[dict[str, Any]]:
    """Student's test and Welch's; the latter only of groups of two and more, as each needs a variance of its own."""
    n, m = len(x), len(y)
    estimate = x.mean() - y.mean()
    head = {"n": n + m, "mean": np.nan, "estimate": estimate}
    if _flat(x) and _flat(y):
        return [{"test": "independent", **head}]
    vx, vy = (values.var(ddof=1) if len(values) > 1 else 0.0 for values in (x, y))
    pooled = math.sqrt(((n - 1) * vx + (m - 1) * vy) / (n + m - 2))
    rank = stats.mannwhitneyu(x, y, use_continuity=True, method="asymptotic")
    tests = [("independent", pooled * math.sqrt(1 / n + 1 / m), float(n + m - 2))]
    if min(n, m) > 1:
        df = (vx / n + vy / m) ** 2 / ((vx / n) ** 2 / (n - 1) + (vy / m) ** 2 / (m - 1))
        tests.append(("Welch", math.sqrt(vx / n + vy / m), df))
    rows = []
    for test, se, df in tests:
        t, half = estimate / se, stats.t.ppf(0.975, df) * se
        row = {
            "test": test,
            **head,
            "sd": pooled,
            "ci_low": estimate - half,
            "ci_high": estimate + half,
            "t": t,
            "df": df,
            "p": _p(t, df),
            "rank_statistic": rank.statistic,
            "rank_p": rank.pvalue,
        }
        if test == "independent":
            scale = math.sqrt(1 / n + 1 / m)
            low, high = t_noncentrality_limits(t, df)
            row |= {
                "d": estimate / pooled,
                "d_low": low * scale,
                "d_high": high * scale,
                "g": hedges_factor(df) * estimate / pooled,
                "bf10": jzs(t, df, n * m / (n + m)),
            }
        rows.append(row)
    return rows


def _p(t: float, df: float) -> float:
    return float(2 * special.stdtr(df, -abs(t)))


def _flat(values: Sequence[float] | np.ndarray) -> bool:
    values = np.asarray(values)
    return float(np.sum((values - values.mean()) ** 2)) <= 1e-26 * float(np.sum(values**2))


def shapiro(values: np.ndarray) -> dict[str, float]:
    """W and p of Shapiro and Wilk's test; empty for fewer than three or equal values."""
    if len(values) < 3 or _flat(values):
        return {}
    w, p = normal_test(values)
    return {"shapiro_w": w, "shapiro_p": p}


def _wilcoxon(differences: np.ndarray, values: np.ndarray) -> dict[str, float]:
    """Signed ranks: R's V (sum of the positive ranks) and p; differences are tied that agree to twelve figures
    of the largest of the `values` they were made of, as equal ones may differ in their last bit.
    """
    largest = float(np.abs(values).max())
    rounded = np.round(differences, 12 - math.floor(math.log10(largest))) if largest > 0 else differences
    if not np.any(rounded):
        return {}

    def test(alternative: str) -> Any:
        return stats.wilcoxon(rounded, correction=True, method="asymptotic", alternative=alternative)

    return {"rank_statistic": float(test("greater").statistic), "rank_p": float(test("two-sided").pvalue)}

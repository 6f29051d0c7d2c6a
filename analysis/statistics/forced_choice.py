"""Choices between alternatives: proportions against chance, and sensitivity d'."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from scipy import special, stats

from analysis.errors import AnalysisError, check_share
from analysis.statistics.cells import names_of
from analysis.statistics.columns import numbers, require, require_filled, require_other_names

PROPORTIONS = ("k", "n", "proportion", "chance", "p", "exact_low", "exact_high", "wilson_low", "wilson_high")
SENSITIVITIES = (
    "hits", "misses", "false_alarms", "correct_rejections", "hit_rate", "false_alarm_rate", "d_prime", "se",
    "criterion",
)  # fmt: skip


def proportions(
    data: pd.DataFrame,
    successes: str,
    trials: str | None = None,
    *,
    by: str | Sequence[str] = (),
    chance: float = 0.5,
    level: float = 0.95,
) -> pd.DataFrame:
    """Share of successes in each combination of `by`, against chance.

    successes: a column of 0 and 1 (one row per trial), or of counts out of the column `trials`.
    All rows of a combination are pooled, which is right for one participant or one answer each; to
    generalise over participants, test their proportions with `t_tests`. Rows without an answer are left out.

    Returns the columns of `by`, k, n, proportion, chance, p (exact binomial, two-sided), exact_low,
    exact_high (Clopper & Pearson 1934), wilson_low, wilson_high (Wilson 1927).
    """
    check_share("level", level, 0.95)
    check_share("chance", chance, 0.5)
    by = names_of(by)
    require(data, [successes, *([trials] if trials else []), *by])
    require_other_names(by, PROPORTIONS)
    require_filled(data, by)
    counts = pd.DataFrame({name: data[name] for name in by})
    counts["k"] = numbers(data, successes)
    counts["n"] = numbers(data, trials) if trials else 1.0
    counts = counts.dropna(subset=["k", "n"])
    whole = (counts["k"] % 1 == 0) & (counts["n"] % 1 == 0)
    if ((counts["k"] < 0) | (counts["k"] > counts["n"]) | ~whole).any():
        raise AnalysisError(f"{successes!r} must hold 0 and 1, or whole counts of at most {trials or 'the trials'!r}.")
    counts = counts[counts["n"] > 0]
    if not len(counts):
        raise AnalysisError(f"{successes!r} has no trials, so there is no share to test.")
    grouped = counts.groupby(list(by), sort=True, observed=True) if by else [((), counts)]
    rows = []
    for names, part in grouped:
        k, n = int(part["k"].sum()), int(part["n"].sum())
        test = stats.binomtest(k, n, chance)
        exact = test.proportion_ci(level, "exact")
        wilson = test.proportion_ci(level, "wilson")
        rows.append((*names, k, n, k / n, chance, test.pvalue, *exact, *wilson))
    return pd.DataFrame(rows, columns=[*by, *PROPORTIONS])


def d_prime(data: pd.DataFrame, signal: str, answer: str, *, by: str | Sequence[str] = ()) -> pd.DataFrame:
    """Sensitivity and bias of yes/no answers, one row per combination of `by` (the participant, usually).

    signal, answer: columns of 0 and 1: was there a signal, was the answer yes. Half an observation is
    added to every count so that perfect scores stay finite (log-linear rule, Hautus 1995).

    Returns the columns of `by`, hits, misses, false_alarms, correct_rejections, hit_rate,
    false_alarm_rate (both corrected), d_prime = z(H) - z(F), se (Gourevitch & Galanter 1967),
    criterion = -(z(H) + z(F)) / 2.
    """
    by = names_of(by)
    require(data, [signal, answer, *by])
    require_other_names(by, SENSITIVITIES)
    require_filled(data, [signal, answer, *by])
    table = pd.DataFrame({name: data[name] for name in by})
    table["_signal"], table["_answer"] = numbers(data, signal), numbers(data, answer)
    if not table[["_signal", "_answer"]].isin([0, 1]).all(axis=None):
        raise AnalysisError(f"{signal!r} and {answer!r} must hold 0 and 1 only.")
    grouped = table.groupby(list(by), sort=True, observed=True) if by else [((), table)]
    rows = []
    for names, part in grouped:
        yes, was = part["_answer"] == 1, part["_signal"] == 1
        hits, misses = int((yes & was).sum()), int((~yes & was).sum())
        alarms, rejections = int((yes & ~was).sum()), int((~yes & ~was).sum())
        if hits + misses == 0 or alarms + rejections == 0:
            where = f" of {' × '.join(map(str, names))}" if by else ""
            raise AnalysisError(f"The trials{where} are all with or all without a signal; d' needs both.")
        h = (hits + 0.5) / (hits + misses + 1)
        f = (alarms + 0.5) / (alarms + rejections + 1)
        zh, zf = float(special.ndtri(h)), float(special.ndtri(f))
        density = [float(np.exp(-z * z) / (2 * np.pi)) for z in (zh, zf)]
        variance = h * (1 - h) / ((hits + misses + 1) * density[0]) + f * (1 - f) / (
            (alarms + rejections + 1) * density[1]
        )
        rows.append((*names, hits, misses, alarms, rejections, h, f, zh - zf, variance**0.5, -(zh + zf) / 2))
    return pd.DataFrame(rows, columns=[*by, *SENSITIVITIES])


def d_prime_forced_choice(proportion_correct: float | np.ndarray, alternatives: int = 2) -> np.ndarray:
    """d' of an unbiased observer in a forced choice between `alternatives` (Green & Swets 1966).

    Two alternatives: sqrt(2) z(p). More: the d' at which the largest of m normals is the signal's with
    probability p, found numerically (Gauss-Hermite). p at or below chance gives d' of 0 or less.
    """
    p = np.atleast_1d(np.asarray(proportion_correct, dtype=float))
    if alternatives == 2:
        return np.sqrt(2) * special.ndtri(p)
    x, weight = np.polynomial.hermite_e.hermegauss(80)
    weight = weight / weight.sum()

    def correct(d: np.ndarray) -> np.ndarray:
        return np.sum(weight * special.ndtr(x + d[:, None]) ** (alternatives - 1), axis=1)

    low, high = np.full(p.shape, -10.0), np.full(p.shape, 10.0)
    for _ in range(60):
        middle = (low + high) / 2
        below = correct(middle) < p
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return (low + high) / 2

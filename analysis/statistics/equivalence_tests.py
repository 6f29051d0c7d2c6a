"""Evidence for sameness: two one-sided tests, because p > .05 says nothing about being equal."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd
from scipy import special

from analysis.errors import AnalysisError, check_share
from analysis.statistics.cells import Levels, names_of
from analysis.statistics.columns import require_other_names
from analysis.statistics.comparisons import pairwise

COLUMNS = ("lower_bound", "upper_bound", "t_lower", "p_lower", "t_upper", "p_upper", "equivalent")


def equivalence(
    data: pd.DataFrame,
    dv: str,
    subject: str,
    within: str | Sequence[str] = (),
    between: str | Sequence[str] = (),
    *,
    factors: str | Sequence[str],
    bound: float | tuple[float, float],
    by: str | Sequence[str] = (),
    model: str = "multivariate",
    alpha: float = 0.05,
    levels: Levels | None = None,
) -> pd.DataFrame:
    """TOST on every pairwise difference of marginal means (Schuirmann 1987).

    bound: the largest difference that would not matter, in the units of `dv`: one number above 0 for plus and
    minus, or (lower, upper), to be decided before seeing the data; alpha: of each one-sided test, in (0, 1).
    Other arguments as for `pairwise`.

    Returns the levels of `by`, a, b, estimate, se, df, lower_bound, upper_bound, t_lower, p_lower,
    t_upper, p_upper, p (the larger of the two), ci_low, ci_high (1 - 2 alpha limits, 90 % by default)
    and equivalent (p < alpha, which is when the limits lie inside the bounds). Not corrected for the
    number of pairs: to call all levels equivalent, all pairs must be. A pair without variance has no p.
    """
    lower, upper = _bounds(bound)
    check_share("alpha", alpha, 0.05)
    require_other_names(names_of(by), COLUMNS)
    pairs = pairwise(
        data, dv, subject, within, between, factors=factors, by=by, model=model, adjust="none", levels=levels
    )
    with np.errstate(all="ignore"):
        t_lower = np.where(pairs["se"] > 0, (pairs["estimate"] - lower) / pairs["se"], np.nan)
        t_upper = np.where(pairs["se"] > 0, (pairs["estimate"] - upper) / pairs["se"], np.nan)
    df = pairs["df"].to_numpy()
    half = -special.stdtrit(df, alpha) * pairs["se"]
    attrs = pairs.attrs
    table = pairs.drop(columns=["t", "p", "p_unadjusted", "ci_low", "ci_high", "d_av", "d_z"])
    table["lower_bound"], table["upper_bound"] = lower, upper
    table["t_lower"], table["p_lower"] = t_lower, special.stdtr(df, -t_lower)
    table["t_upper"], table["p_upper"] = t_upper, special.stdtr(df, t_upper)
    table["p"] = np.maximum(table["p_lower"], table["p_upper"])
    table["ci_low"], table["ci_high"] = table["estimate"] - half, table["estimate"] + half
    table["equivalent"] = table["p"] < alpha
    table.attrs = {**attrs, "adjust": "none"}
    return table


def _bounds(bound: float | tuple[float, float]) -> tuple[float, float]:
    if not isinstance(bound, tuple | list | np.ndarray):
        if not 0 < bound < math.inf:
            raise AnalysisError(
                f"bound is the largest difference that would not matter, a number above 0, not {bound!r}; "
                "give (lower, upper) for bounds that differ."
            )
        return -bound, bound
    lower, upper = bound
    if not lower < upper:
        raise AnalysisError(f"The bounds must be a lower and an upper one; {lower} is not below {upper}.")
    return lower, upper


def equivalence_of_effects(table: pd.DataFrame, eta_p2_bound: float, alpha: float = 0.05) -> pd.DataFrame:
    """Is a whole effect negligible? Noncentral F test against a bound on partial eta squared.

    table: from `anova`; eta_p2_bound: in (0, 1), the smallest effect that would matter. Campbell &
    Lakens 2021, with the noncentrality df2 x eta / (1 - eta) that matches partial eta squared of a
    repeated-measures table. Returns effect, F, df1, df2, eta_p2, bound, p and equivalent.
    """
    check_share("eta_p2_bound", eta_p2_bound, 0.02)
    check_share("alpha", alpha, 0.05)
    result = table[["effect", "F", "df1", "df2", "eta_p2"]].copy()
    noncentrality = result["df2"] * eta_p2_bound / (1 - eta_p2_bound)
    result["bound"] = eta_p2_bound
    result["p"] = special.ncfdtr(result["df1"], result["df2"], noncentrality, result["F"])
    result["equivalent"] = result["p"] < alpha
    return result

"""Pairwise comparisons of marginal means: main effects, interaction cells and simple effects."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from scipy import special

from analysis.errors import AnalysisError, check_share
from analysis.statistics.adjust import METHODS, bonferroni, holm
from analysis.statistics.cells import Levels, cell_means, names_of
from analysis.statistics.columns import require_other_names
from analysis.statistics.marginal_means import MarginalMeans, check_model, marginal_means, variance_and_df
from analysis.statistics.studentized_range import critical_value, survival

COLUMNS = ("a", "b", "estimate", "se", "df", "t", "p", "p_unadjusted", "ci_low", "ci_high", "d_av", "d_z")


def pairwise(
    data: pd.DataFrame,
    dv: str,
    subject: str,
    within: str | Sequence[str] = (),
    between: str | Sequence[str] = (),
    *,
    factors: str | Sequence[str],
    by: str | Sequence[str] = (),
    model: str = "multivariate",
    adjust: str = "tukey",
    level: float = 0.95,
    levels: Levels | None = None,
) -> pd.DataFrame:
    """All pairwise differences among the marginal means of `factors`, within each level of `by`.

    The means are those of the ANOVA with `within` and `between`. factors: one factor for a main
    effect, several for the cells of an interaction; by: simple effects, one family of comparisons for
    each of its levels; model: as for `emmeans`; adjust: "tukey" (Tukey-Kramer over the number of
    means in the family), "bonferroni", "holm" or "none".

    Returns one row per pair: the levels of `by`, then a, b (levels of the factors joined by " × "),
    estimate (a - b, units of `dv`), se, df, t, p (adjusted), p_unadjusted, ci_low, ci_high (adjusted
    like p; for Holm the Bonferroni limits), d_av (estimate over the root mean of the two residual
    variances between participants), d_z (estimate over the standard deviation of the difference; nan
    between groups). A pair without variance has no t and no p; `attrs["notes"]` says so.
    """
    check_model(model)
    check_share("level", level, 0.95)
    if adjust not in METHODS:
        raise AnalysisError(f"adjust must be one of {', '.join(METHODS)}, not {adjust!r}.")
    require_other_names(names_of(by), COLUMNS)
    means = cell_means(data, dv, subject, within, between, levels)
    return pairwise_of(
        marginal_means(means, (*names_of(by), *names_of(factors))), len(names_of(by)), model, adjust, level
    )


def pairwise_of(
    marginal: MarginalMeans,
    by: int = 0,
    model: str = "multivariate",
    adjust: str = "tukey",
    level: float = 0.95,
) -> pd.DataFrame:
    """The table of `pairwise`, from marginal means whose first `by` factors define the families."""
    cells = marginal.cells
    families = list(dict.fromkeys(cell[:by] for cell in cells))
    size = len(cells) // len(families)
    upper_a, upper_b = np.triu_indices(size, 1)
    # cells are in order with the by-factors slowest, so each family is a run of `size` cells
    starts = np.arange(len(families)) * size
    a, b = (starts[:, None] + upper_a).ravel(), (starts[:, None] + upper_b).ravel()
    family = np.repeat(np.arange(len(families)), len(upper_a))

    estimate = marginal.estimates[a] - marginal.estimates[b]
    variance, df = variance_and_df(marginal.strata(model), a, b)
    flat = variance <= marginal.model.no_variance_below
    se = np.where(flat, 0.0, np.sqrt(variance))
    df = np.where(flat, np.nan, df)
    with np.errstate(all="ignore"):
        t = np.where(flat, np.nan, estimate / se)
    unadjusted = 2 * special.stdtr(df, -np.abs(t))
    p, margin = _adjusted(unadjusted, t, df, family, size, adjust, level)
    table = pd.DataFrame([cells[i][:by] for i in a], columns=list(marginal.factors[:by]), index=range(len(a)))
    table["a"] = [" × ".join(cells[i][by:]) for i in a]
    table["b"] = [" × ".join(cells[i][by:]) for i in b]
    d_av, d_z = _standardised(marginal, a, b, estimate)
    for name, column in {
        "estimate": estimate, "se": se, "df": df, "t": t, "p": p, "p_unadjusted": unadjusted,
        "ci_low": estimate - margin * se, "ci_high": estimate + margin * se, "d_av": d_av, "d_z": d_z,
    }.items():  # fmt: skip
        table[name] = column
    notes = list(marginal.means.notes)
    if flat.any():
        pairs = [f"{table['a'][i]} and {table['b'][i]}" for i in np.flatnonzero(flat)[:5]]
        notes.append(
            f"The difference between {'; '.join(pairs)} is the same for every participant: "
            f"it has no variance, so no t and no p are given."
        )
    table.attrs = {
        "notes": notes, "n": len(marginal.means.subjects), "family_size": size,
        "adjust": adjust, "model": model, "factors": marginal.factors[by:], "by": marginal.factors[:by],
    }  # fmt: skip
    return table


def _adjusted(
    p: np.ndarray, t: np.ndarray, df: np.ndarray, family: np.ndarray, means: int, adjust: str, level: float
) -> tuple[np.ndarray, np.ndarray]:
    """Adjusted p values, and the multiple of the standard error that gives matching limits."""
    alpha = 1 - level
    if adjust == "tukey" and means > 2:
        critical = np.array([critical_value(alpha, means, round(x, 6)) if x > 0 else np.nan for x in df])
        return survival(np.abs(t) * np.sqrt(2), means, df), critical / np.sqrt(2)
    tests = np.ones(len(p))
    adjusted = p.copy()
    if adjust in ("bonferroni", "holm"):
        for one in np.unique(family):
            inside = family == one
            adjusted[inside] = (bonferroni if adjust == "bonferroni" else holm)(p[inside])
            tests[inside] = max(1, np.sum(~np.isnan(p[inside])))
    return adjusted, -special.stdtrit(df, alpha / 2 / tests)


def _standardised(
    marginal: MarginalMeans, a: np.ndarray, b: np.ndarray, estimate: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    covariance = marginal.residual_variance
    variance = np.diag(covariance)
    average = (variance[a] + variance[b]) / 2
    difference = variance[a] + variance[b] - 2 * covariance[a, b]
    same_group = np.all(marginal.between_weights[a] == marginal.between_weights[b], axis=1)
    noise = marginal.model.no_variance_below
    with np.errstate(all="ignore"):
        d_av = np.where(average > noise, estimate / np.sqrt(average), np.nan)
        d_z = np.where(same_group & (difference > noise), estimate / np.sqrt(difference), np.nan)
    return d_av, d_z

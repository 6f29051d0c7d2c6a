"""Aligned rank transform: factorial tests for ratings, percentages and other measures far from normal.

For every effect the data are stripped of all other effects, ranked, and submitted to the ANOVA, of
which that effect's row is kept (Higgins & Tashtoush 1994; Wobbrock, Findlater, Gergle & Higgins 2011).
Contrasts by ART-C (Elkin, Kay, Higgins & Wobbrock 2021).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
from scipy import special, stats

from analysis.errors import AnalysisError
from analysis.statistics.cells import CellMeans, Levels, cell_means, names_of
from analysis.statistics.comparisons import pairwise_of
from analysis.statistics.contrasts import subsets
from analysis.statistics.marginal_means import marginal_means
from analysis.statistics.repeated_measures import anova_of_cells

STRATA = ("pooled", "full")


def art_anova(
    data: pd.DataFrame,
    dv: str,
    subject: str,
    within: str | Sequence[str] = (),
    between: str | Sequence[str] = (),
    *,
    strata: str = "pooled",
    levels: Levels | None = None,
) -> pd.DataFrame:
    """ANOVA of aligned ranks, type III, one row per effect.

    Several rows per participant and cell are averaged first. strata: "pooled" has one error term
    between participants and one within them, which is what ARTool's mixed model gives for complete
    data; "full" has an error term per within effect, as a repeated-measures ANOVA, with
    Greenhouse-Geisser.

    Returns columns effect, df1, df2, ss, ss_error, F, p, eta_p2, epsilon_gg, p_gg (nan when pooled).
    Raises AnalysisError; `attrs["notes"]` as for `anova`.
    """
    if strata not in STRATA:
        raise AnalysisError(f"strata must be one of {', '.join(STRATA)}, not {strata!r}.")
    means = cell_means(data, dv, subject, within, between, levels)
    rows = []
    for effect in subsets(means.factors)[1:]:
        table = anova_of_cells(replace(means, values=aligned_ranks(means, effect)))
        row = table[table["effect"] == ":".join(effect)].iloc[0]
        rows.append(_pooled(table, row, means, effect) if strata == "pooled" else row)
    columns = ["effect", "df1", "df2", "ss", "ss_error", "F", "p", "eta_p2", "epsilon_gg", "p_gg"]
    result = pd.DataFrame(rows)[columns].reset_index(drop=True)
    constant = list(result.loc[result["F"].isna(), "effect"])
    flat = [f"{dv} has no variance left to test {', '.join(constant)}, so no F and no p are given."] if constant else []
    result.attrs = {"notes": [*means.notes, *flat], "n": len(means.subjects), "left_out": dict(means.left_out)}
    return result


def _pooled(table: pd.DataFrame, row: pd.Series, means: CellMeans, effect: tuple[str, ...]) -> pd.Series:
    """The row with the error of all within strata together, if the effect has a within part."""
    changed = row.copy()
    changed[["epsilon_gg", "p_gg"]] = math.nan
    if not set(effect) & set(means.within):
        return changed
    inside = [set(name.split(":")) & set(means.within) for name in table["effect"]]
    terms = table.assign(stratum=[tuple(sorted(s)) for s in inside])
    terms = terms[[bool(s) for s in inside]].drop_duplicates("stratum")
    error, df = float(terms["ss_error"].sum()), int(terms["df2"].sum())
    F = (row["ss"] / row["df1"]) / (error / df) if error > 0 else math.nan
    changed["ss_error"], changed["df2"], changed["F"] = error, df, F
    changed["p"] = float(special.fdtrc(row["df1"], df, F))
    changed["eta_p2"] = row["ss"] / (row["ss"] + error) if error > 0 else math.nan
    return changed


def art_contrasts(
    data: pd.DataFrame,
    dv: str,
    subject: str,
    within: str | Sequence[str] = (),
    between: str | Sequence[str] = (),
    *,
    factors: str | Sequence[str],
    adjust: str = "holm",
    levels: Levels | None = None,
) -> pd.DataFrame:
    """ART-C: pairwise comparisons of the cells of `factors`, aligned as one factor and then ranked.

    adjust: "holm", "bonferroni", "tukey" or "none". Returns the columns of `pairwise`; estimates and
    their limits are in ranks, with the pooled covariance and Satterthwaite df.
    """
    means = cell_means(data, dv, subject, within, between, levels)
    named = names_of(factors)
    marginal_means(means, named)  # complains about unknown factors before any work
    ranks = _ranks(means, aligned(means, named, whole=True))
    return pairwise_of(marginal_means(replace(means, values=ranks), named), 0, "pooled", adjust)


def aligned_ranks(means: CellMeans, effect: Sequence[str]) -> np.ndarray:
    """(N, c) mid-ranks of the values aligned for `effect`."""
    return _ranks(means, aligned(means, effect))


def _ranks(means: CellMeans, values: np.ndarray) -> np.ndarray:
    """Ranks after rounding to ten figures: equal values must not differ in their last bit."""
    largest = float(np.abs(means.values).max())
    decimals = 10 - math.floor(math.log10(largest)) if largest > 0 else 10
    return stats.rankdata(np.round(values, decimals)).reshape(values.shape)


def aligned(means: CellMeans, effect: Sequence[str], whole: bool = False) -> np.ndarray:
    """(N, c) residuals from the cell means plus the estimate of `effect`.

    The estimate of an interaction is the inclusion-exclusion sum of marginal means; `whole`: of all
    cells of these factors as if they were one factor (ART-C).
    """
    residual = means.values - _marginal(means, means.factors)
    if whole:
        return residual + _marginal(means, effect) - _marginal(means, ())
    estimate = np.zeros_like(residual)
    for part in subsets(tuple(effect)):
        estimate += (-1) ** (len(effect) - len(part)) * _marginal(means, part)
    return residual + estimate


def _marginal(means: CellMeans, factors: Sequence[str]) -> np.ndarray:
    """(N, c) mean over all rows that share the levels of `factors`, every row weighing the same."""
    shape = [len(levels) for levels in means.within.values()]
    cube = means.values.reshape(-1, *shape)
    away = tuple(1 + i for i, name in enumerate(means.within) if name not in factors)
    averaged = np.broadcast_to(cube.mean(axis=away, keepdims=True), cube.shape).reshape(means.values.shape)
    columns = [i for i, name in enumerate(means.between) if name in factors]
    result = np.empty_like(averaged)
    groups, place = np.unique(means.groups[:, columns], axis=0, return_inverse=True)
    for group in range(len(groups)):
        members = place.ravel() == group
        result[members] = averaged[members].mean(axis=0)
    return result

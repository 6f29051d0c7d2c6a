"""Estimated marginal means of the repeated-measures model, and their covariances.

Every group and every level averaged over weighs the same, as in R's emmeans.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
import pandas as pd
from scipy import stats

from analysis.errors import AnalysisError, check_share
from analysis.statistics.cells import CellMeans, Levels, cell_means, names_of
from analysis.statistics.columns import require_other_names
from analysis.statistics.contrasts import kronecker, subsets, sum_to_zero, within_contrasts
from analysis.statistics.linear_fit import LinearFit, fit

COLUMNS = ("emmean", "se", "df", "ci_low", "ci_high")
MODELS = ("multivariate", "univariate", "pooled")


@dataclass(frozen=True)
class MarginalMeans:
    """Means of the cells of some factors, each the bilinear form a' B w of the fitted model."""

    factors: tuple[str, ...]
    cells: tuple[tuple[str, ...], ...]  # the levels of each mean, first factor slowest
    between_weights: np.ndarray  # (m, p)
    within_weights: np.ndarray  # (m, c)
    model: LinearFit
    means: CellMeans

    @cached_property
    def estimates(self) -> np.ndarray:
        """(m,) marginal means, in the unit of the measure."""
        return np.einsum("ip,pc,ic->i", self.between_weights, self.model.coefficients, self.within_weights)

    @cached_property
    def residual_variance(self) -> np.ndarray:
        """(m, m) covariance between participants, within groups, of the averages behind the means."""
        scores = self.model.residuals @ self.within_weights.T
        return scores.T @ scores / self.model.df

    @cached_property
    def between_covariance(self) -> np.ndarray:
        """(m, m) covariance of the groups' weights, for an error variance of 1."""
        return self.between_weights @ self.model.unscaled @ self.between_weights.T

    def strata(self, kind: str) -> list[tuple[np.ndarray, float]]:
        """Covariance parts (m, m) and their error df; the covariance of the means is their sum.

        multivariate: one part, all covariances free, df = participants - groups.
        univariate: one part for each set of within factors, with its own mean square.
        pooled: two parts, between participants and everything within them.
        """
        if kind == "multivariate":
            return [(self.between_covariance * self.residual_variance, float(self.model.df))]
        parts, sizes = [], [len(levels) for levels in self.means.within.values()]
        pooled_basis: list[np.ndarray] = []
        for chosen in subsets(tuple(self.means.within)):
            C = within_contrasts(sizes, [name in chosen for name in self.means.within])
            if kind == "pooled" and chosen:
                pooled_basis.append(C)
            else:
                parts.append(self._part(C))
        if pooled_basis:
            parts.append(self._part(np.hstack(pooled_basis)))
        return parts

    def _part(self, C: np.ndarray) -> tuple[np.ndarray, float]:
        df = self.model.df * C.shape[1]
        mean_square = float(np.sum((self.model.residuals @ C) ** 2)) / df
        weights = self.within_weights @ C
        return self.between_covariance * (weights @ weights.T) * mean_square, float(df)


def marginal_means(means: CellMeans, factors: Sequence[str]) -> MarginalMeans:
    """The means of every combination of levels of `factors`, averaged over all other factors."""
    unknown = [name for name in factors if name not in means.factors]
    if unknown:
        raise AnalysisError(
            f"{unknown[0]!r} is not a factor of this analysis; the factors are {', '.join(means.factors)}."
        )
    if not factors or len(set(factors)) < len(factors):
        raise AnalysisError("Name the factors whose means are wanted, each once.")
    model = fit(means)
    cells = tuple(product(*(means.levels(name) for name in factors)))
    chosen = [dict(zip(factors, cell, strict=True)) for cell in cells]
    return MarginalMeans(
        tuple(factors),
        cells,
        np.array([_between_row(means, cell) for cell in chosen]),
        np.array([_within_row(means, cell) for cell in chosen]),
        model,
        means,
    )


def _within_row(means: CellMeans, cell: dict[str, str]) -> np.ndarray:
    parts = []
    for name, levels in means.within.items():
        k = len(levels)
        parts.append(np.eye(k)[levels.index(cell[name])] if name in cell else np.full(k, 1 / k))
    return kronecker(parts, np.ones(1))


def _between_row(means: CellMeans, cell: dict[str, str]) -> np.ndarray:
    """Coding of a group; factors averaged over have the mean of their codes, which is zero."""
    codes = {
        name: sum_to_zero(len(levels))[levels.index(cell[name])] if name in cell else np.zeros(len(levels) - 1)
        for name, levels in means.between.items()
    }
    return np.concatenate(
        [kronecker([codes[name] for name in term], np.ones(1)) for term in subsets(tuple(means.between))]
    )


def variance_and_df(
    parts: list[tuple[np.ndarray, float]], rows: np.ndarray, others: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Variance of means `rows` (or of the differences rows - others) and its df (Satterthwaite 1946)."""
    total, spread = np.zeros(len(rows)), np.zeros(len(rows))
    for covariance, df in parts:
        variance = np.diag(covariance)
        part = variance[rows]
        if others is not None:
            part = part + variance[others] - 2 * covariance[rows, others]
            part = np.where(part < 1e-13 * (variance[rows] + variance[others]), 0.0, part)
        total += part
        spread += part**2 / df
    with np.errstate(all="ignore"):
        return total, np.where(spread > 0, total**2 / spread, np.nan)


def check_model(model: str) -> None:
    """Raises AnalysisError for the name of a model of error that there is not."""
    if model not in MODELS:
        raise AnalysisError(f"model must be one of {', '.join(MODELS)}, not {model!r}.")


def emmeans(
    data: pd.DataFrame,
    dv: str,
    subject: str,
    within: str | Sequence[str] = (),
    between: str | Sequence[str] = (),
    *,
    factors: str | Sequence[str],
    model: str = "multivariate",
    level: float = 0.95,
    levels: Levels | None = None,
) -> pd.DataFrame:
    """Estimated marginal means of the ANOVA with these within and between factors.

    factors: whose combinations get a mean; model: "multivariate" (default of afex and jamovi),
    "univariate" (one error variance per stratum, Satterthwaite df) or "pooled" (between and within);
    level: of the confidence interval.

    Returns one row per combination: the factors' levels, then emmean, se, df, ci_low, ci_high; in the
    units of `dv`. Groups weigh equally. `attrs["notes"]` as for `anova`. Raises AnalysisError.
    """
    check_model(model)
    check_share("level", level, 0.95)
    require_other_names(names_of(factors), COLUMNS)
    means = cell_means(data, dv, subject, within, between, levels)
    return emmeans_of(marginal_means(means, names_of(factors)), model, level)


def emmeans_of(marginal: MarginalMeans, model: str = "multivariate", level: float = 0.95) -> pd.DataFrame:
    """The table of `emmeans`, from marginal means."""
    rows = np.arange(len(marginal.cells))
    variance, df = variance_and_df(marginal.strata(model), rows)
    se = np.sqrt(variance)
    half = stats.t.ppf((1 + level) / 2, df) * se
    table = pd.DataFrame(marginal.cells, columns=list(marginal.factors))
    table["emmean"] = marginal.estimates
    table["se"], table["df"] = se, df
    table["ci_low"], table["ci_high"] = marginal.estimates - half, marginal.estimates + half
    table.attrs = {"notes": list(marginal.means.notes), "n": len(marginal.means.subjects)}
    return table

"""Multiple linear regression, fitted by statsmodels, with what a reviewer asks for beside the coefficients."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from analysis.errors import AnalysisError, check_share, listed
from analysis.statistics.cells import names_of
from analysis.statistics.columns import labels, numbers, require
from analysis.statistics.normal_test import normal_test


def regression(data: pd.DataFrame, dv: str, predictors: str | Sequence[str], level: float = 0.95) -> pd.DataFrame:
    """Ordinary least squares of `dv` on the predictors, one row per term.

    predictors: number columns, or label columns, which become one 0/1 column per level but the first,
    named `column[level]`. Rows with a missing value are left out.

    Returns columns term, estimate, se, t, p, ci_low, ci_high, beta (standardised: all variables scaled
    to unit variance), beta_low, beta_high, vif, ss (type III). `attrs["fit"]` is a dict: n, r2,
    r2_adjusted, rmse (over n, as jamovi), residual_se (over the df), F, df1, df2, p, aic, bic,
    log_likelihood (AIC and BIC count the error variance), durbin_watson, shapiro_w, shapiro_p,
    loo_rmse (leave one out). Raises AnalysisError, also when predictors are linearly dependent.
    """
    check_share("level", level, 0.95)
    fitted, terms, _ = _fitted(data, dv, names_of(predictors))
    X, y = fitted.model.exog, fitted.model.endog
    if float(fitted.centered_tss) <= 1e-26 * float(y @ y):
        raise AnalysisError(f"{dv!r} has no variance, so there is nothing to explain.")
    if _exact(fitted):
        raise AnalysisError(
            f"{listed(terms[1:])} explain {dv!r} without a remainder, so there is no variance to test against; "
            "was one computed from the other?"
        )
    scale = np.append(np.nan, X[:, 1:].std(axis=0, ddof=1)) / y.std(ddof=1)
    low, high = np.asarray(fitted.conf_int(1 - level)).T
    inverse = np.diag(fitted.normalized_cov_params)
    spread = np.sum((X - X.mean(axis=0)) ** 2, axis=0)
    ss = fitted.params**2 / inverse
    ss[0] = np.nan
    table = pd.DataFrame(
        {
            "term": terms, "estimate": fitted.params, "se": fitted.bse, "t": fitted.tvalues, "p": fitted.pvalues,
            "ci_low": low, "ci_high": high, "beta": fitted.params * scale, "beta_low": low * scale,
            "beta_high": high * scale, "vif": np.append(np.nan, (spread * inverse)[1:]), "ss": ss,
        }
    )  # fmt: skip
    table.attrs = {"fit": _summary(fitted), "notes": _notes(table, len(y), len(data))}
    return table


def regression_diagnostics(data: pd.DataFrame, dv: str, predictors: str | Sequence[str]) -> pd.DataFrame:
    """Per row used: row (from 1), fitted, residual, studentised (internally), leverage, cooks_distance."""
    fitted, _, rows = _fitted(data, dv, names_of(predictors))
    influence = fitted.get_influence()
    return pd.DataFrame(
        {
            "row": rows + 1,
            "fitted": fitted.fittedvalues,
            "residual": fitted.resid,
            "studentised": influence.resid_studentized_internal,
            "leverage": influence.hat_matrix_diag,
            "cooks_distance": influence.cooks_distance[0],
        }
    )


def _fitted(data: pd.DataFrame, dv: str, predictors: tuple[str, ...]) -> tuple[Any, list[str], np.ndarray]:
    """statsmodels' results, the names of the coefficients, and the positions of the rows used."""
    from statsmodels.regression.linear_model import OLS

    require(data, [dv, *predictors])
    if not predictors:
        raise AnalysisError("Name at least one predictor.")
    if dv in predictors:
        raise AnalysisError(f"{dv!r} cannot be explained by itself; leave it out of the predictors.")
    y = numbers(data, dv)
    terms, columns = ["(intercept)"], [np.ones(len(y))]
    for name in predictors:
        if pd.api.types.is_numeric_dtype(data[name]):
            terms.append(name)
            columns.append(numbers(data, name))
        else:
            found = labels(data, name)
            for code, level in enumerate(found.levels[1:], start=1):
                terms.append(f"{name}[{level}]")
                columns.append(np.where(found.codes < 0, np.nan, found.codes == code).astype(float))
    X = np.column_stack(columns)
    rows = np.flatnonzero(~np.isnan(X).any(axis=1) & ~np.isnan(y))
    X, y = X[rows], y[rows]
    if len(y) <= X.shape[1]:
        raise AnalysisError(
            f"{len(y)} complete rows are too few for {X.shape[1] - 1} predictors: at least {X.shape[1] + 1} are needed."
        )
    size = np.sqrt(np.sum(X**2, axis=0))
    if np.any(size == 0) or np.linalg.matrix_rank(X / size, tol=1e-10) < X.shape[1]:
        raise AnalysisError(
            f"The predictors {listed(terms[1:])} are linearly dependent (one can be computed from the others, "
            "or does not vary); leave one out."
        )
    return OLS(y, X, hasconst=True).fit(method="qr"), terms, rows


def _exact(fitted: Any) -> bool:
    """Whether nothing but rounding is left over."""
    y = fitted.model.endog
    return float(fitted.ssr) <= 1e-24 * float(y @ y)


def _summary(fitted: Any) -> dict[str, float]:
    from statsmodels.stats.stattools import durbin_watson

    n, p = fitted.model.exog.shape
    w, shapiro_p = normal_test(np.asarray(fitted.resid)) if n >= 3 else (np.nan, np.nan)
    return {
        "n": n,
        "r2": float(fitted.rsquared),
        "r2_adjusted": float(fitted.rsquared_adj),
        "rmse": float(np.sqrt(fitted.ssr / n)),
        "residual_se": float(np.sqrt(fitted.scale)),
        "F": float(fitted.fvalue),
        "df1": p - 1,
        "df2": n - p,
        "p": float(fitted.f_pvalue),
        "log_likelihood": float(fitted.llf),
        "aic": float(fitted.aic) + 2,
        "bic": float(fitted.bic + np.log(n)),
        "durbin_watson": float(durbin_watson(fitted.resid)),
        "shapiro_w": w,
        "shapiro_p": shapiro_p,
        "loo_rmse": float(np.sqrt(np.mean((fitted.resid / (1 - fitted.get_influence().hat_matrix_diag)) ** 2))),
    }


def _notes(table: pd.DataFrame, used: int, rows: int) -> list[str]:
    notes = []
    if used < rows:
        notes.append(f"{rows - used} of {rows} rows have a missing value and were left out.")
    high = table.loc[table["vif"] > 5, "term"]
    if len(high):
        notes.append(f"{listed(high)}: variance inflation above 5, so single coefficients are poorly determined.")
    return notes

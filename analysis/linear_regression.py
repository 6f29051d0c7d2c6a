"""Multiple linear regression with what a reviewer asks for beside the coefficients."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import special, stats

from analysis.cells import names_of
from analysis.columns import labels, numbers, require
from analysis.errors import AnalysisError, listed


@dataclass(frozen=True)
class _Regression:
    terms: tuple[str, ...]
    X: np.ndarray
    y: np.ndarray
    coefficients: np.ndarray
    inverse: np.ndarray  # (X'X)^-1
    residuals: np.ndarray
    rows: np.ndarray  # positions of the rows used

    @property
    def df(self) -> int:
        return len(self.y) - self.X.shape[1]

    @property
    def leverage(self) -> np.ndarray:
        return np.einsum("ij,jk,ik->i", self.X, self.inverse, self.X)


def regression(data: pd.DataFrame, dv: str, predictors: str | Sequence[str], level: float = 0.95) -> pd.DataFrame:
    """Ordinary least squares of `dv` on the predictors, one row per term.

    predictors: number columns, or label columns, which become one 0/1 column per level but the first,
    named `column[level]`. Rows with a missing value are left out.

    Returns columns term, estimate, se, t, p, ci_low, ci_high, beta (standardised: all variables scaled
    to unit variance), beta_low, beta_high, vif, ss (type III). `attrs["fit"]` is a dict: n,
    r2, r2_adjusted, rmse
    (over n, as jamovi), residual_se (over the df), F, df1, df2, p, aic, bic, log_likelihood (AIC and
    BIC count the error variance), durbin_watson, shapiro_w, shapiro_p, loo_rmse (leave one out).
    Raises AnalysisError, also when predictors are linearly dependent.
    """
    model = _fitted(data, dv, names_of(predictors))
    p = model.X.shape[1]
    rss = float(model.residuals @ model.residuals)
    tss = float(np.sum((model.y - model.y.mean()) ** 2))
    if tss <= 1e-26 * float(model.y @ model.y):
        raise AnalysisError(f"{dv!r} has no variance, so there is nothing to explain.")
    se = np.sqrt(rss / model.df * np.diag(model.inverse))
    t = model.coefficients / se
    critical = stats.t.ppf((1 + level) / 2, model.df)
    scale = np.append(np.nan, model.X[:, 1:].std(axis=0, ddof=1)) / model.y.std(ddof=1)
    beta, beta_half = model.coefficients * scale, critical * se * scale
    if p > 1:  # the reference fits standardised variables, whose df are the same
        spread = np.sum((model.X[:, 1:] - model.X[:, 1:].mean(axis=0)) ** 2, axis=0)
        vif = np.append(np.nan, spread * np.diag(model.inverse)[1:])
    else:
        vif = np.array([np.nan])
    ss = model.coefficients**2 / np.diag(model.inverse)
    ss[0] = np.nan
    table = pd.DataFrame(
        {
            "term": model.terms,
            "estimate": model.coefficients,
            "se": se,
            "t": t,
            "p": 2 * special.stdtr(model.df, -np.abs(t)),
            "ci_low": model.coefficients - critical * se,
            "ci_high": model.coefficients + critical * se,
            "beta": beta,
            "beta_low": beta - beta_half,
            "beta_high": beta + beta_half,
            "vif": vif,
            "ss": ss,
        }
    )
    table.attrs = {"fit": _summary(model, rss, tss), "notes": _notes(table, model, len(data))}
    return table


def regression_diagnostics(data: pd.DataFrame, dv: str, predictors: str | Sequence[str]) -> pd.DataFrame:
    """Per row used: row (from 1), fitted, residual, studentised (internally), leverage, cooks_distance."""
    model = _fitted(data, dv, names_of(predictors))
    h = model.leverage
    variance = float(model.residuals @ model.residuals) / model.df
    studentised = model.residuals / np.sqrt(variance * (1 - h))
    return pd.DataFrame(
        {
            "row": model.rows + 1,
            "fitted": model.y - model.residuals,
            "residual": model.residuals,
            "studentised": studentised,
            "leverage": h,
            "cooks_distance": studentised**2 * h / (1 - h) / model.X.shape[1],
        }
    )


def _fitted(data: pd.DataFrame, dv: str, predictors: tuple[str, ...]) -> _Regression:
    require(data, [dv, *predictors])
    if not predictors:
        raise AnalysisError("Name at least one predictor.")
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
            f"The predictors {listed(terms[1:])} are linearly dependent (one can be computed from the "
            f"others, "
            "or does not vary); leave one out."
        )
    Q, R = np.linalg.qr(X)
    root = np.linalg.inv(R)
    coefficients = root @ (Q.T @ y)
    return _Regression(tuple(terms), X, y, coefficients, root @ root.T, y - X @ coefficients, rows)


def _summary(model: _Regression, rss: float, tss: float) -> dict[str, float]:
    n, p = model.X.shape
    df1, df2, r2 = p - 1, model.df, 1 - rss / tss
    F = (tss - rss) / df1 / (rss / df2) if rss > 0 else float("nan")
    log_likelihood = -n / 2 * (np.log(2 * np.pi) + np.log(rss / n) + 1) if rss > 0 else float("nan")
    w, shapiro_p = stats.shapiro(model.residuals) if rss > 0 and n >= 3 else (float("nan"), float("nan"))
    return {
        "n": n,
        "r2": r2,
        "r2_adjusted": 1 - (1 - r2) * (n - 1) / df2,
        "rmse": float(np.sqrt(rss / n)),
        "residual_se": float(np.sqrt(rss / df2)),
        "F": F,
        "df1": df1,
        "df2": df2,
        "p": float(special.fdtrc(df1, df2, F)),
        "log_likelihood": float(log_likelihood),
        "aic": float(2 * (p + 1) - 2 * log_likelihood),
        "bic": float(np.log(n) * (p + 1) - 2 * log_likelihood),
        "durbin_watson": float(np.sum(np.diff(model.residuals) ** 2) / rss) if rss > 0 else float("nan"),
        "shapiro_w": float(w),
        "shapiro_p": float(shapiro_p),
        "loo_rmse": float(np.sqrt(np.mean((model.residuals / (1 - model.leverage)) ** 2))),
    }


def _notes(table: pd.DataFrame, model: _Regression, rows: int) -> list[str]:
    notes = []
    if len(model.y) < rows:
        notes.append(f"{rows - len(model.y)} of {rows} rows have a missing value and were left out.")
    high = table.loc[table["vif"] > 5, "term"]
    if len(high):
        notes.append(f"{listed(high)}: variance inflation above 5, so single coefficients are poorly determined.")
    return notes

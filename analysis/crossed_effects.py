"""Linear mixed model with random intercepts of participants and of stimuli, crossed.

An ANOVA of participants' means generalises over people, to these very stimuli only. Here stimuli
(actors, clips) are a sample too (Judd, Westfall & Kenny 2012). Fitted by REML through the small system
of the random effects (Bates, Mächler, Bolker & Walker 2015), with Satterthwaite degrees of freedom for
each coefficient and each type III test (Fai & Cornelius 1996, as R's lmerTest).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import optimize, special, stats

from analysis.cells import Levels, names_of
from analysis.columns import labels, numbers, require
from analysis.contrasts import subsets, sum_to_zero
from analysis.errors import AnalysisError

FEW_STIMULI = 8


@dataclass(frozen=True)
class _Products:
    """Everything the likelihood needs: cross products of fixed columns X, random columns Z and y."""

    n: int
    XX: np.ndarray
    Xy: np.ndarray
    yy: float
    ZZ: np.ndarray
    ZX: np.ndarray
    Zy: np.ndarray
    group: np.ndarray  # (q,) which random effect each column of Z belongs to

    def solved(self, ratios: np.ndarray) -> tuple[np.ndarray, np.ndarray, float, float]:
        """X'V^-1 X, X'V^-1 y, y'V^-1 y and log|V| for standard deviations in units of the residual's."""
        scale = ratios[self.group]
        M = np.eye(len(scale)) + scale[:, None] * self.ZZ * scale
        L = np.linalg.cholesky(M)
        A = np.linalg.solve(L, scale[:, None] * self.ZX)
        b = np.linalg.solve(L, scale * self.Zy)
        return self.XX - A.T @ A, self.Xy - A.T @ b, self.yy - float(b @ b), 2 * float(np.log(np.diag(L)).sum())

    def deviance(self, ratios: np.ndarray, sigma: float | None = None) -> float:
        """REML criterion, -2 log restricted likelihood; profiled over the residual s.d. unless given."""
        XVX, XVy, yVy, log_v = self.solved(ratios)
        beta = np.linalg.solve(XVX, XVy)
        df = self.n - len(beta)
        rss = yVy - float(beta @ XVy)
        _, log_x = np.linalg.slogdet(XVX)
        if sigma is None:
            return df * (1 + np.log(2 * np.pi * rss / df)) + log_v + float(log_x)
        return df * np.log(2 * np.pi * sigma**2) + rss / sigma**2 + log_v + float(log_x)


def mixed_model(
    data: pd.DataFrame,
    dv: str,
    subject: str,
    stimulus: str,
    factors: str | Sequence[str] = (),
    covariates: str | Sequence[str] = (),
    *,
    levels: Levels | None = None,
    level: float = 0.95,
) -> pd.DataFrame:
    """REML fit of dv ~ factors (all interactions) + covariates + (1 | subject) + (1 | stimulus).

    data: one row per trial; rows without a value are left out, nobody is dropped for a missing cell.
    factors: label columns, within or between, coded to sum to zero; covariates: number columns (trial
    order, say), entered as they are.

    Returns one table with a column `part`: "effect" rows are type III F tests (term, df1, df2,
    statistic F, p), "coefficient" rows (term `factor[level]`, estimate, se, df2, statistic t, p,
    ci_low, ci_high; the last level of a factor is minus the sum of the others), "deviation" rows the
    standard deviations of participants, stimuli and residuals (estimate; share: of the total
    variance). `attrs["reml"]` is the REML criterion, `attrs["notes"]` sentences. Raises AnalysisError.
    """
    names, numeric = names_of(factors), names_of(covariates)
    require(data, [dv, subject, stimulus, *names, *numeric])
    y = numbers(data, dv)
    X, terms, columns = _fixed(data, names, numeric, levels)
    random = [labels(data, subject), labels(data, stimulus)]
    have = ~np.isnan(y) & ~np.isnan(X).any(axis=1) & (random[0].codes >= 0) & (random[1].codes >= 0)
    if have.sum() <= X.shape[1] + 2:
        raise AnalysisError(f"{int(have.sum())} complete rows are too few for {X.shape[1]} coefficients.")
    X, y = X[have], y[have]
    if np.linalg.matrix_rank(X) < X.shape[1]:
        raise AnalysisError(
            f"Some combination of {', '.join((*names, *numeric))} never occurs, so its effect cannot be "
            "estimated; leave a factor out."
        )
    Z, group = _indicators([column.codes[have] for column in random])
    if float(np.sum((y - y.mean()) ** 2)) <= 1e-26 * float(y @ y):
        raise AnalysisError(f"{dv!r} has no variance, so there is no model to fit.")
    scale = float(y.std())
    products = _Products(
        len(y), X.T @ X, X.T @ y / scale, float(y @ y) / scale**2, Z.T @ Z, Z.T @ X, Z.T @ y / scale, group
    )
    fitted = _Fitted(products, scale)
    return _table(fitted, terms, columns, [subject, stimulus], random, len(data) - int(have.sum()), level)


class _Fitted:
    """The REML estimates and what Satterthwaite's method needs around them."""

    def __init__(self, products: _Products, scale: float) -> None:
        self.products, self.scale = products, scale
        self.ratios = self._optimum()
        XVX, XVy, yVy, _ = products.solved(self.ratios)
        self.beta = np.linalg.solve(XVX, XVy)
        self.sigma = float(np.sqrt((yVy - float(self.beta @ XVy)) / (products.n - len(self.beta))))
        self.covariance = self.sigma**2 * np.linalg.inv(XVX)
        self.free = np.flatnonzero(self.ratios > 1e-4)  # a deviation of zero is at the edge: held there
        self.parameters = np.append(self.ratios[self.free], self.sigma)
        self.uncertainty = 2 * np.linalg.pinv(_hessian(self._deviance, self.parameters))
        self.gradients = self._gradients()

    def _optimum(self) -> np.ndarray:
        best = min(
            (
                optimize.minimize(
                    lambda r: self.products.deviance(np.abs(r)), [start, start], method="Nelder-Mead",
                    options={"xatol": 1e-9, "fatol": 1e-11, "maxiter": 4000},
                )
                for start in (0.3, 1.5)
            ),
            key=lambda result: result.fun,
        )  # fmt: skip
        ratios = np.abs(best.x)
        for i in range(2):  # on the edge?
            edge = ratios.copy()
            edge[i] = 0.0
            if self.products.deviance(edge) <= best.fun + 1e-9:
                ratios = edge
        return ratios

    def _expanded(self, parameters: np.ndarray) -> tuple[np.ndarray, float]:
        ratios = np.zeros(2)
        ratios[self.free] = parameters[:-1]
        return ratios, float(parameters[-1])

    def _deviance(self, parameters: np.ndarray) -> float:
        return self.products.deviance(*self._expanded(parameters))

    def _covariance_at(self, parameters: np.ndarray) -> np.ndarray:
        ratios, sigma = self._expanded(parameters)
        return sigma**2 * np.linalg.inv(self.products.solved(ratios)[0])

    def _gradients(self) -> np.ndarray:
        """(parameters, p, p) derivatives of the coefficients' covariance."""
        found = []
        for i, value in enumerate(self.parameters):
            h = 1e-4 * max(abs(value), 1e-2)
            step = np.zeros(len(self.parameters))
            step[i] = h
            up, down = self._covariance_at(self.parameters + step), self._covariance_at(self.parameters - step)
            found.append((up - down) / (2 * h))
        return np.array(found)

    def df(self, contrast: np.ndarray) -> float:
        """Satterthwaite df of one contrast of the coefficients."""
        variance = float(contrast @ self.covariance @ contrast)
        gradient = np.einsum("i,kij,j->k", contrast, self.gradients, contrast)
        spread = float(gradient @ self.uncertainty @ gradient)
        return 2 * variance**2 / spread if spread > 0 else float("inf")

    def f_test(self, columns: list[int]) -> tuple[float, float]:
        """F and its denominator df for several coefficients at once (Fai & Cornelius 1996)."""
        part = self.covariance[np.ix_(columns, columns)]
        values, vectors = np.linalg.eigh(part)
        q = len(columns)
        t_squared = (vectors.T @ self.beta[columns]) ** 2 / values
        contrasts = np.zeros((q, len(self.beta)))
        contrasts[:, columns] = vectors.T
        dfs = np.array([self.df(contrast) for contrast in contrasts])
        F = float(t_squared.sum() / q)
        if q == 1:
            return F, float(dfs[0])
        if np.ptp(dfs) < 1e-8 * dfs.mean():
            return F, float(dfs.mean())
        E = float(np.sum(dfs[dfs > 2] / (dfs[dfs > 2] - 2)))
        return F, 2 * E / (E - q) if q < E else 0.0


def _hessian(function, x: np.ndarray) -> np.ndarray:  # type: ignore[no-untyped-def]
    k = len(x)
    h = 1e-3 * np.maximum(np.abs(x), 1e-2)
    H = np.zeros((k, k))
    for i in range(k):
        for j in range(i, k):
            total = 0.0
            for a in (1, -1):
                for b in (1, -1):
                    step = np.zeros(k)
                    step[i] += a * h[i]
                    step[j] += b * h[j]
                    total += a * b * function(x + step)
            H[i, j] = H[j, i] = total / (4 * h[i] * h[j])
    return H


def _fixed(
    data: pd.DataFrame, factors: tuple[str, ...], covariates: tuple[str, ...], levels: Levels | None
) -> tuple[np.ndarray, list[str], dict[str, list[int]]]:
    """Columns of X, a name for each, and which columns belong to which effect."""
    found = {name: labels(data, name, (levels or {}).get(name)) for name in factors}
    coded = {}
    for name, column in found.items():
        if len(column.levels) < 2:
            raise AnalysisError(f"Factor {name!r} has only one level in the data; leave it out.")
        codes = sum_to_zero(len(column.levels))[column.codes].astype(float)
        codes[column.codes < 0] = np.nan
        coded[name] = codes
    blocks, terms, effects = [np.ones((len(data), 1))], ["(intercept)"], {}
    for effect in subsets(factors)[1:]:
        block, names = np.ones((len(data), 1)), [""]
        for name in effect:
            block = (block[:, :, None] * coded[name][:, None, :]).reshape(len(data), -1)
            names = [f"{a}:{name}[{b}]" for a in names for b in found[name].levels[:-1]]
        effects[":".join(effect)] = list(range(len(terms), len(terms) + block.shape[1]))
        terms += [text.lstrip(":") for text in names]
        blocks.append(block)
    for name in covariates:
        effects[name] = [len(terms)]
        terms.append(name)
        blocks.append(numbers(data, name)[:, None])
    return np.hstack(blocks), terms, effects


def _indicators(codes: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    parts, group = [], []
    for place, column in enumerate(codes):
        used = np.unique(column)
        parts.append((column[:, None] == used).astype(float))
        group += [place] * len(used)
    return np.hstack(parts), np.array(group)


def _table(
    fitted: _Fitted, terms: list[str], effects: dict[str, list[int]], names: list[str], random: list, missing: int,
    level: float,
) -> pd.DataFrame:  # fmt: skip
    rows: list[dict[str, object]] = []
    for effect, columns in effects.items():
        F, df2 = fitted.f_test(columns)
        rows.append({"part": "effect", "term": effect, "df1": len(columns), "df2": df2, "statistic": F,
                     "p": float(stats.f.sf(F, len(columns), df2))})  # fmt: skip
    for place, term in enumerate(terms):
        unit = np.eye(len(terms))[place]
        df = fitted.df(unit)
        estimate = fitted.beta[place] * fitted.scale
        se = float(np.sqrt(fitted.covariance[place, place])) * fitted.scale
        half = float(stats.t.ppf((1 + level) / 2, df)) * se
        rows.append({"part": "coefficient", "term": term, "estimate": estimate, "se": se, "df1": 1, "df2": df,
                     "statistic": estimate / se, "p": float(2 * special.stdtr(df, -abs(estimate / se))),
                     "ci_low": estimate - half, "ci_high": estimate + half})  # fmt: skip
    deviations = np.append(fitted.ratios * fitted.sigma, fitted.sigma) * fitted.scale
    for name, deviation in zip([*names, "residual"], deviations, strict=True):
        share = deviation**2 / np.sum(deviations**2)
        rows.append({"part": "deviation", "term": name, "estimate": deviation, "share": share})
    columns_ = ["part", "term", "estimate", "se", "df1", "df2", "statistic", "p", "ci_low", "ci_high", "share"]
    table = pd.DataFrame(rows).reindex(columns=columns_)
    n, p = fitted.products.n, len(terms)
    notes = []
    if missing:
        notes.append(f"{missing} rows with a missing value were left out.")
    if len(random[1].levels) < FEW_STIMULI:
        notes.append(
            f"There are only {len(random[1].levels)} levels of {names[1]!r}: "
            "no method can generalise to others from so few."
        )
    for name, deviation in zip(names, deviations[:2], strict=True):
        if deviation == 0:
            notes.append(f"The variance between levels of {name!r} is estimated at zero.")
    reml = fitted.products.deviance(fitted.ratios) + (n - p) * 2 * float(np.log(fitted.scale))
    table.attrs = {"reml": reml, "n": n, "notes": notes}
    return table

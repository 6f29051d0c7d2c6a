"""Linear mixed model with random intercepts of participants and of stimuli, crossed.

An ANOVA of participants' means generalises over people, to these very stimuli only. Here stimuli
(actors, clips) are a sample too (Judd, Westfall & Kenny 2012).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from scipy import special, stats

from analysis.errors import AnalysisError, check_share, listed
from analysis.statistics.cells import Levels, names_of
from analysis.statistics.columns import labels, numbers, require, require_no_colon
from analysis.statistics.contrasts import subsets, sum_to_zero
from analysis.statistics.normal_test import normal_test, sampled
from analysis.statistics.restricted_likelihood import Fitted, Products

FEW_STIMULI = 8


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
    variance). `attrs["reml"]` is the REML criterion, `attrs["checks"]` Shapiro-Wilk's residual_w,
    residual_p, intercept_w and intercept_p (of participants), `attrs["notes"]` sentences. Raises
    AnalysisError.
    """
    check_share("level", level, 0.95)
    names, numeric = names_of(factors), names_of(covariates)
    require(data, [dv, subject, stimulus, *names, *numeric])
    require_no_colon((*names, *numeric))
    if subject == stimulus:
        raise AnalysisError(f"{subject!r} is named as participant and as stimulus; name the column of each.")
    roles = [dv, subject, stimulus, *names, *numeric]
    twice = [name for name in dict.fromkeys(roles) if roles.count(name) > 1]
    if twice:
        raise AnalysisError(f"{listed(map(repr, twice))} is named twice; a stimulus, a factor and a covariate differ.")
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
    products = Products(
        len(y), X.T @ X, X.T @ y / scale, float(y @ y) / scale**2, Z.T @ Z, Z.T @ X, Z.T @ y / scale, group
    )
    _check_remainder(X, Z, (y - y.mean()) / scale, dv)
    fitted = Fitted(products, scale)
    table = _table(fitted, terms, columns, [subject, stimulus], random, len(data) - int(have.sum()), level)
    modes = fitted.modes()
    table.attrs["checks"] = _normality(y / scale - X @ fitted.beta - Z @ modes, modes[group == 0])
    table.attrs["notes"] += sampled(len(y))
    return table


def _check_remainder(X: np.ndarray, Z: np.ndarray, y: np.ndarray, dv: str) -> None:
    """AnalysisError where coefficients and intercepts leave less than 1e-5 of the standard deviation of `y`."""
    both = np.hstack([X, Z])
    projected = both.T @ y
    explained = float(projected @ np.linalg.lstsq(both.T @ both, projected, rcond=1e-10)[0])
    if float(y @ y) - explained <= 1e-10 * float(y @ y):
        raise AnalysisError(
            f"Participants, stimuli and factors together explain {dv!r} without a remainder, so there is no residual "
            "variance to test against; a mixed model needs several rows of every participant and stimulus."
        )


def _normality(residuals: np.ndarray, intercepts: np.ndarray) -> dict[str, float]:
    found: dict[str, float] = {}
    for name, values in (("residual", residuals), ("intercept", intercepts)):
        known = len(values) >= 3 and np.ptp(values) > 1e-9
        w, p = normal_test(values) if known else (np.nan, np.nan)
        found |= {f"{name}_w": w, f"{name}_p": p}
    return found


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
    fitted: Fitted, terms: list[str], effects: dict[str, list[int]], names: list[str], random: list, missing: int,
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

"""Every check of what the ANOVA assumes, in one table, and what only an adjustment task can get wrong."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
from scipy import special, stats

from analysis.apa import figures
from analysis.errors import AnalysisError
from analysis.statistics.cells import CellMeans, Levels, cell_means
from analysis.statistics.columns import labels, numbers, require
from analysis.statistics.linear_fit import fit
from analysis.statistics.repeated_measures import anova_of_cells
from analysis.statistics.shapiro_wilk import normality_of_cells

OUTLYING = 3.0  # standard deviations


def assumptions(
    data: pd.DataFrame,
    dv: str,
    subject: str,
    within: str | Sequence[str] = (),
    between: str | Sequence[str] = (),
    *,
    trial: str | None = None,
    start: str | None = None,
    levels: Levels | None = None,
) -> pd.DataFrame:
    """All checks as one tidy table; none of them decides which test is reported.

    trial: the column of trial numbers, to look for learning; start: the column of start values of an
    adjustment, to look for anchoring.

    Returns columns check, where, statistic, df1, df2, p, note. Checks: "Shapiro-Wilk" (residuals, then
    cells), "Mauchly" and "Mauchly (textbook)" per effect, "Levene (mean)" as jamovi and
    "Levene (median)" per within cell, "outlier" (a participant's cell beyond 3 standard deviations of
    the studentised residuals; statistic in those units), "learning" (t test of participants' slopes of
    `dv` over trials, condition means taken out; statistic t, note: mean change over the session) and
    "anchoring" (t test of participants' slopes of `dv` on the start value; note: mean difference
    between the lowest and the highest start). Raises AnalysisError.
    """
    means = cell_means(data, dv, subject, within, between, levels)
    rows = [*_shapiro(means), *_mauchly(means), *_levene(means), *_outliers(means)]
    factors = [*means.within]
    if trial is not None:
        rows.append(_learning(data, dv, subject, factors, trial))
    if start is not None:
        rows.append(_anchoring(data, dv, subject, [name for name in factors if name != start], start))
    table = pd.DataFrame(rows).reindex(columns=["check", "where", "statistic", "df1", "df2", "p", "note"])
    table["note"] = [value if isinstance(value, str) else "" for value in table["note"]]
    table.attrs = {"notes": list(means.notes), "n": len(means.subjects)}
    return table


def quantiles(values: Sequence[float] | np.ndarray) -> pd.DataFrame:
    """Data of a Q-Q plot: theoretical (standard normal, Blom's positions) and ordered, standardised values.

    Missing values are left out. Raises AnalysisError.
    """
    ordered = np.sort(np.asarray(values, dtype=float))
    ordered = ordered[~np.isnan(ordered)]
    n = len(ordered)
    if n < 3 or ordered.std() == 0:
        raise AnalysisError("A Q-Q plot needs at least 3 values that differ.")
    theoretical = special.ndtri((np.arange(1, n + 1) - 0.375) / (n + 0.25))
    return pd.DataFrame({"theoretical": theoretical, "ordered": (ordered - ordered.mean()) / ordered.std(ddof=1)})


def _shapiro(means: CellMeans) -> list[dict[str, Any]]:
    factors = list(means.factors)
    return [
        {
            "check": "Shapiro-Wilk",
            "where": "residuals" if row["scope"] == "residuals" else " × ".join(row[f] for f in factors),
            "statistic": row["w"], "df1": row["n"], "p": row["p"],
        }
        for row in normality_of_cells(means).to_dict("records")
    ]  # fmt: skip


def _mauchly(means: CellMeans) -> list[dict[str, Any]]:
    table = anova_of_cells(means)
    rows = []
    for row in table[table["mauchly_w"].notna()].to_dict("records"):
        epsilon = f"Greenhouse-Geisser epsilon {row['epsilon_gg']:.3f}"
        for check, p in (
            ("Mauchly", row["mauchly_p"]),
            ("Mauchly (textbook)", table.attrs["mauchly_p_textbook"][row["effect"]]),
        ):
            rows.append(
                {"check": check, "where": row["effect"], "statistic": row["mauchly_w"], "p": p, "note": epsilon}
            )
    return rows


def _levene(means: CellMeans) -> list[dict[str, Any]]:
    if not means.between:
        return []
    groups = np.unique(means.groups, axis=0, return_inverse=True)[1].ravel()
    cells = list(product(*means.within.values())) or [()]
    rows = []
    for column, cell in enumerate(cells):
        parts = [means.values[groups == g, column] for g in range(groups.max() + 1)]
        for centre in ("mean", "median"):
            distances = [np.abs(part - getattr(np, centre)(part)) for part in parts]
            spread = np.concatenate(distances)
            known = any(np.ptp(group) > 1e-9 * spread.max() for group in distances)
            test = stats.levene(*parts, center=centre) if known else None
            rows.append({
                "check": f"Levene ({centre})", "where": " × ".join(cell) or means.measure,
                "statistic": test.statistic if test else np.nan, "df1": len(parts) - 1,
                "df2": len(spread) - len(parts), "p": test.pvalue if test else np.nan,
            })  # fmt: skip
    return rows


def _outliers(means: CellMeans) -> list[dict[str, Any]]:
    model = fit(means)
    sd = np.sqrt(np.sum(model.residuals**2, axis=0) / model.df)
    cells = list(product(*means.within.values())) or [()]
    rows = []
    for person, column in np.argwhere(np.abs(model.residuals) > OUTLYING * sd):
        if sd[column] ** 2 > model.no_variance_below:
            rows.append({
                "check": "outlier", "where": " × ".join((means.subjects[person], *cells[column])),
                "statistic": model.residuals[person, column] / sd[column],
                "note": f"{means.measure} {means.values[person, column]:.6g}",
            })  # fmt: skip
    return rows


def _slopes(
    data: pd.DataFrame, dv: str, subject: str, factors: Sequence[str], predictor: str
) -> tuple[np.ndarray, float]:
    """Each participant's slope of `dv` on the predictor, both freed of that participant's cell means.

    Also the span of the predictor. Participants whose predictor does not vary are left out.
    """
    require(data, [predictor])
    y, x, people = numbers(data, dv), numbers(data, predictor), labels(data, subject)
    cell = people.codes.astype(np.int64)
    for name in factors:
        found = labels(data, name)
        cell = cell * len(found.levels) + found.codes
    have = ~np.isnan(y) & ~np.isnan(x) & (people.codes >= 0)
    y, x, who, cell = y[have], x[have], people.codes[have], np.unique(cell[have], return_inverse=True)[1].ravel()
    span = float(np.ptp(x))
    counts = np.bincount(cell)
    y = y - (np.bincount(cell, y) / counts)[cell]
    rounding = 1e-26 * np.bincount(who, x * x)
    x = x - (np.bincount(cell, x) / counts)[cell]
    xx, xy = np.bincount(who, x * x), np.bincount(who, x * y)
    usable = xx > np.maximum(rounding, 1e-12 * xx.max(initial=0.0))
    return xy[usable] / xx[usable], span


def _slope_test(check: str, slopes: np.ndarray, span: float, predictor: str, what: str) -> dict[str, Any]:
    row: dict[str, Any] = {"check": check, "where": predictor}
    if len(slopes) < 2 or np.ptp(slopes) == 0:
        return row | {"note": f"not testable: {predictor} does not vary inside conditions"}
    n = len(slopes)
    t = float(slopes.mean() / (slopes.std(ddof=1) / np.sqrt(n)))
    return row | {
        "statistic": t, "df1": 1, "df2": n - 1, "p": float(2 * special.stdtr(n - 1, -abs(t))),
        "note": f"{what} {figures(float(slopes.mean() * span))}",
    }  # fmt: skip


def _learning(data: pd.DataFrame, dv: str, subject: str, factors: Sequence[str], trial: str) -> dict[str, Any]:
    slopes, span = _slopes(data, dv, subject, factors, trial)
    return _slope_test("learning", slopes, span, trial, "mean change from first to last trial")


def _anchoring(data: pd.DataFrame, dv: str, subject: str, factors: Sequence[str], start: str) -> dict[str, Any]:
    slopes, span = _slopes(data, dv, subject, factors, start)
    return _slope_test("anchoring", slopes, span, start, "mean difference between highest and lowest start")

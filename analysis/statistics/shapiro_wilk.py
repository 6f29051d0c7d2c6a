"""Are the residuals normal? Shapiro-Wilk on all of them together and in every cell."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from analysis.statistics.cells import CellMeans, Levels, cell_means, names_of
from analysis.statistics.columns import require_other_names
from analysis.statistics.linear_fit import fit
from analysis.statistics.normal_test import normal_test, sampled

COLUMNS = ("scope", "n", "mean", "sd", "w", "p")


def normality(
    data: pd.DataFrame,
    dv: str,
    subject: str,
    within: str | Sequence[str] = (),
    between: str | Sequence[str] = (),
    *,
    levels: Levels | None = None,
) -> pd.DataFrame:
    """Shapiro-Wilk tests of the ANOVA's residuals (first row) and of each cell's participant means.

    Returns columns scope ("residuals" or "cell"), one column per factor (empty for the residuals),
    n, mean, sd (units of `dv`), w, p. w and p are nan with fewer than 3 values or without variance,
    and `attrs["notes"]` names those cells. Residuals are those of the multivariate linear model:
    each participant's cell mean minus the mean of the participant's group in that cell.
    """
    require_other_names((*names_of(within), *names_of(between)), COLUMNS)
    return normality_of_cells(cell_means(data, dv, subject, within, between, levels))


def normality_of_cells(means: CellMeans) -> pd.DataFrame:
    """The table of `normality`, from cell means."""
    model = fit(means)
    factors = list(means.factors)
    noise = model.no_variance_below
    residuals = model.residuals.ravel()
    rows = [{"scope": "residuals", **dict.fromkeys(factors, ""), **_test(residuals, noise)}]
    groups = list(product(*(range(len(levels)) for levels in means.between.values())))
    cells = list(product(*means.within.values()))
    bare = []
    for group in groups:
        members = np.all(means.groups == np.array(group, dtype=int), axis=1)
        group_levels = {name: levels[i] for i, (name, levels) in zip(group, means.between.items(), strict=True)}
        for column, cell in enumerate(cells):
            names = dict(zip(means.within, cell, strict=True)) | group_levels
            row: dict[str, Any] = {"scope": "cell", **names, **_test(means.values[members, column], noise)}
            if np.isnan(row["w"]):
                bare.append(" × ".join(names.values()))
            rows.append(row)
    table = pd.DataFrame(rows)[["scope", *factors, "n", "mean", "sd", "w", "p"]]
    notes = [*means.notes, *sampled(len(residuals))]
    if bare:
        shown = "; ".join(bare[:5]) + (f" and {len(bare) - 5} more" if len(bare) > 5 else "")
        notes.append(f"Normality cannot be tested in {shown}: fewer than 3 participants, or no variance.")
    table.attrs = {"notes": notes, "n": len(means.subjects)}
    return table


def _test(values: np.ndarray, noise: float) -> dict[str, float]:
    nan = float("nan")
    row = {"n": len(values), "mean": float(values.mean()), "sd": nan, "w": nan, "p": nan}
    if len(values) > 1:
        row["sd"] = float(values.std(ddof=1))
    if len(values) >= 3 and np.sum((values - values.mean()) ** 2) > noise:
        w, p = normal_test(values)
        row |= {"w": w, "p": p}
    return row

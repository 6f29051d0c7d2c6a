"""Analysis of variance with any number of within- and between-participant factors."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from scipy import special

from analysis.errors import AnalysisError
from analysis.statistics.cells import CellMeans, Levels, cell_means, names_of
from analysis.statistics.contrasts import subsets, within_contrasts
from analysis.statistics.effect_size import eta_squared_limits
from analysis.statistics.linear_fit import LinearFit, fit
from analysis.statistics.sphericity import Sphericity, sphericity

COLUMNS = (
    "effect", "df1", "df2", "ss", "ss_error", "F", "p",
    "eta_p2", "eta_p2_low", "eta_p2_high", "eta_g2",
    "epsilon_gg", "epsilon_hf", "df1_gg", "df2_gg", "p_gg", "p_hf", "mauchly_w", "mauchly_p",
)  # fmt: skip


def anova(
    data: pd.DataFrame,
    dv: str,
    subject: str,
    within: str | Sequence[str] = (),
    between: str | Sequence[str] = (),
    *,
    measured: str | Sequence[str] = (),
    levels: Levels | None = None,
) -> pd.DataFrame:
    """Mixed repeated-measures ANOVA, type III, with sphericity corrections and effect sizes.

    data: tidy table, one row per trial or per cell; dv: the column of numbers; subject: the column
    that names participants; within, between: factor columns, any number of each; measured: factors
    that were observed, not manipulated (sex, say), for generalized eta squared; levels: the order of
    levels where it should not be natural order (it changes no number of this table).

    Several rows of one participant in one cell are averaged first. Participants with an empty cell
    are left out, with an AnalysisWarning. Groups of unequal size are allowed.

    Returns one row per effect, main effects first, named `a`, `a:b`, with columns
    effect, df1, df2, ss, ss_error, F, p: the uncorrected test; p_gg, df1_gg, df2_gg, epsilon_gg:
    Greenhouse-Geisser (equal to the uncorrected ones where the within part has one df); epsilon_hf,
    p_hf: Huynh-Feldt; mauchly_w, mauchly_p: as R and jamovi; eta_p2 with 90 % limits eta_p2_low,
    eta_p2_high; eta_g2: generalized eta squared (Olejnik & Algina 2003). What cannot be computed is
    nan; `table.attrs["notes"]` says why in sentences, `table.attrs["n"]` is the number of participants.

    Multivariate formulation after Maxwell & Delaney, Designing Experiments. Raises AnalysisError.
    """
    means = cell_means(data, dv, subject, within, between, levels)
    return anova_of_cells(means, names_of(measured))


def anova_of_cells(means: CellMeans, measured: Sequence[str] = ()) -> pd.DataFrame:
    """The table of `anova`, from cell means."""
    unknown = [name for name in measured if name not in means.factors]
    if unknown:
        raise AnalysisError(f"{unknown[0]!r} is called measured but is no factor of this analysis.")
    model = fit(means)
    sizes = [len(levels) for levels in means.within.values()]
    strata = {}
    for chosen in subsets(tuple(means.within)):
        C = within_contrasts(sizes, [name in chosen for name in means.within])
        strata[chosen] = _Stratum(C, model, len(model.residuals[0]))
    total_error = sum(stratum.ss_error for stratum in strata.values())
    rows, ss_of = [], {}
    for effect in subsets(means.factors)[1:]:
        stratum = strata[tuple(name for name in effect if name in means.within)]
        columns = model.terms[tuple(name for name in effect if name in means.between)]
        M = model.coefficients[columns] @ stratum.contrasts
        ss = float(np.sum(M * np.linalg.solve(model.unscaled[columns, columns], M)))
        ss_of[effect] = ss
        rows.append((effect, stratum, M.shape[0] * stratum.q, ss))
    return _table(means, model, rows, _generalized(ss_of, total_error, measured))


class _Stratum:
    """A set of within contrasts with their common error term."""

    def __init__(self, contrasts: np.ndarray, model: LinearFit, cells: int) -> None:
        residuals = model.residuals @ contrasts
        self.contrasts = contrasts
        self.q = contrasts.shape[1]
        self.df = model.df * self.q
        self.ss_error = float(np.sum(residuals**2))
        self.constant = self.ss_error <= model.no_variance_below
        self.sphericity: Sphericity = sphericity(residuals, model.df, cells)


def _generalized(
    ss_of: dict[tuple[str, ...], float], total_error: float, measured: Sequence[str]
) -> dict[tuple[str, ...], float]:
    """Generalized eta squared of every effect (Olejnik & Algina 2003; Bakeman 2005)."""
    observed = {effect: ss for effect, ss in ss_of.items() if set(effect) & set(measured)}
    total_observed = sum(observed.values())
    result = {}
    for effect, ss in ss_of.items():
        below = total_error + total_observed + (0.0 if effect in observed else ss)
        result[effect] = ss / below if below > 0 else float("nan")
    return result


def _table(
    means: CellMeans,
    model: LinearFit,
    rows: list[tuple[tuple[str, ...], _Stratum, int, float]],
    generalized: dict[tuple[str, ...], float],
) -> pd.DataFrame:
    nan = float("nan")
    constant = np.array([stratum.constant for _, stratum, _, _ in rows])
    df1 = np.array([df for _, _, df, _ in rows], dtype=float)
    df2 = np.array([stratum.df for _, stratum, _, _ in rows], dtype=float)
    ss = np.array([value for *_, value in rows])
    ss_error = np.array([stratum.ss_error for _, stratum, _, _ in rows])
    with np.errstate(all="ignore"):
        F = np.where(constant, nan, (ss / df1) / (ss_error / df2))
        eta = np.where(constant, nan, ss / (ss + ss_error))
    gg = np.where(constant, nan, [stratum.sphericity.greenhouse_geisser for _, stratum, _, _ in rows])
    hf = np.where(constant, nan, [stratum.sphericity.huynh_feldt for _, stratum, _, _ in rows])
    low, high = eta_squared_limits(F, df1, df2)
    table = pd.DataFrame(
        {
            "effect": [":".join(effect) for effect, *_ in rows],
            "df1": df1.astype(int),
            "df2": df2.astype(int),
            "ss": ss,
            "ss_error": ss_error,
            "F": F,
            "p": special.fdtrc(df1, df2, F),
            "eta_p2": eta,
            "eta_p2_low": low,
            "eta_p2_high": high,
            "eta_g2": np.where(constant, nan, [generalized[effect] for effect, *_ in rows]),
            "epsilon_gg": gg,
            "epsilon_hf": hf,
            "df1_gg": gg * df1,
            "df2_gg": gg * df2,
            "p_gg": special.fdtrc(gg * df1, gg * df2, F),
            "p_hf": special.fdtrc(hf * df1, hf * df2, F),
            "mauchly_w": [stratum.sphericity.mauchly_w for _, stratum, _, _ in rows],
            "mauchly_p": [stratum.sphericity.mauchly_p for _, stratum, _, _ in rows],
        }
    )
    table.attrs = {
        "notes": [*means.notes, *_notes(means, model, rows)],
        "n": len(means.subjects),
        "left_out": dict(means.left_out),
        "mauchly_p_textbook": {
            ":".join(effect): stratum.sphericity.mauchly_p_textbook for effect, stratum, _, _ in rows
        },
    }
    return table


def _notes(means: CellMeans, model: LinearFit, rows: list[tuple[tuple[str, ...], _Stratum, int, float]]) -> list[str]:
    notes = []
    constant = [":".join(effect) for effect, stratum, _, _ in rows if stratum.constant]
    if constant:
        notes.append(
            f"{means.measure} has no variance left to test {', '.join(constant)}: "
            f"the error sum of squares is zero, so no F and no p are given."
        )
    singular = [":".join(e) for e, s, _, _ in rows if s.sphericity.singular and not s.constant and s.q > 1]
    if singular:
        notes.append(
            f"The error matrix of {', '.join(singular)} is singular (fewer participants than "
            f"contrasts, or a contrast "
            f"without variance; {model.df} error df): Mauchly's test and Huynh-Feldt are not available, and "
            f"Greenhouse-Geisser is computed from its definition; jamovi shows nothing here."
        )
    if means.between:
        counts = np.unique(means.groups, axis=0, return_counts=True)[1]
        if counts.min() != counts.max():
            notes.append(
                f"Groups are unequal ({counts.min()} to {counts.max()} participants): sums of squares "
                f"are type III, "
                f"every group weighs the same."
            )
    return notes

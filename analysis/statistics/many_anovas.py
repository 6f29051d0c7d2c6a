"""The same mixed ANOVA of very many experiments at once, for simulation."""

from __future__ import annotations

import numpy as np
from scipy import special

from analysis.statistics.cells import CellMeans
from analysis.statistics.contrasts import subsets, within_contrasts
from analysis.statistics.linear_fit import NO_VARIANCE, design_matrix


def many_anovas(values: np.ndarray, design: CellMeans) -> dict[str, np.ndarray]:
    """Greenhouse-Geisser p values of every effect in every experiment.

    values: (S, N, c) cell means of S experiments; design: the participants' groups and the factors (its
    own values are not used). Returns effect name -> (S,) p values, equal to those of `anova`; nan where an
    effect has no error variance.
    """
    X, terms = design_matrix(design)
    inverse = np.linalg.inv(X.T @ X)
    project = inverse @ X.T
    df = X.shape[0] - X.shape[1]
    B = project @ values
    E = values - X @ B
    rounding = NO_VARIANCE * np.sum(values**2, axis=(1, 2))
    sizes = [len(levels) for levels in design.within.values()]
    strata = {}
    for chosen in subsets(tuple(design.within)):
        C = within_contrasts(sizes, [name in chosen for name in design.within])
        residuals = E @ C
        A = residuals.transpose(0, 2, 1) @ residuals
        trace = np.trace(A, axis1=1, axis2=2)
        trace = np.where(trace > rounding, trace, np.nan)
        epsilon = trace**2 / (C.shape[1] * np.sum(A * A, axis=(1, 2)))
        strata[chosen] = B @ C, trace, epsilon, C.shape[1]
    found = {}
    for effect in subsets(design.factors)[1:]:
        M, ss_error, epsilon, q = strata[tuple(name for name in effect if name in design.within)]
        columns = terms[tuple(name for name in effect if name in design.between)]
        part = M[:, columns]
        weight = np.linalg.inv(inverse[columns, columns])
        ss = np.einsum("sij,ik,skj->s", part, weight, part, optimize=True)
        df1, df2 = part.shape[1] * q, df * q
        F = (ss / df1) / (ss_error / df2)
        found[":".join(effect)] = special.fdtrc(epsilon * df1, epsilon * df2, F)
    return found

"""How far the within-participant differences are from equal variances, and what to do about it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import special


@dataclass(frozen=True)
class Sphericity:
    """Epsilons and Mauchly's test of one set of q orthonormal contrasts with v error df."""

    greenhouse_geisser: float
    huynh_feldt: float  # capped at 1, never below Greenhouse-Geisser; nan when singular
    mauchly_w: float
    mauchly_p: float  # as R and jamovi print it
    mauchly_p_textbook: float
    singular: bool


def sphericity(residuals: np.ndarray, df: int, cells: int) -> Sphericity:
    """Sphericity of contrast residuals E C.

    residuals: (N, q); df: v, participants minus groups; cells: number of within cells, which R's
    version of Mauchly's test needs.

    Greenhouse & Geisser 1959: tr(A)^2 / (q tr(A^2)) with A = C'E'EC. Huynh & Feldt 1976 with
    Lecoutre's 1991 correction (as R's car). Mauchly 1940 with the chi-square approximation of
    `mauchly.test`; R's second-order term has 3 x cells where the textbook has 3 x q.
    """
    q = residuals.shape[1]
    nan = float("nan")
    if q == 1:
        return Sphericity(1.0, 1.0, nan, nan, nan, False)
    A = residuals.T @ residuals
    trace, square = float(np.trace(A)), float(np.sum(A * A))
    if square == 0:
        return Sphericity(nan, nan, nan, nan, nan, True)
    gg = trace**2 / (q * square)
    singular_values = np.linalg.svd(residuals, compute_uv=False)
    if df < q or singular_values[-1] <= 1e-7 * singular_values[0]:
        return Sphericity(gg, nan, nan, nan, nan, True)
    below = q * (df - q * gg)
    hf = ((df + 1) * q * gg - 2) / below if below > 0 else 1.0
    _, log_determinant = np.linalg.slogdet(A)
    log_w = float(log_determinant) - q * float(np.log(trace / q))
    return Sphericity(
        gg,
        max(min(hf, 1.0), gg),
        float(np.exp(log_w)),
        _mauchly_p(log_w, q, df, cells),
        _mauchly_p(log_w, q, df, q),
        False,
    )


def _mauchly_p(log_w: float, q: int, df: int, second_order: int) -> float:
    rho = 1 - (2 * q * q + q + 2) / (6 * df * q)
    weight = (q + 2) * (q - 1) * (q - 2) * (2 * q**3 + 6 * q**2 + 3 * second_order + 2) / (288 * (df * q * rho) ** 2)
    z = -df * rho * log_w
    f = q * (q + 1) / 2 - 1
    first, second = special.chdtrc(f, z), special.chdtrc(f + 4, z)
    return float(min(1.0, max(0.0, first + weight * (second - first))))

"""Power of planned tests from an effect size (Faul, Erdfelder, Lang & Buchner 2007), in every convention."""

from __future__ import annotations

import math

import pandas as pd
from scipy import stats

from analysis.errors import AnalysisError, check_share

CONVENTIONS = ("as_in_spss", "gpower_default", "as_in_cohen")
EFFECTS = ("within", "between", "interaction")
DOUBLE_COUNT = (
    "A partial eta squared taken from an ANOVA table already contains the correlation between "
    "measures; with the "
    "G*Power default the correlation is counted twice and the power comes out too high. Use "
    "as_in_spss for it."
)
ACHIEVED = (
    "If the effect size was estimated from these very data, this power is only another way to write "
    "their p value; "
    "ask instead which effect the study could have found (leave the effect size out and give power)."
)


def power_rm_anova(
    *,
    effect: str,
    measures: int,
    n: int | None = None,
    f: float | None = None,
    eta_p2: float | None = None,
    power: float | None = None,
    groups: int = 1,
    rho: float = 0.5,
    epsilon: float = 1.0,
    alpha: float = 0.05,
    convention: str = "as_in_spss",
) -> pd.DataFrame:
    """Power of a repeated-measures effect, or the n or the effect size for a wanted power.

    effect: "within", "between" or "interaction" (of both); measures: levels of the within factor;
    n: participants in all; f or eta_p2: effect size, f^2 = eta_p2 / (1 - eta_p2); groups: between
    groups; rho: mean correlation between measures (gpower_default only); epsilon: sphericity.
    Leave out one of n, effect size and power: it is computed. n is a multiple of the groups.

    convention fixes the noncentrality lambda: "as_in_spss" f^2 df2 (before epsilon times epsilon), for
    effect sizes from data; "gpower_default" f^2 n m e / (1 - rho), between f^2 n m / (1 + (m - 1) rho);
    "as_in_cohen" f^2 n e. They need up to five times as many participants as one another.

    Returns one row: effect, convention, f, eta_p2, n, groups, measures, rho, epsilon, alpha, lambda_,
    df1, df2, F_critical, power; `attrs["notes"]` warns of counting the correlation twice.
    """
    if effect not in EFFECTS:
        raise AnalysisError(f"effect must be one of {', '.join(EFFECTS)}, not {effect!r}.")
    if convention not in CONVENTIONS:
        raise AnalysisError(f"convention must be one of {', '.join(CONVENTIONS)}, not {convention!r}.")
    if f is not None and eta_p2 is not None:
        raise AnalysisError("Give f or eta_p2, not both.")
    if (effect != "between" and measures < 2) or (effect != "within" and groups < 2):
        few = "measures" if effect != "between" and measures < 2 else "groups"
        raise AnalysisError(f"A {effect} effect needs two or more {few}.")
    if not (-1 / max(1, measures - 1) < rho < 1 and 0 < epsilon <= 1):
        raise AnalysisError("rho must be a possible correlation below 1, and epsilon above 0 and at most 1.")
    if (eta_p2 is not None and not 0 <= eta_p2 < 1) or (f is not None and not 0 <= f < math.inf):
        raise AnalysisError("f must be a number from 0 up, and eta_p2 one from 0 up to but not including 1.")
    size = f if f is not None else None if eta_p2 is None else math.sqrt(eta_p2 / (1 - eta_p2))
    check_share("alpha", alpha, 0.05)
    if power is not None and not alpha < power < 1:
        raise AnalysisError(f"power must lie between alpha ({alpha:g}) and 1, not {power}.")
    if [n, size, power].count(None) != 1:
        raise AnalysisError("Give two of n, effect size (f or eta_p2) and power; the third is computed.")

    def row(people: int, cohens_f: float) -> dict[str, float]:
        df1, df2, noncentrality = _noncentrality(effect, cohens_f, people, groups, measures, rho, epsilon, convention)
        critical = float(stats.f.ppf(1 - alpha, df1, df2))
        reached = float(stats.ncf.sf(critical, df1, df2, noncentrality)) if noncentrality > 0 else alpha
        return {"lambda_": noncentrality, "df1": df1, "df2": df2, "F_critical": critical, "power": reached}

    if groups < 1:
        raise AnalysisError(f"groups is 1 or more, not {groups!r}.")
    if n is not None and n <= groups:
        raise AnalysisError(f"{n} participant(s) are too few for {groups} group(s); at least {groups + 1} are needed.")
    if n is None:
        assert size is not None
        assert power is not None
        n = _smallest_n(lambda people: row(people, size)["power"], power, groups)
    elif size is None:
        assert power is not None
        size = _smallest_f(lambda f: row(n, f)["power"], power)
    result = pd.DataFrame(
        [
            {
                "effect": effect,
                "convention": convention,
                "f": size,
                "eta_p2": size**2 / (1 + size**2),
                "n": n,
                "groups": groups,
                "measures": measures,
                "rho": rho,
                "epsilon": epsilon,
                "alpha": alpha,
                **row(n, size),
            }
        ]
    )
    result.attrs["notes"] = []
    if eta_p2 is not None:
        result.attrs["notes"] = [ACHIEVED, *([DOUBLE_COUNT] if convention == "gpower_default" else [])]
    return result


def _noncentrality(
    effect: str, f: float, n: int, k: int, m: int, rho: float, e: float, convention: str
) -> tuple[float, float, float]:
    df1 = {"between": k - 1.0, "within": (m - 1) * e, "interaction": (k - 1) * (m - 1) * e}[effect]
    df2 = float(n - k) if effect == "between" else (n - k) * (m - 1) * e
    if convention == "as_in_spss":
        return df1, df2, f * f * df2
    if convention == "as_in_cohen":
        return df1, df2, f * f * n * (1 if effect == "between" else e)
    if effect == "between":
        return df1, df2, f * f * n * m / (1 + (m - 1) * rho)
    return df1, df2, f * f * n * m * e / (1 - rho)


def _smallest_n(power_of, wanted: float, groups: int) -> int:  # type: ignore[no-untyped-def]
    n = 2 * groups
    while power_of(n) < wanted:
        n *= 2
        if n > 10_000_000:
            raise AnalysisError("No number of participants below ten million reaches this power.")
    low, high = n // 2, n
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if middle > groups and power_of(middle) >= wanted else (middle, high)
    return math.ceil(high / groups) * groups


def _smallest_f(power_of, wanted: float) -> float:  # type: ignore[no-untyped-def]
    from scipy.optimize import brentq

    return float(brentq(lambda f: power_of(f) - wanted, 1e-6, 50.0, xtol=1e-10))


def power_t_test(d: float, n: int, n2: int | None = None, alpha: float = 0.05, tails: int = 2) -> pd.DataFrame:
    """Power of a t test for a standardised difference d: one-sample or paired, or two groups of n and n2.

    tails: 2, or 1 for a difference expected to be above 0. Returns one row: d, n, n2, alpha, tails, ncp, df,
    t_critical, power. Raises AnalysisError.
    """
    check_share("alpha", alpha, 0.05)
    if not math.isfinite(d) or tails not in (1, 2):
        raise AnalysisError(f"d is a finite number and tails 1 or 2, not {d!r} and {tails!r}.")
    if n < 1 or (n2 is None and n < 2) or (n2 is not None and (n2 < 1 or n + n2 < 3)):
        raise AnalysisError("A t test needs 2 participants, or 3 in two groups of at least 1.")
    df = n - 1 if n2 is None else n + n2 - 2
    ncp = d * math.sqrt(n if n2 is None else n * n2 / (n + n2))
    critical = float(stats.t.ppf(1 - alpha / tails, df))
    reached = float(stats.nct.sf(critical, df, ncp))
    if tails == 2:
        reached += float(stats.nct.cdf(-critical, df, ncp))
    return pd.DataFrame(
        [
            {
                "d": d,
                "n": n,
                "n2": n2,
                "alpha": alpha,
                "tails": tails,
                "ncp": ncp,
                "df": df,
                "t_critical": critical,
                "power": reached,
            }
        ]
    )


def power_regression(
    f2: float, n: int, predictors: int, tested: int | None = None, alpha: float = 0.05
) -> pd.DataFrame:
    """Power of the F test of `tested` of the predictors (all by default) with Cohen's f2; lambda = f2 n.

    Returns one row: f2, n, predictors, tested, alpha, lambda_, df1, df2, F_critical, power. Raises AnalysisError.
    """
    check_share("alpha", alpha, 0.05)
    if not 0 <= f2 < math.inf:
        raise AnalysisError(f"f2 is a number from 0 up, not {f2!r}.")
    if not 1 <= (predictors if tested is None else tested) <= predictors:
        raise AnalysisError(f"Of {predictors} predictor(s), tested is from 1 up to all of them, not {tested!r}.")
    if n < predictors + 2:
        raise AnalysisError(
            f"{n} cases are too few for {predictors} predictor(s); at least {predictors + 2} are needed."
        )
    df1, df2 = predictors if tested is None else tested, n - predictors - 1
    critical = float(stats.f.ppf(1 - alpha, df1, df2))
    return pd.DataFrame(
        [
            {
                "f2": f2,
                "n": n,
                "predictors": predictors,
                "tested": df1,
                "alpha": alpha,
                "lambda_": f2 * n,
                "df1": df1,
                "df2": df2,
                "F_critical": critical,
                "power": float(stats.ncf.sf(critical, df1, df2, f2 * n)),
            }
        ]
    )

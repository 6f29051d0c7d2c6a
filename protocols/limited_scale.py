"""Where a normal variable lies so that, kept between the ends of a scale, it has a wanted mean. Plain arithmetic."""

from __future__ import annotations

from statistics import NormalDist


def latent_mean(mean: float, sd: float, low: float, high: float) -> float:
    """Mean of a normal variable whose values, kept between low and high, have the mean `mean`; by bisection.

    E[min(max(X, low), high)] = low Phi(a) + high (1 - Phi(b)) + m (Phi(b) - Phi(a)) + sd (phi(a) - phi(b)), with
    a = (low - m) / sd and b = (high - m) / sd: the two-limit Tobit mean (Greene, Econometric Analysis, ch. 19).
    """
    if sd == 0.0 or not low < mean < high:
        return mean
    reach = high - low + 10.0 * sd
    below, above = low - reach, high + reach
    for _ in range(60):
        middle = (below + above) / 2.0
        below, above = (middle, above) if _kept_mean(middle, sd, low, high) < mean else (below, middle)
    return (below + above) / 2.0


def _kept_mean(mean: float, sd: float, low: float, high: float) -> float:
    normal = NormalDist()
    a, b = (low - mean) / sd, (high - mean) / sd
    inside = normal.cdf(b) - normal.cdf(a)
    return low * normal.cdf(a) + high * (1.0 - normal.cdf(b)) + mean * inside + sd * (normal.pdf(a) - normal.pdf(b))

"""A poulaine from its points: x(t) and z(t) apart, by three interpolations (Niay 2022, section 5.2.1).

The curve is closed by repeating the points a cycle before and after, but for the spline, whose second derivatives are
made to meet. Knows points, no cycle.
"""

from __future__ import annotations

import numpy as np

from stimuli.poulaine.curve import FIVE, FOUR, ControlPoints, Poulaine, PoulaineError, characteristic_points
from stimuli.skeleton import Floats

INTERPOLATIONS: tuple[str, ...] = ("cubic", "pchip", "hermite")


def rebuilt(points: ControlPoints, interpolation: str, phases: Floats) -> Floats:
    """(M, 2) m: x and z at phases (M,) in [0, 1).

    interpolation: "cubic" (periodic cubic, twice differentiable), "pchip" (monotonic between points; Fritsch &
    Butland 1984) or "hermite" (places and first derivatives of the points).
    """
    from scipy.interpolate import CubicHermiteSpline, CubicSpline, PchipInterpolator

    if interpolation not in INTERPOLATIONS:
        raise PoulaineError(f"there is no interpolation {interpolation!r}; there are {', '.join(INTERPOLATIONS)}")
    order = np.argsort(points.phases)
    knots, places, velocities = points.phases[order], points.places[order], points.velocities[order]
    if len(knots) < 3 or np.diff(np.append(knots, knots[0] + 1.0)).min() < 1e-4:
        raise PoulaineError("two points of the poulaine are passed at once; it cannot be rebuilt from them")
    inside = knots[0] + np.mod(phases - knots[0], 1.0)
    if interpolation == "cubic":
        closed = np.concatenate([places, places[:1]])
        return np.asarray(CubicSpline(np.append(knots, knots[0] + 1.0), closed, bc_type="periodic")(inside))
    thrice = np.concatenate([knots - 1.0, knots, knots + 1.0])
    if interpolation == "pchip":
        return np.asarray(PchipInterpolator(thrice, np.tile(places, (3, 1)))(inside))
    return np.asarray(CubicHermiteSpline(thrice, np.tile(places, (3, 1)), np.tile(velocities, (3, 1)))(inside))


def rebuilding_error(poulaine: Poulaine, count: int, interpolation: str) -> float:
    """m: root mean square distance of the poulaine rebuilt from 4 or 5 points from the original, over the cycle."""
    difference = rebuilt(chosen_points(poulaine, count), interpolation, poulaine.phases) - poulaine.xz
    return float(np.sqrt(np.mean(np.sum(difference**2, axis=1))))


def chosen_points(poulaine: Poulaine, count: int) -> ControlPoints:
    """The 4 or 5 points. Raises PoulaineError for another number, or for 5 without a clear M."""
    if count not in (4, 5):
        raise PoulaineError(f"a poulaine is rebuilt from 4 or 5 points, not {count}")
    return characteristic_points(poulaine, FOUR if count == 4 else FIVE)

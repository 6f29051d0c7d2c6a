"""The poulaine of a cycle and its characteristic points (Niay 2022, section 5.1.1 and figure 5.1). Knows no editing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from stimuli.cycle import Cycle, cycle_positions
from stimuli.methods.making import MethodError
from stimuli.skeleton import Floats

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

FOUR: tuple[str, ...] = ("E", "V", "I", "A")
"""Points of Pronost et al. (2005), in the order in which a foot passes them from heel strike."""

FIVE: tuple[str, ...] = (*FOUR, "M")
"""With Niay's (2022) local minimum in mid swing."""

FINE = 1024
"""Places per cycle at which extremes are looked for."""

CLEAR = 0.0005
"""m: a local minimum that is less deep than this on either side is no M."""


class PoulaineError(MethodError):
    """A poulaine that cannot be taken apart or rebuilt as asked."""


@dataclass(frozen=True, eq=False)
class Poulaine:
    """The path of one ankle from its hip joint over one gait cycle, in the plane of walking.

    xz:   (N, 2) m, forward and up, at phases i / N; phase as in the cycle
    name: of the cycle and the foot, for messages
    """

    xz: Floats
    name: str

    @property
    def phases(self) -> Floats:
        """(N,) in [0, 1)."""
        return np.arange(len(self.xz)) / len(self.xz)

    @property
    def spline(self) -> CubicSpline:
        """Phase -> (x, z) m through every sample, periodic."""
        closed = np.concatenate([self.xz, self.xz[:1]])
        from scipy.interpolate import CubicSpline  # here, because most studies show no rebuilt walks

        return CubicSpline(np.linspace(0.0, 1.0, len(closed)), closed, bc_type="periodic")


@dataclass(frozen=True, eq=False)
class ControlPoints:
    """Characteristic points of one poulaine, in the order in which the foot passes them.

    names:      K of FIVE
    phases:     (K,) in [0, 1), as they come (not sorted: the first may be passed at the end of the cycle)
    places:     (K, 2) m, x and z
    velocities: (K, 2) m per cycle, the curve's first derivatives there
    """

    names: tuple[str, ...]
    phases: Floats
    places: Floats
    velocities: Floats

    def of(self, name: str) -> Floats:
        """(2,) m: place of a point."""
        return np.asarray(self.places[self.names.index(name)])

    def without(self, name: str) -> ControlPoints:
        """The points but one."""
        kept = [index for index, other in enumerate(self.names) if other != name]
        return ControlPoints(
            tuple(self.names[index] for index in kept), self.phases[kept], self.places[kept], self.velocities[kept]
        )


def poulaine_of(cycle: Cycle, side: str) -> Poulaine:
    """The ankle's path in the frame of the same side's hip joint; side "left" or "right"."""
    wanted = (f"{side}UpperLeg", f"{side}Foot")
    missing = [joint for joint in wanted if joint not in cycle.joints]
    if missing:
        raise PoulaineError(f"{cycle.provenance.clip} has no {missing[0]}, so it has no poulaine")
    positions = cycle_positions(cycle)
    hip, ankle = (positions[:, cycle.joints.index(joint)] for joint in wanted)
    path = ankle - hip
    return Poulaine(path[:, [2, 1]], f"{cycle.provenance.clip}, {side} foot")


def characteristic_points(poulaine: Poulaine, names: tuple[str, ...] = FIVE) -> ControlPoints:
    """E, V, I, A and, if asked for, M. Raises PoulaineError, saying which point is missing.

    E and I are the extremes of x; A is the highest place between I and the next E; V is where the ankle passes under
    the hip from E to I; M is the deepest local minimum of z between A and E.
    """
    spline = poulaine.spline
    fine = np.arange(FINE) / FINE
    x, z = spline(fine).T
    e, i = int(np.argmax(x)), int(np.argmin(x))
    stance = _between(e, i)
    under = np.flatnonzero((x[stance] >= 0) & (x[(stance + 1) % FINE] < 0))
    if len(under) == 0:
        raise PoulaineError(f"{poulaine.name}: the ankle never passes under the hip in stance, so there is no point V")
    before = stance[under[0]]
    v = (before + x[before] / (x[before] - x[(before + 1) % FINE])) / FINE
    swing = _between(i, e)
    a = int(swing[np.argmax(z[swing])])
    found = {"E": e / FINE, "V": v, "I": i / FINE, "A": a / FINE}
    if "M" in names:
        found["M"] = _local_minimum(z, a, e, poulaine.name) / FINE
    phases = np.array([found[name] for name in names])
    return ControlPoints(names, phases % 1.0, spline(phases), spline(phases, 1))


def _local_minimum(z: Floats, a: int, e: int, name: str) -> int:
    """Place of M among FINE samples of z: the deepest local minimum after A and before E, or just past E.

    The ankle may still sink a little when the leg is furthest out, so the search goes on to the minimum's far side.
    """
    swing = _between(a, e)
    heights = z[swing]
    lower = np.flatnonzero((heights[1:-1] <= heights[:-2]) & (heights[1:-1] < heights[2:])) + 1
    deep = [
        place
        for place in lower
        if heights[: place + 1].max() - heights[place] > CLEAR and heights[place:].max() - heights[place] > CLEAR
    ]
    if not deep:
        raise PoulaineError(
            f"{name}: the ankle has no clear local minimum of height between A and E (point M); "
            f"rebuild it with 4 points"
        )
    return int(swing[min(deep, key=lambda place: heights[place])])


def _between(first: int, last: int) -> np.ndarray:
    """Places first .. last of FINE, round the end of the cycle."""
    return (first + np.arange((last - first) % FINE + 1)) % FINE

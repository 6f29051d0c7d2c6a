"""How often people step at a speed: f = a V^b with V = v / leg length (Glardon et al. 2004, equations 3, 4 and 6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stimuli.methods.making import MethodError


@dataclass(frozen=True)
class FrequencyLaw:
    """Cycles per second from a normalised speed V (1/s): f = factor * V ** exponent."""

    factor: float
    exponent: float

    def frequency(self, speed: float, leg_length: float) -> float:
        """Cycles/s at a speed (m/s) for a leg length (m); 0 at a standstill."""
        if leg_length <= 0:
            raise MethodError(f"a leg length of {leg_length:g} m is not positive")
        return float(self.factor * max(speed / leg_length, 0.0) ** self.exponent)


INMAN = FrequencyLaw(0.743, 0.5)
"""Equation 4, Inman, Ralston & Todd 1981."""

GLARDON = FrequencyLaw(0.85, 0.4)
"""Equation 6, fitted to the five subjects of the source on a treadmill."""


def fitted_law(speeds: Sequence[float], frequencies: Sequence[float], leg_length: float) -> FrequencyLaw:
    """Least squares of log f on log V over walks at these speeds (m/s) and cycle frequencies (1/s).

    Raises MethodError unless there are two speeds at least 0.1 m/s apart.
    """
    if len(speeds) < 2 or max(speeds) - min(speeds) < 0.1:
        raise MethodError("a frequency law needs walks at two speeds at least 0.1 m/s apart; Inman's needs none")
    exponent, constant = np.polyfit(np.log(np.asarray(speeds) / leg_length), np.log(frequencies), 1)
    return FrequencyLaw(float(np.exp(constant)), float(exponent))

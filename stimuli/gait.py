"""How a person walks, as four numbers of which two are free. Knows no motion."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

GRAVITY = 9.81
"""m/s², as in Hof 1996."""


@dataclass(frozen=True)
class NormalisedGait:
    """A gait without its person's size: lengths over l, times over sqrt(l / g) (Hof, Gait & Posture 4, 1996).

    Every value is a plain number; two people of different size who walk alike have equal ones.
    """

    step_length: float
    step_frequency: float
    speed: float
    walk_ratio: float


@dataclass(frozen=True)
class Gait:
    """How a person walks, averaged over whole gait cycles."""

    step_length: float  # m, heel strike to the next heel strike of the other foot
    step_frequency: float  # steps/min

    @classmethod
    def at_speed(cls, speed: float, step_frequency: float) -> Gait:
        """The gait of `speed` (m/s) at `step_frequency` (steps/min): step length = 60 speed / step frequency."""
        return cls(60.0 * speed / step_frequency, step_frequency)

    @property
    def speed(self) -> float:
        """m/s: step length times step frequency."""
        return self.step_length * self.step_frequency / 60.0

    @property
    def walk_ratio(self) -> float:
        """Step length over step frequency, m per step/min (m·min), as in Sekiya et al. 1996."""
        return self.step_length / self.step_frequency

    @property
    def stride_length(self) -> float:
        """m: two steps."""
        return 2.0 * self.step_length

    @property
    def stride_time(self) -> float:
        """s: two steps."""
        return 120.0 / self.step_frequency

    def normalised(self, length: float) -> NormalisedGait:
        """This gait over a body length in m: stature, as the studies do, or leg length, as Hof did."""
        if not length > 0:
            raise ValueError(f"a body length of {length} m is not positive; give stature or leg length in m")
        step_length = self.step_length / length
        step_frequency = self.step_frequency / 60.0 / sqrt(GRAVITY / length)
        return NormalisedGait(
            step_length=step_length,
            step_frequency=step_frequency,
            speed=self.speed / sqrt(GRAVITY * length),
            walk_ratio=step_length / step_frequency,
        )

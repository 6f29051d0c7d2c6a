"""The gait model: how a person walks at any speed and step frequency, from coefficients fitted to real captures.

A walk is 34 signals over one gait cycle, each a short Fourier series in phase (Troje 2002; Tilmanne & Dutoit 2010).
Each Fourier coefficient is a linear function of the step (length and frequency, made dimensionless with the leg
length after Hof 1996), of sex where the data know it, plus a person's own offset (the residual of a captured
person, shrunk as in a mixed model). `stimuli/fitting` makes the coefficients; this file only evaluates them and
knows no body, clip or file but its own.

Axes are the walker's: X left, Y up, Z forward. Phase 0 is the right heel strike. The model is symmetric: its left
side walks like the mirrored right side half a cycle later; captured walks need not be (WalkCurves).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np

from stimuli.skeleton import Floats

GRAVITY = 9.81  # m/s²

MIDLINE: tuple[str, ...] = (
    *(f"{segment}_{axis}" for segment in ("hips", "spine", "chest", "neck", "head") for axis in "xyz"),
    "hips_shift",
)
"""World rotation vectors (rad) of the midline segments, and the sideways shift of the hips in leg lengths."""

SIDED: tuple[str, ...] = (
    *(f"{segment}_{axis}" for segment in ("shoulder", "upperArm", "lowerArm", "hand") for axis in "xyz"),
    *("thigh", "shank", "foot", "foot_yaw", "knee_yaw", "foot_shift"),
)
"""Signals of the RIGHT side: world rotation vectors of the arm (rad); inclination of thigh and shank in the sagittal
plane (rad, 0 vertical, positive with the lower end forward); pitch of the foot (rad, 0 flat, positive toes up);
yaw of foot and knee (rad, positive to the left, so negative is outward); sideways place of the ankle in leg lengths."""

SIGNALS: tuple[str, ...] = MIDLINE + SIDED
HARMONICS = 8
COEFFICIENTS = 1 + 2 * HARMONICS

MIRROR_SIGN = np.array([-1.0 if name.endswith(("_y", "_z", "_shift", "_yaw")) else 1.0 for name in SIGNALS])
"""What reflection in the sagittal plane does to each signal (a rotation vector keeps x and changes y and z)."""


MODEL_ARM = np.array([0.5, -np.sqrt(0.75), 0.0])
"""Direction of the left arm to which the arms' rotations refer: 30 degrees off vertical."""


LONGEST_STEP = 1.4
"""Leg lengths: the model knows no longer step; a figure with very short legs steps as far as it must, in this manner.
The longest step of the actors' grid is 1.37."""


@dataclass(frozen=True)
class Step:
    """One way of stepping, without units (Hof 1996).

    length:    step length / leg length
    frequency: step frequency (1/s) * sqrt(leg length / g)
    """

    length: float
    frequency: float

    @classmethod
    def of(cls, speed: float, step_frequency: float, leg_length: float) -> Step:
        """speed m/s, step_frequency steps/min, leg_length m (hip to ankle)."""
        length = 60.0 * speed / step_frequency / leg_length
        return cls(length, step_frequency / 60.0 * float(np.sqrt(leg_length / GRAVITY)))


@dataclass(frozen=True, eq=False)
class WalkCurves:
    """One walk as curves, before it is put on a skeleton. Left and right may differ.

    sides:       (2, S, C) Fourier coefficients of the left and the right side, each from its own heel strike; the left
                 as seen in a mirror, so that both are written like a right side. The midline's signals are in both.
    stance:      (2,) share of the cycle that the left and the right foot is on the ground
    left_strike: phase of the left heel strike; 0.5 where both steps last alike
    """

    sides: Floats
    stance: Floats
    left_strike: float = 0.5

    @classmethod
    def symmetric(cls, coefficients: Floats, stance: float) -> WalkCurves:
        """A walk (S, C) whose left half is the right half's mirror image half a cycle later."""
        return cls(np.stack([coefficients, coefficients]), np.array([stance, stance]))

    @property
    def is_symmetric(self) -> bool:
        """Whether both sides are exactly alike."""
        return self.left_strike == 0.5 and self.stance[0] == self.stance[1] and np.array_equal(*self.sides)


@dataclass(frozen=True, eq=False)
class GaitModel:
    """Fitted coefficients. S = number of SIGNALS, C = COEFFICIENTS (mean, then cos and sin of each harmonic).

    effects:    (4, S, C) per unit of the predictors (1, step length, cadence, sex)
    offsets:    (P, S, C) what each captured person does differently
    people:     P names of captured people, in the order of offsets
    stance:     (4,) effects on the share of the cycle that a foot is on the ground
    centre:     (2,) step length and step frequency at which the intercept holds
    cadence_slope: expected change of step frequency with step length (both without units)
    cadence_limit: largest cadence residual the data support; beyond it the effect flattens
    length_range:  (2,) step lengths (over leg length) of the captured walks; outside it the model extrapolates
    standing:      (2,) rad, inclination of thigh and shank of people standing; clinical angles are relative to it
    """

    effects: Floats
    offsets: Floats
    people: tuple[str, ...]
    stance: Floats
    centre: Floats
    cadence_slope: float
    cadence_limit: float
    length_range: Floats
    standing: Floats

    def predictors(self, step: Step, sex: float = 0.0) -> Floats:
        """(4,): 1, step length, cadence for that step length, sex (-0.5 man, 0 unknown, +0.5 woman)."""
        length = min(step.length, LONGEST_STEP) - self.centre[0]
        expected = self.centre[1] + self.cadence_slope * length
        cadence = self.cadence_limit * np.tanh((step.frequency - expected) / self.cadence_limit)
        return np.array([1.0, length, cadence, sex])

    def coefficients(self, step: Step, sex: float = 0.0, manner: Floats | None = None) -> Floats:
        """(S, C) Fourier coefficients of a walk; manner is a person's own (S, C) offset."""
        fixed = np.tensordot(self.predictors(step, sex), self.effects, axes=1)
        return fixed if manner is None else fixed + manner

    def stance_share(self, step: Step, sex: float = 0.0) -> float:
        """Share of the cycle from a foot's heel strike to its toe-off."""
        return float(np.clip(self.predictors(step, sex) @ self.stance, 0.56, 0.70))

    def manner(self, mixture: dict[str, float]) -> Floats:
        """(S, C) offset of a person made of captured people; weights as given (name -> weight)."""
        missing = sorted(set(mixture) - set(self.people))
        if missing:
            raise ValueError(f"the gait model has no captured person {missing}; it has {list(self.people)}")
        return sum(
            (weight * self.offsets[self.people.index(name)] for name, weight in mixture.items()),
            np.zeros(self.offsets.shape[1:]),
        )


def basis(phases: Floats) -> Floats:
    """(N, C) Fourier basis at phases (N,) of the cycle: 1, cos and sin of each harmonic."""
    angles = 2.0 * np.pi * np.outer(phases, np.arange(1, HARMONICS + 1))
    columns = np.empty((len(angles), COEFFICIENTS))
    columns[:, 0] = 1.0
    columns[:, 1::2] = np.cos(angles)
    columns[:, 2::2] = np.sin(angles)
    return columns


def curves(coefficients: Floats, phases: Floats) -> dict[str, Floats]:
    """Signal name -> (N,) values at the phases: midline signals and the right side's signals."""
    values = basis(phases) @ coefficients.T
    return {name: values[:, index] for index, name in enumerate(SIGNALS)}


def shifted(coefficients: Floats, phase: float) -> Floats:
    """The same curves (..., C), started `phase` of a cycle later."""
    turned = np.array(coefficients, dtype=float)
    for harmonic in range(1, (COEFFICIENTS - 1) // 2 + 1):
        cosine, sine = coefficients[..., 2 * harmonic - 1], coefficients[..., 2 * harmonic]
        c, s = np.cos(2 * np.pi * harmonic * phase), np.sin(2 * np.pi * harmonic * phase)
        turned[..., 2 * harmonic - 1] = cosine * c + sine * s
        turned[..., 2 * harmonic] = sine * c - cosine * s
    return turned


@cache
def load_gait_model() -> GaitModel:
    """The model that ships with the package (stimuli/data/gait_model.npz)."""
    with (files("stimuli") / "data" / "gait_model.npz").open("rb") as stream, np.load(stream) as stored:
        return GaitModel(
            effects=stored["effects"].astype(np.float64),
            offsets=stored["offsets"].astype(np.float64),
            people=tuple(str(name) for name in stored["people"]),
            stance=stored["stance"],
            centre=stored["centre"],
            cadence_slope=float(stored["cadence_slope"]),
            cadence_limit=float(stored["cadence_limit"]),
            length_range=stored["length_range"],
            standing=stored["standing"],
        )

"""The PCA walking engine (Glardon, Boulic & Thalmann 2004): one space per person, driven by speed and leg length.

Cycles of one person at several speeds and a standing posture become motion vectors (100 frames of axis-angle of all
joints, and the hips' place in leg lengths); the components that hold 80 % of the variance span the space. Over speed
each coefficient is a least-squares line, and below the slowest capture the segment from standing to that line.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stimuli.cycle import Cycle
from stimuli.methods.fourier import exponential_signals, whole_turns
from stimuli.methods.frequency_law import INMAN, FrequencyLaw, fitted_law
from stimuli.methods.making import MethodError, check_same_skeleton, leg_length, made_by, resampled
from stimuli.rotations import continuous, from_exponential, mean_rotation
from stimuli.skeleton import Floats

FRAMES = 100
KEPT = 0.80
"""Share of the variance that the components hold (section 4.1)."""

LEAST = 2
"""Components that are kept at least, the fewest of table 1: with few speeds one component can hold 80 % and do no more
than tell standing from walking."""

FASTEST = 10.0 / 3.6
"""m/s: the source's engine walks from 0 to 10 km/h."""


@dataclass(frozen=True, eq=False)
class PcaWalk:
    """One person's walking engine. D = 3 (R + 1): axis-angle of R joints (rad), then the hips' place (leg lengths).

    mean:          (FRAMES, D) theta_0 of equation 1
    components:    (m, FRAMES, D) E of equation 1, unit vectors
    variance:      (K,) share of the variance of every component, kept or not, largest first
    slope, intercept: (m,) of the line alpha = slope * S + intercept over speed S (m/s) (equation 2)
    standing:      (m,) alpha of the standing posture
    slowest:       m/s, slowest captured walk, where the segment from standing meets the line
    leg_length:    m of the person captured
    source:        a captured cycle, for the skeleton
    """

    mean: Floats
    components: Floats
    variance: Floats
    slope: Floats
    intercept: Floats
    standing: Floats
    slowest: float
    leg_length: float
    law: FrequencyLaw
    source: Cycle
    captures: int

    @property
    def reduction(self) -> float:
        """Motion vectors over components kept: the reduction factor of table 1."""
        return (self.captures + 1) / len(self.components)

    def coefficients(self, speed: Floats | float) -> Floats:
        """(..., m) alpha at the captured person's speed (m/s)."""
        s = np.asarray(speed, dtype=float)[..., None]
        line = self.slope * s + self.intercept
        start = self.slope * self.slowest + self.intercept
        segment = self.standing + (start - self.standing) * (s / self.slowest)
        return np.where(s < self.slowest, segment, line)

    def cycle(self, speed: float, leg: float | None = None) -> Cycle:
        """The walk at a speed (m/s) for a leg length (m, by default the person's own), as FRAMES samples.

        The posture is that of the same normalised speed V = v / leg length; the law gives the frequency. At a speed
        of 0 the stride time is infinite.
        """
        _check(speed, leg)
        size = 1.0 if leg is None else leg / self.leg_length
        values = self.mean + np.tensordot(self.coefficients(speed / size), self.components, axes=1)
        frequency = self.law.frequency(speed, self.leg_length * size)
        joints = len(self.source.joints)
        return replace(
            self.source,
            offsets=self.source.offsets * size,
            rotations=continuous(from_exponential(values[:, : 3 * joints].reshape(FRAMES, joints, 3))),
            hips=values[:, 3 * joints :] * self.leg_length * size,
            stride_length=speed / frequency if frequency > 0 else 0.0,
            stride_time=1.0 / frequency if frequency > 0 else float("inf"),
            provenance=made_by("pca", f"{len(self.components)} components at {speed:.2f} m/s", self.source),
        )

    def phase_advance(self, speed: float, seconds: float, leg: float | None = None) -> float:
        """Equation 5: the share of a cycle that passes in a time, so speed and leg length may change every frame."""
        return seconds * self.law.frequency(speed, self.leg_length if leg is None else leg)

    def poses(self, speeds: Floats, phases: Floats, legs: Floats | None = None) -> tuple[Floats, Floats]:
        """Local rotations (W, R, 4) and hips (W, 3) m of W walkers in one go, linear between frames.

        speeds: (W,) m/s; phases: (W,) of the cycle; legs: (W,) m leg lengths, by default the person's own.
        """
        size = np.ones(len(phases)) if legs is None else np.asarray(legs) / self.leg_length
        alpha = self.coefficients(np.asarray(speeds) / size)
        place = np.mod(phases, 1.0) * FRAMES
        frame = place.astype(int)
        share = (place - frame)[:, None]
        rows = (frame % FRAMES, (frame + 1) % FRAMES)
        values = (1.0 - share) * self.mean[rows[0]] + share * self.mean[rows[1]]
        for component, weight in zip(self.components, alpha.T, strict=True):
            values += (weight[:, None] * (1.0 - share)) * component[rows[0]]
            values += (weight[:, None] * share) * component[rows[1]]
        joints = len(self.source.joints)
        rotations = from_exponential(values[:, : 3 * joints].reshape(-1, joints, 3))
        return rotations, values[:, 3 * joints :] * (self.leg_length * size)[:, None]


def pca_walk(
    cycles: Sequence[Cycle], standing: Cycle | None = None, law: FrequencyLaw | None = None, kept: float = KEPT
) -> PcaWalk:
    """The engine of one person, from cycles at three or more speeds.

    standing: by default `standing_posture`; law: by default fitted to the cycles. kept: share of the variance that
    the components hold, of which there are LEAST or more. Raises MethodError for too few cycles or speeds, or different
    skeletons.
    """
    _check_cycles(cycles)
    legs = leg_length(cycles[0])
    still = standing_posture(cycles[0]) if standing is None else standing
    check_same_skeleton([*cycles, still])
    vectors = [motion_vector(still, legs)] + [motion_vector(cycle, legs) for cycle in cycles]
    motions = np.array(on_one_branch(vectors))
    mean = motions.mean(axis=0)
    _, sizes, rows = np.linalg.svd((motions - mean).reshape(len(motions), -1), full_matrices=False)
    variance = sizes**2 / np.sum(sizes**2)
    count = max(int(np.searchsorted(np.cumsum(variance), kept) + 1), LEAST)
    alpha = (motions - mean).reshape(len(motions), -1) @ rows[:count].T
    speeds = np.array([cycle.gait.speed for cycle in cycles])
    slope, intercept = np.polyfit(speeds, alpha[1:], 1)
    return PcaWalk(
        mean=mean,
        components=rows[:count].reshape(count, *mean.shape),
        variance=variance,
        slope=slope,
        intercept=intercept,
        standing=alpha[0],
        slowest=float(speeds.min()),
        leg_length=legs,
        law=law or _law(speeds, [1.0 / cycle.stride_time for cycle in cycles], legs),
        source=resampled(cycles[0], FRAMES),
        captures=len(cycles),
    )


def standing_posture(cycle: Cycle) -> Cycle:
    """Standing as a cycle of speed 0: identity rotations (section 4.1), arms hanging, the hips at their highest.

    The source's rest pose (H-Anim) has hanging arms and ours may have none, so arms are as they hang in the walk.
    """
    height = float(cycle.hips[:, 1].max())
    still = np.zeros_like(cycle.rotations)
    still[..., 3] = 1.0
    arms = [index for index, joint in enumerate(cycle.joints) if joint.endswith(("Shoulder", "Arm", "Hand"))]
    still[:, arms] = mean_rotation(continuous(cycle.rotations[:, arms]))
    return replace(
        cycle, rotations=still, hips=np.tile([0.0, height, 0.0], (len(cycle.hips), 1)), stride_length=0.0,
        provenance=made_by("standing", "rest pose with hanging arms", cycle),
    )  # fmt: skip


def motion_vector(cycle: Cycle, legs: float) -> Floats:
    """(FRAMES, 3 (R + 1)): axis-angle of all joints without jumps (rad), then the hips' place over leg length."""
    fine = resampled(cycle, FRAMES)
    signals = exponential_signals(fine, fine.joints).reshape(FRAMES, -1)
    return np.concatenate([signals, fine.hips / legs], axis=1)


def on_one_branch(vectors: Sequence[Floats]) -> list[Floats]:
    """Motion vectors on one branch of the exponential map: joint by joint nearest to the second, a captured walk."""
    reference = vectors[1][:, :-3].reshape(FRAMES, -1, 3).mean(axis=0)
    result = []
    for vector in vectors:
        turns = whole_turns(reference, vector[:, :-3].reshape(FRAMES, -1, 3).mean(axis=0))
        small = np.linalg.norm(turns, axis=-1, keepdims=True) < 1e-9
        shift = np.where(small, 0.0, turns).reshape(-1)
        result.append(np.concatenate([vector[:, :-3] + shift, vector[:, -3:]], axis=1))
    return result


def _law(speeds: Floats, frequencies: Sequence[float], legs: float) -> FrequencyLaw:
    try:
        return fitted_law([float(speed) for speed in speeds], frequencies, legs)
    except MethodError:
        return INMAN


def _check_cycles(cycles: Sequence[Cycle]) -> None:
    if len(cycles) < 3:
        raise MethodError(f"a PCA space needs cycles at three speeds or more; there are {len(cycles)}")
    speeds = sorted(cycle.gait.speed for cycle in cycles)
    if np.sum(np.diff(speeds) > 0.05) < 2:
        listed = ", ".join(f"{speed:.2f}" for speed in speeds)
        raise MethodError(f"a PCA space needs cycles at three different speeds; these are walked at {listed} m/s")


def _check(speed: float, leg: float | None) -> None:
    if not 0.0 <= speed <= FASTEST + 1e-9:
        raise MethodError(f"{3.6 * speed:.1f} km/h is outside the PCA engine, 0 to 10 km/h")
    if leg is not None and not 0.2 <= leg <= 2.0:
        raise MethodError(f"a leg length of {leg:g} m is no person's; give 0.2 to 2 m")

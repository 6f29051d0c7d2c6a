"""Cycles whose feet are written on their own clock, and weighted means of them at one shared phase.

All cycles are sampled at one phase, so feet cannot drift apart; rotations are blended joint by joint (normalised
linear blending after turning quaternions to one hemisphere), everything else linearly. Knows no speed, no actor.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stimuli.skeleton import JOINTS, Floats

Indices = NDArray[np.integer]

UPPER: tuple[str, ...] = tuple(name for name in JOINTS if not name.endswith(("Leg", "Foot", "Toes")))
"""Joints whose rotation a cycle stores; legs follow from hips and feet."""

FOOT_CHANNELS: tuple[str, ...] = ("pitch", "clearance", "travel", "side", "yaw", "knee_yaw")
"""Wanted pitch (rad, toes up; see contact.flattened), height of the lowest point (m), travel beyond
contact.footprint_travel (strides), sideways place (m), yaw of the foot and of the knee (rad, to the left)."""

SIDES: tuple[str, ...] = ("left", "right")


@dataclass(frozen=True, eq=False)
class WalkCycle:
    """One gait cycle on one skeleton, N samples, without travel; phase 0 is the right heel strike.

    hips:      (N, 3) m, walker's frame
    rotations: (N, 13, 4) local rotations of the UPPER joints
    feet:      (2, N, 6) FOOT_CHANNELS of the left and the right foot, each on its own clock from its heel strike
    stance:    (2,) share of the cycle that each foot is on the ground
    ahead:     (2,) m, footprint ahead of the walker's mean position at its heel strike
    left_strike: phase of the left heel strike; 0.5 where both steps last alike
    """

    speed: float  # m/s
    step_frequency: float  # steps/min
    hips: Floats
    rotations: Floats
    feet: Floats
    stance: Floats
    ahead: Floats
    left_strike: float = 0.5


@dataclass(frozen=True, eq=False)
class CycleTable:
    """K cycles of one actor laid out for blending: one row per (cycle, phase), last sample repeating the first.

    body:     (K, N + 1, 3 + 13 * 4) hips and rotations, quaternions of a joint all in one hemisphere
    feet:     (2, K, N + 1, 6)
    contacts: (K, 5) stance of left and right, ahead of left and right, phase of the left heel strike
    """

    body: Floats
    feet: Floats
    contacts: Floats

    @classmethod
    def of(cls, cycles: Sequence[WalkCycle]) -> CycleTable:
        """Table of cycles with equal numbers of samples."""
        rotations = np.array([cycle.rotations for cycle in cycles])
        reference = rotations[0, 0]
        rotations = np.where(np.sum(rotations * reference, axis=-1, keepdims=True) < 0, -rotations, rotations)
        body = np.concatenate(
            [np.array([cycle.hips for cycle in cycles]), rotations.reshape(*rotations.shape[:2], -1)], axis=2
        )
        feet = np.ascontiguousarray(np.array([cycle.feet for cycle in cycles]).transpose(1, 0, 2, 3))
        return cls(
            np.concatenate([body, body[:, :1]], axis=1),
            np.concatenate([feet, feet[:, :, :1]], axis=2),
            np.array([[*cycle.stance, *cycle.ahead, cycle.left_strike] for cycle in cycles]),
        )

    @property
    def samples(self) -> int:
        """Samples per cycle N."""
        return int(self.body.shape[1]) - 1


def blend_rotations(rotations: Floats, weights: Floats) -> Floats:
    """Weighted mean of unit quaternions, joint by joint.

    rotations: (N, J, 4) xyzw, one pose per blended cycle
    weights:   (N,) not negative, summing to 1
    returns:   (J, 4) xyzw, unit length

    Normalised linear blending: q and -q are the same rotation, so each is first turned to the hemisphere of the
    heaviest pose.
    """
    heaviest = rotations[np.argmax(weights)]
    same_side = np.sum(rotations * heaviest, axis=-1, keepdims=True)
    mean = np.einsum("n,njk->jk", weights, np.where(same_side < 0, -rotations, rotations))
    return np.asarray(mean / np.linalg.norm(mean, axis=-1, keepdims=True))


def blend_body(table: CycleTable, weighted: Mapping[int, float], phase: float) -> tuple[Floats, Floats]:
    """Hips (3,) m and local rotations (13, 4) of the UPPER joints at a phase of the cycle.

    weighted: index into the table -> weight, summing to 1.
    """
    row = _sampled(table.body, weighted, phase)
    rotations = row[3:].reshape(-1, 4)
    return row[:3], rotations / np.sqrt(np.einsum("jk,jk->j", rotations, rotations))[:, None]


def blend_foot(table: CycleTable, side: int, weighted: Mapping[int, float], clock: float) -> Floats:
    """(6,) FOOT_CHANNELS of the left (0) or right (1) foot at its own clock."""
    return _sampled(table.feet[side], weighted, clock)


def blend_contacts(table: CycleTable, weighted: Mapping[int, float]) -> Floats:
    """(5,) CycleTable.contacts: of both feet their stance and how far ahead they strike, phase of the left strike."""
    weights = np.array(list(weighted.values()))
    return np.asarray(weights @ table.contacts[list(weighted)])


def _sampled(rows: Floats, weighted: Mapping[int, float], place: float) -> Floats:
    """Weighted mean over cycles of rows (K, N + 1, C), linear between samples."""
    cycles, samples, columns = rows.shape
    position = place * (samples - 1)
    sample = min(int(position), samples - 2)
    share = position - sample
    before = [cycle * samples + sample for cycle in weighted]
    chosen = rows.reshape(cycles * samples, columns).take(before + [row + 1 for row in before], axis=0)
    weights = [weight * (1.0 - share) for weight in weighted.values()]
    return np.asarray(np.array(weights + [weight * share for weight in weighted.values()]) @ chosen)

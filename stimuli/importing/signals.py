"""A captured cycle as the signals of the gait model, so that captured and modelled cycles are drawn by one machine.

Directions are kept, in the world and without the person's proportions; so is what left and right do differently. What
a capture does not hold (no head, no arms) is nan. Knows one cycle; no file, no skeleton to be drawn.
"""

from __future__ import annotations

import numpy as np

from stimuli.cycle import Cycle, cycle_pose, leg_length
from stimuli.gait_model import HARMONICS, MIDLINE, MIRROR_SIGN, MODEL_ARM, SIDED, SIGNALS, basis, shifted
from stimuli.rotations import rotate, shortest_arc, to_exponential
from stimuli.skeleton import Floats

FLAT = (0.15, 0.32)
"""Share of the cycle after its heel strike in which a foot stands flat (foot flat to heel rise, Perry 1992)."""

MIDLINE_SEGMENTS = ("hips", "spine", "chest", "neck", "head")
KNEE_YAW_SHARE = 0.6
"""Skin movement makes the thigh's captured rotation about its own axis too large (Cappozzo et al. 1996)."""


def walk_signals(cycle: Cycle) -> Floats:
    """(2, S, C) Fourier coefficients of the left and the right side of a captured cycle (gait_model.WalkCurves).

    nan in the rows of what the capture does not hold.
    """
    world, positions = cycle_pose(cycle)
    leg = leg_length(cycle)
    left, right = (_columns(cycle, world, positions, side, leg) for side in ("left", "right"))
    middle = float(np.mean(right[:, _place("hips_shift")]))
    for columns in (left, right):
        for name in ("hips_shift", "foot_shift"):
            columns[:, _place(name)] -= middle
    design = np.linalg.pinv(basis(cycle.phases))
    return np.stack([shifted((design @ (left * MIRROR_SIGN)).T, cycle.left_strike), (design @ right).T])


def evened(sides: Floats) -> Floats:
    """(2, S, C) with both sides alike: their mean, as the gait model's own captures are."""
    even = np.mean(sides, axis=0)
    for index in range(len(MIDLINE)):
        for harmonic in range(HARMONICS + 1):
            if (harmonic % 2 == 0) != (MIRROR_SIGN[index] > 0):
                even[index, 0 if harmonic == 0 else slice(2 * harmonic - 1, 2 * harmonic + 1)] = 0.0
    return np.stack([even, even])


def _columns(cycle: Cycle, world: Floats, positions: Floats, side: str, leg: float) -> Floats:
    """(N, S) signals over the cycle with one side's limbs in the place of the sided ones, not mirrored."""
    found: dict[str, Floats] = {}

    def index(role: str) -> int | None:
        return cycle.joints.index(role) if role in cycle.joints else None

    def vector(name: str, rotations: Floats | None) -> None:
        if rotations is not None:
            found.update(zip((f"{name}_{axis}" for axis in "xyz"), to_exponential(rotations).T, strict=True))

    for segment in MIDLINE_SEGMENTS:
        joint = index(segment)
        vector(segment, None if joint is None else world[:, joint])
    shoulder = index(f"{side}Shoulder")
    if shoulder is not None:
        vector("shoulder", world[:, shoulder])
    for name, bone in _arm(cycle, world, positions, side).items():
        arm = MODEL_ARM * (1.0 if side == "left" else -1.0, 1.0, 1.0)
        vector(name, shortest_arc(np.broadcast_to(arm, bone.shape), bone))
    found["hips_shift"] = positions[:, 0, 0] / leg
    found.update(_leg(cycle, world, positions, side, leg))
    missing = np.full(len(positions), np.nan)
    return np.column_stack([found.get(name, missing) for name in SIGNALS])


def _arm(cycle: Cycle, world: Floats, positions: Floats, side: str) -> dict[str, Floats]:
    """Directions (N, 3) of the bones of one arm that are there; the hand continues the forearm of the rest pose."""
    roles = [f"{side}{part}" for part in ("UpperArm", "LowerArm", "Hand")]
    if any(role not in cycle.joints for role in roles):
        return {}
    upper, lower, hand = (cycle.joints.index(role) for role in roles)
    return {
        "upperArm": positions[:, lower] - positions[:, upper],
        "lowerArm": positions[:, hand] - positions[:, lower],
        "hand": rotate(world[:, hand], cycle.offsets[hand]),
    }


def _leg(cycle: Cycle, world: Floats, positions: Floats, side: str, leg: float) -> dict[str, Floats]:
    hip, knee, ankle = (cycle.joints.index(f"{side}{part}") for part in ("UpperLeg", "LowerLeg", "Foot"))
    toes = f"{side}Toes"
    rest = cycle.offsets[cycle.joints.index(toes)] if toes in cycle.joints else np.array([0.0, 0.0, 1.0])
    thigh, shank = positions[:, knee] - positions[:, hip], positions[:, ankle] - positions[:, knee]
    foot = rotate(world[:, ankle], rest)
    pitch = np.arctan2(foot[:, 1], np.hypot(foot[:, 0], foot[:, 2]))
    outward = rotate(world[:, hip], np.array([0.0, 0.0, 1.0]))
    phase = (cycle.phases - (cycle.left_strike if side == "left" else 0.0)) % 1.0
    flat = (phase >= FLAT[0]) & (phase <= FLAT[1])
    return {
        "thigh": np.arctan2(thigh[:, 2], -thigh[:, 1]),
        "shank": np.arctan2(shank[:, 2], -shank[:, 1]),
        "foot": pitch - float(np.mean(pitch[flat])),
        "foot_yaw": np.arctan2(foot[:, 0], np.abs(foot[:, 2]) + 0.02 * np.linalg.norm(rest)),
        "knee_yaw": KNEE_YAW_SHARE * np.arctan2(outward[:, 0], outward[:, 2]),
        "foot_shift": positions[:, ankle, 0] / leg,
    }


def _place(name: str) -> int:
    return SIGNALS.index(name)


assert SIGNALS == MIDLINE + SIDED

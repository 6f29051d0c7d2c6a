"""Puts a walk of the gait model on a skeleton: directions kept, feet on the ground, the hips where the legs carry them.

World rotations are kept (not local ones), each limb bone after aligning its rest direction with the model's, so that
another rest pose or proportion does not change where limbs point (characters notes, section 3.3). The height and the
fore-aft place of the hips are not taken from the model: they follow from the standing legs, whose captured angles put
the hips over feet that roll on the ground (leg_paths.py). Left and right may differ. Knows curves and one skeleton;
no blend tree, no actor.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from stimuli.blend import UPPER, WalkCycle
from stimuli.gait_model import MODEL_ARM, WalkCurves, curves
from stimuli.kinematics import rotation_matrices
from stimuli.legs.contact import Sole
from stimuli.legs.foot_channels import foot_channels
from stimuli.legs.foot_paths import PHASES
from stimuli.legs.leg_paths import LegPath, carried_hips, leg_path
from stimuli.legs.two_bone import Leg
from stimuli.rotations import from_exponential, inverse, multiply, shortest_arc
from stimuli.skeleton import JOINTS, PARENTS, Floats, Skeleton

MIRRORED_FOOT = np.array([1.0, 1.0, 1.0, -1.0, -1.0, -1.0])
"""Sign of each of the FOOT_CHANNELS for the other side."""


@dataclass(frozen=True, eq=False)
class Figure:
    """A skeleton with what retargeting needs to know of it."""

    skeleton: Skeleton

    @cached_property
    def sole(self) -> Sole:
        return Sole.of(self.skeleton)

    @cached_property
    def legs(self) -> tuple[Leg, Leg]:
        """Left and right leg."""
        return Leg.of(self.skeleton, "left"), Leg.of(self.skeleton, "right")

    @cached_property
    def arms(self) -> dict[str, Floats]:
        """Joint of an arm to the rotation (4,) that turns its bone at rest into that of the model's arm."""
        offsets = self.skeleton.offsets
        ends = (("UpperArm", "LowerArm"), ("LowerArm", "Hand"), ("Hand", "Hand"))
        return {
            side + joint: shortest_arc(offsets[JOINTS.index(side + end)], MODEL_ARM * (sign, 1.0, 1.0))
            for side, sign in (("right", -1.0), ("left", 1.0))
            for joint, end in ends
        }

    @property
    def leg_length(self) -> float:
        """m, hip to ankle, mean of both legs."""
        return 0.5 * (self.legs[0].length + self.legs[1].length)


def scaled(skeleton: Skeleton, factor: float) -> Skeleton:
    """The same person, larger or smaller."""
    return Skeleton(np.asarray(skeleton.offsets, dtype=float) * factor)


def walk_cycle(figure: Figure, walk: WalkCurves, speed: float, step_frequency: float, calm: bool = False) -> WalkCycle:
    """One cycle of a walk at exactly this speed (m/s) and step frequency (steps/min).

    Both legs are made like a right leg, the left one as seen in a mirror; where it is the right one's image half a
    cycle later, once. calm: takes out the twitches of legs that come from captures (stimuli/legs/swing.py).
    """
    stride = 120.0 * speed / step_frequency
    leg = figure.legs[1]
    sides = (1,) if walk.is_symmetric else (0, 1)
    hips, paths = carried_hips(leg, figure.sole, [_leg(figure, walk, side, calm) for side in sides], stride)
    feet = [foot_channels(leg, path, hips, stride) for path in paths]
    shift = figure.leg_length * curves(walk.sides[1], PHASES)["hips_shift"]
    return WalkCycle(
        speed=speed,
        step_frequency=step_frequency,
        hips=np.column_stack([shift, hips.at(PHASES)]),
        rotations=_upper_body(figure, walk),
        feet=np.array([feet[0] * MIRRORED_FOOT, feet[-1]]),
        stance=np.array(walk.stance),
        ahead=np.array([paths[0].ahead, paths[-1].ahead]),
        left_strike=walk.left_strike,
    )


def _leg(figure: Figure, walk: WalkCurves, side: int, calm: bool) -> LegPath:
    """The left (0) or right (1) leg of a walk before anything is fitted."""
    signals = curves(walk.sides[side], PHASES)
    hips = rotation_matrices(_turned(signals, "hips"))
    path = leg_path(figure.legs[1], figure.sole, figure.leg_length, signals, hips, float(walk.stance[side]), calm)
    return replace(path, strike=walk.left_strike if side == 0 else 0.0)


def _upper_body(figure: Figure, walk: WalkCurves) -> Floats:
    """Local rotations (N, 13, 4) of the UPPER joints over the cycle."""
    right, left = curves(walk.sides[1], PHASES), curves(walk.sides[0], PHASES - walk.left_strike)
    world = {segment: _turned(right, segment) for segment in ("hips", "spine", "chest", "neck", "head")}
    for side, signals, mirror in (("right", right, False), ("left", left, True)):
        world[f"{side}Shoulder"] = _turned(signals, "shoulder", mirror)
        for joint, segment in (("UpperArm", "upperArm"), ("LowerArm", "lowerArm"), ("Hand", "hand")):
            world[side + joint] = multiply(_turned(signals, segment, mirror), figure.arms[side + joint])
    local = [world["hips"]]
    for joint in UPPER[1:]:
        local.append(multiply(inverse(world[JOINTS[PARENTS[JOINTS.index(joint)]]]), world[joint]))
    return np.stack(local, axis=1)


def _turned(signals: dict[str, Floats], segment: str, mirror: bool = False) -> Floats:
    """(N, 4) world rotation of a segment, as it is or as seen in a mirror."""
    vector = np.stack([signals[f"{segment}_{axis}"] for axis in "xyz"], axis=1)
    return from_exponential(vector * (1.0, -1.0, -1.0) if mirror else vector)

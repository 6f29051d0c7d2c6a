"""Two-bone inverse kinematics of a leg: hip and ankle given, the knee is a hinge that bends forward. Pure geometry.

The leg lies in the plane through hip, ankle and a forward direction of the knee; the law of cosines gives its angles
and both bones keep their length exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import acos, cos, sin, sqrt

import numpy as np

from stimuli.one_rotation import Turn, Vector, from_columns, inverse, multiply
from stimuli.skeleton import JOINTS, Floats, Skeleton

STRAIGHTEST = 0.99995
"""Largest hip-ankle distance over the leg's length: a knee keeps a degree of bend and never snaps straight."""

FURTHEST = 0.92
"""Largest distance along the ground from hip to ankle over the leg's length: the leg is 67 degrees off upright. People
stay below 0.71 in their longest steps; beyond, a figure whose legs are too short for the step does the splits, and its
foot gives way along the ground instead (walker.py)."""


@dataclass(frozen=True, eq=False)
class Leg:
    """One leg's constants in the rest pose.

    thigh, shank:     m
    hip:              (3,) m, hip joint from the hips joint
    thigh_rest, shank_rest: (3, 3) rows: bone direction, hinge axis (left), forward normal - an orthonormal frame
    """

    thigh: float
    shank: float
    hip: Floats
    thigh_rest: Floats
    shank_rest: Floats

    @cached_property
    def length(self) -> float:
        """m, hip to knee to ankle."""
        return self.thigh + self.shank

    @cached_property
    def socket(self) -> Vector:
        """m, hip joint from the hips joint, in plain numbers."""
        x, y, z = self.hip.tolist()
        return x, y, z

    @cached_property
    def thigh_to_axes(self) -> Turn:
        """The rotation that turns the thigh at rest along +X, its hinge along +Y."""
        return _to_axes(self.thigh_rest)

    @cached_property
    def shank_to_axes(self) -> Turn:
        """The same of the shank."""
        return _to_axes(self.shank_rest)

    @classmethod
    def of(cls, skeleton: Skeleton, side: str) -> Leg:
        """side: "left" or "right"."""
        offsets = skeleton.offsets
        thigh = np.asarray(offsets[JOINTS.index(f"{side}LowerLeg")], dtype=float)
        shank = np.asarray(offsets[JOINTS.index(f"{side}Foot")], dtype=float)
        hip = np.asarray(offsets[JOINTS.index(f"{side}UpperLeg")], dtype=float)
        return cls(float(np.linalg.norm(thigh)), float(np.linalg.norm(shank)), hip, _frame(thigh), _frame(shank))


def solve(leg: Leg, hip: Vector, ankle: Vector, knee_yaw: float) -> tuple[Turn, Turn]:
    """World rotations of thigh and shank that put the ankle where it is asked.

    hip, ankle: m; knee_yaw: rad, horizontal direction the knee points (0 forward, positive to the left).
    If the ankle is out of reach the leg is left at STRAIGHTEST, pointing at it.
    """
    dx, dy, dz = ankle[0] - hip[0], ankle[1] - hip[1], ankle[2] - hip[2]
    distance = sqrt(dx * dx + dy * dy + dz * dz)
    dx, dy, dz = dx / distance, dy / distance, dz / distance
    distance = min(distance, STRAIGHTEST * leg.length)
    fx, fz = sin(knee_yaw), cos(knee_yaw)
    along = fx * dx + fz * dz
    fx, fy, fz = fx - along * dx, -along * dy, fz - along * dz
    size = sqrt(fx * fx + fy * fy + fz * fz)
    fx, fy, fz = fx / size, fy / size, fz / size
    normal = (fy * dz - fz * dy, fz * dx - fx * dz, fx * dy - fy * dx)
    bend = _angle(leg.thigh, distance, leg.shank)
    knee = _angle(leg.shank, distance, leg.thigh)
    c, s = cos(bend), sin(bend)
    thigh = (c * dx + s * fx, c * dy + s * fy, c * dz + s * fz)
    c, s = cos(knee), -sin(knee)
    shank = (c * dx + s * fx, c * dy + s * fy, c * dz + s * fz)
    return multiply(_along(thigh, normal), leg.thigh_to_axes), multiply(_along(shank, normal), leg.shank_to_axes)


def reach(leg: Leg, knee: Floats) -> Floats:
    """Hip-ankle distance (m) for knee flexions (rad, 0 straight)."""
    return np.sqrt(leg.thigh**2 + leg.shank**2 + 2 * leg.thigh * leg.shank * np.cos(knee))


def _angle(near: float, distance: float, far: float) -> float:
    """Angle between bone `near` and the line to the ankle, by the law of cosines."""
    return acos(max(-1.0, min(1.0, (near * near + distance * distance - far * far) / (2 * near * distance))))


def _frame(bone: Floats) -> Floats:
    """(3, 3) rows: unit bone, hinge axis nearest +X, their product."""
    along = bone / np.linalg.norm(bone)
    hinge = np.array([1.0, 0.0, 0.0]) - along[0] * along
    hinge /= np.linalg.norm(hinge)
    return np.array([along, hinge, np.cross(hinge, along)])


def _to_axes(rest: Floats) -> Turn:
    """The rotation that turns a bone and its hinge (3, 3), the first rows of its frame at rest, into X and Y."""
    (ax, ay, az), (hx, hy, hz) = rest[:2].tolist()
    return inverse(_along((ax, ay, az), (hx, hy, hz)))


def _along(bone: Vector, hinge: Vector) -> Turn:
    """The rotation that turns X into a bone and Y into its hinge."""
    ax, ay, az = bone
    hx, hy, hz = hinge
    return from_columns(bone, hinge, (ay * hz - az * hy, az * hx - ax * hz, ax * hy - ay * hx))

"""Sagittal joint angles of a drawn walker, and the band of healthy adults they are held against.

Angles are those of the Schreiber & Moissenet tables: inclination of the thigh ("hip"), flexion of the knee and
dorsiflexion of the ankle, degrees relative to standing, from heel strike to heel strike of the right foot.
"""

from __future__ import annotations

import csv
from functools import cache
from importlib.resources import files

import numpy as np

from stimuli.actors import Actor
from stimuli.gait_model import load_gait_model
from stimuli.kinematics import world_matrices
from stimuli.measure import poses
from stimuli.skeleton import JOINTS, Floats

ANGLES = ("hip", "knee", "ankle")
BAND = 2.0
"""Standard deviations on each side of the mean within which a walker counts as usual."""


@cache
def normative_band(condition: str = "C4") -> dict[str, Floats]:
    """Angle -> (101, 2) mean and SD between adults over the cycle, deg; C4 comfortable, C5 fast (ATTRIBUTION.md)."""
    text = (files("stimuli") / "quality" / "normative_angles.csv").read_text(encoding="utf-8")
    rows = [row for row in csv.DictReader(text.splitlines()) if row["condition"] == condition]
    return {
        angle: np.array([[float(row[f"{angle}_mean"]), float(row[f"{angle}_sd"])] for row in rows]) for angle in ANGLES
    }


def drawn_angles(actor: Actor, speed: float, step_frequency: float, samples: int = 101) -> dict[str, Floats]:
    """Angle -> (samples,) deg of the right leg as drawn, from 0 to 100 % of the cycle."""
    pose = poses(actor, speed, step_frequency, np.linspace(0.0, 1.0, samples))
    world = world_matrices(actor.skeleton, pose)
    hip, knee, ankle = (world[:, JOINTS.index(f"right{part}"), :3, 3] for part in ("UpperLeg", "LowerLeg", "Foot"))
    thigh, shank = _inclination(knee - hip), _inclination(ankle - knee)
    forward = world[:, JOINTS.index("rightFoot"), :3, 2]
    pitch = np.degrees(np.arctan2(forward[:, 1], np.hypot(forward[:, 0], forward[:, 2])))
    standing = np.degrees(load_gait_model().standing)
    thigh, shank = thigh - standing[0], shank - standing[1]
    return {"hip": thigh, "knee": thigh - shank, "ankle": pitch - shank}


def share_in_band(drawn: Floats, band: Floats) -> float:
    """Share of the cycle in which a curve (101,) lies within BAND standard deviations of the mean."""
    mean, deviation = band.T
    return float(np.mean(np.abs(drawn - mean) <= BAND * deviation))


def _inclination(bone: Floats) -> Floats:
    return np.degrees(np.arctan2(bone[:, 2], -bone[:, 1]))

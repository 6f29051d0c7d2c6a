"""Finding a capture's unit and axes from the body itself, because headers say nothing or say it wrongly.

Up is where the head is from the feet; the unit is the one that makes the legs as long as legs are; forward is
where the walker goes, or where the toes point if it stays.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stimuli.motion_files.errors import MotionFileError

Floats = NDArray[np.floating]

LETTERS = ("+X", "+Y", "+Z", "-X", "-Y", "-Z")

UNITS = {
    "metres": 1.0,
    "centimetres": 0.01,
    "millimetres": 0.001,
    "inches": 0.0254,
    "CMU units": 0.0254 / 0.45,
}
"""Units met in captures, in m. CMU's files are in inches over 0.45 (mocap.cs.cmu.edu, frequently asked questions)."""

LEG = (0.45, 1.15)
"""m: thigh and shank together, from a child of seven to a man of 2.2 m (0.245 + 0.246 of stature each, Winter 2009)."""

TYPICAL_LEG = 0.82  # m, thigh and shank of an adult of 1.68 m (Winter 2009)


@dataclass(frozen=True)
class Axes:
    """Rotation that turns file axes into ours, and how the file's up and forward are written."""

    rotation: Floats  # (3, 3), rows are our X, Y, Z in file axes
    up: str
    forward: str


def axis_vector(letter: str) -> Floats:
    """(3,) unit vector of "+X" ... "-Z"; a letter without sign counts as plus."""
    letter = letter if letter[:1] in "+-" else "+" + letter
    if letter.upper() not in LETTERS:
        raise MotionFileError(f"axis {letter!r} is none of {', '.join(LETTERS)}")
    index = LETTERS.index(letter.upper())
    return np.eye(3)[index % 3] * (1.0 if index < 3 else -1.0)


def nearest_axis(direction: Floats) -> str:
    """The signed axis nearest to a direction (3,)."""
    index = int(np.argmax(np.abs(direction)))
    return LETTERS[index + (3 if direction[index] < 0 else 0)]


def leg_length(positions: Floats, roles: Mapping[str, int]) -> float | None:
    """Thigh plus shank, the longer side, in the unit of positions (T, J, 3), or None without legs."""
    lengths = []
    for side in ("left", "right"):
        try:
            hip, knee, ankle = (positions[:, roles[side + part]] for part in ("UpperLeg", "LowerLeg", "Foot"))
        except KeyError:
            continue
        thigh, shank = np.linalg.norm(knee - hip, axis=-1), np.linalg.norm(ankle - knee, axis=-1)
        lengths.append(float(np.median(thigh) + np.median(shank)))
    return max(lengths) if lengths and max(lengths) > 0 else None


def find_unit(positions: Floats, roles: Mapping[str, int], file: str) -> tuple[float, tuple[str, ...]]:
    """m per unit of positions (T, J, 3) in file units, and warnings.

    Metres, centimetres and millimetres are taken wherever they make a leg; inches and CMU units only for an
    adult's leg within a factor of 1.35, since a child in centimetres looks like an adult in inches.
    """
    leg = leg_length(positions, roles)
    if leg is None:
        extent = float(np.median(np.ptp(positions, axis=1).max(axis=-1)))
        unit = min((1.0, 0.01, 0.001), key=lambda unit: abs(np.log(max(extent, 1e-12) * unit / 1.6)))
        return unit, (f"no legs were found, so the unit was taken from the body's size: {unit:g} m",)
    for unit in (1.0, 0.01, 0.001):
        if LEG[0] <= leg * unit <= LEG[1]:
            return unit, ()
    for name in ("inches", "CMU units"):
        if abs(np.log(leg * UNITS[name] / TYPICAL_LEG)) < np.log(1.35):
            return UNITS[name], ()
    raise MotionFileError(
        f"{file}: thigh and shank are {leg:.4g} file units long, which is no leg of {LEG[0]} to {LEG[1]} m in metres, "
        f"centimetres, millimetres, inches or CMU units; give unit_to_m, the metres in one file unit"
    )


def find_up(positions: Floats, roles: Mapping[str, int]) -> str:
    """The file axis that points from the feet to the head, or from the feet to the hips, on average.

    positions: (T, J, 3) in file axes, posed. Without feet or head, "+Y".
    """
    feet = [roles[role] for role in ("leftFoot", "rightFoot") if role in roles]
    tops = [roles[role] for role in ("head", "neck", "chest", "hips") if role in roles]
    if not feet or not tops:
        return "+Y"
    direction = np.mean(positions[:, tops[0]] - positions[:, feet].mean(axis=1), axis=0)
    return nearest_axis(direction) if np.linalg.norm(direction) > 0 else "+Y"


def knees_forward(hips: Floats, knees: Floats, ankles: Floats, toes: Floats | None) -> Floats:
    """(3,) direction in which knees bend, on average; the toes' where the knees never bend.

    hips, knees, ankles, toes: (legs, T, 3), any unit. Toes alone mislead: those of a trailing foot point back.
    """
    leg = ankles - hips
    share = np.sum((knees - hips) * leg, axis=-1, keepdims=True) / np.maximum(
        np.sum(leg * leg, axis=-1, keepdims=True), 1e-12
    )
    bend = np.mean(knees - hips - share * leg, axis=(0, 1))
    if toes is not None and np.linalg.norm(bend) < 0.01 * np.mean(np.linalg.norm(leg, axis=-1)):
        return np.asarray(np.mean(toes - ankles, axis=(0, 1)))
    return np.asarray(bend)


def facing(positions: Floats, roles: Mapping[str, int]) -> Floats | None:
    """(3,) direction the legs face in posed positions (T, J, 3), or None without two whole legs."""
    parts = ("UpperLeg", "LowerLeg", "Foot")
    if any(side + part not in roles for side in ("left", "right") for part in parts):
        return None
    hips, knees, ankles = (np.stack([positions[:, roles[side + part]] for side in ("left", "right")]) for part in parts)
    toes = None
    if "leftToes" in roles and "rightToes" in roles:
        toes = np.stack([positions[:, roles[side + "Toes"]] for side in ("left", "right")])
    return knees_forward(hips, knees, ankles, toes)


def find_forward(positions: Floats, roles: Mapping[str, int], up: str, least_travel: float) -> str:
    """The file axis nearest to the hips' travel if it exceeds `least_travel` (file units), else to where legs face."""
    flat = np.abs(axis_vector(up)) < 0.5
    hips = positions[:, roles.get("hips", 0)]
    travel = (hips[-1] - hips[0]) * flat
    if np.linalg.norm(travel) > least_travel:
        return nearest_axis(travel)
    direction = facing(positions, roles)
    if direction is None or np.linalg.norm(direction * flat) == 0:
        return ""
    return nearest_axis(direction * flat)


def to_y_up(up: str) -> Floats:
    """(3, 3) rotation of file vectors into axes where Y is up; the identity if it already is.

    The shortest turn, so Z-up data have X kept and -Y become +Z.
    """
    vector = axis_vector(up)
    if up == "+Y":
        return np.eye(3)
    if up == "-Y":
        return np.diag([1.0, -1.0, -1.0])
    axis = np.cross(vector, [0.0, 1.0, 0.0])
    skew = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + skew + skew @ skew  # Rodrigues, a quarter turn


def sides_swapped(positions: Floats, roles: Mapping[str, int]) -> bool:
    """True when the left leg is on the walker's right: the file is mirrored, left-handed or misnamed.

    positions: (T, J, 3), Y up. Judged leg by leg and frame by frame by the way the knees bend, so a walker who
    goes backwards or turns is not mistaken.
    """
    if facing(positions, roles) is None:
        return False
    left, right = (positions[:, roles[side + "UpperLeg"]] for side in ("left", "right"))
    forward = np.cross(left - right, [0.0, 1.0, 0.0])
    votes = []
    for side in ("left", "right"):
        hip, knee, ankle = (positions[:, roles[side + part]] for part in ("UpperLeg", "LowerLeg", "Foot"))
        votes.append(np.sum(forward * (knee - 0.5 * (hip + ankle)), axis=-1))
    return bool(np.sum(votes) < 0)

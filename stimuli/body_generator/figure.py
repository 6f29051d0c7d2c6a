"""The measures of one person and the joints that follow from them. Knows no field and no mesh.

All lengths in cm; Y up from the floor, +Z forward, +X the person's left; left-hand side only, the right is its
mirror image. The arms hang 30 degrees off vertical.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stimuli.skeleton import JOINTS, Floats

Stations = tuple[tuple[float, ...], ...]

ARM_ANGLE = np.radians(30)


@dataclass(frozen=True)
class Figure:
    """One person's measures and garment cuts; the meaning of station columns is in `fields` and `garments`."""

    name: str
    female: bool
    stature: float
    hip: tuple[float, float, float]
    knee: tuple[float, float, float]
    ankle: tuple[float, float, float]
    trunk_heights: tuple[float, float, float]  # hips, spine, chest
    neck: tuple[float, float, float]
    head: tuple[float, float, float]
    shoulder: tuple[float, float, float]
    upper_arm: float
    forearm: float
    hand: float
    foot_scale: float  # 1 = a foot of 27.1 cm
    hand_scale: float  # 1 = a hand of 19.3 cm
    head_scale: float  # 1 = a head of 15.4 x 19.9 cm
    neck_radius: float
    shirt: Stations
    trouser_top: Stations
    trouser_leg: Stations
    sleeve: Stations
    arm: Stations
    bust: tuple[float, float, float] | None  # centre of the left breast
    colours: dict[str, tuple[float, float, float]]  # linear RGB

    @property
    def arm_direction(self) -> Floats:
        """(3,) from the left shoulder to the left hand."""
        return np.array([np.sin(ARM_ANGLE), -np.cos(ARM_ANGLE), 0.0])

    @property
    def toe(self) -> Floats:
        """(3,) ball of the left foot."""
        x, _, z = self.ankle
        return np.array([x + 1.0, 2.4, z + 13.5 * self.foot_scale])

    def joints(self) -> Floats:
        """(21, 3) cm: all joints in the order of JOINTS."""
        hips, spine, chest = self.trunk_heights
        shoulder = np.array(self.shoulder)
        elbow = shoulder + self.upper_arm * self.arm_direction
        wrist = elbow + self.forearm * self.arm_direction
        places = {
            "hips": (0, hips, 0),
            "spine": (0, spine, -0.6),
            "chest": (0, chest, -1.4),
            "neck": self.neck,
            "head": self.head,
            "leftShoulder": (2.0, self.shoulder[1] + 2.5, 0.0),
            "leftUpperArm": shoulder,
            "leftLowerArm": elbow,
            "leftHand": wrist,
            "leftUpperLeg": self.hip,
            "leftLowerLeg": self.knee,
            "leftFoot": self.ankle,
            "leftToes": self.toe,
        }
        for name in [n for n in places if n.startswith("left")]:
            places[name.replace("left", "right")] = np.array(places[name]) * (-1, 1, 1)
        return np.array([places[name] for name in JOINTS], dtype=np.float64)

    def bones(self) -> tuple[tuple[int, Floats, Floats], ...]:
        """Segments that warm the skin: joint index, start, end. The trunk has ribs, flanks and hip bars besides
        its spine, or hanging arms would drag the flanks along."""
        at = dict(zip(JOINTS, self.joints(), strict=True))
        hand_end = at["leftHand"] + self.hand * self.arm_direction
        toe_end = at["leftToes"] + np.array([0.4, -0.6, 6.5 * self.foot_scale])
        crown = np.array([0, self.stature - 7.0, 0])
        rib = 0.62 * self.shoulder[0] * 0.95
        flank = 0.55 * max(row[2] for row in self.shirt[3:6])
        hip_bar = 0.8 * self.hip[0]
        found: list[tuple[str, Floats, Floats]] = [
            ("hips", at["hips"], at["spine"]),
            ("spine", at["spine"], at["chest"]),
            ("chest", at["chest"], at["neck"]),
            ("neck", at["neck"], at["head"]),
            ("head", at["head"], crown),
            ("head", at["head"] + (0, 1, 3), at["head"] + (0, 0, 7)),
        ]
        y = lambda name, up, x, z=0.0: np.array([x, at[name][1] + up, z])  # noqa: E731
        for side in (1, -1):
            found += [
                ("chest", y("chest", 0, side * rib), y("neck", -13, side * rib)),
                ("chest", y("chest", 0, side * rib * 0.5, 5), y("neck", -12, side * rib * 0.5, 4)),
                ("spine", y("spine", 1, side * flank), y("chest", -4, side * flank)),
                ("hips", y("hips", 1, side * hip_bar, 3), y("spine", -3, side * flank, 2)),
                ("hips", y("hips", 1, side * hip_bar, -4), y("spine", -3, side * flank, -3)),
            ]
        limbs = [
            ("Shoulder", "leftShoulder", at["leftUpperArm"]),
            ("UpperArm", "leftUpperArm", at["leftLowerArm"]),
            ("LowerArm", "leftLowerArm", at["leftHand"]),
            ("Hand", "leftHand", hand_end),
            ("UpperLeg", "leftUpperLeg", at["leftLowerLeg"]),
            ("LowerLeg", "leftLowerLeg", at["leftFoot"]),
            ("Foot", "leftFoot", at["leftToes"]),
            ("Foot", "leftFoot", at["leftFoot"] + (0, -5, -4)),
            ("Toes", "leftToes", toe_end),
        ]
        for role, start, end in limbs:
            found.append(("left" + role, at[start], np.asarray(end)))
            found.append(("right" + role, at[start] * (-1, 1, 1), np.asarray(end) * (-1, 1, 1)))
        return tuple((JOINTS.index(name), np.asarray(a, float), np.asarray(b, float)) for name, a, b in found)

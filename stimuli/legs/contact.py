"""How a foot stands, rolls over the ground and swings. Knows one foot in the sagittal plane; no skeleton, no clip.

The sole is a chain heel - ball - tip, hinged at the toe joint. Toes up it rolls on the heel; heel up it rolls on the
toes, which stay flat until they are bent as far as they go and then roll over their tip. Whatever the pitch, `planted`
puts the ankle so that the touching point neither slides nor leaves the ground: foot contact is not repaired here, it
is how the foot is described. A foot's path is its footprint (which travels backwards under the walker in stance and
returns in swing) plus the clearance of its lowest point.

A foot's own clock u runs 0 .. STANCE_END in stance and on to 1 in swing, so that cycles with different stance shares
are blended stance with stance and swing with swing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from stimuli.skeleton import JOINTS, Floats, Skeleton

STANCE_END = 0.62
"""Toe-off on the foot's own clock; about the share of stance at comfortable speed (Murray 1964)."""

FLAT_ZONE = math.radians(4.0)
"""Pitches well inside this are drawn as a flat foot, so that the change of pivot between heel and ball is smooth."""

TOE_BEND_LIMIT = math.radians(38.0)
"""Extension of the toes at push-off before they leave the ground, rad. Bare feet bend them by 40 to 50 degrees
(Bojsen-Moller & Lamoreux 1979), shod ones less; with 38 the drawn ankles of the default actors are nearest to the
captured ones."""

ARRIVAL = 0.99
"""Share of swing after which the foot comes straight down on its footprint."""

TOE_BEND_SOFTNESS = math.radians(4.0)


@dataclass(frozen=True)
class Sole:
    """Where the sole touches the ground in the rest pose; m from the point below the ankle, along the foot.

    ankle_height: height of the ankle joint
    heel:         distance from the ankle back to the last point of the heel
    ball:         distance from the ankle forward to the toe joint; ball_height its height
    tip:          distance from the ankle forward to the last point of the toes
    """

    ankle_height: float
    heel: float
    ball: float
    ball_height: float
    tip: float

    @classmethod
    def of(cls, skeleton: Skeleton) -> Sole:
        """The sole of a shod foot whose length follows the distance from ankle to toe joint.

        Heel and tip are those of the gaitlab shoe: 28 cm long, 13.5 cm from ankle to toe joint, of which 6.3 cm
        behind the ankle and 6.8 cm ahead of the toe joint touch the ground.
        """
        positions = skeleton.positions
        ankle, toes = positions[JOINTS.index("rightFoot")], positions[JOINTS.index("rightToes")]
        ball = float(toes[2] - ankle[2])
        return cls(float(ankle[1]), 0.47 * ball, ball, float(toes[1]), 1.5 * ball)


def flattened(pitch: Any) -> Any:
    """The drawn pitch of a wanted one: the same but for a smooth flat zone around 0 (odd, infinitely smooth)."""
    return pitch * pitch * pitch / (pitch * pitch + FLAT_ZONE * FLAT_ZONE)


def wanted_pitch(drawn: Floats) -> Floats:
    """The inverse of `flattened`: the real root of p³ - d p² - d FLAT_ZONE², by Cardano's formula."""
    d = np.asarray(drawn, dtype=float)
    root = np.cbrt(d * (d * d / 27.0 + FLAT_ZONE * (0.5 * FLAT_ZONE + np.sqrt(d * d / 27.0 + 0.25 * FLAT_ZONE**2))))
    return np.asarray(d / 3.0 + root + d * d / np.where(root == 0.0, 1.0, 9.0 * root))


def toe_bend(pitch: Any, swing: Any) -> Any:
    """Extension of the toes (rad, >= 0) for a foot pitch (rad, positive toes up) and progress of swing (0 .. 1).

    In stance (swing 0) the toes stay on the ground as far as they bend; in swing they straighten within half of it.
    """
    heel_up = np.maximum(-pitch, 0.0)
    over = TOE_BEND_SOFTNESS * softly_positive((heel_up - TOE_BEND_LIMIT) / TOE_BEND_SOFTNESS)
    return np.maximum(heel_up - over, 0.0) * (1.0 - smooth_step(2.0 * swing))


def planted(sole: Sole, pitch: Any, bend: Any) -> tuple[Any, Any]:
    """(forward, up) m: ankle relative to its flat-foot ground point, with the lowest point of the sole on the ground.

    pitch: rad, positive toes up; bend: rad, extension of the toes.
    """
    turned = np.cos(pitch), np.sin(pitch)
    heel_up, heel_ahead = _turn(sole.ankle_height, sole.heel, turned)
    ankle_up, ankle_ahead = _turn(sole.ankle_height - sole.ball_height, -sole.ball, turned)
    toe_pitch = np.minimum(pitch + bend, 0.0)
    ball_up, ball_ahead = _turn(sole.ball_height, sole.ball - sole.tip, (np.cos(toe_pitch), np.sin(toe_pitch)))
    on_heel = pitch >= 0.0
    forward = np.where(on_heel, heel_ahead - sole.heel, sole.tip + ball_ahead + ankle_ahead)
    return forward, np.where(on_heel, heel_up, ball_up + ankle_up)


def clock(phase: Any, stance: Any) -> Any:
    """The foot's own clock u in [0, 1) at a phase counted from its heel strike; stance: share of the cycle."""
    in_stance = phase < stance
    return np.where(
        in_stance,
        phase * (STANCE_END / stance),
        STANCE_END + (phase - stance) * ((1.0 - STANCE_END) / (1.0 - stance)),
    )


def phase_of(u: Any, stance: Any) -> Any:
    """The inverse of `clock`."""
    return np.where(
        u < STANCE_END, u * (stance / STANCE_END), stance + (u - STANCE_END) * ((1.0 - stance) / (1.0 - STANCE_END))
    )


def swing_progress(u: Any) -> Any:
    """0 in stance, 0 .. 1 from toe-off to the next heel strike."""
    return np.maximum(u - STANCE_END, 0.0) / (1.0 - STANCE_END)


def footprint_travel(phase: Any, stance: Any) -> Any:
    """Where the footprint is, in strides ahead of its place at heel strike.

    In stance it moves back with the ground (-phase). In swing it returns on the quintic that leaves and meets the
    ground's speed without a jump in velocity or acceleration, and arrives just before the foot does.
    """
    return smooth_step((phase - stance) / ((1.0 - stance) * ARRIVAL)) - phase


def smooth_step(x: Any) -> Any:
    """0 below 0, 1 above 1, between them the quintic with no velocity and acceleration at its ends."""
    x = np.minimum(np.maximum(x, 0.0), 1.0)
    return x * x * x * (10.0 + x * (-15.0 + 6.0 * x))


def softly_positive(x: Any) -> Any:
    """log(1 + exp(x)): x where well above 0, 0 well below, smooth between."""
    return np.maximum(x, 0.0) + np.log1p(np.exp(-np.abs(x)))


def _turn(up: Any, ahead: Any, pitch: tuple[Any, Any]) -> tuple[Any, Any]:
    """A vector of the sagittal plane turned toes-up by a pitch, of which the cosine and the sine are given."""
    cosine, sine = pitch
    return up * cosine + ahead * sine, ahead * cosine - up * sine

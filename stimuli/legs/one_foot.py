"""One foot at one instant in plain numbers: contact.py, which says what it means, without NumPy's cost per call."""

from __future__ import annotations

from math import cos, exp, log1p, sin

from stimuli.legs.contact import ARRIVAL, STANCE_END, TOE_BEND_LIMIT, TOE_BEND_SOFTNESS, Sole


def clock(phase: float, stance: float) -> float:
    """The foot's own clock in [0, 1) at a phase counted from its heel strike; stance: share of the cycle."""
    if phase < stance:
        return phase * (STANCE_END / stance)
    return STANCE_END + (phase - stance) * ((1.0 - STANCE_END) / (1.0 - stance))


def swing_progress(u: float) -> float:
    """0 in stance, 0 .. 1 from toe-off to the next heel strike."""
    return max(u - STANCE_END, 0.0) / (1.0 - STANCE_END)


def footprint_travel(phase: float, stance: float) -> float:
    """Where the footprint is, in strides ahead of its place at heel strike."""
    if phase < stance:
        return -phase
    return -phase + smooth_step((phase - stance) / ((1.0 - stance) * ARRIVAL))


def toe_bend(pitch: float, swing: float) -> float:
    """Extension of the toes (rad, >= 0) for a foot pitch (rad, positive toes up) and progress of swing (0 .. 1)."""
    heel_up = max(-pitch, 0.0)
    over = TOE_BEND_SOFTNESS * softly_positive((heel_up - TOE_BEND_LIMIT) / TOE_BEND_SOFTNESS)
    return max(heel_up - over, 0.0) * (1.0 - smooth_step(2.0 * swing))


def planted(sole: Sole, pitch: float, bend: float) -> tuple[float, float]:
    """(forward, up) m: ankle relative to its flat-foot ground point, with the lowest point of the sole on the ground.

    pitch: rad, positive toes up; bend: rad, extension of the toes.
    """
    if pitch >= 0.0:
        up, ahead = _turn(sole.ankle_height, sole.heel, pitch)
        return ahead - sole.heel, up
    ball_up, ball_ahead = _turn(sole.ball_height, sole.ball - sole.tip, min(pitch + bend, 0.0))
    ankle_up, ankle_ahead = _turn(sole.ankle_height - sole.ball_height, -sole.ball, pitch)
    return sole.tip + ball_ahead + ankle_ahead, ball_up + ankle_up


def smooth_step(x: float) -> float:
    """0 below 0, 1 above 1, between them the quintic with no velocity and acceleration at its ends."""
    x = min(max(x, 0.0), 1.0)
    return x * x * x * (10.0 + x * (-15.0 + 6.0 * x))


def softly_positive(x: float) -> float:
    """log(1 + exp(x)): x where well above 0, 0 well below, smooth between."""
    return max(x, 0.0) + log1p(exp(-abs(x)))


def _turn(up: float, ahead: float, pitch: float) -> tuple[float, float]:
    cosine, sine = cos(pitch), sin(pitch)
    return up * cosine + ahead * sine, ahead * cosine - up * sine

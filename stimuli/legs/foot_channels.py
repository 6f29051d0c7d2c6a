"""Where the swinging legs carry the feet: a leg's path as the channels that cycles store of a foot.

A captured foot is bent to start where it pushed off, to clear the ground, to stay within reach and to land on its
footprint. Knows one leg and its hips; no actor.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stimuli.blend import FOOT_CHANNELS
from stimuli.legs import contact
from stimuli.legs.foot_paths import PHASES, smoothed, swing_window
from stimuli.legs.leg_paths import BUILT_REACH, Hips, LegPath
from stimuli.legs.swing import calm_curve, calm_swing
from stimuli.legs.two_bone import Leg
from stimuli.skeleton import Floats

RAISED, CALM_RAISED = 0.22, 0.07
"""Share of swing, the first, in which a foot comes up to where its leg carries it; of a calm one as fast as captured.
Within 0.07 the toes of the model's longest steps would rise at 2.8 m/s, within 0.22 they do at 1.1; captured ones rise
at 0.5 to 1.2 (Schreiber & Moissenet's fast walks)."""

LOWERED = 0.12
"""Share of swing, the last, in which the foot comes down; above the ground as long as it still moves ahead."""

WITHIN_REACH = 0.03
"""Share of swing, the last, in which the foot need not stay where its leg reaches: the hips still come nearer to where
it will stand. Any longer and the knee would snap straight."""

LEAST_CLEARANCE = 0.012
"""m, clearance of the lowest point at mid swing (Winter 1992: 1.3 cm on average)."""

LATE_SHARE = 0.2
"""Share of it that is kept until the foot comes down, so that it never brushes the ground on its way."""

CALM_SHARE = 0.5
"""Share of it that smoothing must leave."""


def foot_channels(leg: Leg, path: LegPath, hips: Hips, stride: float) -> Floats:
    """(N, 6) FOOT_CHANNELS of a leg on its own clock (contact.clock)."""
    foot, own = path.foot, hips.at(path.phases)
    swing = contact.swing_progress(PHASES)
    phases = contact.phase_of(PHASES, foot.stance)

    def on_clock(values: Floats) -> Floats:
        return np.interp(phases, np.append(PHASES, 1.0), np.append(values, values[0]))

    carried = own + path.hip[:, 1:] + path.vector  # ankle (up, forward) if the leg had its way
    raised = CALM_RAISED if foot.calm else RAISED
    leave = contact.smooth_step(swing / raised) * contact.smooth_step((1.0 - swing) / LOWERED)
    low, high = (contact.smooth_step((1.0 - swing) / before) for before in (LOWERED, 0.6))
    least = LEAST_CLEARANCE * contact.smooth_step(swing / 0.07) * (LATE_SHARE * low + (1.0 - LATE_SHARE) * high)
    clearance = least + leave * _soft_positive(on_clock(carried[:, 0] - foot.ankle[:, 1]) - least)
    course = contact.footprint_travel(phases, foot.stance)
    travel = swing_window(swing) * (on_clock((carried[:, 1] - foot.ankle[:, 2] - path.ahead) / stride) - course)
    channels = {
        "pitch": on_clock(contact.wanted_pitch(foot.pitch)),
        "clearance": clearance,
        "travel": travel,
        "side": on_clock(foot.side),
        "yaw": on_clock(foot.yaw),
        "knee_yaw": on_clock(foot.knee_yaw),
    }
    joint = np.column_stack([on_clock(path.hip[:, 0]), *(on_clock(v) for v in (own + path.hip[:, 1:]).T)])
    if foot.calm:
        channels |= _calm(leg, path, joint, channels, CALM_SHARE * least, course, stride, on_clock)
    else:
        channels["travel"] = _within_reach(leg, path, joint, channels, course, stride, on_clock)
    return np.column_stack([channels[name] for name in FOOT_CHANNELS])


def _within_reach(
    leg: Leg,
    path: LegPath,
    joint: Floats,
    channels: dict[str, Floats],
    course: Floats,
    stride: float,
    on_clock: Callable[[Floats], Floats],
) -> Floats:
    """(N,) travel that keeps the ankle where the leg reaches from its hip joint (N, 3), until just before it lands."""
    foot, swing, travel = path.foot, contact.swing_progress(PHASES), channels["travel"]
    rolled = on_clock(foot.ankle[:, 2]) + path.ahead
    up = on_clock(foot.ankle[:, 1]) + channels["clearance"] - joint[:, 1]
    sideways = on_clock(foot.ankle[:, 0] - path.hip[:, 0])
    far = np.sqrt(np.maximum((BUILT_REACH * leg.length) ** 2 - up**2 - sideways**2, 0.0))
    places = [(joint[:, 2] + sign * far - rolled) / stride - course for sign in (-1.0, 1.0)]
    travel = smoothed(np.where(swing > 0.0, np.clip(travel, *places), 0.0)) * swing_window(swing)
    bounded = contact.smooth_step(swing / 0.1) * contact.smooth_step((1.0 - swing) / WITHIN_REACH)
    return np.asarray(travel + bounded * (np.clip(travel, *places) - travel))


def _calm(
    leg: Leg,
    path: LegPath,
    joint: Floats,
    channels: dict[str, Floats],
    least: Floats,
    course: Floats,
    stride: float,
    on_clock: Callable[[Floats], Floats],
) -> dict[str, Floats]:
    """The channels that place the ankle, for a leg that swings from its hip joint (N, 3) without a twitch.

    least: (N,) m, clearance that must be left
    """
    foot, swinging = path.foot, contact.swing_progress(PHASES) > 0.0
    ground, forward = on_clock(foot.ankle[:, 1]), on_clock(foot.forward)
    yaw, aside = (calm_curve(on_clock(values), swinging) for values in (foot.yaw, foot.ankle[:, 0]))
    rolled = np.cos(yaw) * forward + path.ahead
    wanted = np.column_stack([ground + channels["clearance"], rolled + stride * (course + channels["travel"])])
    ankle = calm_swing(leg, joint[:, 1:], aside - joint[:, 0], wanted, ground + least, swinging)
    return {
        "clearance": np.where(swinging, np.maximum(ankle[:, 0] - ground, 0.0), 0.0),
        "travel": np.where(swinging, (ankle[:, 1] - rolled) / stride - course, 0.0),
        "side": aside - np.sin(yaw) * forward,
        "yaw": yaw,
    }


def _soft_positive(values: Floats, width: float = 0.002) -> Floats:
    """values where well above 0, 0 well below, smooth between (m)."""
    return np.asarray(width * np.logaddexp(0.0, values / width))

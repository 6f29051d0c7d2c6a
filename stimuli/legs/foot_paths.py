"""A foot over one cycle of its own clock, rolling on its footprint and turning in the air. Knows no leg, no hips."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stimuli.legs import contact
from stimuli.legs.contact import Sole
from stimuli.skeleton import Floats

SAMPLES = 256
PHASES = np.arange(SAMPLES) / SAMPLES
SMOOTHING = 6  # samples each way
LINGERING = 3  # samples each way; less, and the ankle turns sharply there; more, and the foot stops turning

CLOSING = 0.15
"""Share of swing in which a captured foot comes on to its footprint."""


@dataclass(frozen=True, eq=False)
class FootPath:
    """A foot over PHASES, as it would roll on the ground at the place of its footprint.

    pitch: as drawn; yaw, knee_yaw: rad; side: m, of its footprint
    ankle: (N, 3) m from the footprint's forward place; forward: (N,) m, how far the foot has rolled along itself
    calm:  whether the leg's twitches are taken out (stimuli/legs/swing.py)
    """

    stance: float
    pitch: Floats
    yaw: Floats
    knee_yaw: Floats
    side: Floats
    ankle: Floats
    forward: Floats
    calm: bool


def pitched(
    sole: Sole, drawn: Floats, yaw: Floats, knee_yaw: Floats, side: Floats, stance: float, calm: bool
) -> FootPath:
    """The foot that rolls with a drawn pitch (N,) rad.

    In the air a calm one lingers flat, where its lowest point changes from toes to heel, and has its ankle, not its
    footprint, at the captured place aside.
    """
    swing = contact.swing_progress(contact.clock(PHASES, stance))
    if calm:
        wanted = contact.wanted_pitch(drawn)
        drawn = contact.flattened(wanted + swing_window(swing) * (smoothed(wanted, LINGERING) - wanted))
    forward, up = contact.planted(sole, drawn, contact.toe_bend(drawn, swing))
    rolled = 1.0 - swing_window(swing) if calm else 1.0
    ankle = np.column_stack([side + rolled * np.sin(yaw) * forward, up, np.cos(yaw) * forward])
    return FootPath(stance, drawn, yaw, knee_yaw, side, ankle, forward, calm)


def heel_rises(pitch: Floats, stance: float) -> Floats:
    """The pitch (N,) of a foot that stands flat from mid stance until its heel rises: its toes stay down."""
    late = contact.smooth_step((PHASES - 0.3) / 0.1) * contact.smooth_step((stance - PHASES) / 0.05)
    return np.asarray(pitch - late * np.maximum(pitch, 0.0))


def still_in_stance(values: Floats, stance: float) -> Floats:
    """A curve (N,) made constant in stance (its mean over the flat foot) and itself in mid swing."""
    still = float(np.mean(values[(PHASES > 0.1) & (PHASES < 0.4)]))
    return still + (values - still) * swing_window(contact.swing_progress(contact.clock(PHASES, stance)))


def swing_window(progress: Floats) -> Floats:
    """0 in stance, 1 in mid swing, without a jump in velocity or acceleration."""
    return np.asarray(
        contact.smooth_step((progress - 0.01) / 0.1) * contact.smooth_step((contact.ARRIVAL - progress) / CLOSING)
    )


def smoothed(values: Floats, reach: int = SMOOTHING) -> Floats:
    """A periodic curve (N,) averaged over some 2 per cent of the cycle, which takes corners off; reach: samples."""
    kernel = np.hanning(2 * reach + 1)
    padded = np.concatenate([values[-reach:], values, values[:reach]])
    return np.convolve(padded, kernel / kernel.sum(), mode="valid")

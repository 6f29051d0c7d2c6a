"""Where blood shows through the skin: cheeks, nose, ears, knuckles and finger tips, elbows."""

from __future__ import annotations

import numpy as np

from stimuli.body_generator.figure import Figure
from stimuli.body_generator.head import head_frame
from stimuli.skeleton import Floats

# centre on the left in head coordinates (cm), how far it spreads (cm, one sigma), how red (see `Surface.blush`)
_FACE = (
    ((4.4, 160.0, 6.8), 1.7, 0.16),
    ((0.0, 160.2, 10.6), 1.0, 0.16),
    ((1.2, 159.8, 9.8), 0.7, 0.08),
    ((8.3, 162.0, -1.2), 1.6, 0.16),
    ((0.0, 153.8, 8.4), 1.1, 0.08),
    ((2.6, 162.0, 8.0), 0.8, 0.06),
)
_KNUCKLES, _TIPS, _ELBOW = 0.16, 0.16, 0.12
_HAND = 19.3  # cm, of the hand that places on it are given for


def blush(figure: Figure, points: Floats) -> Floats:
    """(N,) of skin at points (N, 3) cm; what `Surface.blush` holds."""
    left = np.abs(points) * (1, 0, 0) + points * (0, 1, 1)
    p = head_frame(figure).to_head(left)
    found = np.zeros(len(points))
    for centre, spread, red in _FACE:
        found += red * np.exp(-np.sum((p - centre) ** 2, axis=1) / (2 * spread**2))
    return found + _on_arm(figure, left)


def _on_arm(figure: Figure, left: Floats) -> Floats:
    shoulder, along = np.array(figure.shoulder), figure.arm_direction
    elbow = shoulder + figure.upper_arm * along - (0, 0, 3.5)
    place = ((left - shoulder) @ along - figure.upper_arm - figure.forearm) * _HAND / (18.9 * figure.hand_scale)
    knuckles = _KNUCKLES * np.exp(-(((place - 10.0) / 1.1) ** 2))
    tips = _TIPS * np.clip((place - 11.0) / 4.0, 0, 1)
    near_elbow = _ELBOW * np.exp(-np.sum((left - elbow) ** 2, axis=1) / (2 * 2.2**2))
    return np.where(place > 3, np.maximum(knuckles, tips), near_elbow)

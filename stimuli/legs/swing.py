"""A swinging leg without a twitch: hip-ankle distance and direction smoothed between toe-off and heel strike.

What bends a captured foot's way through the air (stimuli/legs/foot_channels.py) turns sharply somewhere, and near the
straight leg a millimetre is degrees of the knee. So the knee's bend and the leg's direction are smoothed, not the
ankle's place: what is drawn never asks more than the leg has. Knows one leg in its plane; no skeleton, no actor.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stimuli.legs.two_bone import Leg, reach
from stimuli.skeleton import Floats

Bools = NDArray[np.bool_]

CUTOFF = 14.0
"""Harmonic of the cycle that is damped by half; captured walks are kept to the eighth."""

STRAIGHT = np.radians(4.0)
STRAIGHTEST = np.radians(3.0)
"""Least bend of a swinging knee as wanted, and after smoothing."""

HELD = 1e6
"""Weight of a sample that smoothing must keep, against 1 of others."""

BEFORE = 4
"""Samples before toe-off that are kept, so that the curve goes on with its slope."""

ROUNDS = 6


def calm_curve(values: Floats, swinging: Bools) -> Floats:
    """A curve (N,) over the leg's clock, smoothed where it swings (N,); toe-off keeps its slope, strike its place."""
    part, held = _kept(swinging)
    found = np.array(values)
    found[part[~held]] = _smoothed(values[part], np.where(held, HELD, 1.0))[~held]
    return found


def calm_swing(leg: Leg, hip: Floats, aside: Floats, ankle: Floats, lowest: Floats, swinging: Bools) -> Floats:
    """(N, 2) m, the ankle's path over the leg's clock, smoothed where it swings (N,).

    hip, ankle: (N, 2) m up and forward; aside: (N,) m from hip to ankle
    lowest:     (N,) m, height of the ankle at which the foot clears the ground
    """
    part, held = _kept(swinging)
    vector, aside, least = (ankle - hip)[part], aside[part], (lowest - hip[:, 0])[part]
    weights = np.where(held, HELD, 1.0)
    direction = _smoothed(np.arctan2(vector[:, 1], -vector[:, 0]), weights)
    bend = _bend(leg, np.hypot(np.hypot(*vector.T), aside))
    bend = np.where(held, bend, np.maximum(bend, STRAIGHT))
    above = _bend(leg, np.hypot(least / np.cos(direction), aside))
    for _ in range(ROUNDS):  # the more the curve is held where the foot would touch the ground
        calm = np.maximum(_smoothed(bend, weights), STRAIGHTEST)
        out = np.sqrt(np.maximum(reach(leg, calm) ** 2 - aside**2, 1e-6))
        below = ~held & (-np.cos(direction) * out < least)
        if not below.any():
            break
        bend = np.where(below, np.maximum(bend, above), bend)
        weights = np.where(below, 4.0 * weights, weights)
    found = np.array(ankle)
    path = hip[part] + np.column_stack([-np.cos(direction) * out, np.sin(direction) * out])
    found[part[~held]] = path[~held]
    return found


def _kept(swinging: Bools) -> tuple[NDArray[np.intp], Bools]:
    """Samples from just before toe-off to heel strike, and which of them smoothing must keep."""
    first = int(np.argmax(swinging))
    part = np.append(np.arange(first - BEFORE, len(swinging)), 0)
    return part, (part < first)


def _bend(leg: Leg, distance: Floats) -> Floats:
    """(N,) rad, knee flexion for hip-ankle distances (m); 0 out of reach."""
    cosine = (distance**2 - leg.thigh**2 - leg.shank**2) / (2.0 * leg.thigh * leg.shank)
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)))


def _smoothed(values: Floats, weights: Floats) -> Floats:
    """(K,) the curve nearest to the values, by weighted squares, without sharp turns (Whittaker 1923).

    Its second differences count so much that a wave of CUTOFF per cycle of 256 samples is halved.
    """
    from scipy.linalg import solveh_banded  # here, because showing made cycles needs none of it

    stiffness = (2.0 * np.sin(np.pi * CUTOFF / 256.0)) ** -4
    bands = np.full((3, len(values)), [[1.0], [-4.0], [6.0]])  # of D'D, D the second differences, upper form
    bands[2, [0, -1]], bands[2, [1, -2]], bands[1, [1, -1]] = 1.0, 5.0, -2.0
    bands *= stiffness
    bands[2] += weights
    return np.asarray(solveh_banded(bands, weights * values, check_finite=False))

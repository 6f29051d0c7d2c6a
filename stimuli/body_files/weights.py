"""From a file's joint weights to those of gaitlab's 21 joints, four per vertex, with soles that no shank bends."""

from __future__ import annotations

import numpy as np

from stimuli.bodies.body import Integers
from stimuli.skeleton import JOINTS, Floats

STIFF_BELOW, FREE_ABOVE = 0.35, 0.7
"""Of the ankle's height: below, a foot's vertices do not follow the shank at all; above, as much as in the file."""


def per_role(places: Floats, weights: Floats) -> Floats:
    """(V, 21) weights of vertices whose influences (V, K) move with these places in JOINTS; rows keep their sums."""
    dense = np.zeros((len(places), len(JOINTS)))
    for column in range(places.shape[1]):
        np.add.at(dense, (np.arange(len(places)), places[:, column].astype(np.int64)), weights[:, column])
    return dense


def with_stiff_soles(dense: Floats, positions: Floats, joints: Floats) -> Floats:
    """Weights (V, 21) with what the shank has of a sole given to the foot.

    A shoe weighted smoothly far down has soles that the shank lifts and sinks by millimetres as the ankle turns, which
    shows in a foot that stands on the ground. positions: (V, 3) m and joints: (21, 3) m, in the bind pose.
    """
    stiff = np.array(dense)
    for side in ("left", "right"):
        shank, foot, toes = (JOINTS.index(f"{side}{part}") for part in ("LowerLeg", "Foot", "Toes"))
        height = positions[:, 1] / max(float(joints[foot, 1]), 1e-6)
        share = np.clip((FREE_ABOVE - height) / (FREE_ABOVE - STIFF_BELOW), 0.0, 1.0)
        given = np.where(dense[:, foot] + dense[:, toes] > 0.0, share * dense[:, shank], 0.0)
        stiff[:, foot] += given
        stiff[:, shank] -= given
    return stiff


def four_largest(dense: Floats) -> tuple[Integers, Floats]:
    """(V, 4) joints and weights of the four largest of each row of (V, 21), summing to 1."""
    order = np.argsort(-dense, axis=1, kind="stable")[:, :4]
    kept = np.take_along_axis(dense, order, axis=1)
    return order, kept / kept.sum(axis=1, keepdims=True)

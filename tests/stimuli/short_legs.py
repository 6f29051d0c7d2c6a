"""A body with the legs of a toy: too short for a person's longer steps, as many a stylised character's are."""

from dataclasses import replace

import numpy as np

from stimuli.bodies.body import Body
from stimuli.skeleton import JOINTS, PARENTS, Skeleton

SHARE = 0.35
"""Of a person's length between hip and ankle."""


def short_legged(body: Body) -> Body:
    """The body squeezed between ankles and hips to SHARE of its height there; feet and trunk keep their shape."""
    ankle, hip = (body.skeleton.positions[JOINTS.index(joint), 1] for joint in ("rightFoot", "rightUpperLeg"))

    def squeezed(places):
        lower = np.interp(places[:, 1], [ankle, hip], [0.0, (1.0 - SHARE) * (hip - ankle)])
        return places - lower[:, None] * (0.0, 1.0, 0.0)

    positions = squeezed(body.skeleton.positions)
    above = np.array([positions[parent] if parent >= 0 else np.zeros(3) for parent in PARENTS])
    levels = tuple(tuple(replace(s, positions=squeezed(s.positions)) for s in level) for level in body.levels)
    return Body(body.name, Skeleton(positions - above), body.stature - (1.0 - SHARE) * (hip - ankle), levels)

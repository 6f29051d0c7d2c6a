"""How much of the sky a point of the body sees: ambient occlusion from the field along the normal.

If the field grows more slowly than the way walked, something is near (after Quilez's five-tap occlusion).
"""

from __future__ import annotations

import numpy as np

from stimuli.body_generator.fields import Field
from stimuli.skeleton import Floats

_REACHES = (0.6, 1.4, 3.0, 6.5, 13.0)  # cm
_SHARES = (0.22, 0.22, 0.22, 0.20, 0.14)
STRENGTH = 0.85


def occlusion(field: Field, own: Field, positions: Floats, normals: Floats) -> Floats:
    """(V,) 1 = open sky, 0 = buried. `own` is the part's own field, whose folds the whole person's lacks."""
    hidden = np.zeros(len(positions))
    for reach, share in zip(_REACHES, _SHARES, strict=True):
        there = positions + (0.15 + reach) * normals
        free = np.minimum(field(there), own(there)) if reach < 5 else field(there)
        hidden += share * np.clip(1 - free / reach, 0, 1)
    up = 0.5 + 0.5 * normals[:, 1]
    return np.clip(1 - STRENGTH * hidden, 0.12, 1) * (0.90 + 0.10 * up)

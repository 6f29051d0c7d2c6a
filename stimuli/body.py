"""A skinned body as arrays: vertices, triangles, weights, colours. Knows no file format and no GPU."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stimuli.skeleton import Floats, Skeleton

Integers = NDArray[np.integer]


@dataclass(frozen=True, eq=False)
class Surface:
    """One material of a body and the triangles that wear it.

    name:      "skin", "hair", "shirt", "trousers", "shoes", "eye", ...
    colour:    (3,) linear RGB in [0, 1].
    roughness: 0 (mirror) .. 1 (chalk).
    positions: (V, 3) m, bind pose; normals: (V, 3) unit length; occlusion: (V,) 0 (dark) .. 1 (open sky).
    joints:    (V, 4) int, indices into skeleton JOINTS; weights: (V, 4), not negative, rows sum to 1.
    triangles: (T, 3) int, counter-clockwise seen from outside.
    """

    name: str
    colour: Floats
    roughness: float
    positions: Floats
    normals: Floats
    occlusion: Floats
    joints: Integers
    weights: Floats
    triangles: Integers


@dataclass(frozen=True, eq=False)
class Body:
    """A person to look at, standing in the bind pose on the ground, facing +Z.

    name:           "woman", "man", ...
    skeleton:       rest pose = bind pose: the joints where the skin was attached.
    stature:        m, sole to crown.
    levels:         levels of detail, finest first; each is the body's surfaces.
    """

    name: str
    skeleton: Skeleton
    stature: float
    levels: tuple[tuple[Surface, ...], ...]

"""A skinned body as arrays: vertices, triangles, weights, colours. Knows no file format and no GPU."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stimuli.skeleton import Floats, Skeleton

Integers = NDArray[np.integer]

MOST_BLUSH = 0.45


@dataclass(frozen=True, eq=False)
class Surface:
    """One material of a body and the triangles that wear it.

    name:      "skin", "hair", "shirt", "trousers", "shoes", "eye", ...
    colour:    (3,) linear RGB in [0, 1].
    roughness: 0 (mirror) .. 1 (chalk).
    positions: (V, 3) m, bind pose; normals: (V, 3) unit length; occlusion: (V,) 0 (dark) .. 1 (open sky).
    blush:     (V,) share of green and blue light that blood under the skin takes, 0 .. MOST_BLUSH; None is none.
    knot:      m above the ground, where hair is tied at the back of the head; None where it hangs from the crown.
    joints:    (V, 4) int, indices into skeleton JOINTS; weights: (V, 4), not negative, rows sum to 1.
    triangles: (T, 3) int, counter-clockwise seen from outside.
    picture:   (H, W, 4) uint8 sRGB and alpha, multiplied by the colour; None is the colour alone.
    picture_at: (V, 2) places in the picture, (0, 0) its upper left corner; None without a picture.
    alpha:     what the picture's alpha means (glTF 2.0, section 3.9.4); alpha_cutoff: of a mask;
               alpha_factor: multiplies it.
    double_sided: seen from behind too.
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
    picture: NDArray[np.uint8] | None = None
    picture_at: Floats | None = None
    alpha: Literal["opaque", "mask", "blend"] = "opaque"
    alpha_cutoff: float = 0.5
    alpha_factor: float = 1.0
    double_sided: bool = False
    blush: Floats | None = None
    knot: float | None = None


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

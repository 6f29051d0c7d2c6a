"""The pictures that bodies wear, as one array of layers in linear light with smaller copies for the distance."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from stimuli.bodies.body import Surface

LARGEST = 2048  # pixels; larger pictures are made smaller
MODES = {"opaque": 0.0, "mask": 1.0, "blend": 2.0}
LEAST_BLENDED = 0.04
"""Alpha below which a blended surface is not drawn at all."""

_CODES = np.arange(256) / 255.0
_LINEAR = np.where(_CODES <= 0.04045, _CODES / 12.92, ((_CODES + 0.055) / 1.055) ** 2.4).astype(np.float16)
"""sRGB code -> linear light (IEC 61966-2-1)."""


def has_pictures(surfaces: tuple[Surface, ...]) -> bool:
    """Whether any surface needs more than its colour."""
    return any(s.picture is not None or s.alpha != "opaque" or s.double_sided for s in surfaces)


def layers(context: moderngl.Context, surfaces: tuple[Surface, ...]) -> tuple[moderngl.TextureArray, list[int]]:
    """All pictures in one texture, and the layer of each surface, -1 without; the same picture is stored once."""
    kept: dict[int, int] = {}
    pictures: list[NDArray[np.uint8]] = []
    numbers = []
    for surface in surfaces:
        if surface.picture is None:
            numbers.append(-1)
            continue
        if id(surface.picture) not in kept:
            kept[id(surface.picture)] = len(pictures)
            pictures.append(surface.picture)
        numbers.append(kept[id(surface.picture)])
    width = min(max((p.shape[1] for p in pictures), default=1), LARGEST)
    height = min(max((p.shape[0] for p in pictures), default=1), LARGEST)
    data = np.ones((max(len(pictures), 1), height, width, 4), np.float16)
    for layer, picture in enumerate(pictures):
        same = picture.shape[:2] == (height, width)
        fitted = picture if same else np.asarray(Image.fromarray(picture).resize((width, height)))
        data[layer, ..., :3] = _LINEAR[fitted[..., :3]]
        data[layer, ..., 3] = fitted[..., 3] / np.float16(255)
    texture = context.texture_array((width, height, len(data)), 4, data.tobytes(), dtype="f2")
    texture.build_mipmaps()
    texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    return texture, numbers


def covers(surfaces: tuple[Surface, ...], numbers: list[int], most: int) -> bytes:
    """(most, 4) float32: layer, alpha mode, least alpha that is drawn, alpha factor."""
    rows = np.zeros((most, 4), np.float32)
    rows[:, 0] = -1.0
    for row, surface, number in zip(rows, surfaces, numbers, strict=False):
        least = {"opaque": 0.0, "mask": surface.alpha_cutoff, "blend": LEAST_BLENDED}[surface.alpha]
        row[:] = (number, MODES[surface.alpha], least, surface.alpha_factor)
    return rows.tobytes()

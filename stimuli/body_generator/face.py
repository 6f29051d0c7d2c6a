"""What is painted on a face: eyes, brows and lips. Coordinates as in `head`, cm."""

from __future__ import annotations

import numpy as np

from stimuli.body_generator.eyes import eyes
from stimuli.body_generator.patches import BOTH, Canvas, laid, pressed, ribbon
from stimuli.body_generator.pieces import Piece
from stimuli.skeleton import Floats

_BROW_FROM, _BROW_LONG = 1.30, 3.85
_HAIRS = 72  # of a brow, in close-ups


def face_patches(canvas: Canvas, female: bool) -> list[Piece]:
    """All patches of both sides."""
    return [*eyes(canvas, female), *_brows(canvas, female), *_lips(canvas, female)]


def _brows(canvas: Canvas, female: bool) -> list[Piece]:
    """A thin band with hairs over it, so that a brow has no outline: upright at the nose, lying flat at the temple."""
    rng = np.random.default_rng(3)
    s = np.linspace(0, 1, canvas.count(14))
    low, high = _brow(s, female)
    share = 0.15 if canvas.near else 0.0
    band = ribbon(_BROW_FROM + s * _BROW_LONG, low + share * (high - low), high - share * (high - low), (0.0, 1.0))
    shade = 0.72 + 0.2 * rng.random(band.shape[:2])
    patches = [pressed(canvas, "brow", band, 0.05, shade, side) for side in BOTH]
    if canvas.near:
        patches += _brow_hairs(canvas, female, rng)
    return patches


def _brow(s: Floats, female: bool) -> tuple[Floats, Floats]:
    """Lower and upper edge of a brow from the nose, 0, to the temple, 1."""
    rise, fall, thick = (0.48, 0.40, 0.42) if female else (0.25, 0.48, 0.62)
    arch = 165.28 + rise * np.sin(np.pi * np.clip(s * 0.80, 0, 1)) ** 1.2 - fall * s**3
    half = 0.5 * thick * np.clip(0.55 + s / 0.3, 0, 1) * (1 - 0.82 * s**1.8)
    return arch - half, arch + half


def _brow_hairs(canvas: Canvas, female: bool, rng: np.random.Generator) -> list[Piece]:
    count = max(8, round(_HAIRS * canvas.fineness))
    s = (np.arange(count) + rng.uniform(0, 1, count)) / count
    low, high = _brow(s, female)
    root = np.column_stack([_BROW_FROM - 0.05 + s * _BROW_LONG, low + rng.uniform(-0.05, 0.75, count) * (high - low)])
    turn = np.radians(62 - 48 * np.clip(s / 0.45, 0, 1) - 30 * np.clip((s - 0.55) / 0.45, 0, 1)) + rng.normal(
        0, 0.12, count
    )
    length = rng.uniform(0.30, 0.50, count) * (1 - 0.25 * s) * (0.85 if female else 1.0)
    along = np.column_stack([np.cos(turn), np.sin(turn)])
    across = np.column_stack([-along[:, 1], along[:, 0]]) * (0.026 / min(1.0, canvas.fineness + 0.2))
    tip = root + along * length[:, None]
    hairs = np.stack([np.stack([root - across, root + across], 1), np.stack([tip, tip], 1)], axis=1)
    places = canvas.on_skin(hairs)
    normals = canvas.skin_normals(places)
    raised = places + 0.06 * (0.5 * normals + (0, 0, 0.5))
    shade = rng.uniform(0.6, 1.0, count)
    return [
        laid(canvas, "brow", raised[i], np.full((2, 2), shade[i]), normals[i], side)
        for i in range(count)
        for side in BOTH
    ]


def _lips(canvas: Canvas, female: bool) -> list[Piece]:
    half = 2.5 if female else 2.6  # mouths of 4.7 and 5.2 cm (Farkas 1994: 5.0 and 5.3)
    u = np.linspace(-1, 1, canvas.count(23))
    x = half * u
    fade = (1 - np.abs(u) ** 2.2) ** 0.8
    middle = 156.88 + 0.05 * np.cos(2 * np.pi * u) + (0.20 if female else 0.36) * u**2 + 0.16 * u**4
    bow = 0.66 if female else 0.48
    top = middle + bow * fade * (
        1 - 0.16 * np.exp(-((u / 0.13) ** 2)) + 0.10 * np.exp(-(((np.abs(u) - 0.24) / 0.16) ** 2))
    )
    bottom = middle - (0.78 if female else 0.62) * fade * (1 - 0.1 * u**2)
    v = np.linspace(0, 1, canvas.count(5))
    patches = []
    for low, high, dark in ((middle, top, v[::-1]), (bottom, middle, v)):
        shade = (1 - (0.62 if female else 0.5) * dark[None, :] ** 5) * (1 - 0.25 * np.abs(u[:, None]) ** 6)
        patches.append(pressed(canvas, "lip", ribbon(x, low, high, v), 0.06, shade))
    return patches

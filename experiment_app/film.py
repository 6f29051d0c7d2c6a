"""Pictures of a session: single frames, a strip of frames and a short looping film, from off-screen pixels."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

Pixels = NDArray[np.uint8]


def save_picture(pixels: Pixels, path: Path) -> None:
    """One frame, (height, width, 3) uint8, as PNG."""
    Image.fromarray(pixels).save(path)


def save_strip(frames: Sequence[Pixels], path: Path, count: int = 8, share: float = 0.42) -> None:
    """`count` frames evenly spaced over the film, side by side, each the middle `share` of its width, as PNG."""
    chosen = [frames[round(i * (len(frames) - 1) / max(count - 1, 1))] for i in range(count)]
    width = chosen[0].shape[1]
    margin = int(width * (1.0 - share) / 2.0)
    Image.fromarray(np.hstack([frame[:, margin : width - margin] for frame in chosen])).save(path)


def save_film(frames: Sequence[Pixels], frame_rate: float, path: Path) -> None:
    """A film as animated WebP; every frame lasts the nearest whole number of milliseconds."""
    pictures = [Image.fromarray(frame) for frame in frames]
    duration = round(1000.0 / frame_rate)
    pictures[0].save(path, save_all=True, append_images=pictures[1:], duration=duration, loop=0, quality=80)

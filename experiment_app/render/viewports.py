"""Two scenes side by side: which pixels each has, and the strip that parts them. Pure arithmetic: no GL, no state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from experiment_app.render.drawn import Drawn
from experiment_app.scene import Scene

Area = tuple[int, int, int, int]
"""x and y of the lower left corner, width and height, pixels from the lower left."""

THICKNESS = 240
"""The strip is one pixel wide for so many pixels of the picture's height, and two at least."""


@dataclass(frozen=True, eq=False)
class Viewport:
    """One scene of a picture, the walkers posed for it, and the pixels it covers."""

    scene: Scene
    drawn: Sequence[Drawn]
    area: Area


def viewports_of(scene: Scene, drawn: Sequence[Drawn], size: tuple[int, int]) -> tuple[Viewport, ...]:
    """The views of a picture of `size`: one that fills it, or two with as many pixels each.

    drawn: the scene's walkers and its crowd, then those of the scene beside it. What is seen under the viewer's
    angle is the whole picture, so both halves have the outer scene's.
    """
    width, height = size
    if scene.beside is None:
        return (Viewport(scene, drawn, (0, 0, width, height)),)
    left, right, _ = divide(size)
    beside = replace(scene.beside, screen_angle=scene.screen_angle)
    first = len(scene.walkers) + (scene.crowd is not None)
    alone = replace(scene, beside=None)
    return Viewport(alone, drawn[:first], left), Viewport(beside, drawn[first:], right)


def divide(size: tuple[int, int]) -> tuple[Area, Area, Area]:
    """Left half, right half and the strip between them, which takes what keeps the halves equal."""
    width, height = size
    strip = max(2, round(height / THICKNESS))
    strip += (width - strip) % 2
    half = max((width - strip) // 2, 1)
    return (0, 0, half, height), (width - half, 0, half, height), (half, 0, max(width - 2 * half, 0), height)

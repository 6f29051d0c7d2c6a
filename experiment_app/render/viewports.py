"""Two scenes side by side: which pixels each has, and the strip that parts them. Pure arithmetic: no GL, no state."""

from __future__ import annotations

import math
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

    def smaller(self, scale: int) -> Viewport:
        """The same view in a picture with `scale` times fewer pixels across."""
        left, bottom, width, height = self.area
        return replace(self, area=(left // scale, bottom // scale, width // scale, height // scale))


def viewports_of(scene: Scene, drawn: Sequence[Drawn], size: tuple[int, int]) -> tuple[Viewport, ...]:
    """The views of a picture of `size`: one, or two with as many pixels each, above the strip kept for the page.

    drawn: the scene's walkers and its crowd, then those of the scene beside it. What is seen under the viewer's
    angle is the whole picture, so both halves have the outer scene's.
    """
    width, height = size
    floor = round(scene.strip * height)
    above = 1.0 - floor / height
    alone = cut(replace(scene, beside=None, strip=0.0), above)
    if scene.beside is None:
        return (Viewport(alone, drawn, (0, floor, width, height - floor)),)
    left, right, _ = divide((width, height - floor))
    beside = cut(replace(scene.beside, screen_angle=scene.screen_angle), above)
    first = len(scene.walkers) + (scene.crowd is not None)
    return Viewport(alone, drawn[:first], _raised(left, floor)), Viewport(beside, drawn[first:], _raised(right, floor))


def cut(scene: Scene, share: float) -> Scene:
    """The scene as the middle `share` of its picture's height shows it: narrower angles, everything as large."""
    if share == 1.0:
        return scene
    camera = replace(scene.camera, field_of_view=_narrowed(scene.camera.field_of_view, share))
    return replace(scene, camera=camera, screen_angle=_narrowed(scene.screen_angle, share))


def _narrowed(angle: float, share: float) -> float:
    """Degrees that a share of the height of a picture fills whose whole height fills `angle`."""
    return 2.0 * math.degrees(math.atan(share * math.tan(math.radians(angle / 2.0))))


def _raised(area: Area, by: int) -> Area:
    x, y, width, height = area
    return x, y + by, width, height


def divide(size: tuple[int, int]) -> tuple[Area, Area, Area]:
    """Left half, right half and the strip between them, which takes what keeps the halves equal."""
    width, height = size
    strip = max(2, round(height / THICKNESS))
    strip += (width - strip) % 2
    half = max((width - strip) // 2, 1)
    return (0, 0, half, height), (width - half, 0, half, height), (half, 0, max(width - 2 * half, 0), height)

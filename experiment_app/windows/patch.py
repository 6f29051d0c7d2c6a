"""A square in a corner of the picture for a photodiode: white while somebody is to be seen walking, else black."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import moderngl

from experiment_app.scene import Scene

Corner = Literal["top-left", "top-right", "bottom-left", "bottom-right"]

SIDE = 0.06
"""Side of the square, share of the picture's height: 1.6 cm on a screen 27 cm high."""


@dataclass(frozen=True)
class Patch:
    """The square in one corner."""

    corner: Corner

    def draw(self, screen: moderngl.Framebuffer, size: tuple[int, int], scene: Scene) -> None:
        """Fills the square; size: of the picture, pixels."""
        width, height = size
        side = max(round(SIDE * height), 8)
        left = 0 if self.corner.endswith("left") else width - side
        bottom = 0 if self.corner.startswith("bottom") else height - side
        level = float(scene.somebody)
        screen.clear(level, level, level, viewport=(left, bottom, side, side))

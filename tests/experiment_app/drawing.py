"""One scene drawn off-screen and read back."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

from experiment_app.render.renderer import Renderer
from experiment_app.scene import Scene
from experiment_app.walkers import drawn_walkers

Pixels = NDArray[np.uint8]


def picture(context: moderngl.Context, renderer: Renderer, scene: Scene, size: tuple[int, int]) -> Pixels:
    """The scene's pixels, (height, width, 3) uint8, in a picture of `size` (width, height)."""
    renderer.resize(size, 1.0)
    target = context.simple_framebuffer(size)
    renderer.draw(scene, drawn_walkers(scene), target)
    pixels = renderer.read_pixels(target)
    target.release()
    return pixels

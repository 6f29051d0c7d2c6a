"""Draws point lights and stick figures: lines and dots of a constant size on the screen, smooth to a pixel."""

from __future__ import annotations

import math
from collections.abc import Sequence

import moderngl
import numpy as np

from experiment_app.render.cameras import Viewpoint
from experiment_app.render.drawn import DrawnWalker
from experiment_app.render.programs import build, set_if_used
from experiment_app.scene import Scene

LINE = np.dtype([("from", "3f4"), ("to", "3f4"), ("width", "f4")])


class MarksPass:
    """All lines and dots of a frame in one instanced draw."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._program = build(context, "marks.vert", "marks.frag")
        self._buffer: moderngl.Buffer | None = None
        self._array: moderngl.VertexArray | None = None

    def draw(self, scene: Scene, walkers: Sequence[DrawnWalker], viewpoint: Viewpoint, size: tuple[int, int]) -> None:
        """Draws the walkers that have lines into the bound framebuffer of a size (pixels)."""
        dot, line = (
            visual_angle_pixels(degrees, scene.screen_angle, viewpoint, size[1])
            for degrees in (scene.marks.dot_size, scene.marks.line_width)
        )
        data = packed(walkers, dot, line)
        if len(data) == 0:
            return
        self._write(data)
        assert self._array is not None
        self._context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        self._context.blend_func = moderngl.DEFAULT_BLENDING  # pages leave another behind
        self._context.fbo.depth_mask = False
        set_if_used(self._program, "world_to_clip", viewpoint.matrix_bytes)
        set_if_used(self._program, "size", (float(size[0]), float(size[1])))
        set_if_used(self._program, "brightness", scene.marks.brightness)
        self._array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=len(data))
        self._context.fbo.depth_mask = True

    def release(self) -> None:
        """Frees the GPU's memory."""
        for part in (self._array, self._buffer, self._program):
            if part is not None:
                part.release()

    def _write(self, data: np.ndarray) -> None:
        if self._buffer is None or self._buffer.size < data.nbytes:
            for part in (self._array, self._buffer):
                if part is not None:
                    part.release()
            self._buffer = self._context.buffer(reserve=1 << (data.nbytes - 1).bit_length(), dynamic=True)
            self._array = self._context.vertex_array(
                self._program, [(self._buffer, "3f4 3f4 1f4/i", "from", "to", "width")]
            )
        self._buffer.write(data.tobytes())


def visual_angle_pixels(degrees: float, screen_angle: float, viewpoint: Viewpoint, picture_height: int) -> float:
    """Pixels of a visual angle in the middle of the picture.

    screen_angle: degrees the picture's height fills for the viewer; 0: as much as the camera sees.
    """
    half = math.tan(math.radians(0.5 * screen_angle)) if screen_angle else viewpoint.half_height
    return math.tan(math.radians(0.5 * degrees)) / half * picture_height


def packed(walkers: Sequence[DrawnWalker], dot: float, line: float) -> np.ndarray:
    """(N,) of LINE: all lines in the world; dot, line: pixels across."""
    parts = []
    for walker in walkers:
        if walker.lines is None:
            continue
        part = np.zeros(len(walker.lines), LINE)
        part["from"], part["to"] = walker.lines[:, 0] + walker.place, walker.lines[:, 1] + walker.place
        dots = np.all(walker.lines[:, 0] == walker.lines[:, 1], axis=1)
        part["width"] = np.where(dots, dot, line)
        parts.append(part)
    return np.concatenate(parts) if parts else np.zeros(0, LINE)

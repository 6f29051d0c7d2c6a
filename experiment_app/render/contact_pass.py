"""Darkens the ground where the walkers' bodies keep the sky's light away: strongest right under the soles."""

from __future__ import annotations

from collections.abc import Sequence

import moderngl
import numpy as np

from experiment_app.render.cameras import Viewpoint
from experiment_app.render.contact import TEXELS, fill_occluders
from experiment_app.render.drawn import DrawnWalker
from experiment_app.render.programs import build, set_if_used
from stimuli.skeleton import Floats

OCCLUDERS_UNIT = 1
LIFT = 0.0015  # m above the ground, so that the square is not hidden by the ground itself
EVERYWHERE = (0.0, 0.0, 1e9, 1e9)


class ContactPass:
    """One square per walker, multiplied onto the ground; texels: rows of occluders are so long."""

    def __init__(self, context: moderngl.Context, texels: int = TEXELS) -> None:
        self._context = context
        self._texels = texels
        self._program = build(context, "contact.vert", "contact.frag", {"OCCLUDERS": str(texels)})
        self._square = context.vertex_array(self._program, [])
        self._texture: moderngl.Texture | None = None
        self._rows = np.zeros((0, texels, 4), np.float32)
        self._make_room(8)

    def draw(
        self, walkers: Sequence[DrawnWalker], viewpoint: Viewpoint, area: tuple[float, float, float, float]
    ) -> None:
        """Multiplies into the bound framebuffer; area: centre x, z and half sizes x, z (m) of the ground."""
        if not walkers:
            return
        if len(walkers) > len(self._rows):
            self._make_room(1 << (len(walkers) - 1).bit_length())
        fill_occluders(self._rows, walkers)
        self.draw_rows(self._rows[: len(walkers)], viewpoint, area)

    def draw_rows(self, rows: Floats, viewpoint: Viewpoint, area: tuple[float, float, float, float]) -> None:
        """The same of occluders (N, texels, 4) float32, N > 0."""
        if len(rows) > len(self._rows):
            self._make_room(1 << (len(rows) - 1).bit_length())
        assert self._texture is not None
        self._texture.write(np.ascontiguousarray(rows), viewport=(0, 0, self._texels, len(rows)))
        self._texture.use(OCCLUDERS_UNIT)
        set_if_used(self._program, "occluders", OCCLUDERS_UNIT)
        set_if_used(self._program, "lift", LIFT)
        set_if_used(self._program, "area", area)
        self._program["world_to_clip"].write(viewpoint.matrix_bytes)
        self._context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        self._context.blend_func = moderngl.DST_COLOR, moderngl.ZERO
        self._context.fbo.depth_mask = False
        self._square.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=len(rows))
        self._context.fbo.depth_mask = True
        self._context.blend_func = moderngl.DEFAULT_BLENDING

    def release(self) -> None:
        """Frees the GPU's memory."""
        assert self._texture is not None
        for part in (self._texture, self._square, self._program):
            part.release()

    def _make_room(self, walkers: int) -> None:
        if self._texture is not None:
            self._texture.release()
        self._rows = np.zeros((walkers, self._texels, 4), np.float32)
        self._texture = self._context.texture((self._texels, walkers), 4, dtype="f4")
        self._texture.filter = (moderngl.NEAREST, moderngl.NEAREST)

"""Draws all walkers, skinned on the GPU: one instanced draw per body and level of detail."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import moderngl
import numpy as np

from experiment_app.render.body_buffers import BodyBuffers, BodyOnGpu
from experiment_app.render.cameras import Viewpoint, as_uniform
from experiment_app.render.drawn import DrawnWalker
from experiment_app.render.light import ON_WALKERS, Sunlight
from experiment_app.render.programs import build
from experiment_app.render.shadow_map import set_light
from stimuli.skeleton import JOINTS

POSES_UNIT = 0
TEXELS = 3 * len(JOINTS) + 1  # per walker: a 3x4 matrix per joint, then the place
LEVEL_HEIGHTS = (400.0, 120.0)  # pixels of stature below which a coarser level of detail is drawn


@dataclass(frozen=True, eq=False)
class Batch:
    """Walkers of one body and level, in consecutive rows of the poses texture."""

    body: BodyOnGpu
    first: int
    count: int


def level_of(stature_pixels: float, levels: int) -> int:
    """The level of detail for a walker this tall on the screen."""
    return min(sum(stature_pixels < height for height in LEVEL_HEIGHTS), levels - 1)


class WalkersPass:
    """The walkers of a frame: `place` once, then `draw_shadow` and `draw`."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._lit = build(context, "walker.vert", "walker.frag", ON_WALKERS)
        self._shadow = build(context, "walker_shadow.vert", "nothing.frag")
        self.bodies = BodyBuffers(context, self._lit, self._shadow)
        self._batches: list[Batch] = []
        self._texture: moderngl.Texture | None = None
        self._rows = np.zeros((0, TEXELS, 4), np.float32)
        self._make_room(8)

    def place(self, walkers: Sequence[DrawnWalker], viewpoint: Viewpoint, picture_height: int) -> None:
        """Uploads this frame's matrices and decides the levels of detail."""
        if len(walkers) > len(self._rows):
            self._make_room(1 << (len(walkers) - 1).bit_length())
        keyed = []
        for walker in walkers:
            level = level_of(
                viewpoint.pixels_per_metre(walker.place, picture_height) * walker.body.stature,
                len(walker.body.levels),
            )
            keyed.append((id(walker.body), level, walker))
        if len(keyed) > 1:
            order: dict[tuple[int, int], int] = {}
            for body, level, _ in keyed:
                order.setdefault((body, level), len(order))
            keyed.sort(key=lambda item: order[item[:2]])
        self._batches = []
        first = 0
        for row, (body, level, walker) in enumerate(keyed):
            self._rows[row, :-1] = walker.matrices.reshape(-1, 4)
            self._rows[row, -1, :3] = walker.place
            if row + 1 == len(keyed) or keyed[row + 1][:2] != (body, level):
                self._batches.append(Batch(self.bodies.get(walker.body, level), first, row + 1 - first))
                first = row + 1
        assert self._texture is not None
        self._texture.write(self._rows[: len(keyed)], viewport=(0, 0, TEXELS, len(keyed)))

    def draw_shadow(self, sunlight: Sunlight) -> None:
        """Draws the depth of all walkers into the bound shadow map."""
        self._use(self._shadow)
        self._shadow["world_to_shadow_clip"].write(as_uniform(sunlight.world_to_clip))
        for batch in self._batches:
            self._shadow["first_walker"].value = batch.first
            batch.body.shadow.render(moderngl.TRIANGLES, instances=batch.count)

    def draw(self, viewpoint: Viewpoint, sunlight: Sunlight) -> None:
        """Draws all walkers into the bound framebuffer; insides of clothes are left out."""
        self._context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        self._use(self._lit)
        self._lit["world_to_clip"].write(as_uniform(viewpoint.matrix))
        set_light(self._lit, sunlight, viewpoint.eye)
        for batch in self._batches:
            self._lit["first_walker"].value = batch.first
            self._lit["colours"].write(batch.body.colours)
            self._lit["finishes"].write(batch.body.finishes)
            batch.body.lit.render(moderngl.TRIANGLES, instances=batch.count)

    def release(self) -> None:
        """Frees the GPU's memory."""
        self.bodies.release()
        assert self._texture is not None
        for part in (self._texture, self._lit, self._shadow):
            part.release()

    def _use(self, program: moderngl.Program) -> None:
        assert self._texture is not None
        self._texture.use(POSES_UNIT)
        program["poses"].value = POSES_UNIT

    def _make_room(self, walkers: int) -> None:
        if self._texture is not None:
            self._texture.release()
        self._rows = np.zeros((walkers, TEXELS, 4), np.float32)
        self._texture = self._context.texture((TEXELS, walkers), 4, dtype="f4")
        self._texture.filter = (moderngl.NEAREST, moderngl.NEAREST)

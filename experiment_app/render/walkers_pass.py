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
from experiment_app.render.part_map import SHADER_CONSTANTS
from experiment_app.render.programs import build, set_if_used
from experiment_app.render.shadow_map import set_light
from stimuli.skeleton import JOINTS

POSES_UNIT, PICTURES_UNIT = 0, 6
ALPHA_TO_COVERAGE = 0x809E  # GL_SAMPLE_ALPHA_TO_COVERAGE: blended hair without sorting, as fine as there are samples
TEXELS = 3 * len(JOINTS) + 1  # per walker: a 3x4 matrix per joint, then the place
LEVEL_HEIGHTS = (400.0, 120.0)  # pixels of stature below which a coarser level of detail is drawn


@dataclass(frozen=True, eq=False)
class Batch:
    """Walkers of one body and level of detail, in consecutive rows of the poses texture."""

    body: BodyOnGpu
    first: int
    count: int
    level: int


def level_of(stature_pixels: float, levels: int) -> int:
    """The level of detail for a walker this tall on the screen."""
    return min(sum(stature_pixels < height for height in LEVEL_HEIGHTS), levels - 1)


class WalkersPass:
    """The walkers of a frame: `place` once, then `draw_shadow` and `draw`."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._lit = build(context, "walker.vert", "walker.frag", ON_WALKERS)
        self._shadow = build(context, "walker_shadow.vert", "nothing.frag")
        self._textured: moderngl.Program | None = None
        self._parts: moderngl.Program | None = None
        self.bodies = BodyBuffers(context, self._lit, self._shadow, self._textured_program)
        self.levels: tuple[int, ...] = ()
        self._batches: list[Batch] = []
        self._texture: moderngl.Texture | None = None
        self._rows = np.zeros((0, TEXELS, 4), np.float32)
        self._make_room(8)

    def place(
        self, walkers: Sequence[DrawnWalker], viewpoint: Viewpoint, picture_height: int, forced: int | None = None
    ) -> None:
        """Uploads this frame's matrices and decides the levels of detail, unless one is forced.

        `levels` tells what was chosen, walker by walker; -1 for one that has no body to draw.
        """
        if len(walkers) > len(self._rows):
            self._make_room(1 << (len(walkers) - 1).bit_length())
        keyed = []
        levels = []
        for number, walker in enumerate(walkers):
            if walker.lines is not None:
                levels.append(-1)
                continue
            if forced is None:
                level = level_of(
                    viewpoint.pixels_per_metre(walker.place, picture_height) * walker.body.stature,
                    len(walker.body.levels),
                )
            else:
                level = min(max(forced, 0), len(walker.body.levels) - 1)
            levels.append(level)
            keyed.append((id(walker.body), level, walker, number))
        self.levels = tuple(levels)
        if len(keyed) > 1:
            order: dict[tuple[int, int], int] = {}
            for body, level, *_ in keyed:
                order.setdefault((body, level), len(order))
            keyed.sort(key=lambda item: order[item[:2]])
        self._batches = []
        first = 0
        for row, (body, level, walker, number) in enumerate(keyed):
            self._rows[row, :-1] = walker.matrices.reshape(-1, 4)
            self._rows[row, -1] = (*walker.place, number)
            if row + 1 == len(keyed) or keyed[row + 1][:2] != (body, level):
                self._batches.append(Batch(self.bodies.get(walker.body, level), first, row + 1 - first, level))
                first = row + 1
        self.bodies.give_up(len(self._batches))
        assert self._texture is not None
        if keyed:
            self._texture.write(self._rows[: len(keyed)], viewport=(0, 0, TEXELS, len(keyed)))

    def draw_shadow(self, sunlight: Sunlight) -> None:
        """Draws the depth of all walkers into the bound shadow map."""
        self._use(self._shadow)
        self._shadow["world_to_shadow_clip"].write(as_uniform(sunlight.world_to_clip))
        for batch in self._batches:
            set_if_used(self._shadow, "first_walker", batch.first)
            if batch.body.pictures is not None:
                self._context.disable(moderngl.CULL_FACE)
            batch.body.shadow.render(moderngl.TRIANGLES, instances=batch.count)
            self._context.enable(moderngl.CULL_FACE)

    def draw(self, viewpoint: Viewpoint, sunlight: Sunlight) -> None:
        """Draws all walkers into the bound framebuffer; insides of clothes are left out."""
        self._context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        self._begin(self._lit, viewpoint, sunlight)
        pictured = [batch for batch in self._batches if batch.body.pictures is not None]
        for batch in self._batches:
            if batch.body.pictures is None:
                self._render(self._lit, batch)
        if pictured:
            program = self._textured_program()
            self._begin(program, viewpoint, sunlight)
            set_if_used(program, "pictures", PICTURES_UNIT)
            self._context.enable_only(moderngl.DEPTH_TEST)
            self._context.enable_direct(ALPHA_TO_COVERAGE)
            for batch in pictured:
                assert batch.body.pictures is not None
                batch.body.pictures.use(PICTURES_UNIT)
                set_if_used(program, "covers", batch.body.covers)
                self._render(program, batch)
            self._context.disable_direct(ALPHA_TO_COVERAGE)

    def draw_parts(self, viewpoint: Viewpoint) -> None:
        """Draws joint and walker of every pixel into the bound part map; the walkers are those placed last."""
        if self._parts is None:
            self._parts = build(self._context, "part_map.vert", "part_map.frag", SHADER_CONSTANTS)
        self._use(self._parts)
        set_if_used(self._parts, "world_to_clip", viewpoint.matrix_bytes)
        for batch in self._batches:
            set_if_used(self._parts, "first_walker", batch.first)
            array = batch.body.for_parts(self._context, self._parts)
            array.render(moderngl.TRIANGLES, instances=batch.count)

    def _begin(self, program: moderngl.Program, viewpoint: Viewpoint, sunlight: Sunlight) -> None:
        self._use(program)
        set_if_used(program, "world_to_clip", viewpoint.matrix_bytes)
        set_light(program, sunlight, viewpoint.eye)

    def _render(self, program: moderngl.Program, batch: Batch) -> None:
        set_if_used(program, "first_walker", batch.first)
        set_if_used(program, "colours", batch.body.colours)
        set_if_used(program, "finishes", batch.body.finishes)
        set_if_used(program, "close_up", 1.0 if batch.level < 2 else 0.0)
        batch.body.lit.render(moderngl.TRIANGLES, instances=batch.count)

    def _textured_program(self) -> moderngl.Program:
        """The program of bodies with pictures, built when the first is drawn."""
        if self._textured is None:
            self._textured = build(self._context, "walker.vert", "walker.frag", {**ON_WALKERS, "TEXTURED": "1"})
        return self._textured

    def release(self) -> None:
        """Frees the GPU's memory."""
        self.bodies.release()
        assert self._texture is not None
        for part in (self._texture, self._lit, self._shadow, self._textured, self._parts):
            if part is not None:
                part.release()

    def _use(self, program: moderngl.Program) -> None:
        assert self._texture is not None
        self._texture.use(POSES_UNIT)
        set_if_used(program, "poses", POSES_UNIT)

    def _make_room(self, walkers: int) -> None:
        if self._texture is not None:
            self._texture.release()
        self._rows = np.zeros((walkers, TEXELS, 4), np.float32)
        self._texture = self._context.texture((TEXELS, walkers), 4, dtype="f4")
        self._texture.filter = (moderngl.NEAREST, moderngl.NEAREST)

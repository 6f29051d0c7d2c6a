"""The picture being drawn: linear light, multisampled, then resolved and encoded to sRGB on the target."""

from __future__ import annotations

import moderngl

from experiment_app.render.programs import build


class Picture:
    """A multisampled half-float framebuffer and what brings it to a screen.

    samples: as given, brought down to what the driver has; 1 means no multisampling.
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int], samples: int) -> None:
        self._context = context
        self.samples = max(1, min(samples, context.max_samples))
        self._program = build(context, "full_screen.vert", "encode.frag")
        self._triangle = context.vertex_array(self._program, [])
        self.size = (0, 0)
        self._parts: list[moderngl.Framebuffer | moderngl.Texture | moderngl.Renderbuffer] = []
        self.resize(size)

    def resize(self, size: tuple[int, int]) -> None:
        """Allocates for a new size (pixels); does nothing when it is the present one."""
        if size == self.size:
            return
        self._free()
        self.size = size
        self._resolved = self._context.texture(size, 4, dtype="f2")
        self._resolved.filter = (moderngl.NEAREST, moderngl.NEAREST)
        samples = self.samples if self.samples > 1 else 0
        depth = self._context.depth_renderbuffer(size, samples=samples)
        if samples:
            colour = self._context.renderbuffer(size, 4, samples=samples, dtype="f2")
            self._drawn = self._context.framebuffer([colour], depth)
            self._single = self._context.framebuffer([self._resolved])
            self._parts = [self._drawn, self._single, colour, depth, self._resolved]
        else:
            self._drawn = self._single = self._context.framebuffer([self._resolved], depth)
            self._parts = [self._drawn, depth, self._resolved]

    def begin(self) -> None:
        """Makes the linear framebuffer the one drawn into; every pixel must then be covered."""
        self._drawn.use()
        self._drawn.viewport = (0, 0, *self.size)
        self._drawn.clear()

    def keep_depth(self, kept: bool) -> None:
        """Whether drawing leaves the depths as they are."""
        self._drawn.depth_mask = not kept

    def show(self, target: moderngl.Framebuffer, corner: tuple[int, int] = (0, 0)) -> None:
        """Resolves the samples in linear light and writes sRGB codes into the target, left bound.

        corner: the pixel of the target, from its lower left, where the picture's lower left goes.
        """
        if self._drawn is not self._single:
            self._context.copy_framebuffer(self._single, self._drawn)
        target.use()
        target.viewport = (*corner, *self.size)
        self._context.enable_only(moderngl.NOTHING)
        self._resolved.use(0)
        self._program["corner"].value = corner
        self._program["linear_picture"].value = 0
        self._triangle.render(moderngl.TRIANGLES, vertices=3)

    def release(self) -> None:
        """Frees the GPU's memory."""
        self._free()
        self._triangle.release()
        self._program.release()

    def _free(self) -> None:
        for part in self._parts:
            part.release()
        self._parts = []

"""The picture being drawn: linear light, multisampled, then resolved and encoded to sRGB on the target."""

from __future__ import annotations

import moderngl

from experiment_app.render.programs import build


def most_samples(context: moderngl.Context, wanted: int) -> int:
    """The most samples per pixel, at most so many, with which the driver makes a half-float framebuffer; 1 is none.

    What a driver reports holds for its best format; others may have fewer, so each number is tried.
    """
    for samples in range(min(wanted, context.max_samples), 1, -1):
        parts: list[moderngl.Renderbuffer | moderngl.Framebuffer] = []
        try:
            parts.append(context.renderbuffer((4, 4), 4, samples=samples, dtype="f2"))
            parts.append(context.depth_renderbuffer((4, 4), samples=samples))
            parts.append(context.framebuffer(parts[:1], parts[1]))
            return samples
        except moderngl.Error:
            continue
        finally:
            for part in reversed(parts):
                part.release()
    return 1


class Picture:
    """A multisampled half-float framebuffer and what brings it to a screen.

    samples: as given, brought down to what the driver has; 1 means no multisampling.
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int], samples: int) -> None:
        self._context = context
        self.samples = most_samples(context, samples)
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

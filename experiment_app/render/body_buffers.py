"""Bodies in the GPU's memory: each level of detail of each body is uploaded once, when first drawn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import moderngl
import numpy as np
from numpy.typing import NDArray

from experiment_app.render.pictures import covers, has_pictures, layers
from stimuli.bodies.body import Body, Surface

VERTEX = np.dtype(
    [
        ("position", "3f4"),
        ("material", "f4"),
        ("normal", "3f4"),
        ("occlusion", "f4"),
        ("weights", "4f4"),
        ("joints", "4u1"),
    ]
)
LIT_FORMAT = "4f4 4f4 4f4 4u1"
LIT_NAMES = ("position_material", "normal_sky", "weights", "joints")
SHADOW_FORMAT = "4f4 16x 4f4 4u1"
SHADOW_NAMES = ("position_material", "weights", "joints")

MOST_MATERIALS = 24  # as in walker.frag.glsl
MOST_KEPT = 48  # levels of bodies kept on the GPU, about 1 MB each

KNITTED, WOVEN, SKIN, HAIR = 1.0, 2.0, 3.0, 4.0  # fabrics of fabric.glsl
TIED_HAIR = 5.0  # and the height of the knot (m)

FINISHES: dict[str, tuple[float, float, float, float]] = {
    "skin": (1.0, 0.10, 0.75, SKIN),
    "lip": (0.8, 0.05, 1.0, 0.0),
    "eye": (0.0, 0.0, 1.0, 0.0),
    "iris": (0.0, 0.0, 1.0, 0.0),
    "pupil": (0.0, 0.0, 1.0, 0.0),
    "hair": (0.0, 0.22, 0.3, HAIR),
    "brow": (0.0, 0.0, 0.2, 0.0),
    "lash": (0.0, 0.0, 0.0, 0.0),
    "shirt": (0.0, 0.16, 0.15, KNITTED),
    "trousers": (0.0, 0.16, 0.15, WOVEN),
    "shoes": (0.0, 0.05, 0.8, 0.0),
    "soles": (0.0, 0.0, 0.3, 0.0),
}
"""Material name -> how much it is skin, fuzz that lights up at grazing angles, strength of its highlight, fabric."""

CLOTH = (0.0, 0.16, 0.15, 0.0)


@dataclass(frozen=True, eq=False)
class BodyOnGpu:
    """One level of detail of one body.

    lit, shadow: vertex arrays for the passes; parts: for the part map, made when first asked for.
    colours, finishes: bytes of the shader's material arrays.
    pictures, covers: what a body with pictures wears, else None and empty.
    """

    body: Body
    lit: moderngl.VertexArray
    shadow: moderngl.VertexArray
    parts: list[moderngl.VertexArray]
    buffers: tuple[moderngl.Buffer, ...]
    colours: bytes
    finishes: bytes
    pictures: moderngl.TextureArray | None = None
    covers: bytes = b""

    def release(self) -> None:
        """Frees the GPU's memory."""
        for thing in (self.lit, self.shadow, *self.parts, *self.buffers, self.pictures):
            if thing is not None:
                thing.release()

    def for_parts(self, context: moderngl.Context, program: moderngl.Program) -> moderngl.VertexArray:
        """The vertex array of the part map's pass."""
        if not self.parts:
            self.parts.append(
                context.vertex_array(program, [(self.buffers[0], SHADOW_FORMAT, *SHADOW_NAMES)], self.buffers[1])
            )
        return self.parts[0]


def packed(
    surfaces: tuple[Surface, ...], numbers: Sequence[int] | None = None
) -> tuple[NDArray[np.void], NDArray[np.uint32]]:
    """Vertices (V,) of VERTEX and triangles (T, 3) uint32 of all surfaces together.

    numbers: material of each surface; their order if left out.
    """
    vertices = np.zeros(sum(len(s.positions) for s in surfaces), VERTEX)
    triangles = []
    first = 0
    for material, surface in zip(numbers or range(len(surfaces)), surfaces, strict=True):
        part = vertices[first : first + len(surface.positions)]
        part["position"] = surface.positions
        part["normal"] = surface.normals
        part["weights"] = surface.weights
        part["occlusion"] = surface.occlusion
        part["joints"] = surface.joints
        part["material"] = material if surface.blush is None else material + surface.blush
        triangles.append(np.asarray(surface.triangles, np.uint32) + np.uint32(first))
        first += len(surface.positions)
    return vertices, np.concatenate(triangles)


def picture_places(surfaces: tuple[Surface, ...]) -> NDArray[np.float32]:
    """(V, 2) places in the pictures, of all surfaces together; zero without a picture."""
    parts = [s.picture_at if s.picture_at is not None else np.zeros((len(s.positions), 2)) for s in surfaces]
    return np.concatenate(parts).astype(np.float32)


def materials(surfaces: tuple[Surface, ...]) -> tuple[bytes, bytes]:
    """Colours (24, 4: linear rgb, roughness) and finishes (24, 4) as float32 bytes."""
    if len(surfaces) > MOST_MATERIALS:
        raise ValueError(f"a body has {len(surfaces)} materials; at most {MOST_MATERIALS} can be drawn")
    colours = np.zeros((MOST_MATERIALS, 4), np.float32)
    for row, surface in enumerate(surfaces):
        colours[row] = (*surface.colour, surface.roughness)
    return colours.tobytes(), finishes_of([s.name for s in surfaces], [s.knot for s in surfaces])


def finishes_of(names: Sequence[str], knots: Sequence[float | None] = ()) -> bytes:
    """Finishes (24, 4) of materials with these names as float32 bytes; `knots` as in `Surface`."""
    finishes = np.zeros((MOST_MATERIALS, 4), np.float32)
    for row, name in enumerate(names):
        finishes[row] = FINISHES.get(name, CLOTH)
    for row, knot in enumerate(knots):
        if knot is not None:
            finishes[row, 3] = TIED_HAIR + knot
    return finishes.tobytes()


class BodyBuffers:
    """Every body level that was drawn, until it is given up."""

    def __init__(
        self,
        context: moderngl.Context,
        lit_program: moderngl.Program,
        shadow_program: moderngl.Program,
        textured_program: Callable[[], moderngl.Program],
    ) -> None:
        self._context = context
        self._lit, self._shadow, self._textured = lit_program, shadow_program, textured_program
        self._kept: dict[tuple[int, int], BodyOnGpu] = {}
        self.uploads = 0

    def get(self, body: Body, level: int) -> BodyOnGpu:
        """The level of the body, uploaded now if it is not there yet."""
        key = (id(body), level)  # the body is kept in the value, so its id is not given to another one
        found = self._kept.pop(key, None)
        if found is None:
            found = self._upload(body, level)
        self._kept[key] = found
        return found

    def give_up(self, needed: int) -> None:
        """Frees the least recently drawn beyond MOST_KEPT, but none of the last `needed`: a picture may show more."""
        while len(self._kept) > max(MOST_KEPT, needed):
            self._kept.pop(next(iter(self._kept))).release()

    def release(self) -> None:
        """Frees the GPU's memory."""
        for kept in self._kept.values():
            kept.release()
        self._kept.clear()

    def _upload(self, body: Body, level: int) -> BodyOnGpu:
        self.uploads += 1
        surfaces = body.levels[level]
        vertices, triangles = packed(surfaces)
        vertex_buffer = self._context.buffer(vertices.tobytes())
        index_buffer = self._context.buffer(triangles.tobytes())
        layout: list[tuple[object, ...]] = [(vertex_buffer, LIT_FORMAT, *LIT_NAMES)]
        buffers = [vertex_buffer, index_buffer]
        program, pictures, cover = self._lit, None, b""
        if has_pictures(surfaces):
            program = self._textured()
            pictures, numbers = layers(self._context, surfaces)
            cover = covers(surfaces, numbers, MOST_MATERIALS)
            buffers.append(self._context.buffer(picture_places(surfaces).tobytes()))
            layout.append((buffers[2], "2f4", "picture_at"))
        lit = self._context.vertex_array(program, layout, index_buffer)
        shadow = self._context.vertex_array(self._shadow, [(vertex_buffer, SHADOW_FORMAT, *SHADOW_NAMES)], index_buffer)
        return BodyOnGpu(body, lit, shadow, [], tuple(buffers), *materials(surfaces), pictures, cover)

"""Draws crowds: all bodies and levels of detail in one buffer, all poses in one texture, one draw per level."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable

import moderngl
import numpy as np

from experiment_app.render.body_buffers import LIT_FORMAT, LIT_NAMES, SHADOW_FORMAT, SHADOW_NAMES, finishes_of, packed
from experiment_app.render.cameras import Viewpoint, as_uniform
from experiment_app.render.crowd_levels import (
    FAR_LEVEL,
    Batch,
    Instances,
    distances,
    heights_on_screen,
    seen_instances,
    shadow_instances,
    within_picture,
)
from experiment_app.render.crowd_light import may_shade
from experiment_app.render.drawn import PLACE, ROW_TEXELS, CrowdLook, DrawnCrowd
from experiment_app.render.light import ON_CROWDS, Sunlight
from experiment_app.render.part_map import SHADER_CONSTANTS
from experiment_app.render.programs import build, set_if_used
from experiment_app.render.shadow_map import set_light

POSES_UNIT, PALETTE_UNIT = 0, 8
INSTANCE_BYTES = 16
CROWD = {**ON_CROWDS, "CROWD": "1"}
FAR = {**CROWD, "SHADOW_TAPS": "1"}
HAZE, FADED = {"OPEN_GROUND": "1", "HAZE": "1"}, {"FADED": "1"}


class CrowdPass:
    """The crowd of a frame: `place` once, then `draw_shadow` and `draw`; outdoors, haze lies between it and the eye."""

    def __init__(self, context: moderngl.Context, outdoors: bool) -> None:
        self._context = context
        self._air = HAZE if outdoors else {}
        self._lit: dict[tuple[bool, bool, int], moderngl.Program] = {}  # by far, faded, carriers
        self._shadow: dict[int, moderngl.Program] = {}  # by carriers
        self._parts = build(context, "part_map.vert", "part_map.frag", {**SHADER_CONSTANTS, **CROWD})
        self._meshes: CrowdMeshes | None = None
        self._poses = _table(context, ROW_TEXELS, 1)
        self._tables = [context.buffer(reserve=INSTANCE_BYTES, dynamic=True) for _ in range(2)]
        self._seen = self._casting = Instances(np.zeros((0, 4), np.float32), ())

    def place(self, crowd: DrawnCrowd, viewpoint: Viewpoint, picture_height: int, forced: int | None = None) -> None:
        """Uploads this frame's transforms and decides the levels of detail, unless one is forced."""
        cast = crowd.cast
        if self._meshes is None or not self._meshes.wear(cast):
            if self._meshes is not None:
                self._meshes.release()
            self._meshes = CrowdMeshes(self._context, cast)
            self._build(self._meshes.carriers)
        levels = self._meshes.levels
        places = crowd.rows[:, PLACE, :3]
        distance = distances(viewpoint, places)
        heights = heights_on_screen(viewpoint, distance, cast.statures, picture_height)
        seen = within_picture(viewpoint, places, 0.7 * cast.statures)
        self._seen = seen_instances(np.where(seen, heights, 0.0), crowd.shown, cast.body, cast.look, levels, forced)
        casting = (crowd.shown > 0.5) & may_shade(viewpoint, places, cast.statures)
        self._casting = shadow_instances(heights, casting, cast.body, levels)
        self._poses = _written(self._context, self._poses, crowd.rows)
        for number, instances in enumerate((self._seen, self._casting)):
            _fill(self._tables[number], instances.table)

    def draw_shadow(self, sunlight: Sunlight) -> None:
        """Draws the depth of everybody into the bound shadow map."""
        kinds: dict[int, list[Batch]] = defaultdict(list)
        for batch in self._casting.batches:
            kinds[self._carriers(batch)].append(batch)
        for carriers, batches in kinds.items():
            program = self._shadow[carriers]
            program["world_to_shadow_clip"].write(as_uniform(sunlight.world_to_clip))
            self._render(program, 1, batches)

    def draw(self, viewpoint: Viewpoint, sunlight: Sunlight) -> None:
        """Draws everybody into the bound framebuffer."""
        assert self._meshes is not None
        self._context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        self._meshes.palette.use(PALETTE_UNIT)
        kinds: dict[tuple[bool, bool, int], list[Batch]] = defaultdict(list)
        for batch in self._seen.batches:
            kinds[batch.far, batch.faded, self._carriers(batch)].append(batch)
        for kind, batches in kinds.items():
            program = self._lit[kind]
            set_if_used(program, "world_to_clip", viewpoint.matrix_bytes)
            set_if_used(program, "palette", PALETTE_UNIT)
            set_if_used(program, "finishes", self._meshes.finishes)
            set_light(program, sunlight, viewpoint.eye)
            self._render(program, 0, batches)

    def draw_parts(self, viewpoint: Viewpoint) -> None:
        """Draws joint and walker of every pixel into the bound part map."""
        set_if_used(self._parts, "world_to_clip", viewpoint.matrix_bytes)
        self._render(self._parts, 0, self._seen.batches)

    def _build(self, carriers: list[list[int]]) -> None:
        """Programs for vertices with so many joints: none asks which of them carry. carriers: per body and level."""
        for level, count in {(level, count) for body in carriers for level, count in enumerate(body)}:
            joints = {"INFLUENCES": str(count)}
            if count not in self._shadow:
                self._shadow[count] = build(self._context, "walker_shadow.vert", "nothing.frag", {**FAR, **joints})
            for far in (level >= FAR_LEVEL - 1, level >= FAR_LEVEL):
                for faded in (False, True):
                    if (far, faded, count) not in self._lit:
                        files = ("crowd_far.vert", "crowd_far.frag") if far else ("walker.vert", "walker.frag")
                        constants = {**(FAR if far else CROWD), **self._air, **(FADED if faded else {}), **joints}
                        self._lit[far, faded, count] = build(self._context, *files, constants)

    def _carriers(self, batch: Batch) -> int:
        assert self._meshes is not None
        return self._meshes.carriers[batch.body][batch.level]

    def _render(self, program: moderngl.Program, table: int, batches: Iterable[Batch]) -> None:
        """Draws batches of the instances in a table: 0 the seen, 1 the casting."""
        assert self._meshes is not None
        self._poses.use(POSES_UNIT)
        set_if_used(program, "poses", POSES_UNIT)
        array = self._meshes.array(program, bare=program is self._parts or table == 1)
        location = program["instance"].location
        for batch in batches:
            first, count = self._meshes.parts[batch.body][batch.level]
            start = batch.first * INSTANCE_BYTES
            array.bind(location, "f", self._tables[table], "4f", start, INSTANCE_BYTES, divisor=1)
            array.render(moderngl.TRIANGLES, vertices=count, first=first, instances=batch.count)

    def release(self) -> None:
        """Frees the GPU's memory."""
        programs = (*self._lit.values(), *self._shadow.values(), self._parts)
        for part in (self._meshes, self._poses, *self._tables, *programs):
            if part is not None:
                part.release()


class CrowdMeshes:
    """Every level of every body of a crowd in one buffer, and the looks.

    parts: per body and level, first index and count of indices; carriers: most joints that one of its vertices has
    """

    def __init__(self, context: moderngl.Context, cast: CrowdLook) -> None:
        self._context = context
        self._cast = cast
        numbers = {name: number for number, name in enumerate(cast.materials)}
        self.parts: list[list[tuple[int, int]]] = []
        self.carriers: list[list[int]] = []
        vertices, indices = [], []
        first_vertex = first_index = 0
        for body in cast.bodies:
            self.parts.append([])
            self.carriers.append([])
            for surfaces in body.levels:
                own, triangles = packed(surfaces, [numbers[surface.name] for surface in surfaces])
                _heaviest_first(own)
                vertices.append(own)
                indices.append(triangles.ravel() + np.uint32(first_vertex))
                self.parts[-1].append((first_index, triangles.size))
                self.carriers[-1].append(int(np.count_nonzero(own["weights"], axis=1).max()))
                first_vertex += len(own)
                first_index += triangles.size
        self.levels = min(len(body.levels) for body in cast.bodies)
        self._vertices = context.buffer(np.concatenate(vertices).tobytes())
        self._indices = context.buffer(np.concatenate(indices).tobytes())
        self._arrays: dict[moderngl.Program, moderngl.VertexArray] = {}
        self.palette = _table(context, *cast.colours.shape[1::-1])
        self.palette.write(np.ascontiguousarray(cast.colours, np.float32))
        self.finishes = finishes_of(cast.materials)

    def wear(self, cast: CrowdLook) -> bool:
        """Puts on the looks of a crowd, and says whether it has these bodies; two beside each other take turns."""
        if cast is self._cast:
            return True
        same = cast.bodies == self._cast.bodies and cast.materials == self._cast.materials
        if not same or cast.colours.shape != self._cast.colours.shape:
            return False
        self.palette.write(np.ascontiguousarray(cast.colours, np.float32))
        self._cast = cast
        return True

    def array(self, program: moderngl.Program, bare: bool) -> moderngl.VertexArray:
        """The meshes as a program takes them; bare: it needs places only."""
        if program not in self._arrays:
            wanted = (SHADOW_FORMAT, *SHADOW_NAMES) if bare else (LIT_FORMAT, *LIT_NAMES)
            self._arrays[program] = self._context.vertex_array(program, [(self._vertices, *wanted)], self._indices)
        return self._arrays[program]

    def release(self) -> None:
        """Frees the GPU's memory."""
        for part in (*self._arrays.values(), self._vertices, self._indices, self.palette):
            part.release()


def _heaviest_first(vertices: np.ndarray) -> None:
    """Orders each vertex's joints by weight, so that those beyond a level's carriers carry nothing."""
    order = np.argsort(-vertices["weights"], axis=1, kind="stable")
    for name in ("weights", "joints"):
        vertices[name] = np.take_along_axis(vertices[name], order, axis=1)


def _table(context: moderngl.Context, columns: int, rows: int) -> moderngl.Texture:
    texture = context.texture((columns, rows), 4, dtype="f4")
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    return texture


def _fill(buffer: moderngl.Buffer, data: np.ndarray) -> None:
    """Gives the buffer new contents, and as much room as they need."""
    buffer.orphan(max(data.nbytes, buffer.size))
    if data.nbytes:
        buffer.write(data)


def _written(context: moderngl.Context, texture: moderngl.Texture, data: np.ndarray) -> moderngl.Texture:
    """The texture, or a larger one in its place, with data (rows, columns, 4) float32 in its corner."""
    rows, columns = data.shape[:2]
    if columns > texture.width or rows > texture.height:
        texture.release()
        texture = _table(context, max(columns, texture.width), max(rows, texture.height))
    if columns and rows:
        texture.write(data, viewport=(0, 0, columns, rows))
    return texture

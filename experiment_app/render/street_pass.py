"""Draws the street's kerbs, pavements and houses on both sides, as far as the haze lets one see."""

from __future__ import annotations

import math
from collections.abc import Mapping

import moderngl

from experiment_app.render.cameras import Viewpoint
from experiment_app.render.ground_pass import OUTDOORS
from experiment_app.render.light import CONSTANTS, Sunlight
from experiment_app.render.programs import build, set_if_used
from experiment_app.render.shadow_map import set_light
from experiment_app.render.street_model import HOUSES_AT, STRETCH, street_side

STRETCHES = 5  # drawn, the eye in the middle one; the haze has swallowed what is two stretches away


class StreetPass:
    """One side of one stretch, uploaded once."""

    def __init__(self, context: moderngl.Context, shadows: Mapping[str, str] = CONSTANTS) -> None:
        self._context = context
        self._program = build(context, "street.vert", "street.frag", {**OUTDOORS, **shadows})
        self._buffer = context.buffer(street_side().tobytes())
        self._array = context.vertex_array(
            self._program, [(self._buffer, "3f4 3f4 4f4 4f4", "position", "normal", "paint", "wall")]
        )

    def draw(self, viewpoint: Viewpoint, sunlight: Sunlight) -> None:
        """Draws into the bound framebuffer. A row of houses that the eye stands behind or in is left out."""
        self._context.enable_only(moderngl.DEPTH_TEST)
        set_light(self._program, sunlight, viewpoint.eye)
        set_if_used(self._program, "world_to_clip", viewpoint.matrix_bytes)
        first = (math.floor(float(viewpoint.eye[2]) / STRETCH) - STRETCHES // 2) * STRETCH
        set_if_used(self._program, "first_z", first)
        set_if_used(self._program, "stretch", STRETCH)
        for side in (1.0, -1.0):
            if side * float(viewpoint.eye[0]) < HOUSES_AT - 0.2:
                set_if_used(self._program, "side", side)
                self._array.render(moderngl.TRIANGLES, instances=STRETCHES)

    def release(self) -> None:
        """Frees the GPU's memory."""
        for part in (self._array, self._buffer, self._program):
            part.release()

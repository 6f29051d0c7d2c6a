"""Open ground: paving that shows travel, melting into a hazy sky. And the floor and wall round a treadmill."""

from __future__ import annotations

from collections.abc import Mapping

import moderngl

from experiment_app.render.cameras import Viewpoint, as_uniform
from experiment_app.render.light import CONSTANTS, Sunlight
from experiment_app.render.programs import build, set_if_used
from experiment_app.render.shadow_map import set_light

OUTDOORS = {**CONSTANTS, "OPEN_GROUND": "1"}


class GroundPass:
    """A floor as far as the eye reaches and what stands behind it.

    floor:       the fragment shader of the floor, "open_ground.frag" or "studio_floor.frag".
    half_street: m from the middle to the gutters of a street along z, None for open ground.
    shadows:     what the shaders' shadow code is compiled with, see light.CONSTANTS.
    """

    def __init__(
        self,
        context: moderngl.Context,
        floor: str,
        half_street: float | None = None,
        shadows: Mapping[str, str] = CONSTANTS,
    ) -> None:
        self._context = context
        constants = {**OUTDOORS, **shadows} if floor == "open_ground.frag" else dict(shadows)
        if half_street is not None:
            constants = {**constants, "HALF_STREET": f"{half_street:.3f}"}
        self._floor = build(context, "ground.vert", floor, constants)
        self._sky = build(context, "full_screen.vert", "sky.frag", constants)
        self._square = context.vertex_array(self._floor, [])
        self._screen = context.vertex_array(self._sky, [])

    def draw_floor(
        self,
        viewpoint: Viewpoint,
        sunlight: Sunlight,
        height: float = 0.0,
        machine: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
    ) -> None:
        """Height: y of the floor, m; machine: centre x, z and half sizes x, z (m) of what stands on it."""
        self._context.enable_only(moderngl.DEPTH_TEST)
        self._floor["world_to_clip"].write(viewpoint.matrix_bytes)
        set_if_used(self._floor, "eye_position", tuple(viewpoint.eye))
        set_if_used(self._floor, "ground_height", height)
        set_if_used(self._floor, "machine", machine)
        set_light(self._floor, sunlight, viewpoint.eye)
        self._square.render(moderngl.TRIANGLE_STRIP, vertices=4)

    def draw_background(self, viewpoint: Viewpoint, sunlight: Sunlight) -> None:
        """Fills what nothing has covered; last, so that covered pixels cost nothing."""
        self._context.enable_only(moderngl.DEPTH_TEST)
        self._context.depth_func = "<="
        set_if_used(self._sky, "clip_to_world", as_uniform(viewpoint.inverse))
        set_light(self._sky, sunlight, viewpoint.eye)
        self._screen.render(moderngl.TRIANGLES, vertices=3)
        self._context.depth_func = "<"

    def release(self) -> None:
        """Frees the GPU's memory."""
        for part in (self._square, self._screen, self._floor, self._sky):
            part.release()

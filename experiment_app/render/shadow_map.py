"""The depth of the first thing the sun meets, seen from the sun. What casts the shadow draws itself into it."""

from __future__ import annotations

import moderngl

from experiment_app.render.light import Sunlight
from experiment_app.render.programs import set_if_used
from stimuli.skeleton import Floats

SIZE = (1024, 1024)  # texels; about 2 mm each when fitted to one walker
MAP_UNIT, DEPTH_UNIT = 4, 5


class ShadowMap:
    """A depth texture, read twice: compared (soft edge) and as it is (how far away the caster is)."""

    def __init__(self, context: moderngl.Context, size: tuple[int, int] = SIZE) -> None:
        self._context = context
        self._size = size
        self._depth = context.depth_texture(size)
        self._depth.repeat_x = self._depth.repeat_y = False
        self._frame = context.framebuffer(depth_attachment=self._depth)
        self._compared = context.sampler(
            filter=(moderngl.LINEAR, moderngl.LINEAR), compare_func="<=", repeat_x=False, repeat_y=False
        )
        self._plain = context.sampler(
            filter=(moderngl.NEAREST, moderngl.NEAREST), compare_func="", repeat_x=False, repeat_y=False
        )

    def begin(self) -> None:
        """Makes the map the framebuffer drawn into, and empties it."""
        self._frame.use()
        self._frame.viewport = (0, 0, *self._size)
        self._frame.clear(depth=1.0)
        self._context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)

    def bind(self) -> None:
        """Puts the map where the shaders look for it."""
        for unit, sampler in ((MAP_UNIT, self._compared), (DEPTH_UNIT, self._plain)):
            self._depth.use(unit)
            sampler.use(unit)

    def unbind(self) -> None:
        """Leaves the texture units as other painters expect them."""
        self._compared.clear(MAP_UNIT)
        self._plain.clear(DEPTH_UNIT)

    def release(self) -> None:
        """Frees the GPU's memory."""
        for part in (self._frame, self._depth, self._compared, self._plain):
            part.release()


def set_light(program: moderngl.Program, sunlight: Sunlight, eye: Floats) -> None:
    """The uniforms of common.glsl."""
    set_if_used(program, "sun_colour", sunlight.lights.sun)
    set_if_used(program, "sky_colour", sunlight.lights.sky)
    set_if_used(program, "bounce_colour", sunlight.lights.bounce)
    set_if_used(program, "eye", tuple(eye.tolist()))
    set_if_used(program, "to_sun", tuple(sunlight.to_sun.tolist()))
    set_if_used(program, "world_to_light", sunlight.map_bytes)
    set_if_used(program, "light_extent", tuple(sunlight.extent.tolist()))
    set_if_used(program, "shadow_map", MAP_UNIT)
    set_if_used(program, "shadow_depth", DEPTH_UNIT)

"""Draws the treadmill under the walkers; its belt runs backwards as far as the walker has walked."""

from __future__ import annotations

import moderngl
import numpy as np

from experiment_app.render.cameras import Viewpoint, as_uniform
from experiment_app.render.light import CONSTANTS, Sunlight
from experiment_app.render.programs import build
from experiment_app.render.shadow_map import set_light
from experiment_app.render.treadmill_model import (
    BACK,
    BELT_LENGTH,
    BELT_WIDTH,
    FLOOR,
    FRONT,
    HALF_WIDTH,
    treadmill,
)
from stimuli.skeleton import Floats

PATTERN = 2.4  # m after which the belt's marks repeat, as in treadmill.frag.glsl
LONGEST = 1000 * PATTERN  # m after which the belt's travel starts again, so that float32 stays exact to 0.2 mm


class TreadmillPass:
    """One treadmill, uploaded once."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._lit = build(context, "treadmill.vert", "treadmill.frag", CONSTANTS)
        self._shadow = build(context, "treadmill_shadow.vert", "nothing.frag")
        self._buffer = context.buffer(treadmill().tobytes())
        self._lit_array = context.vertex_array(
            self._lit, [(self._buffer, "3f4 3f4 4f4 2f4", "position", "normal", "paint", "belt")]
        )
        self._shadow_array = context.vertex_array(self._shadow, [(self._buffer, "3f4 36x", "position")])

    def draw_shadow(self, sunlight: Sunlight, place: tuple[float, float, float]) -> None:
        """Draws its depth into the bound shadow map; place: (x, y, z) m of the belt's middle."""
        self._shadow["world_to_shadow_clip"].write(as_uniform(sunlight.world_to_clip))
        self._shadow["machine_place"].value = place
        self._shadow_array.render(moderngl.TRIANGLES)

    def draw(self, viewpoint: Viewpoint, sunlight: Sunlight, place: tuple[float, float, float], travel: float) -> None:
        """Draws it into the bound framebuffer; travel: m the belt has run."""
        self._context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        self._lit["world_to_clip"].write(viewpoint.matrix_bytes)
        self._lit["machine_place"].value = place
        self._lit["belt_travel"].value = travel % LONGEST
        set_light(self._lit, sunlight, viewpoint.eye)
        self._lit_array.render(moderngl.TRIANGLES)

    def release(self) -> None:
        """Frees the GPU's memory."""
        for part in (self._lit_array, self._shadow_array, self._buffer, self._lit, self._shadow):
            part.release()


def corners(place: tuple[float, float, float]) -> Floats:
    """(8, 3) m: the box round the machine, for the shadow map."""
    box = [(x, y, z) for x in (-HALF_WIDTH, HALF_WIDTH) for y in (FLOOR, 0.06) for z in (BACK, FRONT)]
    return np.array(box) + place


def footprint(place: tuple[float, float, float]) -> tuple[float, float, float, float]:
    """Centre x, z and half sizes x, z (m) of the machine on the floor."""
    return place[0], place[2] + 0.5 * (FRONT + BACK), HALF_WIDTH, 0.5 * (FRONT - BACK)


def walked_surface(place: tuple[float, float, float]) -> tuple[float, float, float, float]:
    """Centre x, z and half sizes x, z (m) of the belt's flat upper side."""
    return place[0], place[2], 0.5 * BELT_WIDTH, 0.5 * BELT_LENGTH - 0.05

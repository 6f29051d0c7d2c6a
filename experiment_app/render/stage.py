"""The order in which a scene with walkers is drawn: shadows, walkers, ground, contact, background."""

from __future__ import annotations

from collections.abc import Sequence

import moderngl
import numpy as np

from experiment_app.render.cameras import place_camera
from experiment_app.render.contact_pass import EVERYWHERE, ContactPass
from experiment_app.render.drawn import DrawnWalker
from experiment_app.render.ground_pass import GroundPass
from experiment_app.render.light import fit_sunlight
from experiment_app.render.shadow_map import ShadowMap
from experiment_app.render.treadmill_model import FLOOR
from experiment_app.render.treadmill_pass import TreadmillPass, corners, footprint, walked_surface
from experiment_app.render.walkers_pass import WalkersPass
from experiment_app.scene import Scene

NOTHING = np.zeros((0, 3))


class Stage:
    """Draws walkers on open ground or on a treadmill. Neither ground is built before it is first seen."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._shadows = ShadowMap(context)
        self._walkers = WalkersPass(context)
        self._contact = ContactPass(context)
        self._outdoors: GroundPass | None = None
        self._indoors: tuple[GroundPass, TreadmillPass] | None = None

    @property
    def uploads(self) -> int:
        """How many body levels were uploaded to the GPU so far."""
        return self._walkers.bodies.uploads

    def draw(self, scene: Scene, drawn: Sequence[DrawnWalker], size: tuple[int, int]) -> None:
        """Draws into the bound framebuffer of a size (pixels), in linear light, seen from the first walker's camera."""
        picture = self._context.fbo
        width, height = size
        first = drawn[0]
        viewpoint = place_camera(scene.camera, width / height, first.body.stature, first.place)
        on_treadmill = scene.ground == "treadmill"
        machine = _middle(scene)
        casters = corners(machine) if on_treadmill else NOTHING
        sunlight = fit_sunlight(scene.ground, viewpoint.azimuth, drawn, casters)
        self._walkers.place(drawn, viewpoint, height)

        self._shadows.begin()
        self._walkers.draw_shadow(sunlight)
        if on_treadmill:
            self._treadmill()[1].draw_shadow(sunlight, machine)

        picture.use()
        self._shadows.bind()
        self._walkers.draw(viewpoint, sunlight)
        if on_treadmill:
            ground, treadmill = self._treadmill()
            treadmill.draw(viewpoint, sunlight, machine, scene.walkers[0].distance)
            ground.draw_floor(viewpoint, sunlight, FLOOR, footprint(machine))
            area = walked_surface(machine)
        else:
            ground, area = self._open_ground(), EVERYWHERE
            ground.draw_floor(viewpoint, sunlight)
        self._contact.draw(drawn, viewpoint, area)
        ground.draw_background(viewpoint, sunlight)
        self._shadows.unbind()

    def release(self) -> None:
        """Frees the GPU's memory."""
        for part in (self._shadows, self._walkers, self._contact, self._outdoors, *(self._indoors or ())):
            if part is not None:
                part.release()

    def _open_ground(self) -> GroundPass:
        if self._outdoors is None:
            self._outdoors = GroundPass(self._context, "open_ground.frag")
        return self._outdoors

    def _treadmill(self) -> tuple[GroundPass, TreadmillPass]:
        if self._indoors is None:
            self._indoors = GroundPass(self._context, "studio_floor.frag"), TreadmillPass(self._context)
        return self._indoors


def _middle(scene: Scene) -> tuple[float, float, float]:
    """(x, y, z) m where the first walker was placed: the middle of the belt."""
    x, z = scene.walkers[0].place
    return x, 0.0, z

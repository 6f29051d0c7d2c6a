"""The order in which a scene with a crowd is drawn: shadows, people, street or open ground, contact, background."""

from __future__ import annotations

import moderngl
import numpy as np

from experiment_app.render.cameras import Viewpoint
from experiment_app.render.contact import CROWD_TEXELS, crowd_occluders
from experiment_app.render.contact_pass import EVERYWHERE, ContactPass
from experiment_app.render.crowd_levels import distances
from experiment_app.render.crowd_light import crowd_sunlight, map_size
from experiment_app.render.crowd_pass import CrowdPass
from experiment_app.render.drawn import PLACE, DrawnCrowd
from experiment_app.render.ground_pass import GroundPass
from experiment_app.render.light import ON_CROWDS, Sunlight
from experiment_app.render.shadow_map import ShadowMap
from experiment_app.render.street_pass import StreetPass
from experiment_app.scene import STREET_HALF_WIDTH, Scene

TOUCHED = 40.0  # m from the eye, beyond which contact with the ground is less than a pixel
MOST_MAPS = 4  # shadow maps kept, some 6 MB each; two cameras side by side take turns


class CrowdStage:
    """Draws a crowd on open ground, in a street or on one even tone. Walkers apart from the crowd are not drawn."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._shadow_maps: dict[tuple[int, int], ShadowMap] = {}  # by size, which each camera has its own
        self._people: dict[bool, CrowdPass] = {}
        self._contact = ContactPass(context, CROWD_TEXELS)
        self._outdoors: GroundPass | None = None
        self._street: tuple[GroundPass, StreetPass] | None = None

    def draw(self, scene: Scene, crowd: DrawnCrowd, viewpoint: Viewpoint, size: tuple[int, int]) -> None:
        """Draws into the bound framebuffer of a size (pixels), in linear light."""
        picture = self._context.fbo
        people = self._of(scene)
        people.place(crowd, viewpoint, size[1], scene.lod)
        if scene.ground == "plain":
            tone = scene.marks.background
            picture.clear(tone, tone, tone)
        sunlight = crowd_sunlight(scene.ground, viewpoint)
        shadows = self._shadow_map(map_size(sunlight))
        shadows.begin()
        people.draw_shadow(sunlight)
        picture.use()
        shadows.bind()
        people.draw(viewpoint, sunlight)
        if scene.ground != "plain":
            self._draw_ground(scene, crowd, viewpoint, sunlight)
        shadows.unbind()

    def draw_parts(self, scene: Scene, crowd: DrawnCrowd, viewpoint: Viewpoint, height: int) -> None:
        """Draws the part map of a crowd into the bound framebuffer."""
        people = self._of(scene)
        people.place(crowd, viewpoint, height, scene.lod)
        people.draw_parts(viewpoint)

    def _draw_ground(self, scene: Scene, crowd: DrawnCrowd, viewpoint: Viewpoint, sunlight: Sunlight) -> None:
        area = EVERYWHERE
        if scene.ground == "street":
            ground, street = self._street_passes()
            street.draw(viewpoint, sunlight)
            area = (0.0, 0.0, STREET_HALF_WIDTH, EVERYWHERE[3])
        else:
            ground = self._open_ground()
        ground.draw_floor(viewpoint, sunlight)
        close = np.flatnonzero((distances(viewpoint, crowd.rows[:, PLACE, :3]) < TOUCHED) & (crowd.shown > 0.5))
        if len(close):
            self._contact.draw_rows(crowd_occluders(crowd, close), viewpoint, area)
        ground.draw_background(viewpoint, sunlight)

    def _of(self, scene: Scene) -> CrowdPass:
        """The pass that draws people under the scene's air."""
        outdoors = scene.ground != "plain"
        if outdoors not in self._people:
            self._people[outdoors] = CrowdPass(self._context, outdoors)
        return self._people[outdoors]

    def _shadow_map(self, size: tuple[int, int]) -> ShadowMap:
        if size not in self._shadow_maps:
            if len(self._shadow_maps) >= MOST_MAPS:
                self._shadow_maps.pop(next(iter(self._shadow_maps))).release()
            self._shadow_maps[size] = ShadowMap(self._context, size)
        return self._shadow_maps[size]

    def _open_ground(self) -> GroundPass:
        if self._outdoors is None:
            self._outdoors = GroundPass(self._context, "open_ground.frag", shadows=ON_CROWDS)
        return self._outdoors

    def _street_passes(self) -> tuple[GroundPass, StreetPass]:
        if self._street is None:
            ground = GroundPass(self._context, "open_ground.frag", STREET_HALF_WIDTH, ON_CROWDS)
            self._street = ground, StreetPass(self._context, ON_CROWDS)
        return self._street

    def release(self) -> None:
        """Frees the GPU's memory."""
        several = (*self._shadow_maps.values(), *self._people.values(), *(self._street or ()))
        for part in (self._contact, self._outdoors, *several):
            if part is not None:
                part.release()

"""The order in which a scene with walkers is drawn: shadows, walkers, ground, contact, background."""

from __future__ import annotations

from collections.abc import Sequence

import moderngl

from experiment_app.render.cameras import NOTHING, Viewpoint, place_camera, place_still
from experiment_app.render.contact_pass import EVERYWHERE, ContactPass
from experiment_app.render.crowd_stage import CrowdStage
from experiment_app.render.drawn import Drawn, DrawnCrowd, DrawnWalker
from experiment_app.render.ground_pass import GroundPass
from experiment_app.render.light import fit_sunlight
from experiment_app.render.marks_pass import MarksPass
from experiment_app.render.part_map import PartMapTarget
from experiment_app.render.shadow_map import ShadowMap
from experiment_app.render.street_pass import StreetPass
from experiment_app.render.treadmill_model import FLOOR
from experiment_app.render.treadmill_pass import TreadmillPass, corners, footprint, walked_surface
from experiment_app.render.viewports import Viewport
from experiment_app.render.walkers_pass import WalkersPass
from experiment_app.scene import STREET_HALF_WIDTH, Scene

ROADWAY = (0.0, 0.0, STREET_HALF_WIDTH, 1e9)


class Stage:
    """Draws walkers on their ground. No ground is built before it is first seen."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._shadows = ShadowMap(context)
        self._walkers = WalkersPass(context)
        self._contact = ContactPass(context)
        self._marks: MarksPass | None = None
        self._crowds: CrowdStage | None = None
        self._outdoors: GroundPass | None = None
        self._street_passes: tuple[GroundPass, StreetPass] | None = None
        self._indoors: tuple[GroundPass, TreadmillPass] | None = None

    @property
    def uploads(self) -> int:
        """How many body levels were uploaded to the GPU so far."""
        return self._walkers.bodies.uploads

    @property
    def levels(self) -> tuple[int, ...]:
        """The level of detail of every walker of the last frame, -1 for one without a body."""
        return self._walkers.levels

    def draw(self, scene: Scene, everyone: Sequence[Drawn], size: tuple[int, int]) -> None:
        """Draws into the bound framebuffer of a size (pixels), in linear light, seen from the first walker's camera."""
        picture = self._context.fbo
        width, height = size
        drawn, crowd = parted(everyone)
        viewpoint = seen_from(scene, drawn, width / height)
        if crowd is not None:
            self._crowd_stage().draw(scene, crowd, viewpoint, size)
            return
        if scene.ground == "plain" or (drawn and all(walker.lines is not None for walker in drawn)):
            self._draw_plain(scene, drawn, viewpoint, size)
            return
        on_treadmill = scene.ground == "treadmill"
        machine = _middle(scene)
        casters = corners(machine) if on_treadmill else NOTHING
        bodies = [walker for walker in drawn if walker.lines is None]
        if not bodies and not on_treadmill:  # the shadow map lies where it harms nobody: under the eye
            casters = (viewpoint.eye * (1.0, 0.0, 1.0))[None]
        sunlight = fit_sunlight(scene.ground, viewpoint.azimuth, bodies, casters)
        self._walkers.place(drawn, viewpoint, height, scene.lod)

        self._shadows.begin()
        self._walkers.draw_shadow(sunlight)
        if on_treadmill:
            self._treadmill()[1].draw_shadow(sunlight, machine)

        picture.use()
        self._shadows.bind()
        self._walkers.draw(viewpoint, sunlight)
        if on_treadmill:
            ground, treadmill = self._treadmill()
            treadmill.draw(viewpoint, sunlight, machine, scene.walkers[0].distance if scene.walkers else 0.0)
            ground.draw_floor(viewpoint, sunlight, FLOOR, footprint(machine))
            area = walked_surface(machine)
        elif scene.ground == "street":
            (ground, street), area = self._street(), ROADWAY
            street.draw(viewpoint, sunlight)
            ground.draw_floor(viewpoint, sunlight)
        else:
            ground, area = self._open_ground(), EVERYWHERE
            ground.draw_floor(viewpoint, sunlight)
        self._contact.draw(bodies, viewpoint, area)
        ground.draw_background(viewpoint, sunlight)
        self._shadows.unbind()
        self._draw_marks(scene, drawn, viewpoint, size)

    def draw_parts(self, viewports: Sequence[Viewport], target: PartMapTarget) -> None:
        """Draws the part map of the last frame; viewports: what it showed."""
        target.begin()
        for view in viewports:
            width, height = view.area[2:]
            drawn, crowd = parted(view.drawn)
            viewpoint = seen_from(view.scene, drawn, width / height)
            target.look_at(view.area)
            if crowd is not None:
                self._crowd_stage().draw_parts(view.scene, crowd, viewpoint, height)
                continue
            if len(viewports) > 1:  # the passes hold the walkers of the last view only
                self._walkers.place(drawn, viewpoint, height, view.scene.lod)
            self._walkers.draw_parts(viewpoint)
        target.end()

    def _draw_plain(
        self, scene: Scene, drawn: Sequence[DrawnWalker], viewpoint: Viewpoint, size: tuple[int, int]
    ) -> None:
        """Walkers on nothing but one even tone: no ground, no shadow on it."""
        tone = scene.marks.background
        self._context.fbo.clear(tone, tone, tone)
        self._walkers.place(drawn, viewpoint, size[1], scene.lod)
        bodies = [walker for walker in drawn if walker.lines is None]
        if bodies:
            picture = self._context.fbo
            sunlight = fit_sunlight(scene.ground, viewpoint.azimuth, bodies, NOTHING)
            self._shadows.begin()
            self._walkers.draw_shadow(sunlight)
            picture.use()
            self._shadows.bind()
            self._walkers.draw(viewpoint, sunlight)
            self._shadows.unbind()
        self._draw_marks(scene, drawn, viewpoint, size)

    def _draw_marks(
        self, scene: Scene, drawn: Sequence[DrawnWalker], viewpoint: Viewpoint, size: tuple[int, int]
    ) -> None:
        if all(walker.lines is None for walker in drawn):
            return
        if self._marks is None:
            self._marks = MarksPass(self._context)
        self._marks.draw(scene, drawn, viewpoint, size)

    def release(self) -> None:
        """Frees the GPU's memory."""
        several = (*(self._indoors or ()), *(self._street_passes or ()))
        always = (self._shadows, self._walkers, self._contact)
        for part in (*always, self._marks, self._crowds, self._outdoors, *several):
            if part is not None:
                part.release()

    def _crowd_stage(self) -> CrowdStage:
        if self._crowds is None:
            self._crowds = CrowdStage(self._context)
        return self._crowds

    def _open_ground(self) -> GroundPass:
        if self._outdoors is None:
            self._outdoors = GroundPass(self._context, "open_ground.frag")
        return self._outdoors

    def _street(self) -> tuple[GroundPass, StreetPass]:
        if self._street_passes is None:
            ground = GroundPass(self._context, "open_ground.frag", STREET_HALF_WIDTH)
            self._street_passes = ground, StreetPass(self._context)
        return self._street_passes

    def _treadmill(self) -> tuple[GroundPass, TreadmillPass]:
        if self._indoors is None:
            self._indoors = GroundPass(self._context, "studio_floor.frag"), TreadmillPass(self._context)
        return self._indoors


def parted(drawn: Sequence[Drawn]) -> tuple[tuple[DrawnWalker, ...], DrawnCrowd | None]:
    """The walkers, and the crowd if there is one."""
    crowds = [each for each in drawn if isinstance(each, DrawnCrowd)]
    return tuple(each for each in drawn if isinstance(each, DrawnWalker)), crowds[0] if crowds else None


def seen_from(scene: Scene, drawn: Sequence[DrawnWalker], aspect: float) -> Viewpoint:
    """The scene's camera in the world; a view that follows looks at the first walker."""
    if not scene.camera.follows:
        return place_still(scene.camera, aspect)
    machine = corners(_middle(scene)) if scene.ground == "treadmill" else NOTHING
    if not drawn:
        return place_camera(scene.camera, aspect, 1.75, (0.0, 0.0, 0.0), machine)
    return place_camera(scene.camera, aspect, drawn[0].body.stature, drawn[0].place, machine)


def _middle(scene: Scene) -> tuple[float, float, float]:
    """(x, y, z) m where the first walker was placed: the middle of the belt."""
    x, z = scene.walkers[0].place if scene.walkers else (0.0, 0.0)
    return x, 0.0, z

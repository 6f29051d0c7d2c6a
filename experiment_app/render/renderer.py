"""A scene of plain values to pixels: walkers on their ground, then the page of text over them."""

from __future__ import annotations

from collections.abc import Sequence

import moderngl
import numpy as np
from numpy.typing import NDArray

from experiment_app.render.drawn import Drawn
from experiment_app.render.page_shapes import PAGE
from experiment_app.render.pages import PagePainter
from experiment_app.render.part_map import PartMap, PartMapTarget
from experiment_app.render.picture import Picture
from experiment_app.render.stage import Stage
from experiment_app.render.viewports import Viewport, viewports_of
from experiment_app.scene import Page, Scene

PRIMITIVE_RESTART = 0x8F9D
"""moderngl turns it on. No mesh of ours has a restart in its indices, and a software driver looks for one in each index
of each instance: 5 ms a frame with a crowd of 1000."""


class Renderer:
    """Everything a window needs to show scenes.

    size:        (width, height) of the target, pixels.
    pixel_ratio: pixels per unit of a page's layout, 2 on most high-density screens.
    samples:     wanted per pixel; `samples` tells what the driver gave.
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int], pixel_ratio: float, samples: int) -> None:
        context.disable_direct(PRIMITIVE_RESTART)
        self._picture = Picture(context, size, samples)
        self._context = context
        self._stage = Stage(context)
        self._parts: PartMapTarget | None = None
        self._pages = PagePainter(context, size, pixel_ratio)
        self._asked = (tuple(size), pixel_ratio)
        self._half: Picture | None = None
        self._viewports: tuple[Viewport, ...] = ()
        self._levels: tuple[int, ...] = ()

    @property
    def samples(self) -> int:
        """Samples per pixel, at most what the driver has; 1 is no multisampling."""
        return self._picture.samples

    @property
    def uploads(self) -> int:
        """How many body levels were uploaded to the GPU so far."""
        return self._stage.uploads

    @property
    def levels(self) -> tuple[int, ...]:
        """The level of detail of every walker of the last frame, 0 the finest, -1 for one without a body."""
        return self._levels

    def draw_parts(self, frames_ago: int = 0, scale: int = 1) -> PartMap | None:
        """Draws the body-part map of the frame drawn last, and returns it or the one of the frame before.

        With frames_ago 1 nothing is waited for: that map's bytes have arrived while this frame was drawn. None when
        there is none yet. Call it after `draw`; what is bound afterwards is the map.
        scale: pixels of the picture per pixel of the map, which is all the cheaper to fetch.
        """
        size = (self._picture.size[0] // scale, self._picture.size[1] // scale)
        if self._parts is None or self._parts.size != size:
            if self._parts is not None:
                self._parts.release()
            self._parts = PartMapTarget(self._context, size)
        self._stage.draw_parts([view.smaller(scale) for view in self._viewports], self._parts)
        return self._parts.take(frames_ago)

    def draw(self, scene: Scene, drawn: Sequence[Drawn], target: moderngl.Framebuffer) -> None:
        """Draws the scene over the whole target; drawn: `scene.everyone` in the same order, posed.

        The same scene gives the same pixels on the same driver. Allocates nothing once a scene with as many
        walkers of the same bodies was drawn.
        """
        target.use()
        target.viewport = (0, 0, *self._picture.size)
        if (scene.beside is not None or scene.strip) and scene.visible:
            target.clear(*PAGE)  # the strips between the halves and under them, and a half with nobody in it
        viewports = viewports_of(scene, drawn, self._picture.size)
        self._viewports = tuple(view for view in viewports if view.scene.visible)
        self._levels = ()
        for view in self._viewports:
            picture = self._picture_for(view)
            picture.begin()
            self._stage.draw(view.scene, view.drawn, picture.size)
            self._levels += self._stage.levels
            picture.show(target, view.area[:2])
        target.viewport = (0, 0, *self._picture.size)
        self._pages.draw(scene)

    def _picture_for(self, view: Viewport) -> Picture:
        """The picture a view is drawn in; both halves take turns in one."""
        size = view.area[2:]
        if size == self._picture.size:
            return self._picture
        if self._half is None:
            self._half = Picture(self._context, size, self.samples)
        self._half.resize(size)
        return self._half

    def resize(self, size: tuple[int, int], pixel_ratio: float) -> None:
        """The target has a new size (pixels) or density; does nothing when neither has changed."""
        if (tuple(size), pixel_ratio) == self._asked:
            return
        self._asked = (tuple(size), pixel_ratio)
        self._picture.resize(size)
        self._pages.resize(size, pixel_ratio)

    def hit(self, page: Page, x: float, y: float) -> str | None:
        """The id of the box of a page at a pixel (from the top left), or None."""
        return self._pages.hit(page, x, y)

    def read_pixels(self, target: moderngl.Framebuffer) -> NDArray[np.uint8]:
        """(height, width, 3) sRGB codes of the target, top row first."""
        width, height = self._picture.size
        raw = target.read(viewport=(0, 0, width, height), components=3, alignment=1)
        return np.frombuffer(raw, np.uint8).reshape(height, width, 3)[::-1].copy()

    def release(self) -> None:
        """Frees the GPU's memory."""
        self._pages.release()
        if self._parts is not None:
            self._parts.release()
        self._stage.release()
        self._picture.release()
        if self._half is not None:
            self._half.release()

"""Pages, captions and the plain background, drawn into the bound framebuffer with moderngl.

Whatever is written is composed once into a picture of its own; showing it again is one textured rectangle.
"""

from __future__ import annotations

from collections.abc import Sequence

import moderngl
import numpy as np
from numpy.typing import NDArray

from experiment_app.render.layout import hit, layout_caption, layout_page
from experiment_app.render.page_shapes import (
    CAPTION_BACK,
    CARD,
    CLEAR,
    DIM,
    INKS,
    PAGE,
    Colour,
    PageLayout,
    PlacedText,
    Rectangle,
    Shape,
    shapes_of,
)
from experiment_app.render.programs import build
from experiment_app.render.text import mask_of, overhang
from experiment_app.scene import Page, Scene

INSTANCE = {"rectangle": 4, "fill": 4, "edge": 4, "form": 3}
"""What the vertex shader reads of one shape, and how many numbers each is."""

PREMULTIPLIED = (moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA)
"""How colours multiplied by their alpha go over others."""


class PagePainter:
    """Draws what there is to read.

    size: (width, height) of the window, device pixels; pixel_ratio: device pixels per ordinary pixel.
    Drawing leaves blending, depth test and face culling off.
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int], pixel_ratio: float) -> None:
        self._context = context
        self._programs = (
            build(context, "page_shape.vert", "page_shape.frag"),
            build(context, "page_shape.vert", "page_text.frag"),
        )
        self._whole = build(context, "page_whole.vert", "page_whole.frag")
        self._whole_array = context.vertex_array(self._whole, [])
        self._page = _Picture(context, self._programs)
        self._caption = _Picture(context, self._programs)
        self._size, self._pixel_ratio = (int(size[0]), int(size[1])), float(pixel_ratio)

    def draw(self, scene: Scene) -> None:
        """Draws the scene's page or caption, over what is there only if the scene or its page says so."""
        width, height = self._size
        page = scene.page
        plain = not page.over_scene if page is not None else not scene.visible
        if plain and page in (None, Page()):
            self._context.clear(*PAGE)
        if page is not None and page != Page():
            layout = layout_page(page, width, height, self._pixel_ratio)
            back = PAGE if plain else CLEAR if page.strip else DIM
            card = () if layout.card is None else (Shape(layout.card, CARD, 9 * layout.unit),)
            whole = Rectangle(0, 0, width, height)
            if page.strip and not plain:
                floor = round(page.strip * height)
                whole = Rectangle(0, height - floor, width, floor)
            self._page.compose(layout, whole, back, (*card, *shapes_of(layout)))
            if plain:
                self._context.copy_framebuffer(self._context.fbo, self._page.frame)
            else:
                self._show(self._page)
        if scene.caption.strip() and (page is None or not page.hint):
            layout = layout_caption(scene.caption, width, height, self._pixel_ratio)
            assert layout.card is not None
            card = (Shape(layout.card, CAPTION_BACK, 8 * layout.unit),)
            self._caption.compose(layout, layout.card.grown(2), CLEAR, card)
            self._show(self._caption)

    def hit(self, page: Page, x: float, y: float) -> str | None:
        """The id of the box of a page at a device pixel (from the top left), or None."""
        return hit(layout_page(page, *self._size, self._pixel_ratio), x, y)

    def resize(self, size: tuple[int, int], pixel_ratio: float) -> None:
        """The window has a new size (device pixels) or density."""
        self._size, self._pixel_ratio = (int(size[0]), int(size[1])), float(pixel_ratio)

    def release(self) -> None:
        """Frees the GPU's memory."""
        self._page.release()
        self._caption.release()
        for resource in (self._whole_array, self._whole, *self._programs):
            resource.release()

    def _show(self, picture: _Picture) -> None:
        at = picture.place
        self._context.enable_only(moderngl.BLEND)
        self._context.blend_func = PREMULTIPLIED
        self._whole["place"] = (at.x, at.y, at.width, at.height)
        self._whole["window"] = self._size
        picture.texture.use(0)
        self._whole_array.render(moderngl.TRIANGLE_STRIP, vertices=4)
        self._context.enable_only(moderngl.NOTHING)


class _Picture:
    """A composed page in a texture, composed again only when something differs."""

    def __init__(self, context: moderngl.Context, programs: tuple[moderngl.Program, moderngl.Program]) -> None:
        self._context = context
        self._programs = programs
        self._shown: object = None
        self.place = Rectangle(0, 0, 1, 1)
        self._allocate((1, 1))

    def compose(self, layout: PageLayout, place: Rectangle, back: Colour, shapes: Sequence[Shape]) -> None:
        """Makes the picture that covers `place`: the back colour, then the shapes, then the layout's texts."""
        wanted = (layout, place, back, shapes)
        if wanted == self._shown:
            return
        texts = [*layout.texts, *(text for placed in layout.boxes for text in placed.texts)]
        bound = self._context.fbo
        viewport = bound.viewport
        self.place = place
        if self.texture.size != (place.width, place.height):
            self.release()
            self._allocate((place.width, place.height))
        self.frame.use()
        self._context.enable_only(moderngl.BLEND)
        self._context.blend_func = PREMULTIPLIED
        red, green, blue, alpha = back
        self.frame.clear(red * alpha, green * alpha, blue * alpha, alpha)
        self._paint(self._programs[0], [_instance(shape) for shape in shapes])
        self._sheet.write(_sheet(texts, place)[::-1].tobytes())
        self._sheet.use(0)
        self._paint(self._programs[1], [_instance(Shape(_inked(t), INKS[t.role])) for t in texts])
        self._context.enable_only(moderngl.NOTHING)
        bound.use()
        bound.viewport = viewport
        self._shown = wanted

    def release(self) -> None:
        """Frees the GPU's memory."""
        for resource in (self.frame, self.texture, self._sheet):
            resource.release()

    def _allocate(self, size: tuple[int, int]) -> None:
        self.texture = self._context.texture(size, 4)
        self.frame = self._context.framebuffer([self.texture])
        self._sheet = self._context.texture(size, 1, alignment=1)

    def _paint(self, program: moderngl.Program, instances: Sequence[Sequence[float]]) -> None:
        if not instances:
            return
        program["size"] = (self.place.width, self.place.height)
        program["corner"] = (self.place.x, self.place.y)
        buffer = self._context.buffer(np.asarray(instances, np.float32).tobytes())
        used = [name for name in INSTANCE if name in program]  # a driver may drop what changes nothing
        form = " ".join(f"{count}f" if name in used else f"{4 * count}x" for name, count in INSTANCE.items())
        array = self._context.vertex_array(program, [(buffer, f"{form}/i", *used)])
        array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=len(instances))
        array.release()
        buffer.release()


def _instance(shape: Shape) -> tuple[float, ...]:
    at = shape.rectangle
    return (at.x, at.y, at.width, at.height, *shape.fill, *shape.edge, shape.radius, shape.border, shape.softness)


def _inked(text: PlacedText) -> Rectangle:
    """Where a text's ink may be: its rectangle and the overhang on both sides."""
    at, margin = text.rectangle, overhang(text.size)
    return Rectangle(at.x - margin, at.y, at.width + 2 * margin, at.height)


def _sheet(texts: Sequence[PlacedText], place: Rectangle) -> NDArray[np.uint8]:
    """How much of every pixel of `place` is ink: (height, width) uint8, the top row first."""
    sheet = np.zeros((place.height, place.width), np.uint8)
    for text in texts:
        at = _inked(text).moved(-place.x, -place.y)
        mask = mask_of(text.text, text.size, text.bold, at.height)
        top, left = max(at.y, 0), max(at.x, 0)
        part = sheet[top : max(at.bottom, 0), left : max(at.right, 0)]
        mask = mask[top - at.y :, left - at.x :][: part.shape[0], : part.shape[1]]
        part = part[: mask.shape[0], : mask.shape[1]]
        np.maximum(part, mask, out=part)
    return sheet

"""What a laid-out page is made of, and what it is painted with: rectangles, placed texts, shapes and colours.

Plain values in device pixels from the top left; knows no font and no GPU. All colours are sRGB as the display
wants them, components in [0, 1].
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from experiment_app.scene import Box

if TYPE_CHECKING:
    from experiment_app.render.sliders import PlacedSlider

Role = Literal["title", "text", "prompt", "small", "hint", "error", "sign", "label", "chosen", "check", "button"]
Colour = tuple[float, float, float, float]


def colour(code: str, alpha: float = 1.0) -> Colour:
    """A colour from #rrggbb."""
    red, green, blue = (int(code[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    return (red, green, blue, alpha)


PAGE = colour("#2b2d30")
DIM = colour("#16181a", 0.55)  # over a scene
CARD = colour("#2b2d30")
CAPTION_BACK = colour("#1b1d1f", 0.80)
FIELD = colour("#1f2123")
PILL = colour("#383b3f")
BUTTON = colour("#43474d")
ACCENT = colour("#a9d1f7")
OUTLINE = colour("#878d94")
FAULT = colour("#ffb59c")
TRACK = colour("#4b4f55")
CLEAR: Colour = (0.0, 0.0, 0.0, 0.0)

INKS: dict[Role, Colour] = {
    "title": colour("#f6f5f2"),
    "text": colour("#ecebe7"),
    "prompt": colour("#f6f5f2"),
    "small": colour("#d3d3d0"),
    "hint": colour("#c2c5c8"),
    "error": FAULT,
    "sign": colour("#2b1710"),
    "label": colour("#f0efec"),
    "chosen": colour("#10202e"),
    "check": ACCENT,
    "button": colour("#f6f5f2"),
}
"""The colour of every kind of text."""

BACKS: dict[Role, Colour] = {"sign": FAULT, "label": PILL, "chosen": ACCENT, "check": INKS["chosen"], "button": BUTTON}
"""What a kind of text stands on, where that is not the page."""


def contrast(ink: Colour, back: Colour) -> float:
    """Contrast ratio of two opaque colours, 1 to 21, as WCAG 2 defines it."""

    def luminance(of: Colour) -> float:
        linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in of[:3]]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    brighter, darker = sorted((luminance(ink), luminance(back)), reverse=True)
    return (brighter + 0.05) / (darker + 0.05)


def over(top: Colour, below: Colour) -> Colour:
    """A translucent colour over an opaque one."""
    mixed = [t * top[3] + b * (1.0 - top[3]) for t, b in zip(top[:3], below[:3], strict=True)]
    return (mixed[0], mixed[1], mixed[2], 1.0)


@dataclass(frozen=True)
class Rectangle:
    """Whole pixels; x, y is the top left corner."""

    x: int
    y: int
    width: int
    height: int

    @property
    def right(self) -> int:
        """The first column right of it."""
        return self.x + self.width

    @property
    def bottom(self) -> int:
        """The first row below it."""
        return self.y + self.height

    def contains(self, x: float, y: float) -> bool:
        """Whether a point is inside."""
        return self.x <= x < self.right and self.y <= y < self.bottom

    def overlaps(self, other: Rectangle) -> bool:
        """Whether they share a pixel."""
        return self.x < other.right and other.x < self.right and self.y < other.bottom and other.y < self.bottom

    def grown(self, by: int) -> Rectangle:
        """Larger by so many pixels on every side."""
        return Rectangle(self.x - by, self.y - by, self.width + 2 * by, self.height + 2 * by)

    def moved(self, right: int, down: int) -> Rectangle:
        """The same rectangle elsewhere."""
        return Rectangle(self.x + right, self.y + down, self.width, self.height)

    def mirrored(self, width: int) -> Rectangle:
        """As seen in a mirror, within 0..width."""
        return Rectangle(width - self.right, self.y, self.width, self.height)


@dataclass(frozen=True)
class PlacedText:
    """One line of text; the rectangle is as wide as the text and as high as the line."""

    text: str
    role: Role
    size: int  # of the font, pixels
    rectangle: Rectangle

    @property
    def bold(self) -> bool:
        """Whether it is set in the bold face."""
        return self.role in ("title", "sign", "check")


@dataclass(frozen=True)
class PlacedBox:
    """A box of a page with its texts; mark: an option's circle; caret: where the next letter goes."""

    box: Box
    rectangle: Rectangle
    texts: tuple[PlacedText, ...] = ()
    mark: Rectangle | None = None
    caret: Rectangle | None = None
    faulty: bool = False


@dataclass(frozen=True)
class PageLayout:
    """Everything on a page, placed.

    rings:    around what has the keyboard. signs: the discs with an exclamation mark before errors.
    track:    the progress bar, and done the part of it that is filled.
    card:     what a page over a scene stands on. unit: pixels, a tenth of the text's size.
    complete: False if the window is so small that even tiny text does not fit.
    """

    width: int
    height: int
    unit: float
    texts: tuple[PlacedText, ...] = ()
    boxes: tuple[PlacedBox, ...] = ()
    sliders: tuple[PlacedSlider, ...] = ()
    rings: tuple[Rectangle, ...] = ()
    signs: tuple[Rectangle, ...] = ()
    track: Rectangle | None = None
    done: Rectangle | None = None
    card: Rectangle | None = None
    complete: bool = True


@dataclass(frozen=True)
class Shape:
    """A rounded rectangle, drawn with smooth edges; the border lies inside it."""

    rectangle: Rectangle
    fill: Colour
    radius: float = 0.0
    border: float = 0.0
    edge: Colour = CLEAR
    softness: float = 0.0  # pixels over which the outline fades, outwards


def shapes_of(layout: PageLayout) -> tuple[Shape, ...]:
    """What is painted under the texts of a page, back to front."""
    u = layout.unit
    shapes: list[Shape] = []
    for ring in layout.rings:
        shapes.append(Shape(ring, CLEAR, 6 * u, max(2.0, 1.0 * u), ACCENT))
    for placed in layout.boxes:
        shapes += _box_shapes(placed, u)
    for slider in layout.sliders:
        shapes += slider.shapes(u)
    if layout.track is not None and layout.done is not None:
        shapes.append(Shape(layout.track, TRACK, layout.track.height / 2))
        shapes.append(Shape(layout.done, ACCENT, layout.done.height / 2))
    shapes += (Shape(sign, FAULT, sign.height / 2) for sign in layout.signs)
    return tuple(shapes)


def _box_shapes(placed: PlacedBox, u: float) -> list[Shape]:
    at, box = placed.rectangle, placed.box
    thin = max(1.0, 0.6 * u)
    if box.kind == "button":
        return [Shape(at, BUTTON, 3 * u, thin, OUTLINE)]
    if box.kind == "option":
        radius = min(at.height / 2, 10 * u)
        pill = Shape(at, ACCENT if box.chosen else PILL, radius, thin, ACCENT if box.chosen else OUTLINE)
        assert placed.mark is not None
        mark = Shape(
            placed.mark,
            INKS["chosen"] if box.chosen else CLEAR,
            placed.mark.height / 2,
            thin,
            INKS["chosen"] if box.chosen else OUTLINE,
        )
        return [pill, mark]
    line = max(2, round(0.9 * u))
    rule = Rectangle(at.x, at.bottom - line, at.width, line)
    shapes = [Shape(at, FIELD, 1.5 * u), Shape(rule, FAULT if placed.faulty else OUTLINE)]
    if placed.caret is not None:
        shapes.append(Shape(placed.caret, INKS["label"]))
    return shapes

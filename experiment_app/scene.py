"""What is on the screen at one instant, as plain values: print it, compare it, log it. Knows no GPU."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from stimuli.methods.recipe import Making

View = Literal["three_quarter", "side", "front", "legs", "elevated", "first_person"]
Ground = Literal["open_ground", "treadmill", "plain", "street"]

STREET_HALF_WIDTH = 9.0
"""m from the middle of the street, x = 0, to either kerb; it runs along z without end."""


@dataclass(frozen=True)
class Walker:
    """One walker at one instant.

    actor:          name of the actor whose motion is shown.
    body:           name of a body or of a figure without one (point_light, stick_figure, ...); "" the actor's own.
    making:         the method that makes the walk at that speed; None the actor as captured, at `step_frequency`.
    speed:          m/s; step_frequency: steps/min.
    phase:          in [0, 1), 0 at right heel strike.
    distance:       m walked along +Z since the walker was placed (0 on a treadmill).
    place:          (x, z) m, where the walker was placed.
    """

    actor: str
    speed: float
    step_frequency: float
    phase: float
    distance: float = 0.0
    place: tuple[float, float] = (0.0, 0.0)
    body: str = ""
    making: Making | None = None


Palette = Literal["varied", "equal_luminance"]


@dataclass(frozen=True)
class Crowd:
    """Many people walking the same way, along +Z; who, where and how follows from these values alone.

    size:      walkers, half of them women.
    variation: "1:N", one motion for N walkers, or "1", one motion for all women and one for all men.
    seed:      of paths, speeds, sizes and which motions are chosen; pool: of the motions that there are to choose from.
    palette:   colours differ in everything, or in hue and chroma only.
    seconds:   s since the crowd began to walk.
    """

    size: int
    variation: str = "1:1"
    seed: int = 0
    pool: int = 0
    palette: Palette = "varied"
    seconds: float = 0.0


@dataclass(frozen=True)
class Camera:
    """Where the scene is seen from.

    view:          a named view. Most follow the first walker, legs narrows the field of view to the legs; elevated
                   looks down at a place and first_person stands at one, whoever walks there.
    distance:      m along the ground from the camera to the walker or the place.
    height:        m above the ground.
    field_of_view: vertical, degrees.
    heading:       degrees in which the camera looks, 0 along +Z, 90 along +X; None: the view's own.
    place:         (x, z) m, what elevated looks at or where first_person stands.
    """

    view: View = "three_quarter"
    distance: float = 5.0
    height: float = 1.6
    field_of_view: float = 30.0
    heading: float | None = None
    place: tuple[float, float] = (0.0, 0.0)

    @property
    def follows(self) -> bool:
        """Whether the camera keeps pace with the first walker."""
        return self.view not in ("elevated", "first_person")


@dataclass(frozen=True)
class Marks:
    """How point lights and stick figures look; a scene with nothing else shows them on a plain field.

    dot_size:   diameter of a dot, degrees of visual angle; line_width: of a stick, the same.
    brightness: of dots and sticks, linear light, 1 is the display's white; background: of the plain field.
    seed:       of the places of a scrambled point light.
    """

    dot_size: float = 0.15
    line_width: float = 0.1
    brightness: float = 1.0
    background: float = 0.0
    seed: int = 0


@dataclass(frozen=True)
class Line:
    """One paragraph of a page: kind decides size and weight; text may hold any script."""

    text: str
    kind: Literal["title", "text", "small", "hint", "error"] = "text"


@dataclass(frozen=True)
class Box:
    """Something on a page that can be typed into or chosen: a field, an option or a button.

    id:      what a click on it answers, unique on the page.
    label:   text in or beside it.
    kind:    "field" (typed text), "option" (one of several), "button".
    chosen:  the option that is chosen; focused: has the keyboard.
    """

    id: str
    label: str
    kind: Literal["field", "option", "button"]
    chosen: bool = False
    focused: bool = False


@dataclass(frozen=True)
class Slider:
    """A scale from minimum to maximum with labelled ends; a click on it answers `id:value`.

    step: between the points that can be marked; None where every value can. mark: None before there is one.
    """

    id: str
    minimum: float
    maximum: float
    step: float | None
    low: str
    high: str
    mark: float | None = None


@dataclass(frozen=True)
class Row:
    """A question's prompt and the boxes that answer it, or a row of buttons when the prompt is empty.

    slider: stands left of the boxes.
    """

    prompt: str
    boxes: tuple[Box, ...]
    error: str = ""
    slider: Slider | None = None


@dataclass(frozen=True)
class Page:
    """A page of text, centred in a calm column: lines, then rows of boxes, then a hint at the bottom.

    over_scene: drawn over the (dimmed) walker instead of on a plain background, as a pause is.
    strip:      share of the picture's height at the lower edge that the page keeps to; 0: all of the picture.
    """

    lines: tuple[Line, ...] = ()
    rows: tuple[Row, ...] = ()
    hint: str = ""
    progress: float | None = None
    over_scene: bool = False
    strip: float = 0.0


@dataclass(frozen=True)
class Scene:
    """Everything visible: walkers on a ground from a camera, or a page, or both; and one line at the bottom.

    screen_angle: vertical visual angle of the whole picture for the viewer, degrees; 0 takes the camera's field of
                  view, which is the same when the perspective is true.
    lod:          level of detail that all walkers are forced to, 0 the finest; None chooses by size on the screen.
    crowd:        more people, of whom each has a motion, a place and a look of its own.
    strip:        share of the picture's height at its lower edge that is kept free for the page; what is above is cut
                  from the same picture, so that nothing gets smaller.
    beside:       a second scene for the right half of the picture, this one then has the left half: each with its own
                  walkers, camera, ground, marks and lod. Page, caption and screen_angle are those of this scene and
                  for the whole picture.
    """

    walkers: tuple[Walker, ...] = ()
    camera: Camera = field(default_factory=Camera)
    ground: Ground = "open_ground"
    page: Page | None = None
    caption: str = ""
    marks: Marks = field(default_factory=Marks)
    screen_angle: float = 0.0
    lod: int | None = None
    strip: float = 0.0
    beside: Scene | None = None
    crowd: Crowd | None = None

    @property
    def visible(self) -> bool:
        """Whether there is more to see than a page: somebody, or a place the camera stands at."""
        here = self.somebody or not self.camera.follows
        return here or (self.beside is not None and self.beside.visible)

    @property
    def somebody(self) -> bool:
        """Whether anybody walks: a walker or a crowd, here or in the scene beside."""
        here = bool(self.walkers) or self.crowd is not None
        return here or (self.beside is not None and self.beside.somebody)

    @property
    def clickable(self) -> bool:
        """Whether there is something to click: a field, an option, a button or a scale."""
        return self.page is not None and bool(self.page.rows)

    @property
    def everyone(self) -> tuple[Walker, ...]:
        """The walkers of the scene, then those of the scene beside it."""
        return self.walkers + (self.beside.walkers if self.beside is not None else ())

"""Where a rating scale goes: its track, points, mark, numbers and labelled ends, and which value a point is. No GPU."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import ceil
from typing import TYPE_CHECKING

from experiment_app.render.page_shapes import ACCENT, OUTLINE, PILL, TRACK, PlacedText, Rectangle, Role, Shape
from experiment_app.render.text import break_lines, clean, width_of
from experiment_app.scene import Slider

if TYPE_CHECKING:
    from experiment_app.render.layout import Setting


@dataclass(frozen=True)
class PlacedSlider:
    """A scale with its places in pixels.

    rectangle: where a click marks a value. low, high: around the ends of the scale.
    track:     the line; points: discs of a discrete scale; knob: the mark of a continuous one, None before.
    """

    slider: Slider
    rectangle: Rectangle
    low: Rectangle
    high: Rectangle
    track: Rectangle
    points: tuple[Rectangle, ...] = ()
    knob: Rectangle | None = None

    def value_at(self, x: float) -> float:
        """The value of the scale under a pixel column, the nearest one it has."""
        slider, first, last = self.slider, _middle(self.low), _middle(self.high)
        share = min(max((x - first) / (last - first), 0.0), 1.0)
        value = slider.minimum + share * (slider.maximum - slider.minimum)
        if slider.step is None:
            return value
        return slider.minimum + round((value - slider.minimum) / slider.step) * slider.step

    def shapes(self, unit: float) -> list[Shape]:
        """What is painted under the texts, back to front; unit as in a PageLayout."""
        thin = max(1.0, 0.6 * unit)
        shapes = [Shape(self.track, TRACK, self.track.height / 2)]
        for i, point in enumerate(self.points):
            chosen = marked(self.slider, i)
            shapes.append(
                Shape(point, ACCENT if chosen else PILL, point.height / 2, thin, ACCENT if chosen else OUTLINE)
            )
        if self.slider.step is None:
            for end in (self.low, self.high):
                tick = Rectangle(round(_middle(end)) - 1, end.y + end.height // 4, max(2, round(thin)), end.height // 2)
                shapes.append(Shape(tick, OUTLINE))
        if self.knob is not None:
            shapes.append(Shape(self.knob, ACCENT, self.knob.height / 2))
        return shapes

    def elsewhere(self, place: Callable[[Rectangle], Rectangle]) -> PlacedSlider:
        """The same scale with every rectangle where `place` puts it."""
        return replace(
            self,
            rectangle=place(self.rectangle),
            low=place(self.low),
            high=place(self.high),
            track=place(self.track),
            points=tuple(place(point) for point in self.points),
            knob=self.knob and place(self.knob),
        )


def placed_slider(slider: Slider, width: int, setting: Setting) -> tuple[PlacedSlider, tuple[PlacedText, ...], int]:
    """A scale in a column of a width (pixels) from (0, 0), its texts, and its height."""
    count = 2 if slider.step is None else round((slider.maximum - slider.minimum) / slider.step) + 1
    side = min(setting.space(1.9), int(0.85 * width / count))
    ends = setting.space(0.4)
    spots = tuple(
        Rectangle(ends + round(i * (width - 2 * ends - side) / (count - 1)), 0, side, side) for i in range(count)
    )
    thin = max(2, setting.space(0.22))
    first, last = spots[0], spots[-1]
    track = Rectangle(round(_middle(first)), (side - thin) // 2, round(_middle(last) - _middle(first)), thin)
    placed = PlacedSlider(slider, Rectangle(0, 0, width, side), first, last, track)
    texts: list[PlacedText] = []
    if slider.step is None:
        placed = replace(placed, knob=_knob(placed, side))
    else:
        placed = replace(placed, points=spots)
        texts += _numbers(slider, spots, setting)
    labels, height = _ends(slider, width, side + setting.space(0.25), setting)
    return placed, (*texts, *labels), height


def marked(slider: Slider, index: int) -> bool:
    """Whether the point of a discrete scale with this index is the mark."""
    if slider.mark is None or slider.step is None:
        return False
    return abs(slider.minimum + index * slider.step - slider.mark) < slider.step / 2.0


def _middle(at: Rectangle) -> float:
    return at.x + at.width / 2.0


def _knob(placed: PlacedSlider, side: int) -> Rectangle | None:
    slider = placed.slider
    if slider.mark is None:
        return None
    share = (slider.mark - slider.minimum) / (slider.maximum - slider.minimum)
    size = round(0.62 * side)
    middle = _middle(placed.low) + share * (_middle(placed.high) - _middle(placed.low))
    return Rectangle(round(middle - size / 2.0), (side - size) // 2, size, size)


def _numbers(slider: Slider, spots: tuple[Rectangle, ...], setting: Setting) -> list[PlacedText]:
    """The value of every point inside its disc; none where the discs are too small for the longest."""
    assert slider.step is not None
    texts = [f"{slider.minimum + i * slider.step:g}" for i in range(len(spots))]
    size = setting.size("label")
    if max(width_of(text, size) for text in texts) > 0.8 * spots[0].width or spots[0].width < 1.1 * size:
        return []
    numbers = []
    for i, (text, spot) in enumerate(zip(texts, spots, strict=True)):
        width, role = ceil(width_of(text, size)), _role(marked(slider, i))
        leading = setting.leading("label")
        at = Rectangle(spot.x + (spot.width - width) // 2, (spot.height - leading) // 2, width, leading)
        numbers.append(PlacedText(text, role, size, at))
    return numbers


def _role(chosen: bool) -> Role:
    return "chosen" if chosen else "label"


def _ends(slider: Slider, width: int, top: int, setting: Setting) -> tuple[list[PlacedText], int]:
    """What both ends mean, under them, each in less than half of the width; and where they end."""
    size, leading, texts, bottom = setting.size("small"), setting.leading("small"), [], top
    for label, at_right in ((slider.low, False), (slider.high, True)):
        for i, line in enumerate(break_lines(clean(label), size, False, max(1, round(0.46 * width)))):
            wide = ceil(width_of(line, size))
            at = Rectangle(width - wide if at_right else 0, top + i * leading, wide, leading)
            texts.append(PlacedText(line, "small", size, at))
            bottom = max(bottom, at.bottom)
    return texts, bottom

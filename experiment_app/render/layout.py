"""Where everything on a page goes: a page as plain values to rectangles in device pixels. Knows no GPU.

Lines and rows are set one below the other in a column of readable width, in the middle of the window. Sizes follow
the window's height; a page that does not fit gets a wider column and smaller text, down to what is still legible.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from math import ceil, log

from experiment_app.render.page_shapes import PageLayout, PlacedBox, PlacedText, Rectangle, Role
from experiment_app.render.sliders import PlacedSlider, placed_slider
from experiment_app.render.text import break_lines, clean, has_direction, is_right_to_left, last_part, width_of
from experiment_app.scene import Box, Line, Page, Row, Slider

TEXT_HEIGHT = 0.026
"""Font size of text, of the window's height: 0.4 degrees of x-height on a 24-inch display at 60 cm."""
LEAST_TEXT_HEIGHT = 0.0165
TITLE, SMALL = 1.62, 0.80
"""Font sizes of titles, and of hints and small text, relative to text."""
LEADING, TITLE_LEADING = 1.5, 1.25
TITLE_TOP = 0.17
"""Where a page that is not over a scene begins, of the window's height; a long one begins higher."""
LEAST_PIXELS = 15.0
"""Font size of text in small windows, in pixels of an ordinary display."""
MEASURE, WIDE_MEASURE, CARD_MEASURE = 34.0, 40.0, 29.0
"""Column widths in font sizes; a letter is about half a font size wide, so 34 are about 62 letters."""


@dataclass(frozen=True)
class Setting:
    """Text size (pixels) and column width (pixels) that a page is tried with."""

    text: int
    column: int

    def size(self, role: Role) -> int:
        """The font size of a kind of text, pixels."""
        if role == "title":
            return round(TITLE * self.text)
        return max(1, round(SMALL * self.text)) if role in ("small", "hint", "error", "sign") else self.text

    def leading(self, role: Role) -> int:
        """The height of a line of a kind of text, pixels."""
        return ceil((TITLE_LEADING if role == "title" else LEADING) * self.size(role))

    def space(self, sizes: float) -> int:
        """A distance given in text sizes, in pixels."""
        return round(sizes * self.text)


@dataclass(frozen=True)
class Block:
    """A part of a page, placed from its own top left corner."""

    height: int = 0
    texts: tuple[PlacedText, ...] = ()
    boxes: tuple[PlacedBox, ...] = ()
    sliders: tuple[PlacedSlider, ...] = ()
    rings: tuple[Rectangle, ...] = ()
    signs: tuple[Rectangle, ...] = ()
    track: Rectangle | None = None
    done: Rectangle | None = None


@lru_cache(maxsize=64)
def layout_page(page: Page, width: int, height: int, pixel_ratio: float) -> PageLayout:
    """A page in a window of width x height device pixels; pixel_ratio is device pixels per ordinary pixel."""
    measure = WIDE_MEASURE if page.strip else CARD_MEASURE if page.over_scene else MEASURE
    settings = _settings(width, height, pixel_ratio, measure)
    return _first_complete(lambda setting: _layout(page, width, height, setting), settings)


@lru_cache(maxsize=16)
def layout_caption(caption: str, width: int, height: int, pixel_ratio: float) -> PageLayout:
    """The line at the bottom of a scene, on a card of its own."""
    settings = _settings(width, height, pixel_ratio, MEASURE)
    return _first_complete(lambda setting: _caption(caption, width, height, setting), settings)


def _first_complete(lay_out: Callable[[Setting], PageLayout], settings: Sequence[Setting]) -> PageLayout:
    """The layout with the best setting that fits; nearly always the first."""
    first = lay_out(settings[0])
    if first.complete:
        return first
    fits = bisect_left(settings, True, key=lambda setting: lay_out(setting).complete)
    return lay_out(settings[min(fits, len(settings) - 1)])


def hit(layout: PageLayout, x: float, y: float) -> str | None:
    """The id of the box under a point, or of the scale with the value there, as `scale:3`, or None."""
    for placed in layout.sliders:
        if placed.rectangle.contains(x, y):
            return f"{placed.slider.id}:{placed.value_at(x):g}"
    return next((placed.box.id for placed in layout.boxes if placed.rectangle.contains(x, y)), None)


def _settings(width: int, height: int, pixel_ratio: float, measure: float) -> list[Setting]:
    """What to try, the best first: wider columns and smaller text in turn, then whatever fits."""
    unit = min(height, width / 1.25)
    best = max(TEXT_HEIGHT * unit, LEAST_PIXELS * pixel_ratio)
    least = max(LEAST_TEXT_HEIGHT * unit, 0.75 * LEAST_PIXELS * pixel_ratio)
    middle = 0.5 * (best + least)
    room = max(1, width - 2 * round(0.06 * width))
    tried = [(best, measure), *((size, WIDE_MEASURE) for size in _shrinking(best, middle))]
    tried += [(size, 1.25 * WIDE_MEASURE) for size in _shrinking(middle, least)]
    tried += [(least, wider * WIDE_MEASURE) for wider in (1.5, 2.0, 3.0)]
    tried += [(size, 5.0 * WIDE_MEASURE) for size in _shrinking(least, 4.0)]
    return [Setting(max(1, round(size)), min(round(wide * size), room)) for size, wide in tried]


def _shrinking(first: float, last: float) -> list[float]:
    """Sizes from the first to the last in steps of some six per cent."""
    steps = max(1, ceil(log(first / last) / 0.06)) if first > last else 1
    return [first * (last / first) ** (i / steps) for i in range(steps + 1)]


def _layout(page: Page, width: int, height: int, setting: Setting) -> PageLayout:
    content = _stack(_content(page, setting))
    if page.strip:
        return _in_strip(page, content, width, height, setting)
    hint = _text(clean(page.hint), "hint", setting) if page.hint.strip() else Block()
    gap = setting.space(1.6) if hint.height and content.height else 0
    left = (width - setting.column) // 2
    margin = round(0.055 * height)
    needed = content.height + gap + hint.height
    card = None
    if page.over_scene:
        padding = setting.space(1.8)
        top = max((height - needed) // 2, 0)
        hint_top = top + content.height + gap
        card = Rectangle(left, top, setting.column, needed).grown(padding) if needed else None
        complete = needed + 2 * padding <= height
    else:
        hint_top = height - margin - hint.height
        room = hint_top - gap - content.height
        complete = room >= margin
        top = max(min(round(TITLE_TOP * height), room), margin)
    whole = _join([_moved(content, left, top), _moved(hint, left, hint_top)])
    return PageLayout(
        width, height, setting.text / 10, whole.texts, whole.boxes, whole.sliders, whole.rings, whole.signs,
        whole.track, whole.done, card, complete,
    )  # fmt: skip


def _in_strip(page: Page, content: Block, width: int, height: int, setting: Setting) -> PageLayout:
    """Content in the middle of the page's strip; a question alone is centred."""
    if not page.rows:
        texts = tuple(replace(t, rectangle=replace(t.rectangle, x=(setting.column - t.rectangle.width) // 2))
                      for t in content.texts)  # fmt: skip
        content = replace(content, texts=texts)
    strip = round(page.strip * height)
    top = height - strip + (strip - content.height) // 2
    placed = _moved(content, (width - setting.column) // 2, top)
    return PageLayout(
        width, height, setting.text / 10, placed.texts, placed.boxes, placed.sliders, placed.rings, placed.signs,
        complete=content.height <= 0.86 * strip,
    )  # fmt: skip


def _content(page: Page, setting: Setting) -> list[tuple[int, Block]]:
    """Parts of a page from top to bottom, each with the space above it."""
    parts: list[tuple[int, Block]] = []
    before = ""
    for line in page.lines:
        parts.append((setting.space(1.0 if before == "title" else 0.75), _line(line, setting)))
        before = line.kind
    if page.progress is not None:
        parts.append((setting.space(1.4), _progress(page.progress, setting)))
    for row in page.rows:
        parts.append((setting.space(1.5 if row.prompt else 1.9), _row(row, setting)))
    return parts


def _line(line: Line, setting: Setting) -> Block:
    text = clean(line.text)
    return _error(text, setting) if line.kind == "error" else _text(text, line.kind, setting)


def _text(text: str, role: Role, setting: Setting, indent: int = 0) -> Block:
    """A paragraph, from the left or, in a right-to-left script, from the right."""
    size, leading = setting.size(role), setting.leading(role)
    room = max(1, setting.column - indent)
    to_right = is_right_to_left(text)
    texts = []
    for i, line in enumerate(break_lines(text, size, role == "title", room)):
        width = ceil(width_of(line, size, role == "title"))
        at = Rectangle(indent, i * leading, width, leading)
        texts.append(PlacedText(line, role, size, at.mirrored(setting.column) if to_right else at))
    return Block(len(texts) * leading, tuple(texts))


def _error(text: str, setting: Setting) -> Block:
    """A message after a disc with an exclamation mark."""
    leading, side = setting.leading("error"), setting.space(0.95)
    disc = Rectangle(0, (leading - side) // 2, side, side)
    disc = disc.mirrored(setting.column) if is_right_to_left(text) else disc
    message = _text(text, "error", setting, indent=setting.space(1.4))
    mark = _centred("!", "sign", setting, disc)
    return replace(message, texts=(mark, *message.texts), signs=(disc,))


def _progress(progress: float, setting: Setting) -> Block:
    height = max(3, setting.space(0.28))
    part = min(max(progress, 0.0), 1.0)
    return Block(
        height,
        track=Rectangle(0, 0, setting.column, height),
        done=Rectangle(0, 0, round(part * setting.column), height),
    )


def _row(row: Row, setting: Setting) -> Block:
    """A prompt, its boxes, and what is wrong with the answer."""
    parts: list[tuple[int, Block]] = []
    prompt = clean(row.prompt)
    to_right = is_right_to_left(prompt or "".join(box.label for box in row.boxes))
    if prompt.strip():
        parts.append((0, _text(prompt, "prompt", setting)))
    boxes = _boxes(row.boxes, setting, bool(row.error), to_right)
    if row.slider is not None:
        boxes = _scale(row.slider, boxes, setting)
        boxes = _elsewhere(boxes, lambda at: at.mirrored(setting.column)) if to_right else boxes
    parts.append((setting.space(0.5), boxes))
    if row.error.strip():
        parts.append((setting.space(0.45), _error(clean(row.error), setting)))
    elif row.slider is not None:  # so that a scale stays where it is when the sentence comes
        parts.append((setting.space(0.45), Block(setting.leading("error"))))
    return _stack(parts)


def _scale(slider: Slider, boxes: Block, setting: Setting) -> Block:
    """A scale, and right of it the boxes at the height of its track."""
    button = _around([placed.rectangle for placed in boxes.boxes])
    scale, texts, height = placed_slider(slider, setting.column - button.width - setting.space(1.5), setting)
    place = _mover(setting.column - button.right, (scale.rectangle.height - button.height) // 2)
    beside = tuple(_box_elsewhere(placed, place) for placed in boxes.boxes)
    return Block(max(height, button.height), texts, beside, (scale,))


def _boxes(boxes: Sequence[Box], setting: Setting, faulty: bool, to_right: bool) -> Block:
    """Boxes side by side, on as many lines as they need, and a ring around what has the keyboard.

    to_right: from the right, as a right-to-left script has them.
    """
    placed: list[PlacedBox] = []
    x = y = line_height = 0
    for box in boxes:
        new = _box(box, setting, faulty, to_right)
        if x and x + new.rectangle.width > setting.column:
            x, y, line_height = 0, y + line_height + setting.space(0.5), 0
        placed.append(_box_elsewhere(new, _mover(x, y)))
        x += new.rectangle.width + setting.space(0.7 if box.kind == "option" else 1.0)
        line_height = max(line_height, new.rectangle.height)
    focused = [p.rectangle for p in placed if p.box.focused]
    if len(focused) > 1 and len(focused) == len(placed):
        focused = [_around(focused)]
    rings = tuple(rectangle.grown(max(4, setting.space(0.26))) for rectangle in focused)
    block = Block(y + line_height if placed else 0, boxes=tuple(placed), rings=rings)
    return _elsewhere(block, lambda at: at.mirrored(setting.column)) if to_right else block


def _box(box: Box, setting: Setting, faulty: bool, to_right: bool) -> PlacedBox:
    if box.kind == "field":
        return _field(box, setting, faulty, to_right)
    return _option(box, setting, faulty) if box.kind == "option" else _button(box, setting)


def _field(box: Box, setting: Setting, faulty: bool, to_right: bool) -> PlacedBox:
    """What is typed, kept to its end when it is long; the caret stands where the next letter goes."""
    size, height, padding, leading = setting.text, setting.space(2.0), setting.space(0.6), setting.leading("label")
    at = Rectangle(0, 0, min(setting.column, setting.space(20)), height)
    caret_width, caret_height = max(2, setting.space(0.07)), round(1.15 * size)
    typed = last_part(clean(box.label), size, False, max(at.width - 2 * padding - 2 * caret_width, 1))
    width = ceil(width_of(typed, size))
    against = has_direction(typed) and is_right_to_left(typed) != to_right
    text_at = Rectangle(padding + 2 * caret_width * against, (height - leading) // 2, width, leading)
    caret_x = padding if against else padding + width + caret_width
    caret = Rectangle(caret_x, (height - caret_height) // 2, caret_width, caret_height)
    texts = (PlacedText(typed, "label", size, text_at),) if typed.strip() else ()
    return PlacedBox(box, at, texts, caret=caret if box.focused else None, faulty=faulty)


def _option(box: Box, setting: Setting, faulty: bool) -> PlacedBox:
    """A pill with a circle, checked when chosen, and a label of one or more lines."""
    padding, above, side = setting.space(0.75), setting.space(0.22), setting.space(1.0)
    indent = padding + side + setting.space(0.5)
    texts = _label(box.label, "chosen" if box.chosen else "label", setting, indent, padding, above)
    mark = Rectangle(padding, above + (setting.leading("label") - side) // 2, side, side)
    at = Rectangle(0, 0, _around([t.rectangle for t in texts]).right + padding, texts[-1].rectangle.bottom + above)
    if box.chosen:
        texts = (*texts, _centred("✓", "check", replace(setting, text=round(0.85 * setting.text)), mark))
    return PlacedBox(box, at, texts, mark=mark, faulty=faulty)


def _button(box: Box, setting: Setting) -> PlacedBox:
    """A label in the middle of a box that is not too narrow to aim at."""
    padding, above = setting.space(1.3), setting.space(0.28)
    texts = _label(box.label, "button", setting, padding, padding, above)
    needed = _around([text.rectangle for text in texts]).right + padding
    at = Rectangle(0, 0, max(needed, min(setting.space(6), setting.column)), texts[-1].rectangle.bottom + above)
    middle = tuple(replace(t, rectangle=replace(t.rectangle, x=(at.width - t.rectangle.width) // 2)) for t in texts)
    return PlacedBox(box, at, middle)


def _label(label: str, role: Role, setting: Setting, left: int, right: int, above: int) -> tuple[PlacedText, ...]:
    """The lines of a label in a box with that much room around them, no wider than the column."""
    size, leading = setting.size(role), setting.leading(role)
    lines = break_lines(clean(label), size, False, max(1, setting.column - left - right))
    return tuple(
        PlacedText(line, role, size, Rectangle(left, above + i * leading, ceil(width_of(line, size)), leading))
        for i, line in enumerate(lines)
    )


def _caption(caption: str, width: int, height: int, setting: Setting) -> PageLayout:
    """Lines in the middle, near the bottom edge."""
    size, leading = round(0.85 * setting.text), setting.leading("small")
    lines = break_lines(clean(caption), size, False, setting.column)
    widths = [ceil(width_of(line, size)) for line in lines]
    padding, margin = setting.space(0.9), round(0.03 * height)
    above = setting.space(0.3)
    top = height - margin - above - len(lines) * leading
    texts = tuple(
        PlacedText(line, "text", size, Rectangle((width - w) // 2, top + i * leading, w, leading))
        for i, (line, w) in enumerate(zip(lines, widths, strict=True))
    )
    widest = max(widths)
    card = Rectangle(
        (width - widest) // 2 - padding, top - above, widest + 2 * padding, len(lines) * leading + 2 * above
    )
    return PageLayout(width, height, setting.text / 10, texts, card=card, complete=card.height < 0.3 * height)


def _centred(text: str, role: Role, setting: Setting, at: Rectangle) -> PlacedText:
    """A short text in the middle of a rectangle."""
    size, bold = setting.size(role), role in ("sign", "check")
    width = ceil(width_of(text, size, bold))
    place = Rectangle(at.x + (at.width - width) // 2, at.y, width, at.height)
    return PlacedText(text, role, size, place)


def _around(rectangles: Sequence[Rectangle]) -> Rectangle:
    left, top = min(r.x for r in rectangles), min(r.y for r in rectangles)
    right, bottom = max(r.right for r in rectangles), max(r.bottom for r in rectangles)
    return Rectangle(left, top, right - left, bottom - top)


def _stack(parts: Sequence[tuple[int, Block]]) -> Block:
    """Blocks one below the other; the first needs no space above."""
    placed: list[Block] = []
    y = 0
    for space, block in parts:
        y += space if placed else 0
        placed.append(_moved(block, 0, y))
        y += block.height
    return replace(_join(placed), height=y)


def _join(blocks: Sequence[Block]) -> Block:
    return Block(
        0,
        tuple(text for block in blocks for text in block.texts),
        tuple(box for block in blocks for box in block.boxes),
        tuple(slider for block in blocks for slider in block.sliders),
        tuple(ring for block in blocks for ring in block.rings),
        tuple(sign for block in blocks for sign in block.signs),
        next((block.track for block in blocks if block.track), None),
        next((block.done for block in blocks if block.done), None),
    )


def _moved(block: Block, right: int, down: int) -> Block:
    return _elsewhere(block, _mover(right, down))


def _mover(right: int, down: int) -> Callable[[Rectangle], Rectangle]:
    return lambda at: at.moved(right, down)


def _elsewhere(block: Block, place: Callable[[Rectangle], Rectangle]) -> Block:
    """The same block with every rectangle where `place` puts it."""
    return Block(
        block.height,
        tuple(replace(text, rectangle=place(text.rectangle)) for text in block.texts),
        tuple(_box_elsewhere(placed, place) for placed in block.boxes),
        tuple(slider.elsewhere(place) for slider in block.sliders),
        tuple(place(ring) for ring in block.rings),
        tuple(place(sign) for sign in block.signs),
        block.track and place(block.track),
        block.done and place(block.done),
    )


def _box_elsewhere(placed: PlacedBox, place: Callable[[Rectangle], Rectangle]) -> PlacedBox:
    return replace(
        placed,
        rectangle=place(placed.rectangle),
        texts=tuple(replace(text, rectangle=place(text.rectangle)) for text in placed.texts),
        mark=placed.mark and place(placed.mark),
        caret=placed.caret and place(placed.caret),
    )

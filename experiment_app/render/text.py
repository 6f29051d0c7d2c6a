"""Text to widths, lines and masks, in device pixels: cleaning, breaking into lines, drawing. Knows no GPU."""

from __future__ import annotations

import unicodedata
from bisect import bisect_left
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from experiment_app.render.fonts import Face, can_shape, face_for, is_invisible, main_face, needs_shaping, sized_font

OVERHANG = 0.2
"""Ink may reach this far beyond a line's width on both sides, in font sizes."""

LONELY = 0.15
"""A last line shorter than this part of the width looks lost."""

NO_LINE_STARTS_WITH = frozenset(
    "!%),.:;?]}»’”…、。々〉》」』】〕゛゜ゝゞァィゥェォッャュョヮぁぃぅぇぉっゃゅょゎー！），．：；？］｝"
)
NO_LINE_ENDS_WITH = frozenset("([{«‘“〈《「『【〔（［｛")


@lru_cache(maxsize=1024)
def clean(text: str) -> str:
    """Any string as text that can be set: composed, on one line, without control characters."""
    return "".join(map(_drawable, unicodedata.normalize("NFC", text)))


def _drawable(character: str) -> str:
    category = unicodedata.category(character)
    if category in ("Cc", "Zl", "Zp"):
        return " "
    return "\N{REPLACEMENT CHARACTER}" if category == "Cs" else character


@lru_cache(maxsize=1024)
def is_right_to_left(text: str) -> bool:
    """Whether the first letter with a direction is Hebrew, Arabic or the like."""
    for character in text:
        direction = unicodedata.bidirectional(character)
        if direction in ("L", "R", "AL"):
            return direction != "L"
    return False


def has_direction(text: str) -> bool:
    """Whether there is any letter with a direction; numbers alone have none."""
    return any(unicodedata.bidirectional(character) in ("L", "R", "AL") for character in text)


@lru_cache(maxsize=8192)
def width_of(text: str, size: int, bold: bool = False) -> float:
    """Width of a line in pixels; text must be clean, size is the font's in pixels."""
    return sum(_run_width(run, face, size) for run, face in _runs(text, bold))


@lru_cache(maxsize=1024)
def break_lines(text: str, size: int, bold: bool, width: float) -> tuple[str, ...]:
    """A clean paragraph as lines no wider than `width` pixels; a word that is wider itself is broken.

    Where as many lines allow it, the last is not left with a lonely word.
    """
    lines = _fill_lines(text, size, bold, width)
    if len(lines) > 1:
        for narrower in (1.0, 0.96, 0.92, 0.88):
            tried = _fill_lines(text, size, bold, narrower * width)
            if len(tried) == len(lines) and width_of(tried[-1], size, bold) > LONELY * width:
                return tried
    return lines


def _fill_lines(text: str, size: int, bold: bool, width: float) -> tuple[str, ...]:
    lines: list[str] = []
    line, line_width = "", 0.0
    for piece in _pieces(text):
        if line and line_width + width_of(piece.rstrip(), size, bold) > width:
            lines.append(line.rstrip())
            line, line_width = "", 0.0
        while width_of(piece.rstrip(), size, bold) > width and len(_clusters(piece)) > 1:
            head = _widest_start(piece, size, bold, width)
            lines.append(head)
            piece = piece[len(head) :]
        line, line_width = line + piece, line_width + width_of(piece, size, bold)
    if line.strip() or not lines:
        lines.append(line.rstrip())
    return tuple(lines)


def last_part(text: str, size: int, bold: bool, width: float) -> str:
    """A clean text, or when it is wider than `width` its end after an ellipsis, as a field shows what is typed."""
    if width_of(text, size, bold) <= width:
        return text
    clusters = _clusters(text)
    ends = ["…" + "".join(clusters[i:]) for i in range(1, len(clusters) + 1)]
    return ends[min(bisect_left(ends, True, key=lambda end: width_of(end, size, bold) <= width), len(ends) - 1)]


@lru_cache(maxsize=256)
def mask_of(text: str, size: int, bold: bool, height: int) -> NDArray[np.uint8]:
    """How much of every pixel a line of clean text covers.

    height:  of the line, pixels; the baseline is `baseline(size, height)` from the top.
    returns: (height, width + 2 overhangs) uint8; the text starts `overhang(size)` from the left.
    """
    margin = overhang(size)
    image = Image.new("L", (int(np.ceil(width_of(text, size, bold))) + 2 * margin, height))
    draw = ImageDraw.Draw(image)
    runs = _runs(text, bold)
    to_right = is_right_to_left(text)
    x = float(margin)
    for run, face in reversed(runs) if to_right else runs:
        shaped = needs_shaping(run)
        direction = ("rtl" if to_right else "ltr") if shaped and can_shape() else None
        font = sized_font(face, size, shaped)
        draw.text((x, baseline(size, height)), run, 255, font, anchor="ls", direction=direction)
        x += _run_width(run, face, size)
    mask = np.array(image, np.uint8)
    mask.flags.writeable = False
    return mask


def baseline(size: int, height: int) -> int:
    """Pixels from the top of a line to its baseline, so that capitals look centred in the line."""
    return round(0.5 * height + 0.36 * size)


def overhang(size: int) -> int:
    """Pixels on both sides of a line's mask that ink may reach into."""
    return round(OVERHANG * size)


def _run_width(run: str, face: Face, size: int) -> float:
    return float(sized_font(face, size, needs_shaping(run)).getlength(run))


@lru_cache(maxsize=8192)
def _runs(text: str, bold: bool) -> tuple[tuple[str, Face], ...]:
    """A text in pieces of one font each, in reading order. Marks and invisible characters stay with their base."""
    runs: list[tuple[str, Face]] = []
    for cluster in _clusters(text):
        if is_invisible(cluster[0]):
            face = runs[-1][1] if runs else main_face(bold)
        else:
            face = face_for(cluster[0], bold, text) or main_face(bold)
        if runs and runs[-1][1] == face:
            runs[-1] = (runs[-1][0] + cluster, face)
        else:
            runs.append((cluster, face))
    return tuple((run if needs_shaping(run) else _visible(run), face) for run, face in runs)


def _visible(run: str) -> str:
    """Without joiners and selectors, which a font without shaping would draw as boxes."""
    return "".join(c for c in run if not is_invisible(c) or unicodedata.category(c) == "Zs")


@lru_cache(maxsize=8192)
def _clusters(text: str) -> tuple[str, ...]:
    """A text in pieces that must not be parted: a character with the marks and joiners that follow it."""
    clusters: list[str] = []
    for character in text:
        joined = bool(clusters) and clusters[-1].endswith("\N{ZERO WIDTH JOINER}")
        follows = joined or unicodedata.category(character) in ("Mn", "Mc", "Me", "Cf")
        if follows and clusters and len(clusters[-1]) < 32:
            clusters[-1] += character
        else:
            clusters.append(character)
    return tuple(clusters)


def _pieces(text: str) -> list[str]:
    """A text in pieces between which a line may end: after spaces and hyphens, and between Han characters."""
    pieces: list[str] = []
    previous = ""
    for cluster in _clusters(text):
        if pieces and not _may_part(previous, cluster[0]):
            pieces[-1] += cluster
        else:
            pieces.append(cluster)
        previous = cluster[-1]
    return pieces


def _may_part(before: str, after: str) -> bool:
    if after == " " or after in NO_LINE_STARTS_WITH or before in NO_LINE_ENDS_WITH:
        return False
    if before in " -\N{ZERO WIDTH SPACE}\N{HYPHEN}\N{EN DASH}\N{EM DASH}":
        return before == " " or after.isalpha()
    return _is_ideographic(before) or _is_ideographic(after)


def _is_ideographic(character: str) -> bool:
    return 0x2E80 <= ord(character) <= 0xA4CF or 0xF900 <= ord(character) <= 0xFAFF or ord(character) >= 0x1F000


def _widest_start(text: str, size: int, bold: bool, width: float) -> str:
    """As much of a text as fits, at least one character with its marks."""
    clusters = _clusters(text)
    starts = ["".join(clusters[: i + 1]) for i in range(len(clusters))]
    return starts[max(0, bisect_left(starts, True, key=lambda start: width_of(start, size, bold) > width) - 1)]

"""Which font draws which character: DejaVu Sans first, because it is the same everywhere, then the system's.

Knows no layout and no GPU. Font files are opened once; the system's folders are only looked into when a text
needs a character that DejaVu Sans lacks.
"""

from __future__ import annotations

import os
import struct
import sys
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray
from PIL import ImageFont, features

OUTLINES = (b"glyf", b"CFF ", b"CFF2")
"""Tables of which a font must have one: bitmap and colour fonts cannot be drawn at any size."""

COLLECTION = b"ttcf"
"""The first bytes of a file with several fonts."""

UPRIGHT_WEIGHTS = ("regular", "book", "medium", "")
LAST_CHOICES = ("serif", "mono", "italic", "oblique", "condensed", "thin", "light", "black", "display", "looped")
"""Words in a file's name that make it a poor companion of an upright sans."""


Codes = NDArray[np.int64]
NOTHING: tuple[Codes, Codes] = (np.empty(0, np.int64), np.empty(0, np.int64))


@dataclass(frozen=True)
class Face:
    """One font of a file; index counts the fonts in a collection (.ttc)."""

    path: str
    index: int = 0


@cache
def main_face(bold: bool) -> Face:
    """DejaVu Sans as matplotlib carries it; matplotlib itself is not imported."""
    spec = find_spec("matplotlib")
    assert spec is not None
    assert spec.submodule_search_locations
    folder = Path(spec.submodule_search_locations[0]) / "mpl-data" / "fonts" / "ttf"
    return Face(str(folder / ("DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf")))


def face_for(character: str, bold: bool, neighbours: str = "") -> Face | None:
    """The font that draws a character, or None when no font here does.

    neighbours: the text around it. It decides between the Chinese, Japanese and Korean forms of a Han character.
    """
    return _face_for(ord(character), bold, _han_language(neighbours) if ord(character) > 0x2E7F else "")


def missing_glyphs(text: str) -> frozenset[str]:
    """The characters of a text that no font on this computer can draw; they would show as empty boxes."""
    return frozenset(c for c in text if not is_invisible(c) and face_for(c, False, text) is None)


def can_shape() -> bool:
    """Whether joined and right-to-left scripts can be set properly (Pillow found RAQM and FriBiDi)."""
    return bool(features.check_feature("raqm"))


@lru_cache(maxsize=8192)
def needs_shaping(text: str) -> bool:
    """Whether a text has right-to-left characters or marks that must be placed on others."""
    return any(
        ord(c) > 0x2FF and (unicodedata.category(c)[0] == "M" or unicodedata.bidirectional(c) in ("R", "AL", "AN"))
        for c in text
    )


def is_invisible(character: str) -> bool:
    """Whether a character has no ink of its own: spaces, controls, joiners, selectors of a variant or a skin tone."""
    code = ord(character)
    selects = 0xFE00 <= code <= 0xFE0F or 0x1F3FB <= code <= 0x1F3FF
    return selects or unicodedata.category(character) in ("Zs", "Zl", "Zp", "Cc", "Cf")


@lru_cache(maxsize=64)
def sized_font(face: Face, size: int, shaped: bool) -> ImageFont.FreeTypeFont:
    """A font at a size in pixels.

    shaped: with RAQM, for the scripts that need it. Others are set without, so that their pixels do not depend
    on what the system has.
    """
    engine = ImageFont.Layout.RAQM if shaped and can_shape() else ImageFont.Layout.BASIC
    return ImageFont.truetype(face.path, size, index=face.index, layout_engine=engine)


@lru_cache(maxsize=4096)
def _face_for(code: int, bold: bool, language: str) -> Face | None:
    if _covers(main_face(bold), code):
        return main_face(bold)
    if unicodedata.category(chr(code)) in ("Cn", "Co", "Cs"):
        return None
    faces = (face for path in _system_files(bold, language) for face in _faces_in(path, language))
    return next((face for face in faces if _covers(face, code)), None)


def _covers(face: Face, code: int) -> bool:
    starts, ends = _ranges(face)
    place = int(np.searchsorted(starts, code, side="right")) - 1
    return place >= 0 and code <= int(ends[place])


@cache
def _ranges(face: Face) -> tuple[Codes, Codes]:
    """First and last code points, (N,) each and sorted, of the ranges a font has outlines for.

    NOTHING for a file that cannot be read as a font, and for bitmap and colour fonts.
    """
    try:
        with open(face.path, "rb") as file:
            tables = _tables(file, face.index)
            if not any(tag in tables for tag in OUTLINES):
                return NOTHING
            offset, length = tables[b"cmap"]
            file.seek(offset)
            return _mapped(file.read(length))
    except (OSError, struct.error, ValueError, LookupError):
        return NOTHING


def _tables(file: BinaryIO, index: int) -> dict[bytes, tuple[int, int]]:
    """Where the tables of a font are: tag to (offset, length) in bytes, as in the OpenType specification."""
    start = 0
    if file.read(4) == COLLECTION:
        file.seek(12 + 4 * index)
        (start,) = struct.unpack(">I", file.read(4))
    file.seek(start + 4)
    (count,) = struct.unpack(">H6x", file.read(8))
    records = struct.iter_unpack(">4s4xII", file.read(16 * count))
    return {tag: (offset, length) for tag, offset, length in records}


def _mapped(cmap: bytes) -> tuple[Codes, Codes]:
    """The ranges of a cmap table: its Unicode subtable of format 12, else that of format 4."""
    (count,) = struct.unpack_from(">2xH", cmap)
    subtables = {}
    for platform, encoding, offset in struct.iter_unpack(">HHI", cmap[4 : 4 + 8 * count]):
        if platform == 0 or (platform == 3 and encoding in (1, 10)):
            subtables[struct.unpack_from(">H", cmap, offset)[0]] = offset
    if 12 in subtables:
        (groups,) = struct.unpack_from(">12xI", cmap, subtables[12])
        found = np.frombuffer(cmap, ">u4", 3 * groups, subtables[12] + 16).reshape(-1, 3)
        return found[:, 0].astype(np.int64), found[:, 1].astype(np.int64)
    start = subtables[4]
    segments = struct.unpack_from(">6xH", cmap, start)[0] // 2
    ends = np.frombuffer(cmap, ">u2", segments, start + 14)
    starts = np.frombuffer(cmap, ">u2", segments, start + 16 + 2 * segments)
    return starts[:-1].astype(np.int64), ends[:-1].astype(np.int64)


@cache
def _faces_in(path: str, language: str) -> tuple[Face, ...]:
    """The fonts of a file; of a collection, the one for the language first."""
    if not path.lower().endswith((".ttc", ".otc")):
        return (Face(path),)
    try:
        with open(path, "rb") as file:
            tag, _, count = struct.unpack(">4sII", file.read(12))
        fonts = min(count, 64) if tag == COLLECTION else 0
        names = [str(ImageFont.truetype(path, 12, index=i).getname()[0]).lower() for i in range(fonts)]
    except (OSError, ValueError, struct.error):
        return ()

    def rank(index: int) -> tuple[bool, bool, int]:
        return (bool(language) and language.lower() not in names[index].split(), "mono" in names[index], index)

    return tuple(Face(path, index) for index in sorted(range(fonts), key=rank))


@lru_cache(maxsize=1024)
def _han_language(text: str) -> str:
    """JP, KR or SC: whose form of a Han character, by the other scripts in the text."""
    if any(0x3040 <= ord(c) <= 0x30FF for c in text):
        return "JP"
    return "KR" if any(0x1100 <= ord(c) <= 0x11FF or 0xAC00 <= ord(c) <= 0xD7AF for c in text) else "SC"


@cache
def _system_files(bold: bool, language: str) -> tuple[str, ...]:
    """Font files of the system, those that go best with DejaVu Sans first, always in the same order."""

    def rank(path: str) -> tuple[bool, int, bool, bool, str, str]:
        name = Path(path).stem.lower()
        weight = name.rpartition("-")[2] if "-" in name else ""
        wanted = weight == "bold" if bold else weight in UPRIGHT_WEIGHTS
        return (
            bool(language) and "cjk" not in name,
            sum(word in name for word in LAST_CHOICES),
            not wanted,
            "sans" not in name,
            name,
            path,
        )

    return tuple(sorted(set(_font_files()), key=rank))


def _font_files() -> Iterator[str]:
    for folder in _font_folders():
        for parent, _, names in os.walk(folder):
            for name in names:
                if name.lower().endswith((".ttf", ".otf", ".ttc", ".otc")):
                    yield os.path.join(parent, name)


def _font_folders() -> tuple[Path, ...]:
    """Where this system keeps fonts."""
    home = Path.home()
    if sys.platform == "win32":
        local = Path(os.environ.get("LOCALAPPDATA", home))
        return (Path(os.environ.get("WINDIR", "C:/Windows")) / "Fonts", local / "Microsoft" / "Windows" / "Fonts")
    if sys.platform == "darwin":
        return (Path("/System/Library/Fonts"), Path("/Library/Fonts"), home / "Library" / "Fonts")
    shared = (os.environ.get("XDG_DATA_DIRS") or "/usr/local/share:/usr/share").split(":")
    return (home / ".local" / "share" / "fonts", home / ".fonts", *(Path(d) / "fonts" for d in shared if d))

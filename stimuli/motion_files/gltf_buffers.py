"""The containers and number arrays of glTF 2.0: .glb, .gltf with .bin files or embedded data. Knows no animation.

Specification: Khronos glTF 2.0, sections 3.6 (accessors) and 4 (GLB).
"""

from __future__ import annotations

import base64
import binascii
import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from stimuli.motion_files.errors import MotionFileError

Floats = NDArray[np.floating]

TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
LARGEST = 50_000_000  # numbers in one array; ten minutes of a body at 120 Hz are a tenth of it


@dataclass(frozen=True, eq=False)
class Document:
    """A glTF file's JSON and, for a .glb, its binary chunk."""

    path: Path
    json: dict[str, Any]
    chunk: bytes

    def items(self, name: str) -> list[dict[str, Any]]:
        """The list `name` of the JSON, empty if there is none; raises MotionFileError if it is no list of objects."""
        items = self.json.get(name, [])
        if not isinstance(items, list) or not all(isinstance(item, dict) for item in items):
            raise MotionFileError(f"{self.path}: {name!r} is no list of objects; export the file again")
        return items

    def item(self, name: str, index: object) -> dict[str, Any]:
        """Element `index` of list `name`."""
        items = self.items(name)
        if not isinstance(index, int) or isinstance(index, bool) or not 0 <= index < len(items):
            raise MotionFileError(f"{self.path}: {name}[{index}] is named but not in the file; export it again")
        return items[index]


def read_document(path: Path) -> Document:
    """Container and JSON of a .glb or .gltf file. Raises MotionFileError."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise MotionFileError(f"{path}: cannot be read ({error.strerror or error})") from error
    text, chunk = _glb_chunks(path, data) if data[:4] == b"glTF" else (data, b"")
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise MotionFileError(f"{path}: its JSON cannot be read ({error}); export it again") from error
    if not isinstance(content, dict):
        raise MotionFileError(f"{path}: is no glTF file, whose JSON is an object")
    asset = content.get("asset")
    version = str(asset.get("version", "")) if isinstance(asset, dict) else ""
    if version.split(".")[0] != "2":
        said = f"is glTF {version[:20]}" if version else "does not say which glTF it is (asset.version)"
        raise MotionFileError(f"{path}: {said}; only glTF 2.0 can be read: convert or export it again")
    return Document(path, content, chunk)


def _glb_chunks(path: Path, data: bytes) -> tuple[bytes, bytes]:
    chunks: dict[bytes, bytes] = {}
    place = 12
    while place + 8 <= len(data):
        length, kind = struct.unpack_from("<I4s", data, place)
        if place + 8 + length > len(data):
            raise MotionFileError(f"{path}: is cut off in the chunk at byte {place}; export it again")
        chunks.setdefault(kind, data[place + 8 : place + 8 + length])
        place += 8 + length
    if b"JSON" not in chunks:
        raise MotionFileError(f"{path}: holds no JSON chunk; export it again as glTF 2.0")
    return chunks[b"JSON"], chunks.get(b"BIN\0", b"")


def read_array(document: Document, index: object) -> Floats:
    """(count, width) float64 of an accessor: strides, normalised integers, sparse and missing buffers included."""
    accessor = document.item("accessors", index)
    place = f"{document.path}: accessors[{index}]"
    kind, width = TYPES.get(whole(accessor.get("componentType"))), WIDTHS.get(str(accessor.get("type")))
    count = whole(accessor.get("count"))
    if kind is None or width is None or not 0 < count * width <= LARGEST:
        raise MotionFileError(f"{place} has a type or count that glTF 2.0 does not know; export the file again")
    if "bufferView" in accessor:
        values = _view(document, accessor["bufferView"], accessor.get("byteOffset", 0), kind, count, width, place)
    else:
        values = np.zeros((count, width), dtype=kind)
    if "sparse" in accessor:
        values = _with_sparse(document, accessor["sparse"], values, place)
    numbers = values.astype(np.float64)
    if accessor.get("normalized") and kind[1] in "iu":
        numbers = np.maximum(numbers / np.iinfo(kind).max, -1.0)
    if not np.all(np.isfinite(numbers)):
        raise MotionFileError(f"{place} holds a value that is no finite number; export the file again")
    return numbers


def whole(value: object) -> int:
    """A JSON value as a whole number, -1 if it is none; true and false are none, though Python counts with them."""
    return value if isinstance(value, int) and not isinstance(value, bool) else -1


def _with_sparse(document: Document, sparse: Any, values: Any, place: str) -> Any:
    try:
        count, indices, replacing = sparse["count"], sparse["indices"], sparse["values"]
        kind = TYPES[indices["componentType"]]
        where = _view(document, indices["bufferView"], indices.get("byteOffset", 0), kind, count, 1, place)[:, 0]
        new = _view(
            document,
            replacing["bufferView"],
            replacing.get("byteOffset", 0),
            values.dtype.str,
            count,
            values.shape[1],
            place,
        )
        values = values.copy()
        values[where] = new
    except (KeyError, TypeError, IndexError, AttributeError) as error:
        raise MotionFileError(f"{place} has sparse values that do not fit it; export the file again") from error
    return values


def _view(document: Document, view_index: object, offset: Any, kind: str, count: Any, width: int, place: str) -> Any:
    view = document.item("bufferViews", view_index)
    data = _buffer(document, view.get("buffer"))
    numbers = [offset, count, view.get("byteOffset", 0), view.get("byteLength", 0)]
    size = np.dtype(kind).itemsize * width
    stride = view.get("byteStride") or size
    if not all(whole(n) >= 0 for n in (*numbers, stride)) or stride < size:
        raise MotionFileError(f"{place} has offsets or a stride that are no sizes in bytes; export the file again")
    start = numbers[2] + offset
    end = start + stride * (count - 1) + size
    if count < 1 or end > min(len(data), numbers[2] + numbers[3]):
        raise MotionFileError(f"{place} reaches beyond its buffer of {len(data)} bytes; the file is cut off")
    rows = np.ndarray((count, width), dtype=kind, buffer=data, offset=start, strides=(stride, np.dtype(kind).itemsize))
    return rows.copy()


def _buffer(document: Document, index: object) -> bytes:
    uri = document.item("buffers", index).get("uri")
    if uri is None:
        return document.chunk
    if not isinstance(uri, str):
        raise MotionFileError(f"{document.path}: buffers[{index}] has no address in words; export the file again")
    if uri.startswith("data:"):
        try:
            return base64.b64decode(uri.partition(",")[2], validate=False)
        except (binascii.Error, ValueError) as error:
            raise MotionFileError(f"{document.path}: buffers[{index}] is no base64 data; export it again") from error
    beside = document.path.parent / unquote(uri)
    folder = document.path.parent.resolve()
    try:
        if not beside.resolve().is_relative_to(folder):
            raise MotionFileError(f"{document.path}: its buffer {uri!r} lies outside the folder; put it beside it")
        return beside.read_bytes()
    except (OSError, ValueError) as error:
        if isinstance(error, MotionFileError):
            raise
        raise MotionFileError(f"{document.path}: its buffer {uri!r} cannot be read; put it beside the file") from error

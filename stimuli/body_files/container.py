"""The GLB container (glTF 2.0, section 4.4): a JSON document and one block of bytes. Knows no meshes."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from typing import Any

from stimuli.body_files.errors import BodyError

_MAGIC, _VERSION = b"glTF", 2
_JSON, _BIN = b"JSON", b"BIN\0"


@dataclass(frozen=True)
class Container:
    """The document as plain JSON values, and the bytes its buffer views point into."""

    document: dict[str, Any]
    block: bytes


def read_container(data: bytes, where: str) -> Container:
    """The parts of a GLB file; `where` names the file in the sentence when it is broken."""
    if len(data) < 20 or data[:4] != _MAGIC:
        raise BodyError(f"{where}: this is not a GLB file (it does not begin with 'glTF')")
    version, length = struct.unpack_from("<II", data, 4)
    if version != _VERSION:
        raise BodyError(f"{where}: glTF version {version} can't be read, only version 2; re-export it")
    if length > len(data):
        raise BodyError(f"{where}: the file is cut short ({len(data)} of {length} bytes); copy it again")
    chunks: dict[bytes, bytes] = {}
    place = 12
    while place + 8 <= length:
        size, kind = struct.unpack_from("<I4s", data, place)
        if place + 8 + size > length:
            raise BodyError(f"{where}: a chunk runs past the end of the file; copy it again")
        chunks.setdefault(kind, data[place + 8 : place + 8 + size])
        place += 8 + size
    if _JSON not in chunks:
        raise BodyError(f"{where}: the GLB file has no JSON chunk")
    try:
        document = json.loads(chunks[_JSON].decode("utf-8"))
    except (ValueError, RecursionError) as error:
        raise BodyError(f"{where}: the JSON chunk can't be read ({type(error).__name__})") from error
    if not isinstance(document, dict):
        raise BodyError(f"{where}: the JSON chunk does not hold an object")
    return Container(document, chunks.get(_BIN, b""))


def write_container(container: Container) -> bytes:
    """The bytes of a GLB file: the same container always gives the same bytes."""
    text = json.dumps(container.document, separators=(",", ":")).encode("utf-8")
    text += b" " * (-len(text) % 4)
    block = container.block + b"\0" * (-len(container.block) % 4)
    length = 12 + 8 + len(text) + 8 + len(block)
    return b"".join(
        [
            struct.pack("<4sII", _MAGIC, _VERSION, length),
            struct.pack("<I4s", len(text), _JSON),
            text,
            struct.pack("<I4s", len(block), _BIN),
            block,
        ]
    )

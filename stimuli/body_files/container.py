"""glTF containers (glTF 2.0, sections 3.6.1 and 4.4): a JSON document and the bytes it points into. Knows no meshes."""

from __future__ import annotations

import base64
import binascii
import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from stimuli.body_files.errors import BodyError

_MAGIC, _VERSION = b"glTF", 2
_JSON, _BIN = b"JSON", b"BIN\0"


@dataclass(frozen=True)
class Container:
    """The document as plain JSON values, and its buffers as bytes, in the document's order."""

    document: dict[str, Any]
    buffers: tuple[bytes, ...]


def open_container(path: Path) -> Container:
    """A .glb file, or a .gltf file with its buffers embedded or in files beside it."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise BodyError(f"{path.name}: the file can't be opened ({error.strerror})") from error
    if data[:4] == _MAGIC:
        return read_container(data, path.name)
    if path.suffix.lower() == ".fbx" or data[:18] == b"Kaydara FBX Binary":
        raise BodyError(f"{path.name}: FBX can't be read; convert it first, e.g. FBX2glTF --binary {path.name}")
    document = _document(data, path.name)
    buffers = document.get("buffers", [])
    if not isinstance(buffers, list):
        raise BodyError(f"{path.name}: 'buffers' is not a list")
    return Container(document, tuple(_buffer(buffer, path) for buffer in buffers))


def read_container(data: bytes, where: str) -> Container:
    """The parts of a GLB file; `where` names the file in the sentence when it is broken."""
    if len(data) < 20 or data[:4] != _MAGIC:
        raise BodyError(f"{where}: this is not a GLB file (it does not begin with 'glTF')")
    version, length = struct.unpack_from("<II", data, 4)
    if version != _VERSION:
        raise BodyError(f"{where}: {other_version(str(version), where)}")
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
    return Container(_document(chunks[_JSON], where), (chunks.get(_BIN, b""),))


def write_container(container: Container) -> bytes:
    """The bytes of a GLB file: the same container always gives the same bytes."""
    text = json.dumps(container.document, separators=(",", ":")).encode("utf-8")
    text += b" " * (-len(text) % 4)
    (block,) = container.buffers
    block += b"\0" * (-len(block) % 4)
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


def _document(text: bytes, where: str) -> dict[str, Any]:
    try:
        document = json.loads(text.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise BodyError(f"{where}: its JSON can't be read ({type(error).__name__}); is it a glTF file?") from error
    if not isinstance(document, dict):
        raise BodyError(f"{where}: its JSON does not hold an object; is it a glTF file?")
    _check_version(document.get("asset"), where)
    return document


def _check_version(asset: Any, where: str) -> None:
    """Raises BodyError unless the file says it is glTF 2 and asks for no later minor version (section 3.2)."""
    version = asset.get("version") if isinstance(asset, dict) else None
    if version is None:
        raise BodyError(f"{where}: it does not say which glTF it is (asset.version); export it again as glTF 2.0")
    least = str(asset.get("minVersion", "2.0"))
    if str(version).split(".")[0] != "2" or least != "2.0":
        raise BodyError(f"{where}: {other_version(str(version) if least == '2.0' else least, where)}")


def other_version(version: str, where: str) -> str:
    """What is said of a file in another glTF than 2.0, whose meshes and materials are written in another way."""
    way_out = f"convert it first: gltf-pipeline -i {where} -o converted.glb" if version[:1] in "01" else "re-export it"
    return f"glTF {version[:20]} can't be read, only glTF 2.0; {way_out}"


def _buffer(buffer: Any, path: Path) -> bytes:
    """Bytes of one buffer of a .gltf file: from a data address or from a file in the same folder or below."""
    uri = buffer.get("uri") if isinstance(buffer, dict) else None
    if not isinstance(uri, str):
        raise BodyError(f"{path.name}: a buffer names no data")
    if uri.startswith("data:"):
        try:
            return base64.b64decode(uri.partition(",")[2], validate=False)
        except (binascii.Error, ValueError) as error:
            raise BodyError(f"{path.name}: an embedded buffer is not valid base64") from error
    folder = path.parent.resolve()
    target = (folder / unquote(uri)).resolve()
    if not target.is_relative_to(folder):
        raise BodyError(f"{path.name}: the buffer {uri!r} lies outside the file's own folder")
    try:
        return target.read_bytes()
    except OSError as error:
        raise BodyError(f"{path.name}: its data file {uri!r} can't be opened; keep both files together") from error

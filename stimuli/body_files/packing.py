"""Any glTF container as one GLB file: buffers joined, pictures taken in. Knows no meshes."""

from __future__ import annotations

import copy
from pathlib import Path
from urllib.parse import unquote

from stimuli.body_files.container import Container, write_container
from stimuli.body_files.errors import BodyError

KINDS = {".png": "image/png", ".jpg": "image/jpeg", ".jpeg": "image/jpeg", ".webp": "image/webp"}


def packed(container: Container, path: Path) -> bytes:
    """The bytes of a GLB file that needs no other file; pictures that are missing stay missing."""
    document = copy.deepcopy(container.document)
    parts: list[bytes] = []
    starts: list[int] = []

    def added(data: bytes) -> int:
        start = sum(len(part) for part in parts)
        parts.append(data + b"\0" * (-len(data) % 4))
        return start

    for data in container.buffers:
        starts.append(added(data))
    views = document.setdefault("bufferViews", [])
    for view in views:
        view["byteOffset"] = int(view.get("byteOffset", 0)) + starts[int(view.get("buffer", 0))]
        view["buffer"] = 0
    folder = path.parent.resolve()
    for image in document.get("images", []):
        uri = str(image.get("uri", ""))
        if not uri or uri.startswith("data:"):
            continue
        target = (folder / unquote(uri)).resolve()
        if not target.is_relative_to(folder):
            raise BodyError(f"{path.name}: the picture {uri!r} lies outside the file's own folder")
        if target.is_file():
            data = target.read_bytes()
            views.append({"buffer": 0, "byteOffset": added(data), "byteLength": len(data)})
            del image["uri"]
            image["bufferView"] = len(views) - 1
            image["mimeType"] = KINDS.get(target.suffix.lower(), "image/png")
    document["buffers"] = [{"byteLength": sum(len(part) for part in parts)}]
    return write_container(Container(document, (b"".join(parts),)))

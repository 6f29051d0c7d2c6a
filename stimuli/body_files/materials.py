"""Materials of a glTF file: colour, roughness, base-colour picture and what its alpha means. Knows no mesh."""

from __future__ import annotations

import base64
import binascii
import io
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from stimuli.body_files.accessors import item, whole
from stimuli.body_files.container import Container
from stimuli.body_files.errors import BodyError
from stimuli.skeleton import Floats

LARGEST = 16_000_000
"""Pixels of the largest picture that is read."""

Picture = NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class Material:
    """How a surface looks.

    colour: (4,) linear RGB and alpha; picture: (H, W, 4) sRGB and alpha, or None; texture_set: which coordinates it
    takes; to_picture: (2, 3) from those coordinates to the picture's; problem: why a picture is missing, or "".
    """

    name: str
    colour: Floats
    roughness: float
    picture: Picture | None
    texture_set: int
    to_picture: Floats
    alpha: Literal["opaque", "mask", "blend"]
    alpha_cutoff: float
    double_sided: bool = False
    problem: str = ""


PLAIN = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
GREY = (0.5, 0.5, 0.5, 1.0)


def read_materials(container: Container, path: Path) -> Callable[[int | None], Material]:
    """Material by its number; a picture that several use is decoded once."""
    pictures: dict[int, Picture | str] = {}

    def picture(index: int) -> Picture | str:
        if index not in pictures:
            pictures[index] = _picture(container, index, path)
        return pictures[index]

    def material(index: int | None) -> Material:
        if index is None:
            return Material("", np.array(GREY), 1.0, None, 0, PLAIN, "opaque", 0.5)
        return _material(item(container, "materials", index, path.name), index, picture)

    return material


def _material(raw: dict[str, Any], index: int, picture: Callable[[int], Picture | str]) -> Material:
    pbr = raw.get("pbrMetallicRoughness", {})
    glossy = raw.get("extensions", {}).get("KHR_materials_pbrSpecularGlossiness", {})
    texture = glossy.get("diffuseTexture") or pbr.get("baseColorTexture")
    factor = glossy.get("diffuseFactor") or pbr.get("baseColorFactor") or ((1, 1, 1, 1) if texture else GREY)
    roughness = 1.0 - float(glossy["glossinessFactor"]) if "glossinessFactor" in glossy else None
    found, problem, texture_set, to_picture = None, "", 0, PLAIN
    if texture is not None:
        read = picture(int(texture["index"]))
        found, problem = (None, read) if isinstance(read, str) else (read, "")
        texture_set = int(texture.get("texCoord", 0))
        moved = texture.get("extensions", {}).get("KHR_texture_transform")
        if moved is not None:
            to_picture = _transform(moved)
            texture_set = int(moved.get("texCoord", texture_set))
    mode = str(raw.get("alphaMode", "OPAQUE")).lower()
    name = str(raw.get("name", f"material {index}"))
    if texture is None and "emissiveTexture" in raw:
        problem = f"the picture of {name!r} is one that glows (emissive), which is not drawn; make it its base colour"
    return Material(
        name=name,
        colour=np.clip(np.array([*(float(c) for c in factor), 1.0][:4]), 0, 1),
        roughness=float(np.clip(float(pbr.get("roughnessFactor", 1.0)) if roughness is None else roughness, 0.05, 1)),
        picture=found,
        texture_set=texture_set,
        to_picture=to_picture,
        alpha="mask" if mode == "mask" else "blend" if mode == "blend" else "opaque",
        alpha_cutoff=float(np.clip(float(raw.get("alphaCutoff", 0.5)), 0, 1)),
        double_sided=bool(raw.get("doubleSided", False)),
        problem=problem,
    )


def _transform(moved: dict[str, Any]) -> Floats:
    """(2, 3) of KHR_texture_transform: scale, then turn, then shift."""
    angle = float(moved.get("rotation", 0.0))
    scale = np.diag([float(v) for v in moved.get("scale", (1, 1))])
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    return np.column_stack([turn @ scale, [float(v) for v in moved.get("offset", (0, 0))]])


def _picture(container: Container, texture: int, path: Path) -> Picture | str:
    """The pixels of a texture, or a sentence saying why there are none."""
    raw = item(container, "textures", texture, path.name)
    extensions = raw.get("extensions", {})
    source = extensions.get("EXT_texture_webp", {}).get("source", raw.get("source"))
    if source is None:
        kinds = ", ".join(extensions) or "no format"
        return f"a picture is stored as {kinds}, which can't be read; re-export it as PNG or JPEG"
    image = item(container, "images", source, path.name)
    name = str(image.get("uri") or image.get("name") or f"image {source}")[:60]
    try:
        data = _bytes(container, image, path)
    except OSError as error:
        return f"the picture {name!r} can't be opened ({error.strerror}); keep it beside the file"
    try:
        with Image.open(io.BytesIO(data)) as opened:
            if opened.width * opened.height > LARGEST:
                return f"the picture {name!r} has {opened.width}x{opened.height} pixels; make it smaller"
            return np.asarray(opened.convert("RGBA"))
    except Exception:  # a damaged picture makes Pillow's readers raise almost anything
        return f"the picture {name!r} can't be read; re-export it as PNG or JPEG"


def _bytes(container: Container, image: dict[str, Any], path: Path) -> bytes:
    if "bufferView" in image:
        view = item(container, "bufferViews", image["bufferView"], path.name)
        start = whole(view.get("byteOffset", 0), path.name, "byteOffset")
        length = whole(view.get("byteLength"), path.name, "byteLength")
        buffer = whole(view.get("buffer"), path.name, "a buffer view's buffer")
        if buffer >= len(container.buffers):
            raise BodyError(f"{path.name}: a picture lies in buffer {buffer}, which does not exist")
        return container.buffers[buffer][start : start + length]
    uri = str(image.get("uri", ""))
    if uri.startswith("data:"):
        try:
            return base64.b64decode(uri.partition(",")[2])
        except (binascii.Error, ValueError):
            return b""
    folder = path.parent.resolve()
    target = (folder / unquote(uri)).resolve()
    if not target.is_relative_to(folder):
        raise BodyError(f"{path.name}: the picture {uri!r} lies outside the file's own folder")
    return target.read_bytes()

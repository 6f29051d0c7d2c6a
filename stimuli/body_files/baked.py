"""Reads the bodies gaitlab bakes itself (see `baking`) back into arrays."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from stimuli.bodies.body import MOST_BLUSH, Body, Surface
from stimuli.body_files.accessors import item, read_accessor
from stimuli.body_files.container import Container, read_container
from stimuli.body_files.errors import BodyError
from stimuli.skeleton import JOINTS, PARENTS, Floats, Skeleton

_LEVEL = re.compile(r"lod(\d)(?: (hair:.+))?")


def read_baked(data: bytes, where: str, hair: str | None = None) -> Body:
    """The body in a GLB file made by gaitlab's generator; `hair` picks a haircut, None takes the first one."""
    container = read_container(data, where)
    try:
        return _body(container, where, hair)
    except BodyError:
        raise
    except (KeyError, IndexError, TypeError, AttributeError, ValueError, OverflowError) as error:
        raise BodyError(f"{where}: the file is not laid out as a gaitlab body ({type(error).__name__})") from error


def _body(container: Container, where: str, hair: str | None) -> Body:
    document = container.document
    about = document["extras"]["gaitlab"]
    chosen = _haircut(about["hair"], hair, where)
    nodes = document["nodes"]
    if not isinstance(nodes, list) or [n.get("name") for n in nodes[: len(JOINTS)]] != list(JOINTS):
        raise BodyError(f"{where}: the joints are not gaitlab's {len(JOINTS)}; it is not a body baked by gaitlab")
    offsets = np.array([_three(n["translation"], where) for n in nodes[: len(JOINTS)]])
    skeleton = Skeleton(offsets)
    to_metres = _to_metres(container, skeleton, where)
    levels: dict[int, list[Surface]] = {}
    for node in nodes[len(JOINTS) :]:
        match = _LEVEL.fullmatch(str(node.get("name")))
        if match and match.group(2) in (None, chosen):
            mesh = item(container, "meshes", node.get("mesh"), where)
            read = [_surface(container, primitive, to_metres, where) for primitive in mesh["primitives"]]
            levels.setdefault(int(match.group(1)), []).extend(read)
    if sorted(levels) != list(range(len(levels))) or not levels:
        raise BodyError(f"{where}: the levels of detail lod0, lod1, ... are not complete")
    stature = float(about["stature"])
    if not 0.3 < stature < 3.5:
        raise BodyError(f"{where}: the stature is {stature} m")
    return Body(str(about["name"]), skeleton, stature, tuple(tuple(levels[i]) for i in range(len(levels))))


def haircuts(data: bytes, where: str) -> tuple[str, ...]:
    """Names of the haircuts in a baked file."""
    about = read_container(data, where).document.get("extras", {}).get("gaitlab", {})
    return tuple(str(name).removeprefix("hair:") for name in about.get("hair", ()))


def _haircut(styles: list[str], wanted: str | None, where: str) -> str | None:
    if wanted is None:
        return styles[0] if styles else None
    if f"hair:{wanted}" not in styles:
        known = ", ".join(s.removeprefix("hair:") for s in styles)
        raise BodyError(f"{where}: there is no haircut {wanted!r}; known are {known}")
    return f"hair:{wanted}"


def _three(values: Any, where: str) -> Floats:
    numbers = np.array([float(v) for v in values])
    if numbers.shape != (3,) or not np.all(np.isfinite(numbers)) or np.max(np.abs(numbers)) > 10:
        raise BodyError(f"{where}: a joint's place is not three numbers in metres")
    return numbers


def _to_metres(container: Container, skeleton: Skeleton, where: str) -> Floats:
    """(3, 4) from stored positions to the bind pose: root joint times its inverse bind matrix."""
    skin = item(container, "skins", 0, where)
    matrices = read_accessor(container, skin.get("inverseBindMatrices"), where)
    if matrices.shape != (len(JOINTS), 16) or not np.all(np.isfinite(matrices)):
        raise BodyError(f"{where}: the skin does not have {len(JOINTS)} inverse bind matrices")
    root = matrices[0].astype(np.float64).reshape(4, 4).T
    found: Floats = np.column_stack([root[:3, :3], root[:3, 3] + skeleton.positions[PARENTS.index(-1)]])
    return found


def _surface(container: Container, primitive: dict[str, Any], to_metres: Floats, where: str) -> Surface:
    material = item(container, "materials", primitive.get("material"), where)
    attributes = primitive["attributes"]
    stored, normals, colour, joints, weights = (
        read_accessor(container, attributes.get(name), where)
        for name in ("POSITION", "NORMAL", "COLOR_0", "JOINTS_0", "WEIGHTS_0")
    )
    triangles = read_accessor(container, primitive.get("indices"), where).astype(np.int64)
    counts = {len(stored), len(normals), len(colour), len(joints), len(weights)}
    columns = [a.shape[1] for a in (stored, normals, colour, joints, weights)]
    if len(counts) != 1 or columns != [3, 3, 4, 4, 4] or len(stored) == 0:
        raise BodyError(f"{where}: the attributes of {material.get('name')!r} do not have the same length")
    if triangles.size % 3 or triangles.size == 0 or int(triangles.max()) >= len(stored):
        raise BodyError(f"{where}: the triangles of {material.get('name')!r} name vertices that do not exist")
    if joints.dtype.kind != "u" or int(joints.max()) >= len(JOINTS):
        raise BodyError(f"{where}: {material.get('name')!r} hangs on joints that do not exist")
    values = np.concatenate([stored, normals, colour[:, :3], weights], axis=1)
    total = weights.sum(axis=1, keepdims=True)
    if not np.all(np.isfinite(values)) or np.any(weights < 0) or np.any(np.abs(total - 1) > 0.01):
        raise BodyError(f"{where}: weights or positions of {material.get('name')!r} are not usable numbers")
    positions = stored @ to_metres[:, :3].T + to_metres[:, 3]
    if np.max(np.abs(positions)) > 10:
        raise BodyError(f"{where}: {material.get('name')!r} reaches further than 10 m")
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    pbr = material["pbrMetallicRoughness"]
    return Surface(
        name=str(material["name"]).split(":")[0],
        colour=_three(pbr["baseColorFactor"][:3], where),
        roughness=float(pbr["roughnessFactor"]),
        positions=positions,
        normals=normals / np.where(length > 0, length, 1),
        occlusion=colour[:, 0].astype(np.float64),
        joints=joints.astype(np.int64),
        weights=weights / total,
        triangles=triangles.reshape(-1, 3),
        blush=_blush(colour),
        knot=_knot(material, where),
    )


def _knot(material: dict[str, Any], where: str) -> float | None:
    knot = material.get("extras", {}).get("gaitlab", {}).get("knot")
    if knot is None:
        return None
    if not 0 < float(knot) < 3.5:
        raise BodyError(f"{where}: the knot of {material.get('name')!r} is {knot} m above the ground")
    return float(knot)


def _blush(colour: Floats) -> Floats | None:
    """(V,) of skin, from how much less green than red a vertex shows; None where all are grey."""
    red, green = colour[:, 0].astype(np.float64), colour[:, 1].astype(np.float64)
    if np.array_equal(red, green):
        return None
    return np.asarray(np.clip(1 - green / np.maximum(red, 1e-3), 0, MOST_BLUSH))

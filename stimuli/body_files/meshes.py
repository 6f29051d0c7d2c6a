"""The meshes of a glTF file as arrays: vertices, triangles and what moves them (glTF 2.0, section 3.7.2).

Triangle strips and fans come out as triangles. A vertex that no joint moves takes the weights of the nearest one of its
mesh that has some: on any one joint it would stay behind as soon as the rest walks.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stimuli.bodies.body import Integers
from stimuli.body_files.accessors import Array, read_accessor
from stimuli.body_files.container import Container
from stimuli.body_files.errors import BodyError
from stimuli.skeleton import Floats

TRIANGULAR = LIST, STRIP, FAN = 4, 5, 6
"""Modes of primitives that are drawn; the others are points and lines."""


SHORTEST_NORMAL = 0.1
"""Length below which a stored normal, which should be 1 long, says nothing."""


@dataclass(frozen=True, eq=False)
class Primitive:
    """Vertices of one material, as a file stores them.

    mesh:           the mesh it belongs to; material: its number, None without.
    positions:      (V, 3); triangles: (T, 3).
    joints:         (V, K) places in the skin's list, weights: (V, K) summing to 1; both None when nothing skins it.
    texture_places: (V, 2) per set of coordinates, empty without; normals: (V, 3) of any length, None without.
    weightless:     how many vertices had no weight of their own.
    coloured:       whether the file paints its vertices other than white.
    """

    mesh: int
    material: int | None
    positions: Floats
    joints: Integers | None
    weights: Floats | None
    triangles: Integers
    texture_places: tuple[Floats, ...] = ()
    normals: Floats | None = None
    weightless: int = 0
    coloured: bool = False


def read_primitive(container: Container, mesh: int, primitive: dict[str, Any], where: str) -> Primitive:
    """One primitive of the mesh with this number; raises BodyError when its arrays do not fit each other."""
    attributes = primitive["attributes"]
    positions = read_accessor(container, attributes.get("POSITION"), where).astype(np.float64)
    if positions.shape[1] != 3 or not np.all(np.isfinite(positions)):
        raise BodyError(f"{where}: a mesh has positions that are not finite")
    joints, weights, weightless = _influences(container, attributes, positions, where)
    return Primitive(
        mesh=mesh,
        material=primitive.get("material"),
        positions=positions,
        joints=joints,
        weights=weights,
        triangles=_triangles(container, primitive, len(positions), where),
        texture_places=_texture_places(container, attributes, len(positions), where),
        normals=_normals(container, attributes, len(positions), where),
        weightless=weightless,
        coloured=_painted(container, attributes, where),
    )


def _triangles(container: Container, primitive: dict[str, Any], count: int, where: str) -> Integers:
    """(T, 3) vertices of every triangle, counter-clockwise as the file's, of a list, a strip or a fan."""
    indices = np.arange(count)
    if "indices" in primitive:
        stored = read_accessor(container, primitive["indices"], where).ravel()
        if stored.dtype.kind != "u":
            raise BodyError(f"{where}: a mesh counts its vertices in {stored.dtype.name}, which glTF does not allow")
        indices = stored.astype(np.int64)
    mode = primitive.get("mode", LIST)
    if mode == STRIP and len(indices) > 2:
        turned = np.arange(len(indices) - 2) % 2  # every other triangle of a strip is written the other way round
        starts = np.arange(len(indices) - 2)
        indices = np.stack([indices[starts], indices[starts + 1 + turned], indices[starts + 2 - turned]], axis=1)
    elif mode == FAN and len(indices) > 2:
        indices = np.stack([indices[1:-1], indices[2:], np.full(len(indices) - 2, indices[0])], axis=1)
    elif "indices" not in primitive:
        indices = indices[: len(indices) // 3 * 3]
    if indices.size % 3 or (indices.size and int(indices.max()) >= count):
        raise BodyError(f"{where}: a mesh has triangles that name vertices which do not exist")
    return indices.reshape(-1, 3)


def _texture_places(container: Container, attributes: dict[str, Any], count: int, where: str) -> tuple[Floats, ...]:
    """(V, 2) of every set of texture coordinates, in order."""
    found: list[Floats] = []
    while f"TEXCOORD_{len(found)}" in attributes:
        values = read_accessor(container, attributes[f"TEXCOORD_{len(found)}"], where).astype(np.float64)
        if values.shape != (count, 2) or not np.all(np.isfinite(values)):
            raise BodyError(f"{where}: texture coordinates of a mesh do not match its vertices")
        found.append(values)
    return tuple(found)


def _normals(container: Container, attributes: dict[str, Any], count: int, where: str) -> Floats | None:
    """(V, 3) the file's own normals, where it has usable ones."""
    if "NORMAL" not in attributes:
        return None
    values = read_accessor(container, attributes["NORMAL"], where).astype(np.float64)
    if values.shape != (count, 3):
        raise BodyError(f"{where}: normals of a mesh do not match its vertices")
    usable = np.all(np.isfinite(values)) and np.all(np.linalg.norm(values, axis=1) > SHORTEST_NORMAL)
    return values if usable else None


def _painted(container: Container, attributes: dict[str, Any], where: str) -> bool:
    if "COLOR_0" not in attributes:
        return False
    return bool(np.any(read_accessor(container, attributes["COLOR_0"], where)[:, :3] < 0.99))


def _influences(
    container: Container, attributes: dict[str, Any], positions: Floats, where: str
) -> tuple[Integers | None, Floats | None, int]:
    """Joints and weights of all sets, normalised, and how many vertices had none of their own."""
    sets = [n for n in range(8) if f"JOINTS_{n}" in attributes and f"WEIGHTS_{n}" in attributes]
    if not sets:
        return None, None, 0
    stored = [_rows(container, attributes[f"JOINTS_{n}"], len(positions), where) for n in sets]
    if any(part.dtype.kind != "u" for part in stored):
        raise BodyError(f"{where}: a mesh names its joints in a type of number that glTF does not allow")
    joints = np.hstack(stored).astype(np.int64)
    parts = [_rows(container, attributes[f"WEIGHTS_{n}"], len(positions), where) for n in sets]
    weights = np.hstack(parts).astype(np.float64)
    if not np.all(np.isfinite(weights)) or np.any(weights < 0):
        raise BodyError(f"{where}: a mesh has weights that are negative or not finite")
    total = weights.sum(axis=1)
    if len(total) and not total.any():
        raise BodyError(f"{where}: all joint weights of a mesh are 0; export the file again with its skin weights")
    without = total == 0
    if without.any():
        nearest = _nearest(positions[without], positions[~without])
        joints[without], weights[without] = joints[~without][nearest], weights[~without][nearest]
    joints = np.where(weights > 0, joints, 0)
    return joints, weights / weights.sum(axis=1, keepdims=True), int(without.sum())


def _nearest(points: Floats, among: Floats) -> Integers:
    """(N,) which of `among` (M, 3) is nearest to each of `points` (N, 3)."""
    from scipy.spatial import cKDTree  # here, because most files need none

    found: Integers = cKDTree(among).query(points)[1]
    return found


def _rows(container: Container, accessor: Any, count: int, where: str) -> Array:
    values = read_accessor(container, accessor, where)
    if values.shape != (count, 4):
        raise BodyError(f"{where}: joints or weights of a mesh do not match its vertices")
    return values

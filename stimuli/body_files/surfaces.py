"""From meshes of a file, their vertices in place, to the surfaces of a body: pictures, normals, which side is seen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stimuli.bodies.body import Integers, Surface
from stimuli.body_files.materials import Material
from stimuli.body_files.placing import Placed
from stimuli.skeleton import Floats

MOST_MATERIALS = 24  # as the renderer's shaders have room for


def surface_of(material: Material, placed: Placed, joints: Integers, weights: Floats) -> Surface:
    """A mesh in its material, placed in metres; joints and weights (V, 4) of its vertices.

    A mirrored one has its triangles turned over, or its inside would be seen.
    """
    primitive, positions = placed.primitive, placed.points
    triangles = primitive.triangles[:, ::-1] if placed.mirrored else primitive.triangles
    normals = _normals(positions, triangles) if placed.normals is None else _units(placed.normals)
    places = None
    picture = material.picture
    if picture is not None and material.texture_set < len(primitive.texture_places):
        stored = primitive.texture_places[material.texture_set]
        places = stored @ material.to_picture[:, :2].T + material.to_picture[:, 2]
    return Surface(
        name=material.name or f"mesh {placed.node}",
        colour=material.colour[:3],
        roughness=material.roughness,
        positions=positions,
        normals=normals,
        occlusion=np.ones(len(positions)),
        joints=joints,
        weights=weights,
        triangles=triangles,
        picture=picture if places is not None else None,
        picture_at=places,
        alpha=material.alpha,
        alpha_cutoff=material.alpha_cutoff,
        alpha_factor=float(material.colour[3]),
        double_sided=material.double_sided,
    )


def merged(surfaces: tuple[Surface, ...]) -> tuple[Surface, ...]:
    """Surfaces of the same look joined into one, in the order of their first."""
    groups: dict[tuple[object, ...], list[Surface]] = {}
    for s in surfaces:
        key = (
            s.name,
            *s.colour.tolist(),
            s.roughness,
            id(s.picture),
            s.alpha,
            s.alpha_cutoff,
            s.alpha_factor,
            s.double_sided,
        )
        groups.setdefault(key, []).append(s)
    return tuple(_joined(group) for group in groups.values())


def _joined(group: list[Surface]) -> Surface:
    if len(group) == 1:
        return group[0]
    starts = np.cumsum([0, *(len(s.positions) for s in group[:-1])])
    places = [s.picture_at for s in group if s.picture_at is not None]
    return replace(
        group[0],
        positions=np.concatenate([s.positions for s in group]),
        normals=np.concatenate([s.normals for s in group]),
        occlusion=np.concatenate([s.occlusion for s in group]),
        joints=np.concatenate([s.joints for s in group]),
        weights=np.concatenate([s.weights for s in group]),
        triangles=np.concatenate([s.triangles + start for s, start in zip(group, starts, strict=True)]),
        picture_at=np.concatenate(places) if places else None,
    )


def _normals(positions: Floats, triangles: Integers) -> Floats:
    """(V, 3) area-weighted means of the faces round each vertex, vertices at the same place taken together."""
    a, b, c = (positions[triangles[:, i]] for i in range(3))
    faces = np.cross(b - a, c - a)
    _, group = np.unique(np.round(positions, 5), axis=0, return_inverse=True)
    total = np.zeros((int(group.max()) + 1, 3))
    for corner in range(3):
        np.add.at(total, group.ravel()[triangles[:, corner]], faces)
    return _units(total[group.ravel()])


def _units(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12))

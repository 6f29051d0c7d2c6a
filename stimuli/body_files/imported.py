"""A laboratory's own character: any skinned glTF 2.0 person as a body with gaitlab's 21 joints."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from stimuli.body import Body, Integers, Surface
from stimuli.body_files.container import Container, open_container
from stimuli.body_files.errors import BodyError
from stimuli.body_files.humanoid import Humanoid, bind_matrices, understand
from stimuli.body_files.scene import GltfScene, Primitive, placed_vertices, read_scene
from stimuli.skeleton import JOINTS, PARENTS, Floats, Skeleton

GREY = np.array([0.5, 0.5, 0.5])


def import_body(path: Path) -> Body:
    """The person in a .glb or .gltf file, in one level of detail, without textures (their colour factor is kept)."""
    container = open_container(path)
    try:
        return _person(container, path)
    except BodyError:
        raise
    except (KeyError, IndexError, TypeError, AttributeError, ValueError, OverflowError) as error:
        raise BodyError(f"{path.name}: the file breaks glTF's own rules ({type(error).__name__})") from error


def _person(container: Container, path: Path) -> Body:
    scene = read_scene(container, path.name)
    skin = _main_skin(scene, path.name)
    worn = _worn(scene)
    binds = bind_matrices(scene, skin)
    bound = [_bound(scene, node, primitive, binds, path.name) for node, primitive in worn]
    everything = np.concatenate([points for _, points in bound])
    person = understand(container, scene, skin, everything, path.name)
    surfaces = tuple(
        _surface(container, person, node, primitive, carried, points)
        for (node, primitive), (carried, points) in zip(worn, bound, strict=True)
        if len(primitive.triangles)
    )
    if not surfaces:
        raise BodyError(f"{path.name}: its skinned meshes have no triangles")
    offsets = person.positions - np.array([person.positions[p] if p >= 0 else np.zeros(3) for p in PARENTS])
    stature = max(float(s.positions[:, 1].max()) for s in surfaces)
    return Body(path.stem, Skeleton(offsets), stature, (surfaces,))


def bounding_box(path: Path) -> tuple[Floats, Floats]:
    """Lowest and highest corner (3,) of all vertices as the file shows them, in its own units."""
    vertices = placed_vertices(read_scene(open_container(path), path.name))
    if len(vertices) == 0:
        raise BodyError(f"{path.name}: it holds no triangles")
    return vertices.min(axis=0), vertices.max(axis=0)


def _main_skin(scene: GltfScene, where: str) -> int:
    """The skin with the most joints among those that are worn."""
    used = {n.skin for n in scene.nodes if n.skin is not None and n.mesh is not None}
    if not used:
        raise BodyError(f"{where}: no mesh hangs on a skeleton; export it with its armature and skin weights")
    return max(sorted(used), key=lambda s: len(scene.skins[s].joints))


def _worn(scene: GltfScene) -> list[tuple[int, Primitive]]:
    """Skinned primitives with their node. Meshes hung whole on a joint (props) are left out."""
    return [
        (index, primitive)
        for index, node in enumerate(scene.nodes)
        for primitive in scene.primitives
        if node.skin is not None and primitive.mesh == node.mesh and primitive.joints is not None
    ]


def _bound(scene: GltfScene, node: int, primitive: Primitive, binds: Floats, where: str) -> tuple[Integers, Floats]:
    """Node indices (V, K) that carry each vertex, and the vertices (V, 3) in the bind pose, in scene space."""
    own = scene.skins[scene.nodes[node].skin or 0]
    assert primitive.joints is not None
    assert primitive.weights is not None
    if int(primitive.joints.max(initial=0)) >= len(own.joints):
        raise BodyError(f"{where}: a mesh hangs on joints its skin does not have")
    matrices = binds[own.joints] @ own.inverse_binds
    points = np.column_stack([primitive.positions, np.ones(len(primitive.positions))])
    blended = np.einsum("vk,vkij->vij", primitive.weights, matrices[primitive.joints])
    return own.joints[primitive.joints], np.einsum("vij,vj->vi", blended, points)[:, :3]


def _surface(
    container: Container, person: Humanoid, node: int, primitive: Primitive, carried: Integers, points: Floats
) -> Surface:
    positions = points @ person.to_person[:, :3].T + person.to_person[:, 3]
    material = _material(container, primitive.material)
    pbr = material.get("pbrMetallicRoughness", {})
    colour = np.array([float(c) for c in pbr.get("baseColorFactor", [*GREY, 1])[:3]])
    assert primitive.weights is not None
    joints, weights = _four(person.places[carried], primitive.weights)
    return Surface(
        name=str(material.get("name", f"mesh {node}")),
        colour=np.clip(colour, 0, 1),
        roughness=float(np.clip(float(pbr.get("roughnessFactor", 1.0)), 0.05, 1)),
        positions=positions,
        normals=_normals(positions, primitive.triangles),
        occlusion=np.ones(len(positions)),
        joints=joints,
        weights=weights,
        triangles=primitive.triangles,
    )


def _material(container: Container, index: Any) -> dict[str, Any]:
    materials = container.document.get("materials", [])
    found: dict[str, Any] = materials[index] if isinstance(index, int) and 0 <= index < len(materials) else {}
    return found


def _four(places: Floats, weights: Floats) -> tuple[Integers, Floats]:
    """(V, 4) joints and weights: summed per role, the four largest kept."""
    dense = np.zeros((len(places), len(JOINTS)))
    for column in range(places.shape[1]):
        np.add.at(dense, (np.arange(len(places)), places[:, column].astype(np.int64)), weights[:, column])
    order = np.argsort(-dense, axis=1, kind="stable")[:, :4]
    kept = np.take_along_axis(dense, order, axis=1)
    return order, kept / kept.sum(axis=1, keepdims=True)


def _normals(positions: Floats, triangles: Integers) -> Floats:
    """(V, 3) area-weighted means of the faces round each vertex, vertices at the same place taken together."""
    a, b, c = (positions[triangles[:, i]] for i in range(3))
    faces = np.cross(b - a, c - a)
    _, group = np.unique(np.round(positions, 5), axis=0, return_inverse=True)
    total = np.zeros((int(group.max()) + 1, 3))
    for corner in range(3):
        np.add.at(total, group.ravel()[triangles[:, corner]], faces)
    normals = total[group.ravel()]
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)

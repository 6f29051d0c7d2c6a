"""Where a glTF scene shows the vertices of its meshes. Knows nothing of people.

Vertices follow glTF 2.0 section 3.7.3: a skinned mesh ignores its node's own transform; joints take the place
`world of the joint x inverse bind matrix`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stimuli.body_files.meshes import Primitive
from stimuli.body_files.scene import GltfScene, world_matrices
from stimuli.skeleton import Floats


@dataclass(frozen=True, eq=False)
class Placed:
    """A primitive as a node shows it: its vertices (V, 3) and normals (V, 3) of any length in the scene, None where
    the file has none, and whether they are mirrored there."""

    node: int
    primitive: Primitive
    points: Floats
    normals: Floats | None
    mirrored: bool


def placed_primitives(scene: GltfScene) -> tuple[Placed, ...]:
    """All primitives of all meshes where the scene shows them, in the file's units."""
    world = world_matrices(scene.nodes)
    return tuple(
        _placed(scene, world, index, primitive)
        for index, node in enumerate(scene.nodes)
        for primitive in scene.primitives
        if primitive.mesh == node.mesh
    )


def placed_vertices(scene: GltfScene) -> Floats:
    """(V, 3) all vertices of all meshes where the scene shows them, in the file's units."""
    parts = [placed.points for placed in placed_primitives(scene)]
    return np.concatenate(parts) if parts else np.zeros((0, 3))


def _placed(scene: GltfScene, world: Floats, index: int, primitive: Primitive) -> Placed:
    node = scene.nodes[index]
    if node.skin is None or primitive.joints is None:
        return moved(index, primitive, world[index][None])
    skin = scene.skins[node.skin]
    return moved(index, primitive, blended_matrices(primitive, world[skin.joints] @ skin.inverse_binds))


def moved(node: int, primitive: Primitive, matrices: Floats) -> Placed:
    """A node's primitive moved by matrices (V, 4, 4) of its vertices, or by one (1, 4, 4) for all.

    Normals are turned by the cofactors, which keeps them upright on a surface that is stretched.
    """
    turn = matrices[:, :3, :3]
    points = np.einsum("vij,vj->vi", np.broadcast_to(turn, (len(primitive.positions), 3, 3)), primitive.positions)
    sizes = np.linalg.det(turn)
    normals = None
    if primitive.normals is not None:
        rows = [np.cross(turn[:, (i + 1) % 3], turn[:, (i + 2) % 3]) for i in range(3)]
        cofactors = np.stack(rows, axis=1) * np.sign(sizes)[:, None, None]
        normals = np.einsum("vij,vj->vi", np.broadcast_to(cofactors, (len(points), 3, 3)), primitive.normals)
    mirrored = bool(len(sizes) and np.median(sizes) < 0)
    return Placed(node, primitive, points + matrices[:, :3, 3], normals, mirrored)


def blended_matrices(primitive: Primitive, matrices: Floats) -> Floats:
    """(V, 4, 4) what moves each vertex of a skinned primitive, by the matrices (J, 4, 4) of its skin's joints."""
    assert primitive.weights is not None
    assert primitive.joints is not None
    return np.asarray(np.einsum("vk,vkij->vij", primitive.weights, matrices[primitive.joints]))

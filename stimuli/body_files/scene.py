"""Any glTF 2.0 scene as arrays: nodes, skins and its meshes (meshes.py). Knows no people."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stimuli.bodies.body import Integers
from stimuli.body_files.accessors import item, read_accessor
from stimuli.body_files.container import Container
from stimuli.body_files.errors import BodyError
from stimuli.body_files.meshes import TRIANGULAR, Primitive, read_primitive
from stimuli.skeleton import Floats

MOST_JOINTS, MOST_TRIANGLES = 256, 500_000
UNDERSTOOD = frozenset(
    {
        "KHR_mesh_quantization",
        "KHR_materials_unlit",
        "KHR_texture_transform",
        "KHR_materials_pbrSpecularGlossiness",
        "EXT_texture_webp",
        "VRM",
        "VRMC_vrm",
    }
)


@dataclass(frozen=True, eq=False)
class Node:
    """A node of the scene tree: parent (-1 for a root), local place as translation, rotation xyzw and scale.

    matrix: (4, 4) local transform when the file gives one instead; it can't be animated.
    """

    name: str
    parent: int
    translation: Floats
    rotation: Floats
    scale: Floats
    matrix: Floats | None
    mesh: int | None
    skin: int | None


@dataclass(frozen=True, eq=False)
class Skin:
    """joints: (J,) node indices; inverse_binds: (J, 4, 4)."""

    joints: Integers
    inverse_binds: Floats


@dataclass(frozen=True, eq=False)
class GltfScene:
    """What a file holds of geometry."""

    nodes: tuple[Node, ...]
    skins: tuple[Skin, ...]
    primitives: tuple[Primitive, ...]


def read_scene(container: Container, where: str) -> GltfScene:
    """All nodes, skins and triangle meshes of a file's own scene, or a sentence saying why it can't be shown."""
    document = container.document
    strange = sorted(set(map(str, document.get("extensionsRequired", []))) - UNDERSTOOD)
    if strange:
        raise BodyError(f"{where}: it needs {', '.join(strange)}, which gaitlab can't read; re-export without it")
    try:
        nodes = _only_shown(document, _nodes(document, where), where)
        skins = tuple(_skin(container, skin, len(nodes), where) for skin in document.get("skins", []))
        primitives = tuple(
            read_primitive(container, m, primitive, where)
            for m, mesh in enumerate(document.get("meshes", []))
            for primitive in mesh["primitives"]
            if primitive.get("mode", 4) in TRIANGULAR
        )
    except (KeyError, IndexError, TypeError, AttributeError, ValueError, OverflowError) as error:
        if isinstance(error, BodyError):
            raise
        raise BodyError(f"{where}: the file breaks glTF's own rules ({type(error).__name__}: {error})") from error
    total = sum(len(p.triangles) for p in primitives)
    if total > MOST_TRIANGLES:
        raise BodyError(f"{where}: it has {total} triangles, more than {MOST_TRIANGLES}; simplify it first")
    scene = GltfScene(nodes, skins, primitives)
    _check_worn_joints(scene, where)
    return scene


def _check_worn_joints(scene: GltfScene, where: str) -> None:
    """Raises BodyError when a mesh names a joint that the skin it wears does not have."""
    for index, node in enumerate(scene.nodes):
        for primitive in scene.primitives:
            if node.skin is None or primitive.mesh != node.mesh or primitive.joints is None:
                continue
            count = len(scene.skins[node.skin].joints)
            if primitive.joints.size and int(primitive.joints.max()) >= count:
                raise BodyError(
                    f"{where}: mesh {node.mesh} at node {index} names joint {int(primitive.joints.max())}, but its "
                    f"skin has {count}; export the file again"
                )


def local_matrix(node: Node) -> Floats:
    """(4, 4) from the node's frame to its parent's."""
    if node.matrix is not None:
        return node.matrix
    x, y, z, w = node.rotation / max(float(np.linalg.norm(node.rotation)), 1e-12)
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, :3] *= node.scale
    matrix[:3, 3] = node.translation
    return matrix


def world_matrices(nodes: tuple[Node, ...]) -> Floats:
    """(N, 4, 4) from every node's frame to the scene's."""
    found: dict[int, Floats] = {}

    def world(index: int) -> Floats:
        if index not in found:
            node = nodes[index]
            found[index] = local_matrix(node) if node.parent < 0 else world(node.parent) @ local_matrix(node)
        return found[index]

    return np.array([world(i) for i in range(len(nodes))]).reshape(-1, 4, 4)


def _nodes(document: dict[str, Any], where: str) -> tuple[Node, ...]:
    raw = document.get("nodes", [])
    parents = [-1] * len(raw)
    for parent, node in enumerate(raw):
        for child in node.get("children", []):
            if parents[child] >= 0 or child == parent:
                raise BodyError(f"{where}: node {child} has two parents")
            parents[child] = parent
    for start in range(len(raw)):
        at, steps = start, 0
        while at >= 0:
            at, steps = parents[at], steps + 1
            if steps > len(raw) or steps > 500:
                raise BodyError(f"{where}: its nodes are each other's parents, or nested more than 500 deep")
    found = []
    for index, node in enumerate(raw):
        matrix = _numbers(node["matrix"], 16, where).reshape(4, 4).T if "matrix" in node else None
        found.append(
            Node(
                name=str(node.get("name", "")),
                parent=parents[index],
                translation=_numbers(node.get("translation", (0, 0, 0)), 3, where),
                rotation=_numbers(node.get("rotation", (0, 0, 0, 1)), 4, where),
                scale=_numbers(node.get("scale", (1, 1, 1)), 3, where),
                matrix=matrix,
                mesh=node.get("mesh"),
                skin=node.get("skin"),
            )
        )
    for node in found:
        if node.skin is not None:
            item(Container(document, ()), "skins", node.skin, where)
    return tuple(found)


def _only_shown(document: dict[str, Any], nodes: tuple[Node, ...], where: str) -> tuple[Node, ...]:
    """The nodes, without their meshes those outside the scene that the file shows; without scenes it shows all."""
    if not document.get("scenes"):
        return nodes
    scene = item(Container(document, ()), "scenes", document.get("scene", 0), where)
    roots = set(scene.get("nodes", ()))

    def is_shown(index: int) -> bool:
        while index >= 0:
            if index in roots:
                return True
            index = nodes[index].parent
        return False

    return tuple(node if is_shown(i) else replace(node, mesh=None) for i, node in enumerate(nodes))


def _numbers(values: Any, count: int, where: str) -> Floats:
    numbers = np.array([float(v) for v in values])
    if numbers.shape != (count,) or not np.all(np.isfinite(numbers)):
        raise BodyError(f"{where}: a node's transform is not {count} finite numbers")
    return numbers


def _skin(container: Container, skin: dict[str, Any], nodes: int, where: str) -> Skin:
    joints = np.array(skin["joints"], dtype=np.int64)
    if joints.ndim != 1 or len(joints) == 0 or joints.min() < 0 or joints.max() >= nodes:
        raise BodyError(f"{where}: a skin names joints that do not exist")
    if len(joints) > MOST_JOINTS:
        raise BodyError(f"{where}: a skin has {len(joints)} joints, more than {MOST_JOINTS}")
    binds = np.tile(np.eye(4), (len(joints), 1, 1))
    if "inverseBindMatrices" in skin:
        stored = read_accessor(container, skin["inverseBindMatrices"], where)
        if stored.shape[1] != 16 or len(stored) < len(joints) or not np.all(np.isfinite(stored)):
            raise BodyError(f"{where}: a skin's inverse bind matrices are too few or not usable")
        binds = stored[: len(joints)].astype(np.float64).reshape(-1, 4, 4).transpose(0, 2, 1)
    return Skin(joints, binds)

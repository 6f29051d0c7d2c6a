"""A laboratory's own character: any skinned glTF 2.0 person as a body with gaitlab's 21 joints."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from stimuli.bodies.body import Body, Integers, Surface
from stimuli.body_files.container import Container, open_container
from stimuli.body_files.errors import BodyError
from stimuli.body_files.humanoid import Humanoid, bind_matrices, understand
from stimuli.body_files.materials import Material, read_materials
from stimuli.body_files.meshes import Primitive
from stimuli.body_files.notes import notes_on_document, notes_on_meshes, notes_on_skeleton
from stimuli.body_files.placing import Placed, blended_matrices, moved, placed_vertices
from stimuli.body_files.scene import GltfScene, read_scene
from stimuli.body_files.surfaces import MOST_MATERIALS, merged, surface_of
from stimuli.body_files.weights import four_largest, per_role, with_stiff_soles
from stimuli.skeleton import PARENTS, Floats, Skeleton

WITH_WEIGHTS = "export it with its armature and skin weights"
COARSER = re.compile(r"(?i)(^|[_ .-])lod[_ ]?[1-9]")
"""In the names of nodes that show the same body again with fewer triangles."""


@dataclass(frozen=True)
class Explained:
    """What was understood of a file beside the body itself.

    source: how joints were told apart: "VRM", a table of names, or "shape"; joints: role -> the file's name for it;
    props: meshes left out because they hang on no skin; problems: sentences about what is missing or not drawn.
    """

    source: str
    joints: dict[str, str]
    joints_in_file: int
    props: int
    problems: tuple[str, ...]


def import_body(path: Path) -> Body:
    """The person in a .glb or .gltf file, in one level of detail, with base-colour pictures."""
    return import_and_explain(path)[0]


def import_and_explain(path: Path) -> tuple[Body, Explained]:
    """The person in a file, and what was understood of it."""
    container = open_container(path)
    try:
        return _person(container, path)
    except BodyError:
        raise
    except (KeyError, IndexError, TypeError, AttributeError, ValueError, OverflowError) as error:
        raise BodyError(f"{path.name}: the file breaks glTF's own rules ({type(error).__name__})") from error


def _person(container: Container, path: Path) -> tuple[Body, Explained]:
    scene = read_scene(container, path.name)
    skin = _main_skin(scene, path.name)
    worn, elsewhere = _worn(scene, skin)
    if not worn:
        raise BodyError(f"{path.name}: its meshes say not which joints move them (JOINTS_0, WEIGHTS_0); {WITH_WEIGHTS}")
    binds = bind_matrices(scene, skin, path.name)
    bound = [_bound(scene, node, primitive, binds, path.name) for node, primitive in worn]
    everything = np.concatenate([placed.points for _, placed in bound])
    person = understand(container, scene, skin, everything, path.name)
    material = read_materials(container, path)
    surfaces = tuple(
        _surface(material(placed.primitive.material), person, carried, placed)
        for carried, placed in bound
        if len(placed.primitive.triangles)
    )
    if not surfaces:
        raise BodyError(f"{path.name}: its skinned meshes have no triangles")
    offsets = person.positions - np.array([person.positions[p] if p >= 0 else np.zeros(3) for p in PARENTS])
    stature = max(float(s.positions[:, 1].max()) for s in surfaces)
    if len(surfaces) > MOST_MATERIALS:
        surfaces = merged(surfaces)
    if len(surfaces) > MOST_MATERIALS:
        raise BodyError(f"{path.name}: it has {len(surfaces)} materials, more than {MOST_MATERIALS}; join some first")
    props = sum(node.mesh is not None and node.skin is None for node in scene.nodes)
    explained = Explained(
        source=person.source,
        joints={role: scene.nodes[node].name or f"node {node}" for role, node in person.roles.items()},
        joints_in_file=len(scene.skins[skin].joints),
        props=props,
        problems=(
            *notes_on_skeleton(elsewhere, person.swapped),
            *notes_on_meshes([p for _, p in worn], material),
            *notes_on_document(container.document),
        ),
    )
    return Body(path.stem, Skeleton(offsets), stature, (surfaces,)), explained


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
        raise BodyError(f"{where}: no mesh hangs on a skeleton; {WITH_WEIGHTS}")
    return max(sorted(used), key=lambda s: len(scene.skins[s].joints))


def _worn(scene: GltfScene, skin: int) -> tuple[list[tuple[int, Primitive]], int]:
    """Skinned primitives with their node, of the finest level of detail where nodes are named after theirs.

    Meshes hung whole on a joint (props) are left out, and so are those on another skeleton than that of the skin; how
    many these are is the second value.
    """
    worn = [
        (index, primitive)
        for index, node in enumerate(scene.nodes)
        for primitive in scene.primitives
        if node.skin is not None and primitive.mesh == node.mesh and primitive.joints is not None
    ]
    own = {s for s in range(len(scene.skins)) if _of_one_skeleton(scene, skin, s)}
    ours = [pair for pair in worn if scene.nodes[pair[0]].skin in own]
    return [pair for pair in ours if not COARSER.search(scene.nodes[pair[0]].name)] or ours, len(worn) - len(ours)


def _of_one_skeleton(scene: GltfScene, skin: int, other: int) -> bool:
    """Whether a skin has a joint in common with another, or one above or below a joint of it."""
    first, second = ({int(j) for j in scene.skins[s].joints} for s in (skin, other))

    def hangs_on(joints: set[int], among: set[int]) -> bool:
        for joint in joints:
            at = joint
            while at >= 0:
                if at in among:
                    return True
                at = scene.nodes[at].parent
        return False

    return hangs_on(first, second) or hangs_on(second, first)


def _bound(scene: GltfScene, node: int, primitive: Primitive, binds: Floats, where: str) -> tuple[Integers, Placed]:
    """Node indices (V, K) that carry each vertex of a primitive, and the primitive in the bind pose, in scene space."""
    own = scene.skins[scene.nodes[node].skin or 0]
    assert primitive.joints is not None
    if int(primitive.joints.max(initial=0)) >= len(own.joints):
        raise BodyError(f"{where}: a mesh hangs on joints its skin does not have")
    blended = blended_matrices(primitive, binds[own.joints] @ own.inverse_binds)
    return own.joints[primitive.joints], moved(node, primitive, blended)


def _surface(material: Material, person: Humanoid, carried: Integers, placed: Placed) -> Surface:
    turn = person.to_person[:, :3]
    positions = placed.points @ turn.T + person.to_person[:, 3]
    normals = None if placed.normals is None else placed.normals @ turn.T
    assert placed.primitive.weights is not None
    dense = per_role(person.places[carried], placed.primitive.weights)
    joints, weights = four_largest(with_stiff_soles(dense, positions, person.positions))
    return surface_of(material, replace(placed, points=positions, normals=normals), joints, weights)

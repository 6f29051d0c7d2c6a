"""From any skinned glTF person to a body with gaitlab's 21 joints: whose joint plays which role, and in what frame.

The bind pose is taken from the inverse bind matrices, turned so that the person stands upright on y = 0 and looks
along +Z, and brought to metres. A joint without a role (finger, twist, hair) moves with the nearest role above it.
A role the file lacks takes a place between its neighbours and moves nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stimuli.body_files.container import Container
from stimuli.body_files.errors import BodyError
from stimuli.body_files.scene import GltfScene, world_matrices
from stimuli.body_files.standing import other_side, upright, walks_backwards, without_extent
from stimuli.motion_files.joint_names import NEEDED, roles_from_names
from stimuli.motion_files.topology import roles_from_shape
from stimuli.skeleton import JOINTS, PARENTS, Floats

VRM_ROLES = {role.lower(): role for role in JOINTS}


@dataclass(frozen=True, eq=False)
class Humanoid:
    """What was understood of a file's skeleton.

    source:    how the roles were told: "VRM", the name of a table of joint names, or "shape".
    roles:     role -> node index.
    positions: (21, 3) m, joints in the bind pose.
    to_person: (3, 4) from the file's bind space to metres, upright, facing +Z, sole on y = 0.
    places:    (N,) per node the index in JOINTS it moves with.
    swapped:   whether the file takes left for right.
    """

    source: str
    roles: dict[str, int]
    positions: Floats
    to_person: Floats
    places: Floats
    swapped: bool = False


def understand(container: Container, scene: GltfScene, skin: int, bound: Floats, where: str) -> Humanoid:
    """The person in a scene; `bound` (V, 3) are all its vertices in the bind pose, in the file's scene space."""
    nodes = scene.nodes
    parents = [node.parent for node in nodes]
    binds = bind_matrices(scene, skin, where)
    source, roles = _roles(container, scene, skin, binds, where)
    missing = [role for role in NEEDED if role not in roles]
    if missing:
        raise BodyError(f"{where}: this is no person gaitlab can walk: no joint plays {', '.join(missing)}")
    reason = without_extent(roles, binds, bound)
    if reason:
        raise BodyError(f"{where}: {reason}")
    axes = scene_of_bind(scene, skin)[:3, :3]
    to_person = upright(roles, binds, axes, bound)
    swapped = walks_backwards(roles, binds, to_person, bound)
    if swapped:
        roles = {other_side(role): node for role, node in roles.items()}
        to_person = upright(roles, binds, axes, bound)
    positions = _all_places(roles, binds, to_person)
    return Humanoid(source, roles, positions, to_person, _carriers(roles, parents), swapped)


def bind_matrices(scene: GltfScene, skin: int, where: str) -> Floats:
    """(N, 4, 4) where every node stood when the skin was attached, in scene space as the file shows it.

    For joints of the skin the inverse of the inverse bind matrix, brought to the scene by the first joint's place;
    other nodes keep their place relative to their parent. Raises BodyError when a joint's matrix has no inverse.
    """
    try:
        return _bind_matrices(scene, skin)
    except np.linalg.LinAlgError as error:
        raise BodyError(
            f"{where}: a joint, or what it hangs on, is scaled to 0; apply scales and export again"
        ) from error


def _bind_matrices(scene: GltfScene, skin: int) -> Floats:
    world = world_matrices(scene.nodes)
    joints, inverse = scene.skins[skin].joints, scene.skins[skin].inverse_binds
    to_scene = world[joints[0]] @ inverse[0]
    if np.linalg.det(to_scene) == 0:
        raise np.linalg.LinAlgError("the skin is shrunk to nothing")
    found = {int(j): to_scene @ np.linalg.inv(b) for j, b in zip(joints, inverse, strict=True)}

    def bound(index: int) -> Floats:
        if index not in found:
            parent = scene.nodes[index].parent
            relative = world[index] if parent < 0 else np.linalg.inv(world[parent]) @ world[index]
            found[index] = relative if parent < 0 else bound(parent) @ relative
        return found[index]

    return np.array([bound(i) for i in range(len(scene.nodes))])


def scene_of_bind(scene: GltfScene, skin: int) -> Floats:
    """(4, 4) from the space in which the skin was attached to the scene, by the place of its first joint."""
    found: Floats = world_matrices(scene.nodes)[scene.skins[skin].joints[0]] @ scene.skins[skin].inverse_binds[0]
    return found


def _roles(container: Container, scene: GltfScene, skin: int, binds: Floats, where: str) -> tuple[str, dict[str, int]]:
    names = [node.name for node in scene.nodes]
    parents = [node.parent for node in scene.nodes]
    told = _vrm_roles(container, len(names), where)
    if all(role in told for role in NEEDED):
        return "VRM", told
    table, named = roles_from_names(names, parents)
    if all(role in named for role in NEEDED):
        return table, named
    joints = [int(j) for j in scene.skins[skin].joints]
    order = sorted(joints, key=lambda j: _depth(j, parents))
    place = {joint: i for i, joint in enumerate(order)}
    own_parents = [next((place[a] for a in _above(j, parents) if a in place), -1) for j in order]
    shaped = roles_from_shape(own_parents, binds[order, :3, 3][None])
    return "shape", {role: order[i] for role, i in shaped.items()}


def _vrm_roles(container: Container, count: int, where: str) -> dict[str, int]:
    """Roles as VRM 1.0 (an object) or VRM 0.x (a list) names them; upperChest counts as the chest."""
    extensions = container.document.get("extensions", {})
    try:
        if "VRMC_vrm" in extensions:
            pairs = [(role, bone["node"]) for role, bone in extensions["VRMC_vrm"]["humanoid"]["humanBones"].items()]
        elif "VRM" in extensions:
            pairs = [(bone["bone"], bone["node"]) for bone in extensions["VRM"]["humanoid"]["humanBones"]]
        else:
            return {}
        found = {VRM_ROLES[role.lower()]: int(node) for role, node in pairs if role.lower() in VRM_ROLES}
        upper = [int(node) for role, node in pairs if role.lower() == "upperchest"]
        found |= {"chest": upper[0]} if upper else {}
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        raise BodyError(f"{where}: its VRM list of bones can't be read ({type(error).__name__})") from error
    if any(not 0 <= node < count for node in found.values()):
        raise BodyError(f"{where}: its VRM list of bones names nodes that do not exist")
    return found


def _all_places(roles: dict[str, int], binds: Floats, to_person: Floats) -> Floats:
    known = {r: to_person[:, :3] @ binds[n, :3, 3] + to_person[:, 3] for r, n in roles.items()}
    places = np.zeros((len(JOINTS), 3))
    for joint, role in enumerate(JOINTS):
        parent = places[PARENTS[joint]] if joint else np.zeros(3)
        places[joint] = known[role] if role in known else parent + _guess(role, known, parent)
    return places


def _guess(role: str, known: Mapping[str, Floats], parent: Floats) -> Floats:
    """Where a joint the file lacks stands, from its parent: half-way to the next one known, or a short way on."""
    after = {"spine": "chest neck head", "chest": "neck head", "neck": "head"}
    for following in after.get(role, "").split():
        if following in known:
            return 0.5 * (known[following] - parent)
    if role.endswith("Toes"):
        return np.array([0.0, -0.6 * parent[1], 0.13])
    if role.endswith("Shoulder") and role.replace("Shoulder", "UpperArm") in known:
        return 0.3 * (known[role.replace("Shoulder", "UpperArm")] - parent)
    side = 1.0 if role.startswith("left") else -1.0 if role.startswith("right") else 0.0
    return np.array([0.10 * side, 0.12 if side == 0 else 0.0, 0.0])


def _carriers(roles: dict[str, int], parents: list[int]) -> Floats:
    """Per node the place in JOINTS of the nearest role at or above it; the hips carry what hangs on nothing."""
    role_of = {node: JOINTS.index(role) for role, node in roles.items()}
    return np.array(
        [next((role_of[n] for n in (node, *_above(node, parents)) if n in role_of), 0) for node in range(len(parents))]
    )


def _above(node: int, parents: list[int]) -> list[int]:
    chain = []
    while parents[node] >= 0:
        node = parents[node]
        chain.append(node)
    return chain


def _depth(node: int, parents: list[int]) -> int:
    return len(_above(node, parents))

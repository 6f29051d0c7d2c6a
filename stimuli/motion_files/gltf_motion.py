"""Reading an animation of a glTF 2.0 file as a clip: the joints of its skin, sampled evenly.

Rest pose: the inverse bind matrices where there is a skin, else the nodes as they stand. Specification: Khronos
glTF 2.0, section 3.11 and appendix C (interpolation).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stimuli.clip import Clip
from stimuli.motion_files.building import build_clip
from stimuli.motion_files.errors import MotionFileError
from stimuli.motion_files.gltf_buffers import Document, read_array, read_document, whole
from stimuli.motion_files.sampling import rate_meant
from stimuli.motion_files.world_motion import motion_from_world, parents_first
from stimuli.rotations import from_matrix, normalise, slerp, to_matrix

Floats = NDArray[np.floating]

PATHS = {"translation": 3, "rotation": 4, "scale": 3}
LONGEST = 3600.0  # s
MOST_POSES = 10_000_000  # frames times nodes, a GB of matrices; ten minutes of 100 nodes at 120 Hz are 7 million
LEAST_RATE = 20.0  # Hz, at which animations with sparser keys are sampled


@dataclass(frozen=True, eq=False)
class _Nodes:
    """The node tree at rest; order has parents before children."""

    names: list[str]
    parents: list[int]
    order: list[int]
    values: dict[str, Floats]  # "translation" (n, 3), "rotation" (n, 4), "scale" (n, 3)


def read_gltf_motion(
    path: Path | str,
    *,
    animation: str | int | None = None,
    unit_to_m: float | None = 1.0,
    up: str | None = None,
    rate: float | None = None,
    skip_frames: int = 0,
    roles: Mapping[str, str] | None = None,
) -> Clip:
    """One animation of a .glb or .gltf file.

    animation: its name, or its number from 0; may be left out where there is only one
    rate:      Hz at which it is sampled; the spacing of its keys, at least 20, if None. The rest as for `read_bvh`,
               the unit being metres by the format.
    raises:    MotionFileError naming file, place and reason
    """
    path = Path(path)
    document = read_document(path)
    chosen = _choose(document, animation)
    nodes = _nodes(document)
    channels = _channels(document, chosen, len(nodes.names))
    joints, bind = _joints(document, nodes, channels)
    times, used_rate, file_rate = _times(path, channels, rate, len(nodes.names))
    world = _world(nodes, _animated(nodes, channels, times))
    rest = _rest(nodes, joints, bind)
    parents = _joint_parents(nodes, joints)
    motion = motion_from_world(
        "glTF",
        path,
        [nodes.names[joint] for joint in joints],
        parents,
        (_rotation_of(rest), rest[:, :3, 3]),
        (_rotation_of(world[:, joints]), world[:, joints][..., :3, 3]),
        used_rate,
        file_rate,
    )
    return build_clip(motion, unit_to_m=unit_to_m, up=up, skip_frames=skip_frames, roles=roles)


def animation_names(path: Path | str) -> tuple[str, ...]:
    """Names of a file's animations; "#0", "#1" ... where they have none."""
    return _animation_names(read_document(Path(path)))


def _animation_names(document: Document) -> tuple[str, ...]:
    return tuple(str(item.get("name") or f"#{number}") for number, item in enumerate(document.items("animations")))


def _choose(document: Document, animation: str | int | None) -> dict[str, Any]:
    names = _animation_names(document)
    listed = ", ".join(names[:80])
    if not names:
        raise MotionFileError(f"{document.path}: holds no animation; export the motion with the skeleton")
    if animation is None and len(names) == 1:
        animation = 0
    if animation is None:
        raise MotionFileError(f"{document.path}: holds {len(names)} animations; give animation, one of {listed}")
    index = names.index(animation) if animation in names else animation
    if not isinstance(index, int) or not 0 <= index < len(names):
        raise MotionFileError(f"{document.path}: has no animation {animation!r}; it has {listed}")
    return document.items("animations")[index]


def _nodes(document: Document) -> _Nodes:
    items = document.items("nodes")
    count = len(items)
    parents = [-1] * count
    values = {
        "translation": np.zeros((count, 3)),
        "rotation": np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)),
        "scale": np.ones((count, 3)),
    }
    for index, node in enumerate(items):
        for child in node.get("children", []) if isinstance(node.get("children", []), list) else []:
            if not 0 <= whole(child) < count:
                raise MotionFileError(f"{document.path}: nodes[{index}] has a child {child} that is not in the file")
            parents[child] = index
        if "matrix" in node:
            matrix = _vector(document, node["matrix"], 16, index).reshape(4, 4).T
            values["translation"][index] = matrix[:3, 3]
            values["scale"][index] = np.linalg.norm(matrix[:3, :3], axis=0)
            values["rotation"][index] = _rotation_of(matrix)
        for what, width in PATHS.items():
            if what in node:
                values[what][index] = _vector(document, node[what], width, index)
    if np.any(np.linalg.norm(values["rotation"], axis=1) < 1e-6):
        raise MotionFileError(f"{document.path}: a node's rotation is no unit quaternion; export the file again")
    values["rotation"] = normalise(values["rotation"])
    names = _different([str(node.get("name") or f"node {index}") for index, node in enumerate(items)])
    try:
        return _Nodes(names, parents, parents_first(parents), values)
    except ValueError as error:
        raise MotionFileError(f"{document.path}: its nodes form no tree ({error}); export it again") from error


def _vector(document: Document, value: Any, width: int, index: int) -> Floats:
    try:
        numbers = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        numbers = np.zeros(0)
    if numbers.shape != (width,) or not np.all(np.isfinite(numbers)):
        raise MotionFileError(f"{document.path}: nodes[{index}] has a transform that is not {width} numbers")
    return numbers


def _different(names: list[str]) -> list[str]:
    seen: dict[str, int] = {}
    different = []
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        different.append(name if seen[name] == 1 else f"{name}#{seen[name]}")
    return different


@dataclass(frozen=True, eq=False)
class _Channel:
    node: int
    what: str  # translation, rotation or scale
    interpolation: str
    times: Floats  # (K,) s
    keys: Floats  # (K, width), or (K, 3, width) for CUBICSPLINE


def _channels(document: Document, animation: dict[str, Any], count: int) -> list[_Channel]:
    samplers, listed = animation.get("samplers"), animation.get("channels")
    if not isinstance(samplers, list) or not isinstance(listed, list):
        raise MotionFileError(f"{document.path}: its animation has no lists of samplers and channels; export it again")
    channels = []
    for number, channel in enumerate(listed):
        place = f"{document.path}: channel {number} of its animation"
        try:
            target, sampler = channel["target"], samplers[channel["sampler"]]
            node, what = target.get("node"), target["path"]
            interpolation = sampler.get("interpolation", "LINEAR")
            ends = sampler["input"], sampler["output"]
        except (KeyError, TypeError, IndexError, AttributeError) as error:
            raise MotionFileError(f"{place} does not say what it moves; export the file again") from error
        if node is None or not isinstance(what, str) or what not in PATHS:
            continue
        if not 0 <= whole(node) < count or interpolation not in ("LINEAR", "STEP", "CUBICSPLINE"):
            raise MotionFileError(f"{place} moves a node or interpolates in a way the file does not have")
        times, keys = read_array(document, ends[0])[:, 0], read_array(document, ends[1])
        per_key = 3 if interpolation == "CUBICSPLINE" else 1
        if keys.shape != (len(times) * per_key, PATHS[what]) or np.any(np.diff(times) <= 0):
            raise MotionFileError(f"{place} has {len(times)} increasing times for {len(keys)} values, which do not fit")
        shaped = keys.reshape(len(times), 3, -1) if per_key == 3 else keys
        channels.append(_Channel(node, what, interpolation, times, shaped))
    if not channels:
        raise MotionFileError(f"{document.path}: its animation moves no node; choose another or export it again")
    return channels


def _times(path: Path, channels: list[_Channel], rate: float | None, nodes: int) -> tuple[Floats, float, float]:
    """Times (s) of the frames, their rate (Hz), and the rate of the keys; nodes: how many are posed in each frame."""
    start, end = min(c.times[0] for c in channels), max(c.times[-1] for c in channels)
    if not 0 <= end - start <= LONGEST:
        raise MotionFileError(f"{path}: its animation lasts {end - start:g} s; at most {LONGEST:g} s are read")
    gaps = np.concatenate([np.diff(c.times) for c in channels])
    gap = float(np.median(gaps)) if len(gaps) else 1.0
    file_rate = rate_meant(gap, f"{gap:.5f}") if gap > 1e-4 else 1e4
    used = max(file_rate, LEAST_RATE) if rate is None else rate
    if not 1 <= used <= 10_000:
        raise MotionFileError(f"{path}: a rate of {used:g} Hz is not between 1 and 10000; give rate in Hz")
    count = int(np.floor((end - start) * used + 1e-3)) + 1
    if count * nodes > MOST_POSES:
        raise MotionFileError(
            f"{path}: {end - start:g} s at {used:g} Hz are {count} frames, too many for {nodes} nodes; give a lower "
            f"rate in Hz, or cut the animation"
        )
    return start + np.arange(count) / used, used, file_rate


def _animated(nodes: _Nodes, channels: list[_Channel], times: Floats) -> dict[str, Floats]:
    """The nodes' values (T, n, width) at the times."""
    values = {what: np.repeat(rest[None], len(times), axis=0) for what, rest in nodes.values.items()}
    for channel in channels:
        values[channel.what][:, channel.node] = _interpolated(channel, times)
    lengths = np.linalg.norm(values["rotation"], axis=-1, keepdims=True)
    values["rotation"] = np.where(lengths > 1e-9, values["rotation"] / np.maximum(lengths, 1e-9), [0.0, 0.0, 0.0, 1.0])
    return values


def _interpolated(channel: _Channel, times: Floats) -> Floats:
    keys, at = channel.keys, channel.times
    if len(at) == 1:
        return np.repeat(keys[:1, 1] if channel.interpolation == "CUBICSPLINE" else keys[:1], len(times), axis=0)
    left = np.clip(np.searchsorted(at, times, side="right") - 1, 0, len(at) - 2)
    gap = (at[left + 1] - at[left])[:, None]
    share = np.clip((times - at[left])[:, None] / gap, 0.0, 1.0)
    if channel.interpolation == "STEP":
        return np.where(share >= 1.0, keys[left + 1], keys[left])
    if channel.interpolation == "CUBICSPLINE":
        start, out, into, end = keys[left, 1], keys[left, 2] * gap, keys[left + 1, 0] * gap, keys[left + 1, 1]
        s2, s3 = share**2, share**3
        return (2 * s3 - 3 * s2 + 1) * start + (s3 - 2 * s2 + share) * out + (3 * s2 - 2 * s3) * end + (s3 - s2) * into
    if channel.what == "rotation":
        lengths = np.linalg.norm(keys, axis=1, keepdims=True)
        unit = np.where(lengths > 1e-9, keys / np.maximum(lengths, 1e-9), [0.0, 0.0, 0.0, 1.0])
        return slerp(unit[left], unit[left + 1], share[:, 0])
    return keys[left] * (1 - share) + keys[left + 1] * share


def _world(nodes: _Nodes, values: dict[str, Floats]) -> Floats:
    """(T, n, 4, 4): node to scene."""
    frames, count = values["translation"].shape[:2]
    matrices = np.zeros((frames, count, 4, 4))
    matrices[..., :3, :3] = to_matrix(values["rotation"]) * values["scale"][..., None, :]
    matrices[..., :3, 3] = values["translation"]
    matrices[..., 3, 3] = 1.0
    for node in nodes.order:
        if nodes.parents[node] >= 0:
            matrices[:, node] = matrices[:, nodes.parents[node]] @ matrices[:, node]
    return matrices


def _joints(document: Document, nodes: _Nodes, channels: list[_Channel]) -> tuple[list[int], dict[int, Floats]]:
    """Node indices, parents first, of the skin with most joints (or the moved nodes), and its inverse bind matrices."""
    best: list[int] = []
    bind: dict[int, Floats] = {}
    for skin in document.items("skins"):
        joints = skin.get("joints", [])
        if not isinstance(joints, list) or not all(0 <= whole(j) < len(nodes.names) for j in joints):
            raise MotionFileError(f"{document.path}: a skin names joints that are not in the file; export it again")
        if len(joints) > len(best):
            best, bind = list(dict.fromkeys(joints)), {}
            if "inverseBindMatrices" in skin:
                matrices = read_array(document, skin["inverseBindMatrices"])
                if matrices.shape[0] < len(joints) or matrices.shape[1] != 16:
                    raise MotionFileError(f"{document.path}: a skin has fewer inverse bind matrices than joints")
                bind = {j: m.reshape(4, 4).T for j, m in zip(joints, matrices, strict=False)}
    moved = {channel.node for channel in channels}
    chosen = set(best) or moved
    return [node for node in nodes.order if node in chosen], bind


def _rest(nodes: _Nodes, joints: list[int], bind: dict[int, Floats]) -> Floats:
    """(J, 4, 4): joints as the skin was bound, placed so that the first stands as its node does."""
    standing = _world(nodes, {what: rest[None] for what, rest in nodes.values.items()})[0]
    if not bind or any(abs(np.linalg.det(bind[joint][:3, :3])) < 1e-12 for joint in joints):
        return standing[joints]
    placed = standing[joints[0]] @ bind[joints[0]]
    return np.array([placed @ np.linalg.inv(bind[joint]) for joint in joints])


def _joint_parents(nodes: _Nodes, joints: list[int]) -> list[int]:
    parents = []
    for joint in joints:
        above = nodes.parents[joint]
        while above >= 0 and above not in joints:
            above = nodes.parents[above]
        parents.append(joints.index(above) if above >= 0 else -1)
    return parents


def _rotation_of(matrices: Floats) -> Floats:
    """(..., 4) rotation of matrices (..., 4, 4), scale taken off; a flattened axis counts as unturned."""
    columns = matrices[..., :3, :3]
    lengths = np.linalg.norm(columns, axis=-2, keepdims=True)
    unit = np.where(lengths > 1e-12, columns / np.maximum(lengths, 1e-12), np.eye(3))
    u, _, v = np.linalg.svd(unit)
    u = u.copy()
    u[..., :, 2] *= np.where(np.linalg.det(u @ v) < 0, -1.0, 1.0)[..., None]
    return from_matrix(u @ v)

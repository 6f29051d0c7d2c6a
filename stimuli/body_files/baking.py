"""Writes a body as a small GLB file: quantised attributes (KHR_mesh_quantization), one skin, one node per level.

Nodes are called lod0, lod1, lod2; a haircut is its own node, "lod0 hair:bob", so that any viewer can hide it.
Positions are 16-bit fractions of a 2 m box; the inverse bind matrices bring them back to metres.
Vertex colours are how much of the sky is seen; on skin, green and blue are less where blood shows (`Surface.blush`).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stimuli.bodies.body import Body, Surface
from stimuli.body_files.container import Container, write_container
from stimuli.skeleton import JOINTS, PARENTS, Floats, Skeleton

BOX_CORNER = np.array([-1.0, -0.05, -1.0])  # m
BOX_SIZE = 2.0  # m
_BYTE, _SHORT, _INT, _FLOAT = 5121, 5123, 5125, 5126
_SIGNED_BYTE = 5120


@dataclass
class _Block:
    """Bytes being gathered, with the buffer views and accessors that name them."""

    data: bytearray = field(default_factory=bytearray)
    views: list[dict[str, Any]] = field(default_factory=list)
    accessors: list[dict[str, Any]] = field(default_factory=list)

    def add(self, array: NDArray[Any], component: int, kind: str, count: int, target: int = 0, **more: Any) -> int:
        raw = np.ascontiguousarray(array).tobytes()
        view: dict[str, Any] = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(raw)}
        if target:
            view["target"] = target
        if target == 34962:
            view["byteStride"] = len(raw) // max(count, 1)
        self.data += raw + b"\0" * (-len(raw) % 4)
        self.views.append(view)
        accessor = {"bufferView": len(self.views) - 1, "componentType": component, "count": count, "type": kind}
        self.accessors.append({**accessor, **more})
        return len(self.accessors) - 1


def bake(body: Body) -> bytes:
    """The body as the bytes of a GLB file."""
    block = _Block()
    materials: list[dict[str, Any]] = []
    meshes: list[dict[str, Any]] = []
    nodes = _joint_nodes(body.skeleton)
    for level, surfaces in enumerate(body.levels):
        for label in _labels(level, surfaces):
            worn = [s for s in surfaces if _label(level, s) == label]
            primitives = [_primitive(s, block, _material(s, materials)) for s in worn]
            meshes.append({"name": label, "primitives": primitives})
            nodes.append({"name": label, "mesh": len(meshes) - 1, "skin": 0})
    binds = block.add(_inverse_binds(body.skeleton), _FLOAT, "MAT4", len(JOINTS))
    styles = list(dict.fromkeys(s.name for s in body.levels[0] if s.name.startswith("hair:")))
    document = {
        "asset": {"version": "2.0", "generator": "gaitlab body_generator"},
        "extensionsUsed": ["KHR_mesh_quantization"],
        "extensionsRequired": ["KHR_mesh_quantization"],
        "scene": 0,
        "scenes": [{"nodes": [0, *range(len(JOINTS), len(nodes))]}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
        "skins": [{"joints": list(range(len(JOINTS))), "skeleton": 0, "inverseBindMatrices": binds}],
        "accessors": block.accessors,
        "bufferViews": block.views,
        "buffers": [{"byteLength": len(block.data)}],
        "extras": {"gaitlab": {"name": body.name, "stature": round(body.stature, 5), "hair": styles}},
    }
    return write_container(Container(document, (bytes(block.data),)))


def _label(level: int, surface: Surface) -> str:
    return f"lod{level} {surface.name}" if surface.name.startswith("hair:") else f"lod{level}"


def _labels(level: int, surfaces: tuple[Surface, ...]) -> list[str]:
    return list(dict.fromkeys(_label(level, s) for s in surfaces))


def _joint_nodes(skeleton: Skeleton) -> list[dict[str, Any]]:
    nodes: list[dict[str, Any]] = []
    for joint, name in enumerate(JOINTS):
        node: dict[str, Any] = {"name": name, "translation": [float(np.float32(x)) for x in skeleton.offsets[joint]]}
        children = [i for i, parent in enumerate(PARENTS) if parent == joint]
        nodes.append({**node, "children": children} if children else node)
    return nodes


def _inverse_binds(skeleton: Skeleton) -> Floats:
    """(21, 16) column-major: from the quantised box to the joint's own frame."""
    matrices = np.zeros((len(JOINTS), 4, 4), np.float32)
    matrices[:, :3, :3] = BOX_SIZE * np.eye(3)
    matrices[:, 3, 3] = 1
    matrices[:, :3, 3] = BOX_CORNER - skeleton.positions
    return matrices.transpose(0, 2, 1).reshape(len(JOINTS), 16)


def _material(surface: Surface, materials: list[dict[str, Any]]) -> int:
    names = [m["name"] for m in materials]
    if surface.name not in names:
        colour = [round(float(c), 5) for c in surface.colour]
        pbr = {"baseColorFactor": [*colour, 1.0], "metallicFactor": 0.0, "roughnessFactor": surface.roughness}
        tied = {} if surface.knot is None else {"extras": {"gaitlab": {"knot": round(surface.knot, 4)}}}
        materials.append({"name": surface.name, "pbrMetallicRoughness": pbr, **tied})
        return len(materials) - 1
    return names.index(surface.name)


def _primitive(surface: Surface, block: _Block, material: int) -> dict[str, Any]:
    count = len(surface.positions)
    box = np.round((surface.positions - BOX_CORNER) / BOX_SIZE * 65535)
    positions = _padded(np.clip(box, 0, 65535).astype("<u2"))
    extent = {
        "min": [int(x) for x in positions[:, :3].min(axis=0)],
        "max": [int(x) for x in positions[:, :3].max(axis=0)],
    }
    normals = _padded(np.round(np.clip(surface.normals, -1, 1) * 127).astype(np.int8))
    open_sky = np.clip(surface.occlusion, 0, 1)
    pale = open_sky if surface.blush is None else open_sky * (1 - surface.blush)
    light = np.column_stack([open_sky, pale, pale, np.ones(count)])
    colour = np.round(255 * light).astype(np.uint8)
    joints = np.where(surface.weights > 0, surface.joints, 0).astype(np.uint8)
    vertices = 34962
    attributes = {
        "POSITION": block.add(positions, _SHORT, "VEC3", count, vertices, normalized=True, **extent),
        "NORMAL": block.add(normals, _SIGNED_BYTE, "VEC3", count, vertices, normalized=True),
        "COLOR_0": block.add(colour, _BYTE, "VEC4", count, vertices, normalized=True),
        "JOINTS_0": block.add(joints, _BYTE, "VEC4", count, vertices),
        "WEIGHTS_0": block.add(_whole_weights(surface.weights), _BYTE, "VEC4", count, vertices, normalized=True),
    }
    triangles = surface.triangles.ravel()
    wide = count > 65535
    indices = block.add(
        triangles.astype("<u4" if wide else "<u2"), _INT if wide else _SHORT, "SCALAR", len(triangles), 34963
    )
    return {"attributes": attributes, "indices": indices, "material": material}


def _padded(columns: NDArray[Any]) -> NDArray[Any]:
    """(V, 4): three columns and a zero, so that every row starts at a multiple of four bytes."""
    return np.column_stack([columns, np.zeros(len(columns), columns.dtype)])


def _whole_weights(weights: Floats) -> NDArray[np.uint8]:
    """(V, 4) 8-bit fractions whose rows sum to exactly 255; the largest takes up the rounding."""
    whole = np.floor(weights * 255 + 0.5).astype(np.int64)
    rows = np.arange(len(whole))
    whole[rows, np.argmax(whole, axis=1)] += 255 - whole.sum(axis=1)
    return whole.astype(np.uint8)

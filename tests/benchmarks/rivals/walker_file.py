"""A walker as a GLB file that other programs read: one of our bodies, its skin, and one of its walks as a clip."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np

from stimuli.actors import load_actor
from stimuli.crowds.bodies import crowd_body
from stimuli.skeleton import JOINTS, PARENTS
from stimuli.walker import drawn_pose

KEYS = 32
FLOAT, BYTE, SHORT = 5126, 5121, 5123


class _File:
    """The parts of a glTF file as they come."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, object]] = []
        self.accessors: list[dict[str, object]] = []

    def add(self, values: np.ndarray, component: int, kind: str, bounds: bool = False) -> int:
        """Number of the accessor of these values."""
        self.data += b"\0" * (-len(self.data) % 4)
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes})
        self.data += values.tobytes()
        accessor: dict[str, object] = {
            "bufferView": len(self.views) - 1, "componentType": component, "count": len(values), "type": kind,
        }  # fmt: skip
        if bounds:
            rows = values.reshape(len(values), -1)
            accessor |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def write_walker(path: Path, level: int) -> int:
    """Writes the woman at a level of detail, walking; returns her triangles."""
    body = crowd_body("woman", "bob", "medium")
    surfaces = body.levels[level]
    file = _File()
    first, corners = 0, []
    for surface in surfaces:
        corners.append(surface.triangles + first)
        first += len(surface.positions)
    triangles = np.concatenate(corners)
    stacked = {
        name: np.concatenate([getattr(s, name) for s in surfaces])
        for name in ("positions", "normals", "joints", "weights")
    }
    attributes = {
        "POSITION": file.add(stacked["positions"].astype("<f4"), FLOAT, "VEC3", bounds=True),
        "NORMAL": file.add(stacked["normals"].astype("<f4"), FLOAT, "VEC3"),
        "JOINTS_0": file.add(stacked["joints"].astype("u1"), BYTE, "VEC4"),
        "WEIGHTS_0": file.add(stacked["weights"].astype("<f4"), FLOAT, "VEC4"),
    }
    indices = file.add(triangles.ravel().astype("<u2"), SHORT, "SCALAR")
    binds = np.tile(np.eye(4, dtype="<f4"), (len(JOINTS), 1, 1))
    binds[:, 3, :3] = -body.skeleton.positions
    skin = file.add(binds.reshape(len(JOINTS), 16), FLOAT, "MAT4")
    nodes: list[dict[str, object]] = []
    for joint, name in enumerate(JOINTS):
        children = [child for child, parent in enumerate(PARENTS) if parent == joint]
        node: dict[str, object] = {"name": name, "translation": body.skeleton.offsets[joint].tolist()}
        nodes.append(node | ({"children": children} if children else {}))
    nodes.append({"name": "walker", "mesh": 0, "skin": 0})
    nodes.append({"name": "root", "children": [0, len(JOINTS)]})
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [len(JOINTS) + 1]}],
        "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": attributes, "indices": indices, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.6, 0.5, 1.0], "metallicFactor": 0}}],
        "skins": [{"joints": list(range(len(JOINTS))), "inverseBindMatrices": skin, "skeleton": 0}],
        "animations": [_clip(file)],
    }
    file.data += b"\0" * (-len(file.data) % 4)
    document |= {"buffers": [{"byteLength": len(file.data)}], "bufferViews": file.views, "accessors": file.accessors}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    header = struct.pack("<III", 0x46546C67, 2, 28 + len(text) + len(file.data))
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(file.data), 0x004E4942)
    path.write_bytes(header + chunks + bytes(file.data))
    return len(triangles)


def _clip(file: _File) -> dict[str, object]:
    """One gait cycle of an actor, KEYS steps of a second in all."""
    actor = load_actor("F1")
    poses = [drawn_pose(actor, 1.2, 110.0, key / KEYS) for key in range(KEYS + 1)]
    times = file.add((np.arange(KEYS + 1) / KEYS).astype("<f4"), FLOAT, "SCALAR", bounds=True)
    scale = crowd_body("woman", "bob", "medium").stature / actor.height
    tracks = [(joint, "rotation", np.array([pose.rotations[joint] for pose in poses])) for joint in range(len(JOINTS))]
    tracks.append((0, "translation", scale * np.array([pose.hips for pose in poses])))
    samplers, channels = [], []
    for joint, path, values in tracks:
        output = file.add(values.astype("<f4"), FLOAT, "VEC3" if path == "translation" else "VEC4")
        channels.append({"sampler": len(samplers), "target": {"node": joint, "path": path}})
        samplers.append({"input": times, "output": output, "interpolation": "LINEAR"})
    return {"name": "walk", "samplers": samplers, "channels": channels}

"""The bodies of crowds: haircuts and builds of the woman and the man, with levels of detail for the far distance.

The coarse levels merge the vertices of a small cube that move with the same joint (vertex clustering, Rossignac &
Borrel 1993): at the size they are drawn at, a cube is about a pixel. Knows no GPU.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from stimuli.bodies import load_body, with_girths
from stimuli.body import Body, Surface
from stimuli.skeleton import JOINTS, Floats

GIRTHS: dict[str, dict[str, float]] = {
    "slim": dict.fromkeys(("hips", "spine", "chest"), 0.93)
    | {
        f"{side}{part}": 0.93 for side in ("left", "right") for part in ("UpperLeg", "LowerLeg", "UpperArm", "LowerArm")
    },
    "medium": {},
    "stout": {"hips": 1.12, "spine": 1.2, "chest": 1.12, "neck": 1.06}
    | {f"{side}{part}": 1.1 for side in ("left", "right") for part in ("UpperLeg", "LowerLeg", "UpperArm", "LowerArm")},
}

COARSE = ((0.12, 3), (0.24, 2), (0.45, 2))
"""Of each further level of detail: side of its cubes (m) and how many joints carry a vertex."""


def _limb(joint: str) -> str:
    """The joint that stands for the limb a joint belongs to."""
    if joint in ("hips", "spine") or joint.endswith("Shoulder"):
        return "chest"
    return joint.replace("neck", "head").replace("Hand", "LowerArm").replace("Toes", "Foot")


LIMBS = np.array([JOINTS.index(_limb(joint)) for joint in JOINTS])

HAIR_LIFT = 0.12
"""m per metre of a cube's side: about how far the middles of clusters lie inside a head."""

SMALL = ("eye", "iris", "pupil", "lash", "brow", "lip", "laces", "soles")
"""Surfaces that a coarse level does without."""


@cache
def crowd_body(name: str, hair: str, build: str) -> Body:
    """A shipped body with that haircut and build, and coarser levels of detail after its own."""
    body = with_girths(load_body(name, hair), GIRTHS[build])
    last = tuple(surface for surface in body.levels[-1] if surface.name not in SMALL)
    coarse = (tuple(_coarse(surface, side, carriers) for surface in last) for side, carriers in COARSE)
    return replace(body, levels=(*body.levels, *coarse))


def _coarse(surface: Surface, side: float, carriers: int) -> Surface:
    """The surface clustered; hair in finer cubes and lifted, so that it covers the clustered head."""
    if surface.name != "hair":
        return clustered(surface, side, carriers)
    hair = clustered(surface, 0.6 * side, carriers)
    return replace(hair, positions=hair.positions + (HAIR_LIFT * side) * hair.normals)


def clustered(surface: Surface, side: float, carriers: int) -> Surface:
    """The surface with one vertex for all that share a cube of `side` m, a limb and a side.

    The sides are front or back and left or right, by their normals, so that an arm thinner than a cube keeps its
    volume; means lie inside what is round, so the whole is stretched to be as large as it was.
    """
    every = np.arange(len(surface.positions))
    heaviest = surface.joints[every, np.argmax(surface.weights, axis=1)]
    cubes = np.floor(surface.positions / side + 0.5).astype(np.int64)
    facing = surface.normals[:, [0, 2]] > 0.0
    _, cluster = np.unique(np.column_stack([cubes, LIMBS[heaviest], facing]), axis=0, return_inverse=True)
    cluster = cluster.ravel()
    used, corners = np.unique(_without_slivers(cluster[surface.triangles]), return_inverse=True)
    count = int(cluster.max()) + 1
    carried = np.zeros((len(every), len(JOINTS)))
    np.add.at(carried, (every[:, None], surface.joints), surface.weights)
    joints, weights = _heaviest(_mean(carried, cluster, count), carriers)
    normals = _mean(surface.normals, cluster, count)
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
    return replace(
        surface,
        positions=_as_large(_mean(surface.positions, cluster, count)[used], surface.positions),
        normals=normals[used],
        occlusion=_mean(surface.occlusion[:, None], cluster, count)[used, 0],
        joints=joints[used],
        weights=weights[used],
        triangles=corners.reshape(-1, 3),
    )


def _as_large(positions: Floats, fine: Floats) -> Floats:
    """Positions (V, 3) stretched along each axis to the bounding box of the fine ones."""
    low, size = positions.min(axis=0), np.ptp(positions, axis=0)
    stretch = np.ptp(fine, axis=0) / np.where(size > 0.0, size, 1.0)
    return np.asarray(fine.min(axis=0) + (positions - low) * stretch)


def _mean(values: Floats, cluster: NDArray[np.intp], count: int) -> Floats:
    """(count, C) mean of values (V, C) over each cluster."""
    total = np.zeros((count, values.shape[1]))
    np.add.at(total, cluster, values)
    return total / np.bincount(cluster, minlength=count)[:, None]


def _without_slivers(triangles: NDArray[np.intp]) -> NDArray[np.intp]:
    """Triangles (T, 3) with three corners, each once."""
    a, b, c = triangles.T
    whole = triangles[(a != b) & (b != c) & (c != a)]
    _, first = np.unique(np.sort(whole, axis=1), axis=0, return_index=True)
    return np.asarray(whole[np.sort(first)])


def _heaviest(weights: Floats, carriers: int) -> tuple[NDArray[np.intp], Floats]:
    """Joints and weights (V, 4) of rows of weights (V, joints), the `carriers` heaviest kept."""
    joints = np.argsort(-weights, axis=1, kind="stable")[:, :4]
    kept = np.take_along_axis(weights, joints, axis=1)
    kept[:, carriers:] = 0.0
    return joints, kept / kept.sum(axis=1, keepdims=True)

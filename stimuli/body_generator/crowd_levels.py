"""python -m stimuli.body_generator.crowd_levels: the coarse levels of detail of crowds, from the baked bodies.

Each surface of a body's coarsest level is simplified by quadric edge collapse (Garland & Heckbert 1997) and takes
colours' shade, normals and joints from the vertices around. Made when bodies are released, not when they are drawn.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from stimuli.bodies.body import Integers, Surface
from stimuli.bodies.known import hair_names, load_body
from stimuli.crowds.bodies import KEPT, LEVELS
from stimuli.skeleton import JOINTS, Floats

SHARES = ((0.33, 3), (0.14, 2), (0.07, 2))
"""Of each level: share of the triangles that is kept, and how many joints carry a vertex."""

SMALL = ("eye", "iris", "pupil", "lash", "brow", "lip", "laces", "soles")
"""Surfaces that a coarse level does without."""

LEAST = 6  # triangles of a surface
PULLS = (5, 3, 4, 6, 7, 8)  # how fast edges are collapsed (fast-simplification's `agg`)
HAIR_LIFT = 0.008  # m, so that the corners of a coarse head do not stick out of coarse hair
COVERS = ("shirt", "trousers", "shoes", "hair")
SKIN_SINKS = 0.02  # m, under cloth and hair, so that its coarse triangles do not stick out of theirs


def simplified(surface: Surface, share: float, carriers: int) -> Surface:
    """The surface with a share of its triangles, each vertex carried by so many joints at most.

    Of several ways of collapsing edges, the one whose triangles are moved most nearly by the joints that move the fine
    surface there: few triangles with corners on arms, legs and neck alone would leave no chest between them.
    """
    welded, corner = np.unique(np.round(surface.positions, 5), axis=0, return_inverse=True)
    triangles = corner.ravel()[surface.triangles]
    a, b, c = triangles.T
    whole = triangles[(a != b) & (b != c) & (c != a)].astype(np.int32)
    count = max(round(len(surface.triangles) * share), LEAST)
    carried = np.zeros((len(surface.positions), len(JOINTS)))
    np.add.at(carried, (np.arange(len(carried))[:, None], surface.joints), surface.weights)
    around = _Around(surface.positions)
    found = [_collapsed(welded.astype(np.float32), whole, count, pull) for pull in PULLS]
    fewest = min(len(chosen) for _, chosen in found)
    few = [mesh for mesh in found if len(mesh[1]) <= max(fewest, count)]
    positions, chosen = min(few, key=lambda mesh: _misled(mesh[0], mesh[1], around, carried))
    normals = around(positions, surface.normals)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
    joints, weights = _heaviest(around(positions, carried), carriers)
    return replace(
        surface,
        positions=positions + (HAIR_LIFT if surface.name == "hair" else 0.0) * normals,
        normals=normals,
        occlusion=around(positions, surface.occlusion[:, None])[:, 0],
        joints=joints,
        weights=weights,
        triangles=chosen,
    )


class _Around:
    """What the vertices around a place have."""

    def __init__(self, vertices: Floats) -> None:
        self._tree = cKDTree(vertices)

    def __call__(self, places: Floats, values: Floats) -> Floats:
        """(P, C) of values (V, C) of the vertices, at places (P, 3)."""
        distance, near = self._tree.query(places, k=4)
        shares = 1.0 / (distance + 1e-3) ** 2
        shares /= shares.sum(axis=1, keepdims=True)
        return np.asarray(np.einsum("vk,vkc->vc", shares, values[near]))


def _collapsed(positions: Floats, triangles: Integers, count: int, pull: int) -> tuple[Floats, Integers]:
    import fast_simplification

    positions, triangles = fast_simplification.simplify(positions, triangles, target_count=count, agg=pull)
    used, triangles = np.unique(triangles, return_inverse=True)
    return positions[used].astype(float), triangles.reshape(-1, 3)


def _misled(positions: Floats, triangles: Integers, around: _Around, carried: Floats) -> float:
    """By how much joints' weights in the middle of triangles differ from the fine surface's, over its area."""
    corners = positions[triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    coarse = around(positions, carried)[triangles].mean(axis=1)
    off = np.abs(coarse - around(corners.mean(axis=1), carried)).sum(axis=1)
    return float(area @ off / area.sum())


def _heaviest(weights: Floats, carriers: int) -> tuple[np.ndarray, Floats]:
    """Joints and weights (V, 4) of rows of weights (V, joints), the `carriers` heaviest kept."""
    joints = np.argsort(-weights, axis=1, kind="stable")[:, :4]
    kept = np.take_along_axis(weights, joints, axis=1)
    kept[:, carriers:] = 0.0
    return joints, kept / kept.sum(axis=1, keepdims=True)


def coarse_levels(name: str, hair: str) -> list[list[Surface]]:
    """LEVELS levels of a body with a haircut."""
    surfaces = [surface for surface in load_body(name, hair).levels[-1] if surface.name not in SMALL]
    covers = [surface for surface in surfaces if surface.name in COVERS]
    levels = [[simplified(surface, *share) for surface in surfaces] for share in SHARES]
    return [[_sunk(coarse, covers) if coarse.name == "skin" else coarse for coarse in level] for level in levels]


def _sunk(skin: Surface, covers: Sequence[Surface]) -> Surface:
    """Skin that gives way where the nearest cloth or hair of the finer body lies outside it."""
    cloth = np.concatenate([cover.positions for cover in covers])
    outwards = np.concatenate([cover.normals for cover in covers])
    _, near = cKDTree(cloth).query(skin.positions)
    under = np.sum((cloth[near] - skin.positions) * outwards[near], axis=1) > 0.0
    return replace(skin, positions=skin.positions - SKIN_SINKS * under[:, None] * skin.normals)


def main() -> None:
    """Write the coarse levels of every body and haircut; the same bodies always give the same bytes."""
    parser = argparse.ArgumentParser(prog="python -m stimuli.body_generator.crowd_levels", description=main.__doc__)
    parser.add_argument("--out", type=Path, default=Path("stimuli/data/bodies/crowd.npz"))
    chosen = parser.parse_args()
    assert len(SHARES) == LEVELS
    stored: dict[str, Any] = {}
    for name in ("woman", "man"):
        for hair in hair_names(name):
            for level, surfaces in enumerate(coarse_levels(name, hair)):
                for surface in surfaces:
                    for array, kind in KEPT.items():
                        key = f"{name}/{hair}/{level}/{surface.name}/{array}"
                        stored[key] = np.asarray(getattr(surface, array)).astype(kind)
    np.savez_compressed(chosen.out, **stored)
    print(f"{chosen.out}: {chosen.out.stat().st_size} bytes")


if __name__ == "__main__":
    main()

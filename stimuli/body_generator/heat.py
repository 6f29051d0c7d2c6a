"""Which joints move a point of the body: bone heat (Baran & Popović 2007) on one closed mesh of everything.

Garments do not get weights of their own: each of their points asks the nearest points of this one mesh, so a
shirt and the trousers under it move alike and never poke through each other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix, diags
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

from stimuli.bodies.body import Integers
from stimuli.body_generator.polygons import Mesh
from stimuli.skeleton import JOINTS, Floats

HEAT = 1.6  # strength of the pull of the nearest bone; larger = narrower transitions at the joints
NEIGHBOURS = 6
SHOULDER, ELBOW, KNEE, KNEE_BACK = 0.7, 2.0, 1.15, 4.5
BEHIND = (1.0, -4.0)  # cm forwards of the hip: where a hinge is as sharp as in front, and as behind
# sharpness in front and behind: above 1 a hinge bends in a narrower band, below 1 it is rounder. The hollow of a bent
# knee is a crease between two straight legs of cloth; a wide band pulls it in as if it were pinched.
_HINGES = tuple(
    (JOINTS.index(side + upper), JOINTS.index(side + lower), front, back)
    for side in ("left", "right")
    for upper, lower, front, back in (
        ("Shoulder", "UpperArm", SHOULDER, SHOULDER),
        ("UpperArm", "LowerArm", ELBOW, ELBOW),
        ("UpperLeg", "LowerLeg", KNEE, KNEE_BACK),
    )
)
MIRROR_JOINT = np.array(
    [JOINTS.index(n.replace("left", "right") if n.startswith("left") else n.replace("right", "left")) for n in JOINTS]
)


@dataclass(frozen=True, eq=False)
class Heat:
    """Weights of all joints on the points of the union mesh: positions (V, 3), weights (V, 21)."""

    positions: Floats
    weights: Floats


def bone_heat(mesh: Mesh, segments: tuple[tuple[int, Floats, Floats], ...]) -> Heat:
    """Heat from every bone, spread over the surface: (L + H) w = H p, one right-hand side per joint.

    segments: joint index, start (3,) and end (3,) of each bone; a joint may have several.
    """
    laplacian, area = _cotangent_laplacian(mesh)
    nearest = np.full(len(mesh.positions), np.inf)
    owner = np.zeros(len(mesh.positions), dtype=int)
    for joint, start, end in segments:
        distance = _to_segment(mesh.positions, start, end)
        closer = distance < nearest
        nearest[closer], owner[closer] = distance[closer], joint
    pull = HEAT * area / np.maximum(nearest, 0.5) ** 2
    one_hot = np.zeros((len(mesh.positions), len(JOINTS)))
    one_hot[np.arange(len(owner)), owner] = pull
    weights = splu(csc_matrix(laplacian + diags(pull))).solve(one_hot)
    weights = np.clip(weights, 0, None)
    return Heat(mesh.positions, weights / weights.sum(axis=1, keepdims=True))


def weights_at(heat: Heat, points: Floats) -> tuple[Integers, Floats]:
    """(N, 4) joints and (N, 4) weights at points near the body, the same left and right.

    The fifth largest weight is subtracted before the rest is dropped, so that weights change without a jump
    from point to point (plain "best four" tears visible seams).
    """
    dense = 0.5 * (_interpolated(heat, points) + _interpolated(heat, points * (-1, 1, 1))[:, MIRROR_JOINT])
    behind = np.clip((BEHIND[0] - points[:, 2:]) / (BEHIND[0] - BEHIND[1]), 0, 1)
    for upper, lower, front, back in _HINGES:
        pair = dense[:, [upper, lower]]
        sharp = pair ** (front + (back - front) * behind)
        dense[:, [upper, lower]] = (
            pair.sum(axis=1, keepdims=True) * sharp / np.maximum(sharp.sum(axis=1, keepdims=True), 1e-30)
        )
    order = np.argsort(-dense, axis=1, kind="stable")[:, :5]
    largest = np.take_along_axis(dense, order, axis=1)
    four = np.clip(largest[:, :4] - largest[:, 4:5], 0, None)
    four[four < 0.004] = 0
    return order[:, :4], four / four.sum(axis=1, keepdims=True)


def _interpolated(heat: Heat, points: Floats) -> Floats:
    distance, index = cKDTree(heat.positions).query(points, k=NEIGHBOURS)
    closeness = 1 / (distance**2 + 0.05)
    closeness /= closeness.sum(axis=1, keepdims=True)
    return np.einsum("nk,nkj->nj", closeness, heat.weights[index])


def _to_segment(points: Floats, start: Floats, end: Floats) -> Floats:
    d = end - start
    t = np.clip((points - start) @ d / max(float(d @ d), 1e-9), 0, 1)
    return np.linalg.norm(points - start - t[:, None] * d, axis=1)


def _cotangent_laplacian(mesh: Mesh) -> tuple[csc_matrix, Floats]:
    """Positive semi-definite cotangent Laplacian (V, V) and the area (V,) belonging to each vertex."""
    t, p = mesh.triangles, mesh.positions
    count = len(p)
    rows, columns, values = [], [], []
    area = np.zeros(count)
    for corner in range(3):
        a, b, c = t[:, corner], t[:, (corner + 1) % 3], t[:, (corner + 2) % 3]
        ab, ac = p[b] - p[a], p[c] - p[a]
        double_area = np.maximum(np.linalg.norm(np.cross(ab, ac), axis=1), 1e-9)
        cotangent = np.clip(np.sum(ab * ac, axis=1) / double_area, -0.2, 20) / 2
        rows += [b, c]
        columns += [c, b]
        values += [cotangent, cotangent]
        np.add.at(area, a, double_area / 6)
    edge = coo_matrix(
        (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(count, count)
    ).tocsc()
    edge.data = np.maximum(edge.data, 1e-6)
    return csc_matrix(diags(np.asarray(edge.sum(axis=1)).ravel()) - edge), area

"""From a field to triangles: marching cubes in a narrow band, polishing, simplifying. Knows nothing of people.

scikit-image and fast-simplification are needed here only, at release time; gaitlab itself ships the result.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from stimuli.bodies.body import Integers
from stimuli.body_generator.fields import Field
from stimuli.skeleton import Floats

_TETRAHEDRON = np.array([(1, -1, -1), (-1, -1, 1), (-1, 1, -1), (1, 1, 1)], dtype=np.float64)
_COARSE = 4  # fine cells per coarse cell of the narrow band


@dataclass(frozen=True, eq=False)
class Mesh:
    """positions: (V, 3); triangles: (T, 3) int, counter-clockwise seen from outside."""

    positions: Floats
    triangles: Integers


def gradient(field: Field, points: Floats, step: float) -> Floats:
    """(N, 3) gradient of the field by differences over `step` along a tetrahedron's corners."""
    values = np.stack([field(points + step * corner) for corner in _TETRAHEDRON], axis=1)
    return values @ _TETRAHEDRON / (4 * step)


def normals_of(field: Field, points: Floats, step: float) -> Floats:
    """(N, 3) unit normals: the field's direction of steepest ascent."""
    g = gradient(field, points, step)
    return g / np.maximum(np.linalg.norm(g, axis=1, keepdims=True), 1e-12)


def polygonise(field: Field, lower: Floats, upper: Floats, spacing: float) -> Mesh:
    """The closed surface field = 0 in the box, every `spacing`; the field is evaluated near the surface only."""
    from skimage.measure import marching_cubes

    coarse = spacing * _COARSE
    cells = np.ceil((np.asarray(upper) - lower) / coarse).astype(int) + 1
    values = _on_grid(field, np.asarray(lower, dtype=np.float64), coarse, cells + 1)
    near = _near_surface(values, coarse)
    fine = np.repeat(np.repeat(np.repeat(values, _COARSE, 0), _COARSE, 1), _COARSE, 2)
    wanted = np.repeat(np.repeat(np.repeat(near, _COARSE, 0), _COARSE, 1), _COARSE, 2)
    where = np.argwhere(wanted)
    fine[tuple(where.T)] = field(lower + where * spacing)
    positions, triangles, _, _ = marching_cubes(fine, 0.0, spacing=(spacing,) * 3)
    mesh = Mesh(positions.astype(np.float64) + lower, triangles[:, ::-1].astype(np.int64))
    return mesh if volume(mesh) > 0 else Mesh(mesh.positions, mesh.triangles[:, ::-1])


def _on_grid(field: Field, lower: Floats, spacing: float, counts: Floats) -> Floats:
    axes = [lower[i] + spacing * np.arange(counts[i]) for i in range(3)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return field(points).reshape(tuple(counts))


def _near_surface(values: Floats, spacing: float) -> Floats:
    """Coarse cells (by their lowest corner) which the surface may cross, with one cell to spare."""
    from scipy.ndimage import binary_dilation

    inside = values < 0
    near = np.abs(values) < 1.2 * spacing
    for axis in range(3):
        change = np.diff(inside.astype(np.int8), axis=axis) != 0
        index = [slice(None)] * 3
        index[axis] = slice(0, -1)
        near[tuple(index)] |= change
    return binary_dilation(near, iterations=1)


def polished(mesh: Mesh, field: Field, spacing: float, rounds: int = 2) -> Mesh:
    """The mesh on the field's zero surface with evenly spread vertices: half Laplacian steps, each pulled back."""
    neighbours = adjacency(mesh)
    mean = csr_matrix(neighbours.multiply(1 / np.maximum(neighbours.sum(axis=1), 1)))
    positions = settled(field, mesh.positions, spacing)
    for _ in range(rounds):
        positions = settled(field, 0.5 * positions + 0.5 * (mean @ positions), spacing)
    return Mesh(positions, mesh.triangles)


def settled(field: Field, points: Floats, spacing: float) -> Floats:
    """Points moved on to the zero surface by one Newton step, never by more than `spacing`."""
    g = gradient(field, points, 0.1 * spacing)
    step = (field(points) / np.maximum(np.sum(g * g, axis=1), 0.1))[:, None] * g
    length = np.linalg.norm(step, axis=1, keepdims=True)
    return points - step * np.minimum(1, spacing / np.maximum(length, 1e-12))


def edged(mesh: Mesh, outside: Field, ends: Field, depth: float, length: float) -> Mesh:
    """The mesh with a sharp edge where the surface `outside` = 0 meets the one `ends` = 0.

    Marching cubes and simplification cut such an edge off unevenly; vertices nearer than `depth` to the outside and
    `length` to the end are brought on to it.
    """
    positions = mesh.positions.copy()
    near = np.flatnonzero((np.abs(outside(positions)) < depth) & (np.abs(ends(positions)) < length))
    p = positions[near]
    for _ in range(8):
        p = settled(ends, settled(outside, p, length), length)
    positions[near] = p
    before, after = (_facing(q, mesh.triangles) for q in (mesh.positions, positions))
    folded = np.sum(before * after, axis=1) < -0.1 * np.sum(before**2, axis=1)  # thin cloth, through itself
    turned = mesh.triangles[folded]
    positions[turned] = mesh.positions[turned]
    return Mesh(positions, mesh.triangles)


def _facing(positions: Floats, triangles: Integers) -> Floats:
    """(T, 3) normals of triangles, as long as twice their areas."""
    a, b, c = (positions[triangles[:, i]] for i in range(3))
    return np.asarray(np.cross(b - a, c - a))


def simplified(mesh: Mesh, triangles: int) -> Mesh:
    """At most about `triangles` triangles, chosen by quadric error (Garland & Heckbert 1997)."""
    import fast_simplification

    if len(mesh.triangles) <= triangles:
        return mesh
    positions, faces = mesh.positions.astype(np.float32), mesh.triangles.astype(np.int32)
    for pull in (5, 7, 8, 9):  # harder only if the gentle setting stops early
        if len(faces) > 1.03 * triangles:
            positions, faces = fast_simplification.simplify(positions, faces, target_count=triangles, agg=pull)
    return Mesh(positions.astype(np.float64), faces.astype(np.int64))


def adjacency(mesh: Mesh) -> csr_matrix:
    """(V, V) with 1 where an edge joins two vertices."""
    t = mesh.triangles
    i = np.concatenate([t[:, 0], t[:, 1], t[:, 2]])
    j = np.concatenate([t[:, 1], t[:, 2], t[:, 0]])
    count = len(mesh.positions)
    matrix = coo_matrix((np.ones(2 * len(i)), (np.r_[i, j], np.r_[j, i])), shape=(count, count)).tocsr()
    matrix.data[:] = 1
    return matrix


def volume(mesh: Mesh) -> float:
    """Enclosed volume, in the cube of the mesh's unit; positive when triangles face outwards."""
    a, b, c = (mesh.positions[mesh.triangles[:, i]] for i in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6)


def mirror_image(mesh: Mesh) -> Mesh:
    """The mesh reflected at x = 0, still facing outwards."""
    return Mesh(mesh.positions * (-1, 1, 1), mesh.triangles[:, ::-1])

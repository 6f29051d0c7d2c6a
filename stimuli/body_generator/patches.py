"""Thin pieces laid on the face: grids of points in head coordinates (see `head`) made into coloured meshes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stimuli.body_generator.fields import Field
from stimuli.body_generator.head import HeadFrame
from stimuli.body_generator.pieces import Piece
from stimuli.body_generator.polygons import Mesh, normals_of
from stimuli.skeleton import Floats

BOTH = (1, -1)


@dataclass(frozen=True)
class Canvas:
    """The face that is painted: its field in the figure's coordinates, and the head's frame.

    fineness: 1 for close-ups, less for coarser levels of detail.
    """

    face: Field
    frame: HeadFrame
    fineness: float

    @property
    def near(self) -> bool:
        """Whether it will be seen from so near that single hairs and the eyelids' folds show."""
        return self.fineness > 0.6

    def count(self, fine: int) -> int:
        """How many points a row has that has `fine` of them in close-ups."""
        return max(3 if fine < 10 else 5, round(fine * self.fineness))

    def on_skin(self, points: Floats) -> Floats:
        """Points (..., 2) of x and y in head coordinates on the skin of the front: (..., 3)."""
        flat = points.reshape(-1, 2)
        place = self.frame.to_figure(np.column_stack([flat, np.full(len(flat), 14.0)]))
        for _ in range(24):
            place[:, 2] -= 0.7 * np.clip(self.face(place), -0.5, 3.0)
        return self.frame.to_head(place).reshape(*points.shape[:-1], 3)

    def skin_normals(self, places: Floats) -> Floats:
        """(..., 3) of the skin at places (..., 3) in head coordinates on or near it."""
        flat = self.frame.to_figure(places.reshape(-1, 3))
        return normals_of(self.face, flat, 0.25).reshape(places.shape)


def pressed(canvas: Canvas, material: str, points: Floats, lift: float, shade: Floats, side: int = 1) -> Piece:
    """A grid (N, M, 2) of x, y laid on to the skin `lift` cm above it, on the left (side 1) or mirrored (-1).

    Coarse skin does not follow the face so closely, so the patch lies higher on it.
    """
    places = canvas.on_skin(points)
    normals = canvas.skin_normals(places)
    lift = lift * (0.6 + 0.4 / canvas.fineness)
    raised = places + lift * (0.5 * normals + (0, 0, 0.5))
    return laid(canvas, material, raised, shade, normals, side)


def laid(
    canvas: Canvas, material: str, places: Floats, shade: Floats, normals: Floats | None = None, side: int = 1
) -> Piece:
    """A grid (N, M, 3) of places in head coordinates as a patch facing forwards; its own normals unless given."""
    n, m, _ = places.shape
    normals = grid_normals(places) if normals is None else normals
    i = np.arange(n * m).reshape(n, m)
    a, b, c, d = i[:-1, :-1].ravel(), i[1:, :-1].ravel(), i[1:, 1:].ravel(), i[:-1, 1:].ravel()
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    flat = places.reshape(-1, 3)
    corners = flat[triangles]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    triangles = triangles[np.linalg.norm(facing, axis=1) > 1e-7]
    if facing[:, 2].sum() * side < 0:
        triangles = triangles[:, ::-1]
    if material == "skin":  # whose surfaces are closed: the patch has a back
        triangles = np.concatenate([triangles, triangles[:, ::-1]])
    mesh = Mesh(canvas.frame.to_figure(flat * (side, 1, 1)), triangles)
    dimmed = np.asarray(np.broadcast_to(shade, (n, m)).reshape(-1), dtype=np.float64)
    return Piece(material, mesh, normals.reshape(-1, 3) * (side, 1, 1), dimmed)


def both_sides_laid(
    canvas: Canvas, material: str, places: Floats, shade: Floats, normals: Floats | None = None
) -> list[Piece]:
    """`laid` on the left and mirrored on the right."""
    return [laid(canvas, material, places, shade, normals, side) for side in BOTH]


def ribbon(x: Floats, low: Floats, high: Floats, rows: Sequence[float] | Floats) -> Floats:
    """(N, M, 2) grid between two outlines over x (N,), at shares `rows` (M,) of the way from low to high."""
    v = np.asarray(rows, dtype=np.float64)
    return np.stack([np.repeat(x[:, None], len(v), 1), low[:, None] + (high - low)[:, None] * v], axis=-1)


def grid_normals(places: Floats) -> Floats:
    """(N, M, 3) unit normals of a grid of places, forwards; straight ahead where the grid is pinched to a point."""
    along, across = np.gradient(places, axis=0), np.gradient(places, axis=1)
    normals = np.cross(along, across)
    normals *= np.where(normals[..., 2].sum() < 0, -1, 1)
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    return np.where(length > 1e-9, normals / np.maximum(length, 1e-9), (0.0, 0.0, 1.0))

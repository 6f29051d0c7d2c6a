"""Haircuts as meshes: caps, the locks combed over them, wisps along hairlines, at every level of detail."""

from __future__ import annotations

import numpy as np

from stimuli.body_generator.fields import Field
from stimuli.body_generator.figure import Figure
from stimuli.body_generator.hair import Style, solid_field, style
from stimuli.body_generator.head import HeadFrame, head_frame
from stimuli.body_generator.light import occlusion
from stimuli.body_generator.locks import comb
from stimuli.body_generator.pieces import Piece
from stimuli.body_generator.polygons import Mesh, normals_of, polished, polygonise, simplified
from stimuli.body_generator.scalp import Hairline, grown_cap, wisps
from stimuli.skeleton import Floats

BUDGETS = (800, 400, 150)  # triangles of the cap; three times as many, wisps among them, where no locks lie on it
LOCK_SEGMENTS = (4, 2, 0)
LOCK_SHARE = (1.0, 0.55, 0.0)
WISPS = (300, 80, 0)
WISP_LENGTH = 0.34  # cm
GRIDDED = 2  # levels whose caps are grids from the hairline; a coarser grid would cut into the head
LIFTS = (0.0, 0.12)  # cm, of those caps
GROWN_SHARE = 0.66  # of the cap's triangles that grow from the hairline, where something hangs too
COLUMNS = 4.5  # times as many columns as rows
FINE = (160, 48)  # columns and rows of the cap that locks root in
UNDER_LOCKS = 0.62  # of the light that a cap gets among locks


def hair_pieces(name: str, figure: Figure, everything: Field, coarseness: float = 1.0) -> list[list[Piece]]:
    """One haircut at each level; the material is called hair:NAME."""
    frame, cut = head_frame(figure), style(name, figure)
    volume = solid_field(cut.volume, figure)
    hanging = _closed(cut.solid, figure, coarseness)
    closed = _closed(cut.volume, figure, coarseness) if cut.line is not None else hanging
    assert closed is not None
    roots = _cap(cut, frame, hanging, 0)
    found = []
    for level in range(len(BUDGETS)):
        combed = bool(cut.locks and LOCK_SEGMENTS[level])
        fringed = round(WISPS[level] / coarseness) if cut.line is not None else 0
        plain = 3 * BUDGETS[level] - WISPS[level] if LOCK_SEGMENTS[level] else BUDGETS[level]
        budget = (BUDGETS[level] if combed else plain) / coarseness
        gridded = level < GRIDDED
        cap = _cap(cut, frame, hanging, level, budget) if gridded else simplified(closed, round(budget))
        normals = normals_of(volume, cap.positions, 0.3)
        shade = occlusion(everything, volume, cap.positions, normals)
        if not combed:
            normals, shade = _grained(normals, shade)
        pieces = [Piece(f"hair:{name}", cap, normals, shade * (UNDER_LOCKS if combed else 1.0))]
        if combed:
            locks = comb(cut, frame, roots, LOCK_SEGMENTS[level], LOCK_SHARE[level] / coarseness)
            open_sky = occlusion(everything, volume, locks.mesh.positions, locks.normals)
            pieces.append(Piece(f"hair:{name}", locks.mesh, locks.normals, locks.shade * (0.35 + 0.65 * open_sky)))
        if cut.line is not None and fringed:
            ends, normals, shade = wisps(cut.line, cut.flow, fringed, WISP_LENGTH)
            ends = Mesh(frame.to_figure(ends.positions), ends.triangles)
            open_sky = occlusion(everything, volume, ends.positions, normals)
            pieces.append(Piece(f"hair:{name}", ends, normals, shade * open_sky))
        found.append(pieces)
    return found


def _closed(solid: Field | None, figure: Figure, coarseness: float) -> Mesh | None:
    """A closed solid of a haircut, finely."""
    if solid is None:
        return None
    spacing = 0.42 * coarseness
    lower = np.array([-13.0, figure.stature - 34, -22])
    upper = np.array([13.0, figure.stature + 4, 13])
    field = solid_field(solid, figure)
    return polished(polygonise(field, lower, upper, spacing), field, spacing, rounds=1)


def _cap(cut: Style, frame: HeadFrame, hanging: Mesh | None, level: int, budget: float | None = None) -> Mesh:
    """The solid under the locks in about so many triangles, or finely: what grows from a hairline and what hangs."""
    share = 1.0 if hanging is None else GROWN_SHARE if cut.line is not None else 0.0
    parts = []
    if cut.line is not None:
        parts.append(_grown(cut.line, cut, frame, LIFTS[level], None if budget is None else share * budget))
    if hanging is not None:
        parts.append(hanging if budget is None else simplified(hanging, round((1 - share) * budget)))
    counts = np.cumsum([0] + [len(part.positions) for part in parts])
    triangles = [part.triangles + first for part, first in zip(parts, counts[:-1], strict=True)]
    return Mesh(np.concatenate([part.positions for part in parts]), np.concatenate(triangles))


def _grown(line: Hairline, cut: Style, frame: HeadFrame, lift: float, budget: float | None) -> Mesh:
    """The part of a cap that grows from the hairline."""
    columns, rows = FINE
    if budget is not None:
        rows = round(np.sqrt(budget / 2 / COLUMNS))
        columns = round(budget / 2 / rows)
    mesh = grown_cap(line, cut.volume, columns, rows, lift)
    return Mesh(frame.to_figure(mesh.positions), mesh.triangles)


def _grained(normals: Floats, shade: Floats) -> tuple[Floats, Floats]:
    """Normals and shade of clipped hair: uneven from vertex to vertex, so that it does not shine like a cap."""
    rng = np.random.default_rng(8)
    uneven = normals + rng.normal(0, 0.05, normals.shape)
    return uneven / np.linalg.norm(uneven, axis=1, keepdims=True), shade * rng.uniform(0.84, 1.0, len(shade))

"""A whole body from a figure: parts meshed, skinned, shaded, simplified and gathered by material."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stimuli.bodies.body import Body, Surface
from stimuli.body_generator.blush import blush
from stimuli.body_generator.face import face_patches
from stimuli.body_generator.fields import Field
from stimuli.body_generator.figure import Figure
from stimuli.body_generator.hair import hangs, knot_height, style_names
from stimuli.body_generator.haircuts import hair_pieces
from stimuli.body_generator.head import head_frame
from stimuli.body_generator.heat import Heat, bone_heat, weights_at
from stimuli.body_generator.light import occlusion
from stimuli.body_generator.parts import Part, parts_of
from stimuli.body_generator.patches import Canvas
from stimuli.body_generator.pieces import Piece
from stimuli.body_generator.polygons import (
    Mesh,
    edged,
    mirror_image,
    normals_of,
    polished,
    polygonise,
    settled,
    simplified,
)
from stimuli.body_generator.seams import sewn
from stimuli.skeleton import JOINTS, PARENTS, Floats, Skeleton

ROUGHNESS = {
    "skin": 0.55,
    "hair": 0.45,
    "shirt": 0.9,
    "trousers": 0.9,
    "shoes": 0.5,
    "soles": 0.8,
    "laces": 0.9,
    "eye": 0.15,
    "iris": 0.12,
    "pupil": 0.1,
    "lash": 0.8,
    "brow": 0.8,
    "lip": 0.4,
}
ORDER = tuple(ROUGHNESS)
LEVELS = 3
RIM = 0.45  # cm inside cloth up to which the cloth's own normals count
EDGE_REACH = (1.0, 1.5, 0.0)  # cm from its end within which cloth is brought to a sharp edge; not in crowds
UNION_SPACING = 1.15  # cm


def build(figure: Figure, coarseness: float = 1.0, report: Callable[[str], None] = lambda _: None) -> Body:
    """The body of a figure; `coarseness` > 1 widens every grid (for tests)."""
    parts, everything = parts_of(figure)
    report("weights")
    heat = body_heat(figure, everything, coarseness)
    levels: list[list[Piece]] = [[] for _ in range(LEVELS)]
    for part in parts:
        report(part.name)
        for level, piece in enumerate(solid_pieces(part, everything, coarseness)):
            levels[level] += piece
    report("face")
    head = next(part for part in parts if part.name == "head")
    for level, fineness in enumerate((1.0, 0.5, 0.38)):
        levels[level] += face_pieces(head, everything, figure, fineness)
    for name in style_names(figure):
        report(name)
        for level, pieces in enumerate(hair_pieces(name, figure, everything, coarseness)):
            levels[level] += pieces
    return gathered(figure, levels, heat)


def body_heat(figure: Figure, everything: Field, coarseness: float = 1.0) -> Heat:
    """Bone heat on one coarse mesh of the whole person."""
    reach = figure.shoulder[0] + 0.5 * (figure.upper_arm + figure.forearm + figure.hand) + 6
    lower, upper = np.array([-reach, -1.5, -20]), np.array([reach, figure.stature + 3, 24])
    spacing = UNION_SPACING * coarseness
    mesh = polished(polygonise(everything, lower, upper, spacing), everything, spacing, rounds=1)
    return bone_heat(mesh, figure.bones())


def solid_pieces(part: Part, everything: Field, coarseness: float = 1.0) -> list[list[Piece]]:
    """The part at each level of detail, with its mirror image when it is one of two."""
    spacing = part.spacing * coarseness
    found: list[list[Piece]] = []
    finest = None
    for level, budget in enumerate(part.budgets):
        field = part.field if level == 0 else part.plain
        if finest is None or (level == 1 and part.plain is not part.field):
            finest = polished(polygonise(field, part.lower, part.upper, spacing), field, spacing)
            if level == 0:
                finest = _edged(part, finest, 0.3)
        if budget == 0:
            found.append([])
            continue
        mesh = simplified(finest, round(budget / coarseness))
        mesh = Mesh(settled(field, mesh.positions, 0.35 * part.spacing), mesh.triangles)
        mesh = _edged(part, mesh, EDGE_REACH[level])
        edge = np.sqrt(_area(mesh) / max(len(mesh.triangles), 1))
        normals = _normals(part, field, mesh.positions, float(np.clip(0.22 * edge, 0.12, 0.5)))
        shade = _shade(part, everything, field, mesh.positions, normals)
        piece = Piece(part.material, mesh, normals, shade)
        pieces = [piece]
        if part.seams and level == 0:
            pieces.append(Piece(part.material, *sewn(mesh, normals, shade, part.seams)))
        found.append([*pieces, *map(_mirror, pieces)] if part.twin else pieces)
    return found


def _edged(part: Part, mesh: Mesh, reach: float) -> Mesh:
    if part.outside is None or part.ends is None or reach == 0:
        return mesh
    return edged(mesh, part.outside, part.ends, 0.75 * RIM, reach)


def _normals(part: Part, field: Field, positions: Floats, step: float) -> Floats:
    """(V, 3) of the part; on the outside of cloth those of the cloth, so that hems stay crisp in coarse triangles."""
    normals = normals_of(field, positions, step)
    if part.outside is None:
        return normals
    share = np.clip((part.outside(positions) + RIM) / (0.6 * RIM), 0, 1)[:, None]
    mixed = share * normals_of(part.outside, positions, step) + (1 - share) * normals
    return mixed / np.maximum(np.linalg.norm(mixed, axis=1, keepdims=True), 1e-9)


def face_pieces(part: Part, everything: Field, figure: Figure, fineness: float) -> list[Piece]:
    """Eyes, brows and lips on the head; `fineness` 1 for close-ups, less for coarser levels."""
    pieces = []
    for patch in face_patches(Canvas(part.field, head_frame(figure), fineness), figure.female):
        shade = patch.shade
        if patch.material == "skin":
            shade = shade * _shade(part, everything, part.field, patch.mesh.positions, patch.normals)
        pieces.append(Piece(patch.material, patch.mesh, patch.normals, shade))
    return pieces


def _shade(part: Part, everything: Field, field: Field, positions: Floats, normals: Floats) -> Floats:
    """(V,) of a part's surface: the sky that it sees, what is painted on it, what goes on under it."""
    shade = 1 - (1 - part.soft) * (1 - occlusion(everything, field, positions, normals))
    return shade * part.paint(positions)


def gathered(figure: Figure, levels: list[list[Piece]], heat: Heat) -> Body:
    """Pieces joined by material, in metres, with four weights per vertex."""
    joints = figure.joints() / 100
    offsets = joints - np.array([joints[p] if p >= 0 else np.zeros(3) for p in PARENTS])
    surfaces = tuple(_surfaces(figure, pieces, heat) for pieces in levels)
    crown = max(float(s.positions[:, 1].max()) for s in surfaces[0] if s.name == "skin")
    return Body(figure.name, Skeleton(offsets), crown, surfaces)


def _surfaces(figure: Figure, pieces: list[Piece], heat: Heat) -> tuple[Surface, ...]:
    names = sorted(dict.fromkeys(p.material for p in pieces), key=lambda n: ORDER.index(n.split(":")[0]))
    return tuple(_surface(figure, name, [p for p in pieces if p.material == name], heat) for name in names)


def _surface(figure: Figure, name: str, pieces: list[Piece], heat: Heat) -> Surface:
    positions = np.concatenate([p.mesh.positions for p in pieces])
    counts = np.cumsum([0] + [len(p.mesh.positions) for p in pieces])
    triangles = np.concatenate([p.mesh.triangles + first for p, first in zip(pieces, counts[:-1], strict=True)])
    kind = name.split(":")[0]
    joints, weights = weights_at(heat, positions)
    if kind == "hair":
        hanging = hangs(name.removeprefix("hair:"), figure, positions)
        joints[hanging], weights[hanging] = (JOINTS.index("head"), 0, 0, 0), (1.0, 0, 0, 0)
    return Surface(
        name=name,
        colour=np.array(figure.colours[kind]),
        roughness=ROUGHNESS[kind],
        positions=positions / 100,
        normals=np.concatenate([p.normals for p in pieces]),
        occlusion=np.concatenate([p.shade for p in pieces]),
        joints=joints,
        weights=weights,
        triangles=triangles,
        blush=blush(figure, positions) if name == "skin" else None,
        knot=knot_height(name.removeprefix("hair:"), figure),
    )


def _mirror(piece: Piece) -> Piece:
    return Piece(piece.material, mirror_image(piece.mesh), piece.normals * (-1, 1, 1), piece.shade)


def _area(mesh: Mesh) -> float:
    a, b, c = (mesh.positions[mesh.triangles[:, i]] for i in range(3))
    return float(np.sum(np.linalg.norm(np.cross(b - a, c - a), axis=1)) / 2)

"""Eyes: the visible part of two eyeballs, lids of some thickness which lie on them, and lashes.

A patch of colour on a closed face looks pasted on from the side; so the cornea is the foremost point, both corners lie
further back, and the lids stand before the eyeball. Coordinates as in `head`, cm.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stimuli.body_generator.patches import Canvas, both_sides_laid, grid_normals, laid, ribbon
from stimuli.body_generator.pieces import Piece
from stimuli.skeleton import Floats

EYE = (3.2, 163.2)  # centre of the left iris
INNER, OUTER = 1.75, 4.70  # x of the corners: fissures of 3.0 cm, 3.4 cm apart (Farkas 1994: 3.1 and 3.3)
APEX = 8.45  # z of the cornea
_BEND = {"inner": 1.55, "outer": 1.40, "upright": 1.20}  # cm, radii of curvature of what is seen of the eyeball
_IRIS, _PUPIL = 0.58, 0.21  # radii; an iris measures 11.7 mm across (Rufer et al. 2005)

Outline = Callable[[Floats], Floats]


def eyes(canvas: Canvas, female: bool) -> list[Piece]:
    """Whites, irises, pupils, lids and lashes of both eyes."""
    patches = [*_white(canvas, female), *_iris(canvas, female), *_lashes(canvas, female)]
    if canvas.near:
        patches += [*_glint(canvas), *_upper_lid(canvas, female), *_lower_lid(canvas, female)]
    return patches


def eyeball(points: Floats) -> Floats:
    """z (...,) of the eyeball at points (..., 2); it falls back on all sides of the cornea."""
    across, up = points[..., 0] - EYE[0], points[..., 1] - EYE[1]
    bend = np.where(across > 0, _BEND["outer"], _BEND["inner"])
    return np.asarray(APEX - across**2 / (2 * bend) - up**2 / (2 * _BEND["upright"]))


def _lids(female: bool) -> tuple[Outline, Outline]:
    """Heights of upper and lower lid along the eye, 0 at the nose; 1.0 cm apart (Farkas 1994: 1.08 and 1.09)."""
    open_up, open_down = (0.52, 0.47) if female else (0.45, 0.46)
    tilt = 0.20 if female else 0.12

    def base(t: Floats) -> Floats:
        return np.asarray(EYE[1] - 0.10 + tilt * (t - 0.3))

    def upper(t: Floats) -> Floats:
        return np.asarray(base(t) + open_up * np.sin(np.pi * np.clip(t, 0, 1) ** 0.88) ** 0.72)

    def lower(t: Floats) -> Floats:
        return np.asarray(base(t) - open_down * np.sin(np.pi * np.clip(t, 0, 1) ** 1.12) ** 0.85)

    return upper, lower


def _place(x: Floats) -> Floats:
    return np.asarray((x - INNER) / (OUTER - INNER))


def _x(t: Floats) -> Floats:
    return np.asarray(INNER + t * (OUTER - INNER))


def _on_eye(canvas: Canvas, points: Floats, lift: float) -> Floats:
    skin = canvas.on_skin(points)[..., 2]
    return np.concatenate([points, np.maximum(eyeball(points), skin + 0.02)[..., None] + lift], axis=-1)


def _white(canvas: Canvas, female: bool) -> list[Piece]:
    upper, lower = _lids(female)
    t = np.linspace(0, 1, canvas.count(16))
    v = np.linspace(0, 1, canvas.count(6))
    lids_shadow = 0.55 * v[None, :] ** 2.5 + 0.12 * (1 - v[None, :]) ** 3
    shade = np.clip(0.88 - lids_shadow - 0.6 * np.abs(2 * t[:, None] - 1) ** 2.2, 0.12, 1)
    return both_sides_laid(canvas, "eye", _on_eye(canvas, ribbon(_x(t), lower(t), upper(t), v), 0.0), shade)


def _iris(canvas: Canvas, female: bool) -> list[Piece]:
    upper, lower = _lids(female)
    angle = np.linspace(0, 2 * np.pi, canvas.count(18))
    patches = []
    for material, radius, lift in (("iris", _IRIS, 0.025), ("pupil", _PUPIL, 0.04)):
        ring = np.linspace(0.02, 1, 3 if canvas.near else 2)
        disc = np.stack(
            [EYE[0] + radius * np.outer(np.cos(angle), ring), EYE[1] + radius * np.outer(np.sin(angle), ring)], -1
        )
        place = np.clip(_place(disc[..., 0]), 0, 1)
        disc[..., 1] = np.clip(disc[..., 1], lower(place), upper(place))
        shade = np.clip(np.where(ring > 0.8, 0.45, 1.0) - 0.5 * np.clip(np.sin(angle), 0, 1)[:, None] ** 2, 0.25, 1)
        patches += both_sides_laid(canvas, material, _on_eye(canvas, disc, lift), shade)
    return patches


def _glint(canvas: Canvas) -> list[Piece]:
    """A reflection, on the same side of both eyes: that is where the light is."""
    angle = np.linspace(0, 2 * np.pi, 7)
    disc = np.stack([0.08 * np.outer(np.cos(angle), (0.02, 1)), 0.08 * np.outer(np.sin(angle), (0.02, 1))], -1)
    return [
        laid(
            canvas,
            "eye",
            _on_eye(canvas, disc + np.array([EYE[0] + side * 0.17, EYE[1] + 0.2]), 0.05),
            np.ones((7, 2)),
            None,
            side,
        )
        for side in (1, -1)
    ]


def _lashes(canvas: Canvas, female: bool) -> list[Piece]:
    """Dark edges of the lids; the upper ones stand out forwards."""
    upper, lower = _lids(female)
    t = np.linspace(0.0, 1.05 if female else 1.0, canvas.count(16))
    inside = np.clip(t, 0, 1)
    thick = (0.10 if female else 0.06) * np.clip(0.25 + 1.1 * t, 0, 1) * np.clip((1.09 - t) / 0.2, 0.05, 1)
    edge = upper(inside) + 0.9 * np.clip(t - 1, 0, 1)
    long = (0.17 if female else 0.08) * np.sin(np.pi * np.clip(0.12 + 0.80 * t, 0, 1))
    points = ribbon(_x(t), edge - 0.02, edge + thick, (0.0, 0.6, 1.0))
    places = _on_eye(canvas, points, 0.05)
    out = 0.08 * np.clip(3 * t, 0, 1)
    places[..., 2] += np.stack([0 * t, out, out + long * np.clip(3 * t, 0, 1)], axis=1)
    patches = both_sides_laid(canvas, "lash", places, np.ones(points.shape[:2]))
    if canvas.near:
        t = np.linspace(0.15, 1, canvas.count(12))
        points = ribbon(_x(t), lower(t) - 0.045 * np.sin(np.pi * t), lower(t) + 0.01, (0.0, 1.0))
        patches += both_sides_laid(canvas, "lash", _on_eye(canvas, points, 0.10), np.ones(points.shape[:2]))
    return patches


def _upper_lid(canvas: Canvas, female: bool) -> list[Piece]:
    """From the edge over the eyeball to the crease, and the fold of skin above it."""
    upper, _ = _lids(female)
    fold = 0.08 if female else 0.13
    rows = (
        (-0.02, lambda eye, skin: eye + 0.01),
        (0.03, lambda eye, skin: eye + 0.13),
        (0.20, lambda eye, skin: eye + 0.17),
        (0.33, lambda eye, skin: np.maximum(eye + 0.10, skin + 0.02)),
        (0.47, lambda eye, skin: np.maximum(eye + 0.16, skin + fold)),
        (0.90, lambda eye, skin: skin - 0.03),
    )
    crease = np.array([0.7, 1.0, 1.0, 0.72, 1.0, 1.0])
    return _lid(canvas, upper, rows, crease)


def _lower_lid(canvas: Canvas, female: bool) -> list[Piece]:
    """From the edge over the eyeball on to the cheek."""
    _, lower = _lids(female)
    rows = (
        (0.02, lambda eye, skin: eye + 0.01),
        (-0.04, lambda eye, skin: eye + 0.10),
        (-0.22, lambda eye, skin: np.maximum(eye + 0.09, skin + 0.06)),
        (-0.65, lambda eye, skin: skin - 0.03),
    )
    return _lid(canvas, lower, rows, np.array([0.8, 1.0, 0.96, 1.0]))


Depth = Callable[[Floats, Floats], Floats]


def _lid(canvas: Canvas, edge: Outline, rows: tuple[tuple[float, Depth], ...], shade: Floats) -> list[Piece]:
    """A lid along its edge; at both corners of the eye and far from it it runs out under the skin.

    rows: height above the edge (cm), and z from those of eyeball and skin there.
    """
    t = np.concatenate([[-0.14, -0.05], np.linspace(0.03, 0.97, canvas.count(14)), [1.07, 1.18]])
    standing = np.clip(np.sin(np.pi * np.clip(0.03 + 0.94 * t, 0, 1)) * 3, 0, 1)
    heights = edge(np.clip(t, 0, 1))
    places = []
    for up, depth in rows:
        points = np.column_stack([_x(t), heights + up * (0.35 + 0.65 * standing)])
        place = canvas.on_skin(points)
        skin = place[:, 2]
        eye = np.maximum(eyeball(points), skin - 0.1)
        place[:, 2] = standing * depth(eye, skin) + (1 - standing) * (skin - 0.03)
        places.append(place)
    grid = np.stack(places, axis=1)
    own, skin_normals = grid_normals(grid), canvas.skin_normals(grid)
    share = standing[:, None, None] * np.array([1.0] * (len(rows) - 1) + [0.0])[None, :, None]
    normals = share * own + (1 - share) * skin_normals
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-9)
    dimmed = 1 - standing[:, None] * (1 - shade)[None, :]
    return both_sides_laid(canvas, "skin", grid, dimmed, normals)

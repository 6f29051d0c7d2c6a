"""Eyes, lashes, brows and lips: thin coloured patches pressed on to the face along its looking direction.

Sculpted eyelids of this size look ghastly; patches with crisp outlines do not. Coordinates as in `head`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stimuli.body_generator.fields import Field
from stimuli.body_generator.head import HeadFrame
from stimuli.body_generator.polygons import Mesh, normals_of
from stimuli.skeleton import Floats

EYE = (3.2, 163.2)  # centre of the left iris
_EYE_FROM, _EYE_TO = 1.72, 4.72
_IRIS, _PUPIL = 0.62, 0.24


@dataclass(frozen=True, eq=False)
class Patch:
    """One painted piece: material, mesh (cm, in the figure), normals (V, 3) and occlusion (V,) in 0..1."""

    material: str
    mesh: Mesh
    normals: Floats
    occlusion: Floats


Outline = Callable[[Floats], Floats]


def face_patches(head: Field, frame: HeadFrame, female: bool, fineness: float = 1.0) -> list[Patch]:
    """All patches of both sides; `fineness` scales their number of triangles."""
    count = lambda n: max(3 if n < 10 else 5, round(n * fineness))  # noqa: E731
    rng = np.random.default_rng(3)
    patches: list[Patch] = []
    upper, lower = _lids(female)
    along = np.linspace(0, 1, count(22))

    def strip(material: str, x: Floats, low: Floats, high: Floats, rows: int, lift: float, shade: Floats) -> None:
        v = np.linspace(0, 1, rows)
        points = np.stack([np.repeat(x[:, None], rows, 1), low[:, None] + (high - low)[:, None] * v], axis=-1)
        for side in (1, -1):
            patches.append(_pressed(material, points, side, lift, shade, head, frame))

    t = along
    x = _EYE_FROM + t * (_EYE_TO - _EYE_FROM)
    rows = count(7)
    v = np.linspace(0, 1, rows)
    white = np.clip(0.95 - 0.70 * v[None, :] ** 3 - 0.35 * np.abs(2 * t[:, None] - 1) ** 4, 0.2, 1)
    strip("eye", x, lower(t), upper(t), rows, 0.03, white)

    for material, radius, lift in (("iris", _IRIS, 0.05), ("pupil", _PUPIL, 0.065)):
        angle = np.linspace(0, 2 * np.pi, count(20))
        ring = np.linspace(0.02, 1, 3 if fineness > 0.3 else 2)
        disc = np.stack(
            [EYE[0] + radius * np.outer(np.cos(angle), ring), EYE[1] + radius * np.outer(np.sin(angle), ring)], -1
        )
        place = np.clip((disc[..., 0] - _EYE_FROM) / (_EYE_TO - _EYE_FROM), 0, 1)
        disc[..., 1] = np.clip(disc[..., 1], lower(place), upper(place))
        shade = np.clip(np.where(ring > 0.8, 0.45, 1.0) - 0.5 * np.clip(np.sin(angle), 0, 1)[:, None] ** 2, 0.25, 1)
        for side in (1, -1):
            patches.append(_pressed(material, disc, side, lift, shade, head, frame))
    angle = np.linspace(0, 2 * np.pi, 7)
    sides = (1, -1) if fineness > 0.3 else ()
    glint = np.stack(
        [3.38 + 0.085 * np.outer(np.cos(angle), (0.02, 1)), 163.42 + 0.085 * np.outer(np.sin(angle), (0.02, 1))], -1
    )
    for side in sides:  # light comes from one side for both eyes
        here = glint if side > 0 else glint * (1, 1) - (0.36, 0)
        patches.append(_pressed("eye", here, side, 0.08, np.ones((7, 2)), head, frame))

    thick = 0.125 if female else 0.085
    lash_t = np.linspace(0.0, 1.05 if female else 1.0, count(18))
    lash_x = _EYE_FROM + lash_t * (_EYE_TO - _EYE_FROM)
    lid = upper(np.clip(lash_t, 0, 1)) + 0.9 * np.clip(lash_t - 1, 0, 1)
    swell = thick * np.clip(0.25 + 1.1 * lash_t, 0, 1) * np.clip((1.09 - lash_t) / 0.2, 0.05, 1)
    strip("lash", lash_x, lid - 0.035, lid + swell, 3, 0.10, np.ones((len(lash_t), 3)))
    strip("lash", x, lower(t) - 0.035 * np.sin(np.pi * t), lower(t) + 0.012, 2, 0.07, np.ones((len(t), 2)))

    if fineness > 0.3:  # the crease above the lid
        over = upper(t) + 0.17 + 0.10 * np.sin(np.pi * t)
        crease = 1 - 0.42 * np.sin(np.pi * np.clip(0.1 + 0.85 * t, 0, 1))[:, None] * np.array([0.0, 1.0, 0.0])
        strip("skin", x, over - 0.09, over + 0.14, 3, 0.12, crease)

    s = np.linspace(0, 1, count(22))
    brow_x = 1.35 + s * 3.95
    arch = (
        165.30
        + (0.50 if female else 0.25) * np.sin(np.pi * np.clip(s * 0.80, 0, 1)) ** 1.2
        - (0.35 if female else 0.45) * s**3
    )
    fat = (0.34 if female else 0.43) * np.clip(0.45 + s / 0.25, 0, 1) * (1 - 0.80 * s**1.8)
    rough = 0.05 * rng.random((2, len(s)))
    strip(
        "brow",
        brow_x,
        arch - fat * 0.5 - rough[0],
        arch + fat * 0.5 + rough[1],
        3,
        0.05,
        0.75 + 0.25 * rng.random((len(s), 3)),
    )

    patches += _lips(head, frame, female, count)
    return patches


def _lids(female: bool) -> tuple[Outline, Outline]:
    """Heights of upper and lower lid along the eye, 0 at the nose."""
    open_up, open_down = (0.47, 0.42) if female else (0.40, 0.39)
    tilt = 0.20 if female else 0.12
    base = lambda t: EYE[1] - 0.12 + tilt * (t - 0.3)  # noqa: E731
    upper = lambda t: base(t) + open_up * np.sin(np.pi * np.clip(t, 0, 1) ** 0.88) ** 0.72  # noqa: E731
    lower = lambda t: base(t) - open_down * np.sin(np.pi * np.clip(t, 0, 1) ** 1.12) ** 0.85  # noqa: E731
    return upper, lower


def _lips(head: Field, frame: HeadFrame, female: bool, count: Callable[[float], int]) -> list[Patch]:
    half = 2.35 if female else 2.5
    u = np.linspace(-1, 1, count(23))
    x = half * u
    fade = (1 - np.abs(u) ** 2.2) ** 0.8
    middle = 156.88 + 0.05 * np.cos(2 * np.pi * u) + (0.20 if female else 0.36) * u**2 + 0.16 * u**4
    bow = 0.66 if female else 0.48
    top = middle + bow * fade * (
        1 - 0.16 * np.exp(-((u / 0.13) ** 2)) + 0.10 * np.exp(-(((np.abs(u) - 0.24) / 0.16) ** 2))
    )
    bottom = middle - (0.78 if female else 0.62) * fade * (1 - 0.1 * u**2)
    rows = count(5)
    v = np.linspace(0, 1, rows)
    patches = []
    for low, high, dark in ((middle, top, v[::-1]), (bottom, middle, v)):
        points = np.stack([np.repeat(x[:, None], rows, 1), low[:, None] + (high - low)[:, None] * v], axis=-1)
        shade = np.repeat(1 - (0.62 if female else 0.5) * dark[None, :] ** 5, len(x), axis=0) * (
            1 - 0.25 * np.abs(u[:, None]) ** 6
        )
        patches.append(_pressed("lip", points, 1, 0.06, shade, head, frame))
    return patches


def _pressed(
    material: str, points: Floats, side: int, lift: float, shade: Floats, head: Field, frame: HeadFrame
) -> Patch:
    """A grid (N, M, 2) of x, y in head coordinates laid on to the face `lift` above the skin."""
    n, m, _ = points.shape
    flat = points.reshape(-1, 2)
    start = np.column_stack([side * flat[:, 0], flat[:, 1], np.full(len(flat), 14.0)])
    place = frame.to_figure(start)
    for _ in range(24):
        place[:, 2] -= 0.7 * np.clip(head(place), -0.5, 3.0)
    normals = normals_of(head, place, 0.25)
    place = place + lift * frame.scale * (0.5 * normals + (0, 0, 0.5))
    i = np.arange(n * m).reshape(n, m)
    a, b, c, d = i[:-1, :-1].ravel(), i[1:, :-1].ravel(), i[1:, 1:].ravel(), i[:-1, 1:].ravel()
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    corners = place[triangles]
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    triangles = np.where((face[:, 2] < 0)[:, None], triangles[:, ::-1], triangles)
    triangles = triangles[np.linalg.norm(face, axis=1) > 1e-7]
    if material == "skin":  # whose surfaces are closed: the patch has a back
        triangles = np.concatenate([triangles, triangles[:, ::-1]])
    shade = np.broadcast_to(shade, (n, m)).reshape(-1)
    return Patch(material, Mesh(place, triangles), normals, np.asarray(shade, dtype=np.float64))

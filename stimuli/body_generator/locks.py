"""Locks of hair: tapered strips combed along a haircut's flow, rooted all over its cap. Knows no particular haircut."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stimuli.body_generator.hair import Style
from stimuli.body_generator.head import HeadFrame
from stimuli.body_generator.polygons import Mesh, normals_of
from stimuli.skeleton import Floats

ROOT_UNDER, TIP_UNDER = 0.22, 0.10  # cm under the cap's surface, so that no lock begins or ends with a step
STEPS = 8
"""Steps in which a lock is laid along the head at least; longer ones would leave a round head and float beside it."""


@dataclass(frozen=True, eq=False)
class Locks:
    """Locks as one open mesh (figure coordinates) with normals and shade (V,) in 0..1."""

    mesh: Mesh
    normals: Floats
    shade: Floats


def comb(cut: Style, frame: HeadFrame, cap: Mesh, segments: int, share: float = 1.0, seed: int = 11) -> Locks:
    """Locks rooted all over the cap (figure coordinates), each laid along the flow and tapered to its tip.

    segments: quads along a lock; share: part of the style's locks to comb.
    """
    rng = np.random.default_rng(seed)
    roots = _spread_roots(frame.to_head(cap.positions), cut, rng, round(cut.locks * share))
    length, width, lift = cut.shape(roots)
    spread = 1 / np.sqrt(share)
    length = length * rng.uniform(0.75, 1.25, len(roots))
    width = width * spread * rng.uniform(0.8, 1.3, len(roots))
    lift = lift * rng.uniform(0.6, 1.5, len(roots))
    sway = rng.normal(0, 0.08, len(roots))
    finer = -(-STEPS // segments)
    path = [roots]
    normals = [normals_of(cut.volume, roots, 0.3)]
    for _ in range(segments * finer):
        p, n = path[-1], normals[-1]
        d = cut.flow(p, n)
        side = np.cross(n, d)
        d = d + sway[:, None] * side
        d -= n * np.sum(d * n, axis=1, keepdims=True)
        d /= np.maximum(np.linalg.norm(d, axis=1, keepdims=True), 1e-6)
        following = p + d * (length / (segments * finer))[:, None]
        m = normals_of(cut.volume, following, 0.3)
        following = following - m * np.clip(cut.volume(following), -0.6, 0.6)[:, None]
        outside = cut.ends(following) > 0
        following[outside] = p[outside] + 0.25 * (following[outside] - p[outside])
        path.append(following)
        normals.append(m)
    path, normals = path[::finer], normals[::finer]
    return _as_strips(np.stack(path, 1), np.stack(normals, 1), width, lift, frame, rng)


def _spread_roots(points: Floats, cut: Style, rng: np.random.Generator, count: int) -> Floats:
    """Blue-noise roots: farthest-point picks among the cap's outer vertices."""
    outer = points[(cut.volume(points) > -0.35) & (cut.ends(points) < 0.2)]
    pool = outer[rng.choice(len(outer), min(len(outer), 4000), replace=False)]
    chosen = [0]
    nearest = np.linalg.norm(pool - pool[0], axis=1)
    for _ in range(count - 1):
        chosen.append(int(np.argmax(nearest)))
        nearest = np.minimum(nearest, np.linalg.norm(pool - pool[chosen[-1]], axis=1))
    return pool[np.array(chosen)]


def _as_strips(
    path: Floats, normals: Floats, width: Floats, lift: Floats, frame: HeadFrame, rng: np.random.Generator
) -> Locks:
    """Roof-shaped strips, three points across, the edges sunk into the cap."""
    count, rings, _ = path.shape
    t = np.linspace(0, 1, rings)
    along = np.gradient(path, axis=1)
    across = np.cross(along, normals)
    across /= np.maximum(np.linalg.norm(across, axis=2, keepdims=True), 1e-6)
    taper = np.clip(0.55 + 1.2 * t, 0, 1) * np.sqrt(np.clip(1.04 - t, 0, 1))
    half = 0.5 * width[:, None, None] * taper[None, :, None]
    raised = (lift[:, None] * np.sin(np.pi * np.clip(0.05 + 0.85 * t, 0, 1))[None, :])[..., None]
    raised = raised - (ROOT_UNDER * (1 - t) ** 6 + TIP_UNDER * t**6)[None, :, None]
    crest = path + normals * raised
    sunk = -0.20 - 0.1 * width[:, None, None]
    left, right = path - across * half + normals * sunk, path + across * half + normals * sunk
    vertices = np.stack([left, crest, right], axis=2)
    lean = 0.75 * across
    n = np.stack([normals - lean, normals, normals + lean], axis=2)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    tone = rng.uniform(0.62, 1.0, (count, 1, 1))
    depth = (0.62 + 0.38 * np.sin(np.pi * np.clip(0.1 + 0.65 * t, 0, 1)))[None, :, None]
    shade = tone * depth * np.array([0.62, 1.0, 0.62])
    i = np.arange(count * rings * 3).reshape(count, rings, 3)
    quads = [(i[:, :-1, k], i[:, 1:, k], i[:, 1:, k + 1], i[:, :-1, k + 1]) for k in range(2)]
    triangles = np.concatenate(
        [np.stack([a.ravel(), b.ravel(), c.ravel()], 1) for a, b, c, _ in quads]
        + [np.stack([a.ravel(), c.ravel(), d.ravel()], 1) for a, _, c, d in quads]
    )
    flat = vertices.reshape(-1, 3)
    corner = flat[triangles]
    face = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    wrong = np.sum(face * n.reshape(-1, 3)[triangles[:, 0]], axis=1) < 0
    triangles = np.where(wrong[:, None], triangles[:, ::-1], triangles)
    return Locks(Mesh(frame.to_figure(flat), triangles), n.reshape(-1, 3), shade.reshape(-1))

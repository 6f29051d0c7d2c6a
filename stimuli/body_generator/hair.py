"""Hair: a cap that follows the skull from a natural hairline, and locks combed over it along a flow.

A smooth cap alone is a helmet; overlapping tapered locks break its outline and its highlights. Coordinates as in
`head`: y up with the crown at 175, z forwards, x to the person's left.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from stimuli.body_generator.fields import Field, capsule, ellipsoid, generalised_cylinder, join, smooth_max
from stimuli.body_generator.figure import Figure
from stimuli.body_generator.head import HeadFrame, head_frame, skull_field
from stimuli.body_generator.polygons import Mesh, normals_of
from stimuli.skeleton import Floats

_ANGLES = np.radians([0, 14, 28, 40, 52, 62, 70, 80, 90, 98, 112, 128, 150, 180])  # 0 = front, 180 = nape
_LINE = {  # height of the hairline at those angles
    "short": (170.9, 171.1, 171.3, 170.0, 167.5, 165.3, 163.2, 161.8, 161.8, 164.9, 162.5, 159.0, 156.3, 155.6),
    "cropped": (171.0, 171.2, 171.6, 170.4, 167.8, 165.4, 163.4, 162.4, 162.6, 165.1, 162.6, 159.2, 156.6, 155.9),
    "ponytail": (170.2, 170.3, 170.2, 169.0, 166.6, 164.6, 163.2, 162.2, 162.6, 164.4, 161.8, 158.6, 155.8, 154.8),
}


@dataclass(frozen=True)
class Style:
    """A haircut: the solid under the locks, the surface locks lie on, and how locks run.

    cap:      field (head coordinates) of the solid, ending at the hairline.
    volume:   the same without its lower and front ends; locks are traced on it.
    flow:     points (N, 3), normals (N, 3) -> direction (N, 3), not necessarily tangent.
    locks:    how many; `length`, `width` and `lift` of each from its root (N, 3).
    ends:     field that is negative where locks may lie.
    """

    cap: Field
    volume: Field
    flow: Callable[[Floats, Floats], Floats]
    locks: int
    shape: Callable[[Floats], tuple[Floats, Floats, Floats]]
    ends: Field


def style_names(figure: Figure) -> tuple[str, ...]:
    """Haircuts of this figure, the default first."""
    return ("bob", "ponytail") if figure.female else ("short", "cropped")


def style(name: str, female: bool) -> Style:
    return {"short": _short, "cropped": _cropped, "bob": _bob, "ponytail": _ponytail}[name](skull_field(female))


def _angle(points: Floats) -> Floats:
    return np.abs(np.arctan2(points[:, 0], points[:, 2] + 0.3))


def _above_line(name: str) -> Field:
    """Height above the hairline (cm), positive inside the hair."""
    line = PchipInterpolator(_ANGLES, _LINE[name])
    return lambda p: p[:, 1] - line(_angle(p))


def _cap(skull: Field, name: str, thickness: Callable[[Floats], Floats]) -> tuple[Field, Field]:
    above = _above_line(name)

    def cap(p: Floats) -> Floats:
        grown = np.clip(above(p) / 2.2, -1, 1)
        grown = np.where(grown > 0, np.maximum(grown, 0) ** 0.6, 3 * grown)
        return skull(p) - thickness(p) * grown + 0.12

    return cap, lambda p: skull(p) - thickness(p)


def _short(skull: Field) -> Style:
    """Short sides, longer top combed from a parting on the left."""

    def thickness(p: Floats) -> Floats:
        top = np.clip((p[:, 1] - 167.5) / 4.5, 0, 1)
        top = top * top * (3 - 2 * top)
        front = np.clip((p[:, 2] - 1) / 7, 0, 1)
        parting = np.exp(-(((p[:, 0] - 4.0) / 0.7) ** 2)) * (p[:, 2] > -3)
        return 0.55 + top * (1.25 + 0.9 * front) * (1 - 0.45 * parting) * np.where(p[:, 0] > 4.2, 0.75, 1)

    cap, volume = _cap(skull, "short", thickness)

    def flow(p: Floats, n: Floats) -> Floats:
        up = np.clip(n[:, 1], 0, 1)[:, None] ** 1.5
        across = np.where(p[:, :1] > 4.0, 1.0, -1.0) * np.array([1.0, 0, 0]) + np.array([0, 0, 0.25])
        front = np.clip((p[:, 2:] - 4) / 4, 0, 1)
        combed = across * (1 - 0.35 * front) + front * np.array([0, 0.9, -0.25])
        down = np.array([0, -1.0, -0.45])
        return up * combed * 1.6 + (1 - up) * down

    def shape(p: Floats) -> tuple[Floats, Floats, Floats]:
        top = np.clip((p[:, 1] - 168.0) / 3.0, 0, 1)
        return 1.7 + 3.4 * top, 0.8 + 1.0 * top, 0.07 + 0.12 * top

    above = _above_line("short")
    return Style(cap, volume, flow, 260, shape, lambda p: 0.9 - above(p))


def _cropped(skull: Field) -> Style:
    """Clipped all over, a little longer on top."""

    def thickness(p: Floats) -> Floats:
        return 0.45 + 0.45 * np.clip((p[:, 1] - 167) / 5, 0, 1)

    cap, volume = _cap(skull, "cropped", thickness)

    def flow(p: Floats, n: Floats) -> Floats:
        forward = np.array([0.0, 0, 1.0]) + 0.5 * np.sign(p[:, :1]) * np.array([1.0, 0, 0])
        up = np.clip(n[:, 1:2], 0, 1)
        return up * forward + (1 - up) * np.array([0, -1.0, -0.2])

    def shape(p: Floats) -> tuple[Floats, Floats, Floats]:
        one = np.ones(len(p))
        return 1.6 * one, 0.8 * one, 0.07 * one

    above = _above_line("cropped")
    return Style(cap, volume, flow, 150, shape, lambda p: 0.8 - above(p))


def _bob(skull: Field) -> Style:
    """Chin-length hair parted on the left, tucked slightly inwards at its ends."""
    rows = (
        (152.0, 0, 0, 6.9, 6.9, 7.8, 4.0, 2.2),
        (154.5, 0, 0, 7.8, 7.8, 9.0, 5.0, 2.2),
        (157.5, 0, 0, 8.4, 8.4, 10.2, 6.0, 2.2),
        (161.5, 0, 0, 8.75, 8.75, 11.1, 7.5, 2.2),
        (165.5, 0, 0, 8.7, 8.7, 11.4, 8.5, 2.2),
        (168.0, 0, 0, 8.3, 8.3, 11.0, 8.5, 2.2),
    )
    curtain = generalised_cylinder((0, 0, 0), (0, 1, 0), (1, 0, 0), rows, rounding=1.5)

    def crown(p: Floats) -> Floats:
        parting = np.exp(-(((p[:, 0] - 2.6) / 0.55) ** 2)) * (p[:, 2] > -4) * (p[:, 1] > 168)
        return skull(p) - 1.15 + 0.65 * parting

    volume = join(crown, (curtain, 2.0))
    opening = join(
        ellipsoid((0.0, 158.2, 11.0), (6.9, 11.2, 9.2)),
        (ellipsoid((1.6, 166.0, 11.2), (5.0, 4.6, 5.0)), 2.0),
        (capsule((0, 151, 8.5), (0, 147, 8.5), 7.0, 7.0), 2.0),
    )

    def cap(p: Floats) -> Floats:
        inside = smooth_max(volume(p), -opening(p), 1.5)
        bottom = 152.5 + 0.9 * np.clip(p[:, 2] / 6, -1, 1) * -1
        return smooth_max(inside, bottom - p[:, 1], 0.8)

    def flow(p: Floats, n: Floats) -> Floats:
        up = np.clip(n[:, 1:2], 0, 1)
        away = np.where(p[:, :1] > 2.6, 1.0, -1.0) * np.array([1.0, 0, 0]) + np.array([0, 0, -0.3])
        low = np.clip((156.5 - p[:, 1:2]) / 3, 0, 1)
        near_face = np.clip(1 - opening(p) / 1.6, 0, 1.6)[:, None]
        from_face = normals_of(opening, p, 0.3)
        return (
            up * away * 1.5 + np.array([0, -1.0, 0.12]) - 0.35 * low * n + 1.1 * near_face * from_face
        )

    def shape(p: Floats) -> tuple[Floats, Floats, Floats]:
        one = np.ones(len(p))
        return 6.5 * one, 1.35 * one, 0.24 * one

    return Style(
        cap, volume, flow, 210, shape, lambda p: np.maximum(-0.5 - opening(p), 152.3 - p[:, 1])
    )


def _ponytail(skull: Field) -> Style:
    """Combed back from the face and tied behind the crown."""
    knot = np.array([0.0, 165.2, -11.6])

    def thickness(p: Floats) -> Floats:
        return 0.75 + 0.45 * np.clip((p[:, 1] - 166) / 6, 0, 1)

    cap_only, volume_only = _cap(skull, "ponytail", thickness)
    tail = join(
        capsule(knot + (0, 0, 0.8), knot + (0, 0.6, -1.6), 1.5, 1.7),
        (capsule(knot + (0, 0.4, -1.6), knot + (0, -3.5, -3.6), 1.6, 2.2), 2.5),
        (capsule(knot + (0, -3.5, -3.6), knot + (0, -13.0, -3.6), 2.2, 1.7), 2.5),
        (capsule(knot + (0, -13.0, -3.6), knot + (0, -19.0, -2.2), 1.7, 0.6), 2.0),
    )
    cap, volume = join(cap_only, (tail, 0.7)), join(volume_only, (tail, 0.7))

    def flow(p: Floats, n: Floats) -> Floats:
        to_knot = knot - p
        to_knot = to_knot / np.maximum(np.linalg.norm(to_knot, axis=1, keepdims=True), 1e-6)
        behind = (p[:, 2:] < knot[2] - 0.8)
        return np.where(behind, np.array([0, -1.0, 0.05]), to_knot)

    def shape(p: Floats) -> tuple[Floats, Floats, Floats]:
        behind = p[:, 2] < knot[2] - 0.5
        return np.where(behind, 7.5, 6.0), np.where(behind, 1.3, 1.1), np.where(behind, 0.22, 0.12)

    above = _above_line("ponytail")
    return Style(cap, volume, flow, 240, shape, lambda p: np.where(p[:, 2] < -11, 146.9 - p[:, 1], 0.7 - above(p)))


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
    path = [roots]
    normals = [normals_of(cut.volume, roots, 0.3)]
    for _ in range(segments):
        p, n = path[-1], normals[-1]
        d = cut.flow(p, n)
        side = np.cross(n, d)
        d = d + sway[:, None] * side
        d -= n * np.sum(d * n, axis=1, keepdims=True)
        d /= np.maximum(np.linalg.norm(d, axis=1, keepdims=True), 1e-6)
        following = p + d * (length / segments)[:, None]
        m = normals_of(cut.volume, following, 0.3)
        following = following - m * np.clip(cut.volume(following), -0.6, 0.6)[:, None]
        outside = cut.ends(following) > 0
        following[outside] = p[outside] + 0.25 * (following[outside] - p[outside])
        path.append(following)
        normals.append(m)
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
    crest = path + normals * raised
    sunk = -0.20 - 0.1 * width[:, None, None]
    left, right = path - across * half + normals * sunk, path + across * half + normals * sunk
    vertices = np.stack([left, crest, right], axis=2)
    lean = 0.75 * across
    n = np.stack([normals - lean, normals, normals + lean], axis=2)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    tone = rng.uniform(0.72, 1.0, count)[:, None, None]
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


def cap_field(cut: Style, figure: Figure) -> Field:
    """The cap in the figure's own coordinates."""
    frame = head_frame(figure)
    return lambda p: cut.cap(frame.to_head(p)) * frame.scale

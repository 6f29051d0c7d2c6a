"""Head and neck as one field, from horizontal sections and the features of a face.

Coordinates are those of a man whose crown is at 175 cm (`HeadFrame` brings them to the figure): y up, z forwards,
origin of x and z below the ear canal's plane. Sections follow a head of 15.4 x 19.9 cm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import RegularGridInterpolator
from scipy.ndimage import gaussian_filter

from stimuli.body_generator.fields import (
    Field,
    both_sides,
    capsule,
    cut,
    ellipsoid,
    generalised_cylinder,
    join,
    mirrored,
    smooth_max,
)
from stimuli.body_generator.figure import Figure
from stimuli.skeleton import Floats

CROWN = 175.0
MIDDLE = (0.0, 163.5, -0.5)  # of the head, in head coordinates

# height; 0, 0; half breadth twice; back, front; exponent
_SECTIONS_MAN = (
    (151.8, 0, 0, 1.4, 1.4, -2.0, 7.2, 2.0),
    (152.6, 0, 0, 2.9, 2.9, 0.5, 8.3, 2.0),
    (153.8, 0, 0, 4.1, 4.1, 2.5, 8.8, 2.0),
    (155.5, 0, 0, 5.1, 5.1, 5.0, 8.75, 2.0),
    (157.2, 0, 0, 5.85, 5.85, 7.4, 8.9, 2.0),
    (159.2, 0, 0, 6.4, 6.4, 8.8, 9.0, 2.05),
    (161.2, 0, 0, 6.85, 6.85, 9.5, 8.95, 2.1),
    (163.2, 0, 0, 7.25, 7.25, 10.0, 8.9, 2.1),
    (164.8, 0, 0, 7.5, 7.5, 10.2, 9.25, 2.1),
    (166.5, 0, 0, 7.65, 7.65, 10.2, 9.25, 2.15),
    (168.3, 0, 0, 7.55, 7.55, 10.0, 8.85, 2.15),
    (170.2, 0, 0, 7.05, 7.05, 9.3, 8.0, 2.1),
    (172.0, 0, 0, 6.05, 6.05, 8.1, 6.7, 2.05),
    (173.4, 0, 0, 4.7, 4.7, 6.4, 5.2, 2.0),
    (174.4, 0, 0, 3.1, 3.1, 4.3, 3.4, 2.0),
    (174.95, 0, 0, 1.0, 1.0, 1.4, 1.1, 2.0),
)
# share of the breadths above: faces narrow from cheekbones to jaw angles. On the finished skin, in front of the ears,
# 13.5 (woman 12.4) to 11.0 (9.8) cm; callipers pressed to the bone find 13.7 (13.0) and 9.7 (9.1) cm (Farkas 1994)
_JAW_MAN = {151.8: 0.9, 152.6: 0.9, 153.8: 0.90, 155.5: 0.87, 157.2: 0.86, 159.2: 0.93, 161.2: 0.975}
_JAW_WOMAN = {151.8: 0.76, 152.6: 0.76, 153.8: 0.77, 155.5: 0.79, 157.2: 0.86, 159.2: 0.925, 161.2: 0.965}


@dataclass(frozen=True)
class HeadFrame:
    """Turns head coordinates of the 175 cm man into a figure's (cm)."""

    scale: float
    crown: float

    def to_figure(self, points: Floats) -> Floats:
        """Points (..., 3) of the head's coordinates (cm) in the figure's (cm)."""
        return (np.asarray(points, dtype=np.float64) - (0, CROWN, 0)) * self.scale + (0, self.crown, 0)

    def to_head(self, points: Floats) -> Floats:
        """Points (..., 3) of the figure's coordinates (cm) in the head's (cm)."""
        return (points - (0, self.crown, 0)) / self.scale + (0, CROWN, 0)


def head_frame(figure: Figure) -> HeadFrame:
    """The figure's own head frame."""
    return HeadFrame(figure.head_scale, figure.stature)


def head(figure: Figure, chest: Field) -> Field:
    """Head with ears, and the neck down into the collar, where it runs out on the `chest` under the shirt."""
    frame = head_frame(figure)
    face = join(_face(figure.female), (_ear(), 0.5))
    neck = _neck(figure)

    def field(points: Floats) -> Floats:
        return face(frame.to_head(points)) * frame.scale

    low = figure.neck[1] - 11.0
    under_shirt = lambda p: smooth_max(  # noqa: E731
        chest(p), np.maximum(low - p[:, 1], np.abs(p[:, 0]) - 10.0), 0.5
    )
    return join(field, (neck, 2.4), (under_shirt, 1.6))


def beard_shadow(figure: Figure) -> Callable[[Floats], Floats]:
    """Shade of a shaven beard on men: jaw, chin and upper lip a little darker, the lips left out."""
    if figure.female:
        return lambda points: np.ones(len(points))
    frame = head_frame(figure)

    def shade(points: Floats) -> Floats:
        p = frame.to_head(points)
        edge = 158.9 - 0.10 * np.abs(p[:, 0]) + 0.75 * np.clip(4.5 - p[:, 2], 0, 6)
        low = np.clip((p[:, 1] - 150.6) / 1.5, 0, 1) * np.clip((edge - p[:, 1]) / 1.6, 0, 1)
        return 1 - 0.17 * low * np.clip((p[:, 2] + 0.5) / 2.0, 0, 1)

    return shade


def skull_field(figure: Figure) -> Field:
    """The head and nape without ears, in head coordinates: what hair grows on.

    Measured along rays from the middle of the head, so that it stays round far above the skin too.
    """
    frame, face, neck = head_frame(figure), _face(figure.female), _neck(figure)
    skin = join(face, (lambda p: neck(frame.to_figure(p)) / frame.scale, 2.4 / frame.scale))
    middle = np.array(MIDDLE)
    azimuth, height = np.linspace(-np.pi, np.pi, 145), np.linspace(-1, 1, 121)
    a, h = (g.ravel() for g in np.meshgrid(azimuth, height, indexing="ij"))
    flat = np.sqrt(1 - h * h)
    rays = np.column_stack([flat * np.sin(a), h, flat * np.cos(a)])
    near, far = np.zeros(len(rays)), np.full(len(rays), 16.0)
    for _ in range(28):
        half = 0.5 * (near + far)
        inside = skin(middle + half[:, None] * rays) < 0
        near, far = np.where(inside, half, near), np.where(inside, far, half)
    grid = gaussian_filter(near.reshape(145, 121), 1.5, mode=("wrap", "nearest"))
    table = RegularGridInterpolator((azimuth, height), grid)

    def field(points: Floats) -> Floats:
        local = points - middle
        length = np.maximum(np.linalg.norm(local, axis=1), 1e-6)
        angle = np.arctan2(local[:, 0], local[:, 2])
        return length - table(np.column_stack([angle, np.clip(local[:, 1] / length, -1, 1)]))

    return field


def _sections(female: bool) -> Field:
    rows = [
        (y, 0, 0, a * k, b * k, max(back, 0.4), front - (0.25 if female and y > 164 else 0.0), n)
        for y, _, _, a, b, back, front, n in _SECTIONS_MAN
        for k in ((_JAW_WOMAN if female else _JAW_MAN).get(y, 1.0),)
    ]
    return generalised_cylinder((0, 0, 0), (0, 1, 0), (1, 0, 0), rows, rounding=0.8)


def _face(female: bool) -> Field:
    skull = _sections(female)
    strong = 0.0 if female else 1.0
    jaw = mirrored(ellipsoid((3.5 + 0.35 * strong, 156.9, 1.6), (0.8 + 0.25 * strong, 2.0, 2.2)))
    chin = ellipsoid((0, 153.75, 7.55), (1.75 + 0.5 * strong, 1.45, 1.35))
    muzzle = ellipsoid((0, 157.0, 7.0), (3.0, 2.3, 2.35))
    cheek = mirrored(ellipsoid((4.5, 161.0, 5.7), (1.9, 1.6, 1.7)))
    apple = mirrored(ellipsoid((3.6, 159.7, 6.9), (1.7, 1.6, 1.2)))
    hollow_fill = mirrored(ellipsoid((3.35 + 0.45 * strong, 157.4, 4.9), (1.35 + 0.1 * strong, 2.8, 2.3)))
    jaw_line = mirrored(
        capsule(
            (3.75 + 0.3 * strong, 155.8, 1.6), (1.0 + 0.6 * strong, 153.6, 6.9), 0.6 + 0.1 * strong, 0.65 + 0.2 * strong
        )
    )
    brow = mirrored(ellipsoid((2.6, 165.45, 8.0), (1.9 + 0.3 * strong, 0.62 + 0.12 * strong, 0.62 + 0.3 * strong)))
    shape = join(
        skull,
        (jaw, 2.2),
        (chin, 2.0),
        (muzzle, 1.6),
        (cheek, 2.4),
        (apple, 2.0),
        (hollow_fill, 2.6),
        (jaw_line, 1.8),
        (brow, 1.6),
    )
    shape = cut(shape, mirrored(ellipsoid((3.15, 163.4, 10.5), (1.85, 1.2, 1.85 + 0.2 * strong))), 1.5)
    shape = cut(shape, mirrored(ellipsoid((7.8, 166.5, 6.0), (1.0, 2.5, 2.8))), 1.6)  # temples
    shape = cut(shape, mirrored(ellipsoid((1.85, 163.1, 9.2), (0.75, 0.9, 1.4))), 0.8)  # beside the nose
    lids = mirrored(ellipsoid((3.2, 163.2, 6.9), (1.55, 1.16, 1.35)))
    shape = join(shape, (lids, 0.55))
    wide = 1.0 if strong else 0.88
    up = 0.0 if strong else 0.25
    bridge = capsule((0, 164.2, 8.6), (0, 160.5 + up, 10.4 - 0.6 * up), 0.56 * wide, 0.72 * wide)
    tip = ellipsoid((0, 160.05 + up, 10.4 - 0.4 * up), (0.88 * wide, 0.82, 1.0))
    wing = mirrored(ellipsoid((1.12 * wide, 159.8 + 0.6 * up, 9.55), (0.58 * wide, 0.62, 0.85)))
    shape = join(shape, (bridge, 1.5), (tip, 0.9), (wing, 0.55))
    nostril = mirrored(ellipsoid((0.58 * wide, 159.1 + 0.8 * up, 9.95), (0.36, 0.3, 0.5)))
    shape = cut(shape, nostril, 0.3)
    full = 1.15 if female else 0.95
    upper = both_sides(ellipsoid((0.62, 157.42, 9.08), (1.35, 0.42 * full, 0.72)), 0.5)
    lower = ellipsoid((0, 156.5, 8.98), (1.75, 0.52 * full, 0.8))
    shape = join(shape, (upper, 0.6), (lower, 0.6))
    above_lip = ellipsoid((0, 158.35, 8.55), (1.9, 1.0, 0.85))
    shape = join(shape, (above_lip, 1.2))
    philtrum = capsule((0, 159.0, 9.75), (0, 158.0, 9.85), 0.22, 0.2)
    return cut(shape, philtrum, 0.5)


def _ear() -> Field:
    """Both ears: a tilted disc with a rim, a hollow and a lobe, standing off the head by 20 degrees."""
    tilt, off = np.radians(10), np.radians(17)
    back = np.array([np.sin(off), 0, -np.cos(off)])
    up = np.array([0, np.cos(tilt), -np.sin(tilt)])
    up = up - back * (up @ back)
    up /= np.linalg.norm(up)
    out = np.cross(up, back)
    out = out if out[0] > 0 else -out
    axes = np.stack([out, up, back])
    centre = np.array([7.7, 162.0, -0.9])
    upper = ellipsoid(centre + 0.95 * up + 0.1 * back, (0.62, 2.05, 1.85), axes)
    lower = ellipsoid(centre - 0.7 * up - 0.15 * back, (0.6, 2.0, 1.35), axes)
    lobe = ellipsoid(centre - 2.45 * up - 0.45 * back, (0.45, 0.8, 0.7), axes)
    hollow = ellipsoid(centre + 0.75 * out - 0.55 * up - 0.4 * back, (0.85, 1.25, 0.85), axes)
    groove = ellipsoid(centre + 0.72 * out + 1.2 * up + 0.15 * back, (0.5, 1.25, 1.2), axes)
    fold = capsule(centre + 0.25 * out - 1.5 * up + 0.55 * back, centre + 0.2 * out + 1.2 * up + 0.55 * back, 0.3, 0.25)
    ear = cut(join(upper, (lower, 0.9), (lobe, 0.6)), groove, 0.3)
    ear = cut(join(ear, (fold, 0.3)), hollow, 0.35)
    return mirrored(ear)


def _neck(figure: Figure) -> Field:
    """Neck leaning forwards, with the two sterno-mastoid cords and, on men, the larynx; wide at the shoulders."""
    frame = head_frame(figure)
    r, base = figure.neck_radius, figure.neck[1]
    top = frame.to_figure(np.array([0, 159.0, -2.2]))
    column = capsule((0, base - 6, -1.9), top, r * 1.03, r * 0.90)
    behind = frame.to_figure(np.array([6.2, 160.5, -2.4]))
    thick = 0.45 if figure.female else 0.75
    cord = mirrored(capsule((1.2, base - 5.0, r * 0.50), behind * (0.82, 1, 1), thick, thick + 0.4))
    whole = join(column, (cord, 2.2))
    if figure.female:
        return whole
    larynx = ellipsoid(frame.to_figure(np.array([0, 152.0, 3.6])) - (0, 2.2, 0), (0.9, 1.3, 1.0))
    return join(whole, (larynx, 1.6))

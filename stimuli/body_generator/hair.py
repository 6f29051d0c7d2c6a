"""Hair: a cap that follows the skull from a natural hairline, and locks combed over it along a flow.

A smooth cap alone is a helmet; overlapping tapered locks (see `locks`) break its outline and its highlights.
Coordinates as in `head`: y up with the crown at 175, z forwards, x to the person's left.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from stimuli.body_generator.fields import Field, capsule, ellipsoid, generalised_cylinder, join, smooth_max, smooth_min
from stimuli.body_generator.figure import Figure
from stimuli.body_generator.head import head_frame, skull_field
from stimuli.body_generator.polygons import normals_of
from stimuli.skeleton import Floats

_ANGLES = np.radians([0, 14, 28, 40, 52, 62, 70, 80, 90, 98, 112, 128, 150, 180])  # 0 = front, 180 = nape
_LINE = {  # height of the hairline at those angles
    "short": (170.9, 171.1, 171.3, 170.0, 167.5, 165.3, 163.2, 161.8, 161.8, 164.9, 162.5, 159.0, 156.3, 155.6),
    "cropped": (171.0, 171.2, 171.6, 170.4, 167.8, 165.4, 163.4, 162.4, 162.6, 165.1, 162.6, 159.2, 156.6, 155.9),
    "ponytail": (170.7, 170.6, 170.0, 168.3, 166.0, 164.1, 162.9, 162.0, 162.6, 164.4, 161.8, 158.6, 155.8, 154.8),
}

PARTING = 2.6  # cm to the left, of the bob


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
    """The haircut of that name, cut for the skull of a woman or a man."""
    return {"short": _short, "cropped": _cropped, "bob": _bob, "ponytail": _ponytail}[name](skull_field(female))


def _angle(points: Floats) -> Floats:
    return np.abs(np.arctan2(points[:, 0], points[:, 2] + 0.3))


def _above_line(name: str) -> Field:
    """Height above the hairline (cm), positive inside the hair."""
    line = PchipInterpolator(_ANGLES, _LINE[name])
    return lambda p: p[:, 1] - line(_angle(p))


def _cap(skull: Field, name: str, thickness: Callable[[Floats], Floats]) -> Field:
    above = _above_line(name)

    def cap(p: Floats) -> Floats:
        front = np.clip((p[:, 2] - 2.0) / 4.0, 0, 1)  # where it grows away from the face it begins thin
        grown = np.clip(above(p) / (2.2 + 2.2 * front), -1, 1)
        grown = np.where(grown > 0, np.maximum(grown, 0) ** (0.6 + 0.3 * front), 3 * grown)
        return skull(p) - thickness(p) * grown + 0.12

    return cap


def _short(skull: Field) -> Style:
    """Short sides, longer top combed from a parting on the left."""

    def thickness(p: Floats) -> Floats:
        top = np.clip((p[:, 1] - 167.5) / 4.5, 0, 1)
        top = top * top * (3 - 2 * top)
        front = np.clip((p[:, 2] - 1) / 7, 0, 1)
        parting = np.exp(-(((p[:, 0] - 4.0) / 0.7) ** 2)) * (p[:, 2] > -3)
        return 0.55 + top * (1.2 + 0.25 * front) * (1 - 0.45 * parting) * np.where(p[:, 0] > 4.2, 0.75, 1)

    cap = _cap(skull, "short", thickness)

    def flow(p: Floats, n: Floats) -> Floats:
        up = np.clip(n[:, 1], 0, 1)[:, None] ** 1.5
        across = np.where(p[:, :1] > 4.0, 1.0, -1.0) * np.array([1.0, 0, 0]) + np.array([0, 0, 0.25])
        front = np.clip((p[:, 2:] - 4) / 4, 0, 1)
        combed = across * (1 - 0.35 * front) + front * np.array([0, 0.9, -0.25])
        down = np.array([0, -1.0, -0.45])
        return up * combed * 1.6 + (1 - up) * down

    def shape(p: Floats) -> tuple[Floats, Floats, Floats]:
        top = np.clip((p[:, 1] - 168.0) / 3.0, 0, 1)
        return 1.7 + 3.4 * top, 0.8 + 1.0 * top, 0.07 + 0.06 * top

    above = _above_line("short")
    return Style(cap, cap, flow, 186, shape, lambda p: 0.15 - above(p))


def _cropped(skull: Field) -> Style:
    """Clipped all over, a little longer on top."""

    def thickness(p: Floats) -> Floats:
        return 0.45 + 0.45 * np.clip((p[:, 1] - 167) / 5, 0, 1)

    cap = _cap(skull, "cropped", thickness)

    def flow(p: Floats, n: Floats) -> Floats:
        forward = np.array([0.0, 0, 1.0]) + 0.5 * np.sign(p[:, :1]) * np.array([1.0, 0, 0])
        up = np.clip(n[:, 1:2], 0, 1)
        return up * forward + (1 - up) * np.array([0, -1.0, -0.2])

    def shape(p: Floats) -> tuple[Floats, Floats, Floats]:
        one = np.ones(len(p))
        return 1.6 * one, 0.8 * one, 0.07 * one

    above = _above_line("cropped")
    return Style(cap, cap, flow, 0, shape, lambda p: 0.8 - above(p))


def _bob(skull: Field) -> Style:
    """Chin-length hair parted on the left, swept over the temples and tucked slightly inwards at its ends."""
    rows = (
        (151.5, 0, 0, 6.7, 6.7, 7.4, 2.6, 2.2),
        (154.5, 0, 0, 7.5, 7.5, 8.5, 3.4, 2.2),
        (157.5, 0, 0, 8.5, 8.5, 9.8, 4.2, 2.2),
        (161.5, 0, 0, 9.25, 9.25, 10.8, 5.4, 2.2),
        (165.5, 0, 0, 8.8, 8.8, 10.9, 6.8, 2.2),
        (168.5, 0, 0, 8.0, 8.0, 10.4, 6.6, 2.2),
    )
    curtain = generalised_cylinder((0, 0, 0), (0, 1, 0), (1, 0, 0), rows, rounding=1.5)

    def above(p: Floats) -> Floats:
        """Height above the edge of the hair swept from the parting over the forehead to both temples."""
        right, left = np.clip((PARTING - p[:, 0]) / 9.2, 0, 1.2), np.clip((p[:, 0] - PARTING) / 4.6, 0, 1.2)
        return p[:, 1] - (170.7 - 6.0 * right**1.4 - 6.8 * left**1.6)

    def crown(p: Floats) -> Floats:
        parting = np.exp(-(((p[:, 0] - PARTING) / 0.55) ** 2)) * (p[:, 2] > -4) * (p[:, 1] > 168)
        front = np.clip((p[:, 2] - 1.0) / 3.0, 0, 1)
        grown = np.clip(above(p) / 3.2, -1, 1)
        grown = np.where(grown > 0, np.maximum(grown, 0) ** 0.7, 3 * grown)
        return skull(p) - (1.0 - 0.5 * parting) * (1 - front + front * grown) + 0.1

    opening = join(
        ellipsoid((0.0, 158.6, 11.0), (7.9, 11.6, 9.6)),
        (capsule((0, 151, 8.5), (0, 147, 8.5), 7.4, 7.4), 2.0),
    )
    volume = join(crown, (curtain, 1.4))

    def cap(p: Floats) -> Floats:
        hanging = smooth_max(curtain(p), -opening(p), 0.7)
        bottom = 151.6 - 0.9 * np.clip(p[:, 2] / 6, -1, 1)
        above_chin = smooth_max(crown(p), 160.0 - p[:, 1], 1.0)
        return smooth_max(smooth_min(above_chin, hanging, 1.4), bottom - p[:, 1], 0.5)

    def flow(p: Floats, n: Floats) -> Floats:
        up = np.clip(n[:, 1:2], 0, 1)
        away = np.where(p[:, :1] > PARTING, 1.0, -1.0) * np.array([1.0, 0, 0]) + np.array([0, 0, -0.3])
        low = np.clip((156.5 - p[:, 1:2]) / 3, 0, 1)
        near_face = np.clip(1 - opening(p) / 1.6, 0, 1.6)[:, None]
        from_face = normals_of(opening, p, 0.3)
        return up * away * 1.5 + np.array([0, -1.0, 0.12]) - 0.35 * low * n + 1.1 * near_face * from_face

    def shape(p: Floats) -> tuple[Floats, Floats, Floats]:
        one = np.ones(len(p))
        return 6.5 * one, 1.2 * one, 0.26 - 0.16 * np.clip((p[:, 1] - 169) / 4, 0, 1)

    def ends(p: Floats) -> Floats:
        off_the_face = np.minimum(0.25 - above(p), -0.35 - opening(p))
        return np.maximum(off_the_face, 153.6 - 0.9 * np.clip(p[:, 2] / 6, -1, 1) - p[:, 1])

    return Style(cap, volume, flow, 195, shape, ends)


def _ponytail(skull: Field) -> Style:
    """Combed back from the face and tied behind the crown."""
    knot = np.array([0.0, 165.2, -11.6])

    def thickness(p: Floats) -> Floats:
        return 0.75 + 0.45 * np.clip((p[:, 1] - 166) / 6, 0, 1)

    cap_only = _cap(skull, "ponytail", thickness)
    tail = join(
        capsule((0, 165.2, -10.8), (0, 165.8, -13.2), 1.5, 1.7),
        (capsule((0, 165.6, -13.2), (0, 161.7, -15.2), 1.6, 2.2), 2.5),
        (capsule((0, 161.7, -15.2), (0, 152.2, -15.2), 2.2, 1.7), 2.5),
        (capsule((0, 152.2, -15.2), (0, 146.2, -13.8), 1.7, 0.6), 2.0),
    )
    cap = join(cap_only, (tail, 0.7))

    def flow(p: Floats, n: Floats) -> Floats:
        to_knot = knot - p
        to_knot = to_knot / np.maximum(np.linalg.norm(to_knot, axis=1, keepdims=True), 1e-6)
        behind = p[:, 2:] < knot[2] - 0.8
        return np.where(behind, np.array([0, -1.0, 0.05]), to_knot)

    def shape(p: Floats) -> tuple[Floats, Floats, Floats]:
        behind = p[:, 2] < knot[2] - 0.5
        return np.where(behind, 7.5, 6.0), np.where(behind, 1.3, 1.1), np.where(behind, 0.22, 0.09)

    above = _above_line("ponytail")
    return Style(cap, cap, flow, 190, shape, lambda p: np.where(p[:, 2] < -11, 146.9 - p[:, 1], 0.15 - above(p)))


def cap_field(cut: Style, figure: Figure) -> Field:
    """The cap in the figure's own coordinates."""
    frame = head_frame(figure)
    return lambda p: cut.cap(frame.to_head(p)) * frame.scale

"""Hair: a cap that follows the skull from a natural hairline, and locks combed over it along a flow.

A smooth cap alone is a helmet; overlapping tapered locks (see `locks`) break its outline and its highlights.
Coordinates as in `head`: y up with the crown at 175, z forwards, x to the person's left.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stimuli.body_generator.fields import Field, capsule, ellipsoid, generalised_cylinder, join, smooth_max, smooth_min
from stimuli.body_generator.figure import Figure
from stimuli.body_generator.head import head_frame, skull_field
from stimuli.body_generator.polygons import normals_of
from stimuli.body_generator.scalp import Hairline, hairline
from stimuli.skeleton import Floats

# degrees round the head from the forehead, y: the temple, the sideburn before the ear, over and behind it, the nape
_LINES = {
    "short": (
        (0, 170.9), (14, 171.1), (28, 171.3), (40, 170.2), (50, 168.2), (58, 166.0), (64, 164.4), (69, 162.3),
        (75, 161.4), (80, 161.9), (83, 164.0), (86, 165.5), (96, 165.9), (106, 165.0), (113, 162.6), (120, 160.0),
        (130, 158.2), (145, 157.0), (160, 156.3), (180, 156.0),
    ),
    "cropped": (
        (0, 171.0), (14, 171.2), (28, 171.6), (38, 170.8), (48, 168.6), (57, 166.4), (64, 164.6), (69, 162.9),
        (75, 162.2), (80, 162.7), (83, 164.3), (86, 165.6), (96, 166.0), (106, 165.1), (113, 162.8), (120, 160.3),
        (130, 158.5), (145, 157.3), (160, 156.6), (180, 156.3),
    ),
    "ponytail": (
        (0, 170.7), (14, 170.7), (28, 170.2), (40, 168.9), (50, 167.3), (58, 166.1), (65, 165.0), (71, 163.6),
        (76, 163.1), (80, 163.4), (83, 164.6), (87, 165.5), (96, 165.7), (106, 164.6), (113, 162.2), (120, 159.8),
        (130, 157.8), (145, 156.4), (160, 155.4), (180, 155.0),
    ),
}  # fmt: skip

KNOT = (0.0, 165.2, -11.6)  # of the ponytail
TAIL = -10.6  # z, what lies further back is the ponytail's tail
PARTING = 2.6  # cm to the left, of the bob


@dataclass(frozen=True)
class Style:
    """A haircut: the solid under the locks, the surface locks lie on, and how locks run.

    line:     where it grows out of the skin, if it has a hairline; the rest is a solid of its own.
    solid:    field (head coordinates) of what hangs, if anything does.
    volume:   the whole of it without its lower and front ends; locks are traced on it.
    flow:     points (N, 3), normals (N, 3) -> direction (N, 3), not necessarily tangent.
    locks:    how many; `length`, `width` and `lift` of each from its root (N, 3).
    ends:     field that is negative where locks may lie.
    """

    line: Hairline | None
    solid: Field | None
    volume: Field
    flow: Callable[[Floats, Floats], Floats]
    locks: int
    shape: Callable[[Floats], tuple[Floats, Floats, Floats]]
    ends: Field


def style_names(figure: Figure) -> tuple[str, ...]:
    """Haircuts of this figure, the default first."""
    return ("bob", "ponytail") if figure.female else ("short", "cropped")


def style(name: str, figure: Figure) -> Style:
    """The haircut of that name, cut for the figure's skull."""
    return {"short": _short, "cropped": _cropped, "bob": _bob, "ponytail": _ponytail}[name](skull_field(figure))


def _cap(line: Hairline, thickness: Callable[[Floats], Floats]) -> Field:
    lowest = line.edge[:, 1].min() - 1.0  # below, only the inside of the neck is left

    def cap(p: Floats) -> Floats:
        front = np.clip((p[:, 2] - 2.0) / 4.0, 0, 1)  # where it grows away from the face it begins thin
        grown = np.clip(line.above(p) / (1.6 + 0.9 * front), -1, 1)
        grown = np.where(grown > 0, np.maximum(grown, 0) ** 0.7, 3 * grown)
        return smooth_max(line.skull(p) - thickness(p) * grown - 0.02, lowest - p[:, 1], 0.3)

    return cap


def _short(skull: Field) -> Style:
    """Short sides, longer top combed from a parting on the left."""

    def thickness(p: Floats) -> Floats:
        top = np.clip((p[:, 1] - 167.5) / 4.5, 0, 1)
        top = top * top * (3 - 2 * top)
        front = np.clip((p[:, 2] - 1) / 7, 0, 1)
        parting = np.exp(-(((p[:, 0] - 4.0) / 0.7) ** 2)) * (p[:, 2] > -3)
        return 0.55 + top * (1.2 + 0.25 * front) * (1 - 0.45 * parting) * np.where(p[:, 0] > 4.2, 0.75, 1)

    line = hairline(skull, _LINES["short"])
    cap = _cap(line, thickness)

    def flow(p: Floats, n: Floats) -> Floats:
        up = np.clip(n[:, 1], 0, 1)[:, None] ** 1.5
        across = np.where(p[:, :1] > 4.0, 1.0, -1.0) * np.array([1.0, 0, 0]) + np.array([0, 0, 0.25])
        front = np.clip((p[:, 2:] - 4) / 4, 0, 1)
        combed = across * (1 - 0.35 * front) + front * np.array([0, 0.9, -0.25])
        behind = np.clip((1.0 - p[:, 2:]) / 5, 0, 1)
        combed = combed * (1 - behind) + behind * np.array([0, 0, -1.0])
        down = np.array([0, -1.0, -0.45])
        return up * combed * 1.6 + (1 - up) * down

    def shape(p: Floats) -> tuple[Floats, Floats, Floats]:
        top = np.clip((p[:, 1] - 168.0) / 3.0, 0, 1)
        return 1.7 + 3.4 * top, 0.8 + 1.0 * top, 0.06 + 0.03 * top

    return Style(line, None, cap, flow, 164, shape, lambda p: 0.7 - line.above(p))


def _cropped(skull: Field) -> Style:
    """Clipped all over, a little longer on top."""

    def thickness(p: Floats) -> Floats:
        return 0.45 + 0.45 * np.clip((p[:, 1] - 167) / 5, 0, 1)

    line = hairline(skull, _LINES["cropped"])
    cap = _cap(line, thickness)

    def flow(p: Floats, n: Floats) -> Floats:
        forward = np.array([0.0, 0, 1.0]) + 0.5 * np.sign(p[:, :1]) * np.array([1.0, 0, 0])
        up = np.clip(n[:, 1:2], 0, 1)
        return up * forward + (1 - up) * np.array([0, -1.0, -0.2])

    def shape(p: Floats) -> tuple[Floats, Floats, Floats]:
        one = np.ones(len(p))
        return 1.6 * one, 0.8 * one, 0.07 * one

    return Style(line, None, cap, flow, 0, shape, lambda p: 0.8 - line.above(p))


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
        off_the_face = np.minimum(0.25 - above(p), -0.6 - opening(p))
        return np.maximum(off_the_face, 153.6 - 0.9 * np.clip(p[:, 2] / 6, -1, 1) - p[:, 1])

    return Style(None, cap, volume, flow, 195, shape, ends)


def _ponytail(skull: Field) -> Style:
    """Combed back from the face and tied behind the crown."""
    knot = np.array(KNOT)

    def thickness(p: Floats) -> Floats:
        return 0.75 + 0.45 * np.clip((p[:, 1] - 166) / 6, 0, 1)

    line = hairline(skull, _LINES["ponytail"])
    tail = join(
        capsule((0, 165.2, -10.8), (0, 165.8, -13.2), 1.5, 1.7),
        (capsule((0, 165.6, -13.2), (0, 161.7, -15.2), 1.6, 2.2), 2.5),
        (capsule((0, 161.7, -15.2), (0, 152.6, -15.3), 2.1, 1.5), 2.5),
        (capsule((0, 152.6, -15.3), (0, 144.6, -14.2), 1.5, 0.2), 2.0),
    )
    volume = join(_cap(line, thickness), (tail, 0.7))

    def flow(p: Floats, n: Floats) -> Floats:
        to_knot = knot - p
        to_knot = to_knot / np.maximum(np.linalg.norm(to_knot, axis=1, keepdims=True), 1e-6)
        behind = p[:, 2:] < knot[2] - 0.8
        return np.where(behind, np.array([0, -1.0, 0.05]), to_knot)

    def shape(p: Floats) -> tuple[Floats, Floats, Floats]:
        behind = p[:, 2] < knot[2] - 0.5
        return np.where(behind, 7.5, 6.0), np.where(behind, 1.3, 1.1), np.where(behind, 0.22, 0.09)

    def ends(p: Floats) -> Floats:
        return np.where(p[:, 2] < -11, 146.0 - p[:, 1], 0.7 - line.above(p))

    return Style(line, tail, volume, flow, 168, shape, ends)


def knot_height(name: str, figure: Figure) -> float | None:
    """m above the ground, where the hair of that haircut is tied."""
    return float(head_frame(figure).to_figure(np.array(KNOT))[1] / 100) if name == "ponytail" else None


def hangs(name: str, figure: Figure, points: Floats) -> NDArray[np.bool_]:
    """(N,) which points (N, 3) cm of a haircut do not lie on the skin they grow on: they move with the head alone."""
    if name == "bob":
        return np.full(len(points), True)
    return np.asarray(head_frame(figure).to_head(points)[:, 2] < TAIL)


def solid_field(solid: Field, figure: Figure) -> Field:
    """A haircut's solid in the figure's own coordinates."""
    frame = head_frame(figure)
    return lambda p: solid(frame.to_head(p)) * frame.scale

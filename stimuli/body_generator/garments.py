"""Shirt and trousers as fields: cloth over a trunk, with hems that are open and have thickness."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from stimuli.body_generator.creases import shirt_folds, trouser_folds
from stimuli.body_generator.fields import (
    Field,
    both_sides,
    capsule,
    cut,
    ellipsoid,
    generalised_cylinder,
    grown,
    half_space,
    join,
    mirrored,
    moved,
    smooth_max,
    smooth_min,
)
from stimuli.body_generator.figure import Figure
from stimuli.body_generator.seams import Line, shirt_seams, trouser_seams
from stimuli.skeleton import Floats

CLOTH = 0.85  # cm, thickness of a rolled hem as it reads from outside
SLEEVE_REACH = 10.0  # cm, what is so near the middle of a sleeve's end belongs to it
DEPTH = 1.6  # cm, how far one can look into a sleeve or a leg end
_UP = (0.0, 1.0, 0.0)
_LEFT = (1.0, 0.0, 0.0)


@dataclass(frozen=True)
class Clothes:
    """The garments with open hems (fine levels) and closed ones (coarse levels), and the body they make.

    body:  closed shape of both, without folds.
    chest: what the shirt lies on, a little under its cloth; skin seen in the neckline has this shape.
    shirt_cloth, trouser_cloth: the cloth running on beyond hems and sleeve ends: which way its outside faces.
    shirt_ends, trouser_ends: 0 where they end.
    shirt_seams, trouser_seams: lines on them.
    """

    shirt: Field
    trousers: Field
    closed_shirt: Field
    closed_trousers: Field
    body: Field
    chest: Field
    shirt_cloth: Field
    trouser_cloth: Field
    shirt_ends: Field
    trouser_ends: Field
    shirt_seams: tuple[Line, ...]
    trouser_seams: tuple[Line, ...]


def clothes(figure: Figure) -> Clothes:
    """Shirt over trousers; the shirt always encloses the trousers near its hem."""
    trousers_solid = _trousers_solid(figure)
    shirt_solid = _shirt_solid(figure, trousers_solid, figure.shirt[0][0])
    shirt_cloth = shirt_folds(figure, shirt_solid)
    trouser_cloth = trouser_folds(figure, trousers_solid)
    running_on = shirt_folds(figure, _shirt_solid(_longer(figure), trousers_solid, figure.shirt[0][0]))
    return Clothes(
        cut(_collared(figure, shirt_cloth), _shirt_hollows(figure, shirt_cloth), 0.2),
        _trouser_ends(figure, trouser_cloth, hollow=True),
        _collared(figure, shirt_cloth),
        _trouser_ends(figure, trouser_cloth, hollow=False),
        join(shirt_solid, (trousers_solid, 1.0)),
        grown(shirt_solid, -0.45),
        _banded(figure, running_on),
        trouser_cloth,
        _shirt_ends(figure),
        _leg_ends(figure),
        shirt_seams(figure, _banded(figure, running_on), _neckline(figure, 2.05)),
        trouser_seams(figure, trouser_cloth, _leg_ends(figure)),
    )


def _longer(figure: Figure) -> Figure:
    """The figure in a shirt whose hem and sleeves end further down."""
    (hem, *below), (end, *around) = figure.shirt[0], figure.sleeve[-1]
    return replace(
        figure,
        shirt=((hem - 5, *below), *figure.shirt),
        sleeve=(*figure.sleeve, (end + 5, *around)),
    )


def _trousers_solid(figure: Figure) -> Field:
    top = generalised_cylinder((0, 0, 0), _UP, _LEFT, figure.trouser_top)
    hip, ankle = np.array(figure.hip), np.array(figure.ankle)
    down = ankle - hip
    down[2] = 0
    leg = generalised_cylinder((hip[0], hip[1], 0), down, _LEFT, figure.trouser_leg, rounding=0.3)
    buttock = ellipsoid((7.6, hip[1] - 2.5, -6.2), (7.6, 8.2, 6.6))
    return join(both_sides(leg, 0.8), (top, 4.5), (mirrored(buttock), 3.0))


def _shirt_solid(figure: Figure, trousers: Field, hem: float) -> Field:
    """hem: cm above the floor, down from where the shirt keeps clear of the trousers."""
    trunk = generalised_cylinder((0, 0, 0), _UP, _LEFT, figure.shirt, rounding=0.4)
    # up x left points back, as the torso table wants
    shoulder = np.array(figure.shoulder)
    neck_y = figure.neck[1]
    yoke_radii = (3.6, 2.6) if figure.female else (4.4, 3.4)
    yoke = capsule((3.5, neck_y - 6, -2.2), (shoulder[0] - 0.8, shoulder[1] - 1.3, -1.6), *yoke_radii)
    sleeve = generalised_cylinder(shoulder, figure.arm_direction, (0, 0, -1), figure.sleeve, rounding=0.4)
    blade = ellipsoid((shoulder[0] * 0.5, shoulder[1] - 8, -8.8), (5.5, 7, 2.6))
    if figure.bust is not None:
        chest = both_sides(ellipsoid(figure.bust, (6.2, 6.4, 4.9)), 3.0)
        chest_blend = 6.0
    else:
        chest = both_sides(ellipsoid((8.2, shoulder[1] - 10.5, 6.4), (8.4, 6.4, 3.2)), 2.5)
        chest_blend = 6.0
    worn = join(trunk, (mirrored(yoke), 7.0), (chest, chest_blend), (mirrored(blade), 4.0), (mirrored(sleeve), 2.8))
    end = figure.shirt[0][0]

    def field(points: Floats) -> Floats:
        margin = 0.55 - 0.22 * np.maximum(points[:, 1] - hem - 2, 0)
        over = smooth_min(worn(points), trousers(points) - margin, 3.0)
        return smooth_max(over, end - points[:, 1], 0.15)

    return field


def _shirt_hollows(figure: Figure, cloth: Field) -> Field:
    """The shallow room inside the two sleeve ends; the hem lies so close to the trousers that nobody sees into it."""
    shoulder, along = np.array(figure.shoulder), figure.arm_direction
    sleeve_end = shoulder + figure.sleeve[-1][0] * along
    inner = grown(cloth, -CLOTH)
    near_end = capsule(sleeve_end - 3.0 * along, sleeve_end + 5.0 * along, 8.5, 8.5)
    sleeve_hollow = _meet(inner, _meet(half_space(-along, sleeve_end - DEPTH * along), near_end))
    return mirrored(sleeve_hollow)


def _collared(figure: Figure, cloth: Field) -> Field:
    """The shirt cut at its neckline, with a collar band of doubled cloth."""
    neckline, banded = _neckline(figure, 0.0), _banded(figure, cloth)
    return lambda points: smooth_max(banded(points), neckline(points), 0.2)


def _banded(figure: Figure, cloth: Field) -> Field:
    """The shirt with the collar's doubled cloth, before the neck is cut out."""
    below = _neckline(figure, 2.0)

    def field(points: Floats) -> Floats:
        value = cloth(points)
        band = smooth_max(value - 0.22, -below(points), 0.12)
        return smooth_min(value, band, 0.08)

    return field


def _neckline(figure: Figure, lower: float) -> Field:
    """Above the neckline, `lower` cm further down: high at the nape, dipping in front in a round scoop."""
    neck_y, dip = figure.neck[1], 8.2 if figure.female else 6.6

    def field(points: Floats) -> Floats:
        forward = np.clip((points[:, 2] + 8.0) / 15.0, 0, 1.3)
        round_scoop = 0.035 * points[:, 0] ** 2 * np.clip(forward, 0, 1)
        edge = neck_y - 0.2 - lower - dip * forward**1.15 + round_scoop
        return (points[:, 1] - edge) * 0.85

    return field


def _shirt_ends(figure: Figure) -> Field:
    sleeve_end = np.array(figure.shoulder) + figure.sleeve[-1][0] * figure.arm_direction
    sleeve, hem = half_space(figure.arm_direction, sleeve_end), figure.shirt[0][0]

    def field(points: Floats) -> Floats:
        left = np.abs(points) * (1, 0, 0) + points * (0, 1, 1)
        near = np.linalg.norm(left - sleeve_end, axis=1) < SLEEVE_REACH
        return np.where(near, sleeve(left), hem - points[:, 1])

    return field


def _leg_ends(figure: Figure) -> Field:
    x, _, z = figure.ankle
    return half_space((0.0, -1.0, 0.21), (x, 5.2 if figure.female else 4.4, z + 2.0))


def _trouser_ends(figure: Figure, cloth: Field, hollow: bool) -> Field:
    """Leg ends cut on a slant, longer over the heel; thinner where the shirt covers them."""
    ends = _leg_ends(figure)
    hem = figure.shirt[0][0]

    def field(points: Floats) -> Floats:
        hidden = 0.9 * np.clip((points[:, 1] - hem - 0.5) / 3, 0, 1)
        shape = smooth_max(cloth(points) + hidden, ends(points), 0.15)
        shape = smooth_max(shape, points[:, 1] - hem - 6, 0.5)
        if not hollow:
            return shape
        above = -moved(ends, (0, DEPTH, 0))(points)
        return smooth_max(shape, -smooth_max(cloth(points) + CLOTH, -above, 0.2), 0.2)

    return field


def _meet(a: Field, b: Field, k: float = 0.2) -> Field:
    return lambda points: smooth_max(a(points), b(points), k)

"""The solid parts of a figure: field, box, grid spacing and triangle budgets of each. Knows no hair, face or file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stimuli.body_generator.fields import Field, grown, join, mirrored
from stimuli.body_generator.figure import Figure
from stimuli.body_generator.garments import clothes
from stimuli.body_generator.head import beard_shadow, head
from stimuli.body_generator.limbs import ankle, arm, laces, shoe, shoe_seams, sole
from stimuli.body_generator.seams import Line
from stimuli.skeleton import Floats


@dataclass(frozen=True, eq=False)
class Part:
    """One closed solid in one material.

    lower, upper: (3,) cm, the box it lies in; spacing: cm of the grid it is cut from.
    budgets:      triangles at each level of detail; 0 leaves it out.
    twin:         it is the left one of two, the right one being its mirror image (budgets are for one).
    ends:         0 where the cloth ends: its edge is brought there.
    soft:         share of what is hidden from the sky that gets light all the same: skin passes it on.
    seams:        lines sewn on the finest level.
    outside:      cloth that runs on beyond its openings: normals near an edge are those of the cloth, not of its rim.
    """

    name: str
    material: str
    field: Field
    plain: Field  # without openings, for the coarse levels
    lower: Floats
    upper: Floats
    spacing: float
    budgets: tuple[int, int, int]
    twin: bool
    paint: Callable[[Floats], Floats]  # shade (N,) put on points (N, 3), 1 = none
    outside: Field | None = None
    ends: Field | None = None
    soft: float = 0.0
    seams: tuple[Line, ...] = ()


def _unpainted(points: Floats) -> Floats:
    return np.ones(len(points))


def parts_of(figure: Figure) -> tuple[tuple[Part, ...], Field]:
    """All solid parts, and one field of the whole person (for weights and ambient occlusion)."""
    worn = clothes(figure)
    left_arm, left_shoe, left_sole, face = arm(figure), shoe(figure), sole(figure), head(figure, worn.chest)
    hand_end = np.array(figure.shoulder) + (figure.upper_arm + figure.forearm + figure.hand) * figure.arm_direction
    sleeve_end = np.array(figure.shoulder) + (figure.sleeve[-1][0] - 3.5) * figure.arm_direction
    x, _, z = figure.ankle
    k = figure.foot_scale
    hem = figure.shirt[0][0]
    neck_y = figure.neck[1]

    def part(
        name: str,
        material: str,
        field: Field,
        lower: tuple[float, ...],
        upper: tuple[float, ...],
        spacing: float,
        budgets: tuple[int, int, int],
        twin: bool = False,
        plain: Field | None = None,
        paint: Callable[[Floats], Floats] = _unpainted,
        outside: Field | None = None,
        ends: Field | None = None,
        soft: float = 0.0,
        seams: tuple[Line, ...] = (),
    ) -> Part:
        return Part(
            name,
            material,
            field,
            plain or field,
            np.array(lower, float),
            np.array(upper, float),
            spacing,
            budgets,
            twin,
            paint,
            outside,
            ends,
            soft,
            seams,
        )

    wide = sleeve_end[0] + 11
    arm_low = (sleeve_end[0] - 7, hand_end[1] - 2, -9)
    arm_high = (hand_end[0] + 6, sleeve_end[1] + 5, 9)
    found = (
        part(
            "head",
            "skin",
            face,
            (-12, neck_y - 12.5, -15),
            (12, figure.stature + 2, 15),
            0.38,
            (4156, 1828, 326),
            plain=head(figure, grown(worn.chest, -0.7)),
            paint=beard_shadow(figure),
            soft=0.4,
        ),
        part("arm", "skin", left_arm, arm_low, arm_high, 0.32, (1436, 480, 140), True),
        part(
            "shirt",
            "shirt",
            worn.shirt,
            (-wide, hem - 2, -19),
            (wide, neck_y + 5, 19),
            0.50,
            (4700, 1500, 330),
            plain=worn.closed_shirt,
            outside=worn.shirt_cloth,
            ends=worn.shirt_ends,
            seams=worn.shirt_seams,
        ),
        part(
            "trousers",
            "trousers",
            worn.trousers,
            (-21, 1, -19),
            (21, hem + 22, 17),
            0.55,
            (4100, 1400, 330),
            plain=worn.closed_trousers,
            outside=worn.trouser_cloth,
            ends=worn.trouser_ends,
            seams=worn.trouser_seams,
        ),
        part("ankle", "skin", ankle(figure), (x - 6, 3, z - 7), (x + 6, 20, z + 7), 0.4, (130, 60, 0), True),
        part(
            "shoe",
            "shoes",
            left_shoe,
            (x - 7, -1, z - 10 * k),
            (x + 8, 14, z + 24 * k),
            0.36,
            (620, 180, 56),
            True,
            seams=shoe_seams(figure),
        ),
        part("sole", "soles", left_sole, (x - 7, -1.5, z - 10 * k), (x + 8, 4, z + 24 * k), 0.36, (210, 110, 30), True),
        part("laces", "laces", laces(figure), (x - 5, 3, z), (x + 5, 13, z + 14), 0.14, (170, 50, 0), True),
    )
    everything = join(
        worn.body, (face, 0.6), (mirrored(left_arm), 0.3), (mirrored(left_shoe), 0.5), (mirrored(left_sole), 0.3)
    )
    return found, everything

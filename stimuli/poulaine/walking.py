"""A walk from a poulaine: both ankles on new paths under the captured hips, legs by two-bone inverse kinematics.

Rebuilding (Niay 2022, section 5.2) keeps the gait; editing (section 5.3) moves the points by a regression, towards a
speed, a height or a sex, or towards a walk ratio at constant speed. The sideways place of the ankle, the orientation of
the foot and the upper body stay as captured.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stimuli.cycle import Cycle, cycle_pose, cycle_positions
from stimuli.methods.making import check_speed, leg_length, made_by
from stimuli.poulaine.curve import FIVE, ControlPoints, PoulaineError, characteristic_points, poulaine_of
from stimuli.poulaine.legs import bent, local
from stimuli.poulaine.rebuilding import chosen_points, rebuilt
from stimuli.poulaine.regression import Change, regression_table
from stimuli.rotations import continuous
from stimuli.skeleton import Floats

SIDES = ("left", "right")

SPEEDS = (0.4, 3.0)
"""m/s to which a walk may be edited; the published regressions were made from 0.80 to 2.25 m/s."""

OUT_OF_REACH = 0.12
"""m that the new path may at most lie beyond the leg's reach; there the leg is left at its straightest."""


def poulaine_walk(cycle: Cycle, count: int = 5, interpolation: str = "hermite") -> Cycle:
    """The cycle with both ankles on poulaines rebuilt from 4 or 5 points ("cubic", "pchip" or "hermite")."""
    paths = [rebuilt(chosen_points(poulaine_of(cycle, side), count), interpolation, cycle.phases) for side in SIDES]
    return replace(
        with_paths(cycle, np.array(paths)), provenance=made_by("poulaine", f"{count} points, {interpolation}", cycle)
    )


def poulaine_to_speed(
    cycle: Cycle,
    speed: float,
    table: str = "normalised",
    change: Change | None = None,
    count: int = 5,
    detail: bool = False,
    interpolation: str = "hermite",
) -> Cycle:
    """The walk at another speed (m/s): points moved by the table's coefficients, rebuilt, inverse kinematics.

    table: "raw", "normalised" or "refitted"; change: also another height or sex (its speed is not read).
    detail: False as in the source; True adds back what the captured curve has beyond its own rebuilding.
    interpolation: as in `rebuilt`; Hermite in the source.
    The stride grows as the extent of the poulaine from I to E does, and the stride time gives the speed.
    """
    check_speed(speed, *SPEEDS)
    edit = replace(change or Change(), speed=speed - cycle.gait.speed)
    made = _edited(cycle, edit, table, count, detail, interpolation)
    return replace(made, stride_time=made.stride_length / speed)


def poulaine_to_walk_ratio(cycle: Cycle, walk_ratio: float, table: str = "normalised", count: int = 5) -> Cycle:
    """The walk at its own speed but another walk ratio (m·min): longer steps, fewer of them, or the reverse.

    SF = sqrt(60 v / WR) and SL = 60 v / SF (Sekiya et al. 1996). The points move along the table's line over speed
    until the poulaine's extent has grown as the step has.
    """
    if not 0.001 <= walk_ratio <= 0.02:
        raise PoulaineError(f"a walk ratio of {walk_ratio:g} m·min is no person's; give 0.001 to 0.02 m·min")
    speed = cycle.gait.speed
    frequency = float(np.sqrt(60.0 * speed / walk_ratio))
    growth = 120.0 * speed / frequency / cycle.stride_length
    moved = regression_table(table).moved(Change(speed=1.0), leg_length(cycle))
    per_speed = moved[FIVE.index("E"), 0] - moved[FIVE.index("I"), 0]
    extent = float(np.mean([_extent(characteristic_points(poulaine_of(cycle, side), FIVE[:4])) for side in SIDES]))
    made = _edited(cycle, Change(speed=(growth - 1.0) * extent / float(per_speed)), table, count)
    length = 120.0 * speed / frequency
    return replace(
        made,
        stride_length=length,
        stride_time=length / speed,
        provenance=made_by("poulaine", f"to a walk ratio of {walk_ratio:.5f} m·min by the {table} table", cycle),
    )


def edited_points(points: ControlPoints, moved: Floats) -> ControlPoints:
    """Points moved by (5, 2) m of the FIVE; V stays under the hip.

    First derivatives grow as the extent of the curve does along each axis, so that a larger curve is passed at the
    same phases. Raises PoulaineError where the order of the points would be lost.
    """
    rows = [FIVE.index(name) for name in points.names]
    shift = moved[rows].copy()
    shift[points.names.index("V"), 0] = 0.0
    places = points.places + shift
    growth = np.ptp(places, axis=0) / np.ptp(points.places, axis=0)
    new = replace(points, places=places, velocities=points.velocities * growth)
    if not new.of("I")[0] < new.of("V")[0] < new.of("E")[0] or new.of("A")[1] <= new.of("V")[1]:
        raise PoulaineError(
            "the walk asked for is too far from the captured one: the points of its poulaine change their order; "
            "start from a walk nearer to it"
        )
    return new


def with_paths(cycle: Cycle, paths: Floats) -> Cycle:
    """The cycle with both ankles on new paths from their hip joints.

    paths: (2, N, 2) m, x and z of the left and the right ankle. The hips rise or sink by a constant so that the
    ankles' lowest place stays where it was.
    """
    world, positions = cycle_pose(cycle)
    rotations = cycle.rotations.copy()
    for side, path in zip(SIDES, paths, strict=True):
        hip, knee, ankle = (cycle.joints.index(f"{side}{part}") for part in ("UpperLeg", "LowerLeg", "Foot"))
        target = positions[:, ankle].copy()
        target[:, 2] = positions[:, hip, 2] + path[:, 0]
        target[:, 1] = positions[:, hip, 1] + path[:, 1]
        legs = bent(positions[:, hip], target, world[:, hip], world[:, knee], cycle.offsets[knee], cycle.offsets[ankle])
        if legs.beyond.max() > OUT_OF_REACH:
            raise PoulaineError(
                f"{cycle.provenance.clip}: the new path of the {side} ankle is {100 * legs.beyond.max():.0f} cm out of "
                f"the leg's reach; ask for a walk nearer to the captured one"
            )
        rotations[:, hip] = local(world[:, cycle.parents[hip]], legs.thigh)
        rotations[:, knee] = local(legs.thigh, legs.shank)
        rotations[:, ankle] = local(legs.shank, world[:, ankle])
    bent_cycle = replace(cycle, rotations=continuous(rotations))
    ankles = [cycle.joints.index(f"{side}Foot") for side in SIDES]
    sunk = cycle_positions(bent_cycle)[:, ankles, 1].min(axis=0) - positions[:, ankles, 1].min(axis=0)
    return replace(bent_cycle, hips=cycle.hips - [0.0, float(np.mean(sunk)), 0.0])


def _edited(
    cycle: Cycle, change: Change, table: str, count: int, detail: bool = False, interpolation: str = "hermite"
) -> Cycle:
    regression = regression_table(table)
    size = _size(cycle, change)
    grown = replace(cycle, offsets=cycle.offsets * size, hips=cycle.hips * size)
    before = [chosen_points(poulaine_of(cycle, side), count) for side in SIDES]
    start = before if not regression.normalised else [_scaled(points, size) for points in before]
    moved = regression.moved(change, leg_length(grown))
    after = [edited_points(points, moved) for points in start]
    growth = float(np.mean([_extent(b) / _extent(a) for a, b in zip(before, after, strict=True)]))
    paths = np.array([rebuilt(points, interpolation, cycle.phases) for points in after])
    if detail:
        paths += size * np.array(
            [
                poulaine_of(cycle, side).xz - rebuilt(points, interpolation, cycle.phases)
                for side, points in zip(SIDES, before, strict=True)
            ]
        )
    made = with_paths(grown, paths)
    described = f"edited by {change.speed:+.2f} m/s, {change.height:+.2f} m, gender {change.gender:+g}, {table} table"
    return replace(made, stride_length=cycle.stride_length * growth, provenance=made_by("poulaine", described, cycle))


def _size(cycle: Cycle, change: Change) -> float:
    """How much larger the skeleton becomes; stature is taken as leg length over 0.491 (Drillis & Contini 1966)."""
    stature = leg_length(cycle) / 0.491
    if not 0.5 <= (stature + change.height) / stature <= 1.6:
        raise PoulaineError(f"a height changed by {change.height:+.2f} m is no person's")
    return (stature + change.height) / stature


def _scaled(points: ControlPoints, size: float) -> ControlPoints:
    return replace(points, places=points.places * size, velocities=points.velocities * size)


def _extent(points: ControlPoints) -> float:
    return float(points.of("E")[0] - points.of("I")[0])

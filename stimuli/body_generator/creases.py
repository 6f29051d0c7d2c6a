"""Where a T-shirt and trousers crease. Knows fields only through `folds`.

Where folds go is anatomy of clothing: they radiate from the arm-pit, stack behind the knee and in the elbow,
pull from the crotch over the thigh, hang at the waist and break over the shoe.
"""

from __future__ import annotations

import numpy as np

from stimuli.body_generator.fields import Field
from stimuli.body_generator.figure import ARM_ANGLE, Figure
from stimuli.body_generator.folds import Fold, folded
from stimuli.skeleton import Floats

SEED = 20
Curve = tuple[Floats, Floats, Floats]

_WAIST_ROWS = (8.5, 2.6, -4.2)  # cm above the spine joint
_HEM_FLUTES = ((17.5, 4.0), (14.0, 9.5), (8.0, 11.5), (16.5, -6.0), (11.5, -11.5), (5.0, -12.5))  # x, z in cm
_SLEEVE_FOLDS = ((0.45, 0.6), (0.7, 2.4), (0.8, -0.9), (0.6, 3.9), (0.85, 1.3), (0.9, 3.2))  # share of length, turn
_BREAKS = ((1.6, 0.5), (5.6, 2.1), (10.8, 1.0))  # cm above the leg's end, turn


def shirt_folds(figure: Figure, cloth: Field) -> Field:
    """Folds of a T-shirt: from the arm-pits, over the waist, flutes above the hem, on the sleeves."""
    rng = np.random.default_rng(SEED)
    strength = 1.35 if figure.female else 1.5
    folds: list[Fold] = []
    for side in (1, -1):
        for curve, width, height in [
            *_armpit(figure, side),
            *_waist(figure, side, rng),
            *_flutes(figure, side),
            *_sleeve(figure, side),
        ]:
            folds.append(_uneven(curve, width, strength * height, 0.7, rng))
    return folded(cloth, folds)


def trouser_folds(figure: Figure, cloth: Field) -> Field:
    """Folds of trousers: from the crotch, over the thigh, round the knee, stacked above the shoe; pockets and fly."""
    rng = np.random.default_rng(SEED + 1)
    strength = 1.0 if figure.female else 1.35
    folds: list[Fold] = []
    for side in (1, -1):
        for curve, width, height in [
            *_crotch(figure, side),
            *_thigh(figure, side),
            *_knee(figure, side),
            *_break(figure, side, rng),
        ]:
            folds.append(_uneven(curve, width, strength * height, 0.6, rng))
        folds += [Fold(*curve, width, height) for curve, width, height in _seams(figure, side)]
    return folded(cloth, folds)


def _uneven(curve: Curve, width: float, height: float, wobble: float, rng: np.random.Generator) -> Fold:
    """A fold a little away from where it was wanted, as no two sides of real cloth are alike."""
    start, middle, end = (point + rng.normal(0, wobble, 3) for point in curve)
    return Fold(start, middle, end, width, height * (1 + 0.15 * rng.normal()))


def _point(x: float, y: float, z: float) -> Floats:
    return np.array([x, y, z])


def _armpit(figure: Figure, side: int) -> list[tuple[Curve, float, float]]:
    sx, sy, _ = figure.shoulder
    found = []
    for front in (1, -1):
        start = _point(side * (sx - 1.0), sy - 9.5, 4.0 * front)
        depth = 8.5 * front
        for drop, run in ((-1, 0.42), (-6, 0.5), (-12, 0.62)):
            middle = _point(side * sx * 0.8, sy - 10 + drop * 0.7, depth)
            found.append(((start, middle, _point(side * sx * run, sy - 8 + drop, depth + 1.5 * front)), 1.2, 0.48))
        over = (
            _point(side * (sx + 2), sy - 5, 5 * front),
            _point(side * sx * 0.82, sy - 5, 8 * front),
            _point(side * sx * 0.6, sy - 2.5, depth),
        )
        found.append((over, 1.2, 0.4))
    return found


def _waist(figure: Figure, side: int, rng: np.random.Generator) -> list[tuple[Curve, float, float]]:
    wide = 15.5 if figure.female else 17.5
    found = []
    for k, up in enumerate(_WAIST_ROWS):
        y = figure.trunk_heights[1] + up
        reach = side * wide * (0.25 + 0.2 * rng.random())
        edge = side * wide * 0.98
        front = (_point(edge, y + 1.5, k - 2), _point(0.8 * side * wide, y - 1, 8), _point(reach, y - 2.5, 11))
        back = (_point(edge, y + 1.5, -3 - k), _point(0.75 * side * wide, y, -9), _point(reach, y - 1.5, -11))
        found += [(front, 1.25, 0.5), (back, 1.3, 0.65)]
    return found


def _flutes(figure: Figure, side: int) -> list[tuple[Curve, float, float]]:
    hem = figure.shirt[0][0]
    found = []
    for x, z in _HEM_FLUTES:
        curve = (
            _point(side * x * 0.96, hem + 13, z * 0.95),
            _point(side * x, hem + 6, z),
            _point(side * x * 1.03, hem - 2, z * 1.04),
        )
        found.append((curve, 1.5, 0.38))
    return found


def _sleeve(figure: Figure, side: int) -> list[tuple[Curve, float, float]]:
    along = figure.arm_direction
    across = np.array([np.cos(ARM_ANGLE), np.sin(ARM_ANGLE), 0])
    forward = np.array([0.0, 0.0, 1.0])
    length, radius = figure.sleeve[-1][0], 5.3 if figure.female else 6.6

    def on(share: float, turn: float, lower: float) -> Floats:
        round_it = np.cos(turn) * across + np.sin(turn) * forward
        point: Floats = np.array(figure.shoulder) + (share * length + lower) * along + radius * round_it
        return point * (side, 1, 1)

    return [
        ((on(share, turn - 0.7, 0), on(share, turn, 1.6), on(share, turn + 0.8, 4.0)), 1.1, 0.42)
        for share, turn in _SLEEVE_FOLDS
    ]


def _on_leg(figure: Figure, side: int, y: float, turn: float, radius: float) -> Floats:
    """A point on a leg at height y (cm); turn 0 is outside, a quarter turn in front."""
    hip, ankle = np.array(figure.hip), np.array(figure.ankle)
    part = np.clip((hip[1] - y) / (hip[1] - ankle[1]), 0, 1)
    centre = hip + part * (ankle - hip)
    return _point(side * (centre[0] + radius * np.cos(turn)), y, centre[2] * 0.5 + radius * np.sin(turn))


def _crotch(figure: Figure, side: int) -> list[tuple[Curve, float, float]]:
    """Pulls from the crotch over the thigh and under the buttock; they begin beside the seam, where cloth is held."""
    thick = 0.86 if figure.female else 1.0
    y, half = figure.hip[1] - 8, np.pi
    on = lambda up, turn, radius: _on_leg(figure, side, y + up, turn, radius * thick)  # noqa: E731
    found: list[tuple[Curve, float, float]] = []
    for spread, drop in ((0.35, 5.0), (0.6, 1.0), (0.95, -4.5), (1.2, -10.0)):
        front = (
            on(0.15 * drop - 1.0, half - 1.0, 9.0),
            on(1.0 + 0.5 * drop, half - 1.35, 9.6),
            on(2.5 + drop, half - 1.35 - spread, 9.8),
        )
        found.append((front, 1.15, 0.42))
    for spread, drop in ((0.5, -3.0), (1.0, -7.0), (1.5, -12.0)):
        back = (
            on(0, half + 0.7, 8),
            on(0.6 * drop, half + 1.2, 9.5),
            on(2 + drop, half + 1.4 + 0.6 * spread, 10),
        )
        found.append((back, 1.3, 0.5))
    return found


def _thigh(figure: Figure, side: int) -> list[tuple[Curve, float, float]]:
    """Slanting pulls between hip and knee, front and back."""
    radius = 7.6 if figure.female else 8.6
    top, low = figure.hip[1] - 16, figure.knee[1] + 9
    found: list[tuple[Curve, float, float]] = []
    for share, turn, lean in (
        (0.05, 1.9, 4.0),
        (0.35, 1.25, -4.5),
        (0.62, 1.8, 3.5),
        (0.3, -1.3, 4.0),
        (0.7, -1.8, -3.5),
    ):
        y = top + share * (low - top)
        on = lambda rise, at, y=y: _on_leg(figure, side, y + rise, at, radius)  # noqa: E731
        found.append(((on(lean, turn - 0.75), on(0.3 * lean, turn), on(-lean, turn + 0.75)), 1.3, 0.36))
    return found


def _seams(figure: Figure, side: int) -> list[tuple[Curve, float, float]]:
    """The welt of a slanting front pocket; and once, left of the middle, the fly."""
    y = figure.shirt[0][0]
    on = lambda up, turn: _on_leg(figure, side, y + up, turn, 10.5)  # noqa: E731
    found: list[tuple[Curve, float, float]] = [((on(1.0, 0.95), on(-5.0, 0.62), on(-11.0, 0.12)), 0.55, 0.3)]
    if side > 0:
        fly = (_point(1.2, y + 2, 11), _point(1.3, y - 4, 11), _point(0.4, figure.hip[1] - 7.0, 9.5))
        found.append((fly, 0.6, 0.22))
    return found


def _knee(figure: Figure, side: int) -> list[tuple[Curve, float, float]]:
    radius = 6.2 if figure.female else 7.2
    behind = np.pi / 2
    found: list[tuple[Curve, float, float]] = []
    for k, up in enumerate((5.5, 0.5, -5.0)):
        y, lean = figure.knee[1] + up, 1.5 if k % 2 else -1.5
        on = lambda rise, turn, y=y: _on_leg(figure, side, y + rise, turn, radius)  # noqa: E731
        found.append(((on(lean, -0.5), on(-1.0, -behind), on(-lean, 0.5 - np.pi)), 1.15, 0.5))
        found.append(((on(2 + lean, 0.1), on(0, 0.7), on(-1, 1.25)), 1.3, 0.24))
        found.append(((on(2 - lean, np.pi - 0.1), on(0, np.pi - 0.7), on(-1, np.pi - 1.2)), 1.3, 0.24))
    return found


def _break(figure: Figure, side: int, rng: np.random.Generator) -> list[tuple[Curve, float, float]]:
    radius = 5.85 if figure.female else 6.6
    low = figure.ankle[1] - 1.0
    found: list[tuple[Curve, float, float]] = []
    for k, (up, turn) in enumerate(_BREAKS):
        turn, height = turn + 0.3 * rng.normal(), 0.62 - 0.17 * k
        on = lambda rise, at, more=0.0, y=low + up: _on_leg(figure, side, y + rise, at, radius + more)  # noqa: E731
        found.append(((on(1.0, turn - 1.3), on(-0.8, turn, 0.6), on(1.4, turn + 1.3)), 1.05, height))
        found.append(((on(2.4, turn + 2.0), on(1.2, turn + 3.1), on(2.2, turn + 4.2)), 1.1, 0.85 * height))
    return found

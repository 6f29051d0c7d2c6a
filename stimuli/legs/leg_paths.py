"""Where captured leg angles carry the hips, and the legs that are swung and pushed off to fit the step.

Each leg is looked at on its own clock, phase 0 its heel strike, the left one as seen in a mirror, so that both are
written like a right leg. The hips are where the standing legs put them over feet that roll on the ground, least
squares over both legs in the first harmonics of the cycle. Knows one skeleton's leg and curves; no actor.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stimuli.legs import contact
from stimuli.legs.contact import Sole
from stimuli.legs.foot_paths import PHASES, SAMPLES, FootPath, heel_rises, pitched, smoothed, still_in_stance
from stimuli.legs.two_bone import FURTHEST, Leg, reach
from stimuli.skeleton import Floats

Bools = NDArray[np.bool_]

HIPS_HARMONICS = 10
"""Harmonics of the cycle in the hips' height and advance; of a walk whose sides are alike only the even ones."""

CALM = 8.0
"""Harmonic of the cycle at which the hips give in to the legs by half; above it they hardly do, as in captured walks,
whose hips move less than half a millimetre in any harmonic above the sixth."""

STEADY = 0.3
"""How much the odd harmonics of the advance are held to zero, in samples of a standing leg: left and right footprints
and a forward sway once per cycle are told apart only while both feet are on the ground."""

BUILT_REACH = 0.9996
"""Largest hip-ankle distance over leg length in a cycle as built (knee bent 3.2 degrees); blending needs the rest."""

CALM_REACH = np.where(np.arange(SAMPLES) < 8, 0.9980, 0.9992)
"""(N,) the same in a calm cycle: knee bent 5 degrees, 7 as the heel strikes. The knee of a leg that is nearly straight
bends with the root of what its hip and ankle come nearer, so that it would snap; the hips are 1 mm lower for it."""

CEILING_MARGIN = 0.0003
"""m below the highest place that the standing leg reaches at which the hips are aimed where they would be above."""

SWING_GAIN = (0.8, 1.35)
"""How much less or more than captured the stance leg may swing to make a step of the wanted length."""

PUSH_OFF = np.radians(12.0)
"""Largest change of the captured foot pitch at push-off (two standard deviations between people, S&M tables)."""

CALM_PUSH_OFF = np.radians(20.0)
"""The same in a calm cycle: people complete far from their captures with feet that would not lift their heels."""


@dataclass(frozen=True, eq=False)
class LegPath:
    """A leg over PHASES of its own clock.

    strike: phase of the cycle at its heel strike
    hip:    (N, 3) m, hip joint less the height and advance of the hips
    knee:   (N,) rad, captured flexion
    vector: (N, 2) m, up and forward from hip to ankle
    ahead:  m, footprint ahead of the walker's mean position at its heel strike
    """

    strike: float
    hip: Floats
    knee: Floats
    vector: Floats
    foot: FootPath
    ahead: float = 0.0

    @property
    def phases(self) -> Floats:
        """(N,) phases of the cycle."""
        return PHASES + self.strike

    @property
    def standing(self) -> Floats:
        """(N,) how much this leg tells of the hips: all from heel strike until the other leg takes over."""
        return np.asarray(contact.smooth_step((self.foot.stance - 0.07 - PHASES) / 0.1))


@dataclass(frozen=True, eq=False)
class Hips:
    """Height and advance (m) of the hips as Fourier coefficients of the cycle's `harmonics`."""

    harmonics: Floats
    height: Floats
    advance: Floats

    def at(self, phases: Floats) -> Floats:
        """(N, 2) m, height and advance at phases of the cycle."""
        return np.column_stack(
            [_terms(phases, self.harmonics) @ self.height, _terms(phases, self.harmonics)[:, 1:] @ self.advance]
        )


def leg_path(
    leg: Leg, sole: Sole, scale: float, side: dict[str, Floats], hips: Floats, stance: float, calm: bool
) -> LegPath:
    """A leg of a walk before anything is fitted, at the right side's heel strike.

    side: the side's signals over PHASES; hips: (N, 3, 3) world rotation of the hips; scale: leg length m; calm: whether
    its twitches are taken out. The yaw of a foot that points steeply down is mostly roll, and a calm one is spared it.
    """
    turned = side["foot_yaw"] * np.cos(side["foot"]) if calm else side["foot_yaw"]
    yaw = still_in_stance(turned, stance)
    place = scale * still_in_stance(side["foot_shift"], stance)
    pitch = heel_rises(side["foot"], stance) if calm else side["foot"]
    foot = pitched(sole, pitch, yaw, side["knee_yaw"], place, stance, calm)
    hip = hips @ leg.hip
    hip[:, 0] += scale * side["hips_shift"]
    vector = _leg_vector(leg, side["thigh"], side["shank"], foot.ankle[:, 0] - hip[:, 0])
    return LegPath(0.0, hip, side["thigh"] - side["shank"], vector, foot)


def carried_hips(leg: Leg, sole: Sole, paths: Sequence[LegPath], stride: float) -> tuple[Hips, list[LegPath]]:
    """The hips that fit the standing legs best, and the legs swung and pushed off to fit the step of that length.

    paths: both legs, or one where the other is its mirror image half a cycle later. stride: m.
    """
    step = 1 if len(paths) > 1 else 2
    harmonics = np.arange(step, HIPS_HARMONICS + 1, step, dtype=float)
    advance, swung = _advance(paths, harmonics, stride)
    height = _height(leg, swung, harmonics, advance, stride)
    hips = Hips(harmonics, height, advance)
    return hips, [replace(path, foot=_pushed_off(sole, path, hips.at(path.phases), stride)) for path in swung]


def _leg_vector(leg: Leg, thigh: Floats, shank: Floats, sideways: Floats) -> Floats:
    """(N, 2) m up and forward from hip to ankle, for inclinations of its bones (rad).

    The knee angle is kept, so the part of the leg's length that leads sideways is taken off; a stout figure's legs may
    be too short for the step's width, and then keep a fifth of their length.
    """
    vector = np.column_stack(
        [
            -leg.thigh * np.cos(thigh) - leg.shank * np.cos(shank),
            leg.thigh * np.sin(thigh) + leg.shank * np.sin(shank),
        ]
    )
    length = reach(leg, thigh - shank)
    upright = np.sqrt(np.maximum(length**2 - sideways**2, (0.2 * length) ** 2))
    return vector * (upright / np.linalg.norm(vector, axis=1))[:, None]


def _advance(paths: Sequence[LegPath], harmonics: Floats, stride: float) -> tuple[Floats, list[LegPath]]:
    """Coefficients (2 H,) m of the hips' advance, and the legs with their footprints, swung to fit the step.

    Least squares over the standing legs: the hips are where the leg puts them over its footprint. A step longer than
    the captured angles make is made by swinging both legs further in proportion, which keeps the knees.
    """
    own = np.eye(len(paths))
    terms = [np.column_stack([_terms(path.phases, harmonics)[:, 1:], np.tile(-own[n], (SAMPLES, 1))])
             for n, path in enumerate(paths)]  # fmt: skip
    wanted = [path.foot.ankle[:, 2] - stride * PHASES - path.hip[:, 2] for path in paths]
    forward = [path.vector[:, 1] for path in paths]
    weights = np.concatenate([path.standing for path in paths])
    steady = np.repeat(np.where(harmonics % 2 == 1, STEADY, 0.0), 2)
    hold = np.append(steady + _calming(harmonics, weights), np.zeros(len(paths)))
    design = np.column_stack([np.concatenate(terms), np.concatenate(forward)])
    solution = _least_squares(design, np.concatenate(wanted), weights, np.append(hold, 0.0))
    gain = float(np.clip(solution[-1], *SWING_GAIN))
    left = np.concatenate(wanted) - gain * np.concatenate(forward)
    solution = _least_squares(design[:, :-1], left, weights, hold)
    advance, ahead = solution[: 2 * len(harmonics)], solution[2 * len(harmonics) :]
    swung = [
        replace(path, vector=_swung(path.vector, gain), ahead=float(place))
        for path, place in zip(paths, ahead, strict=True)
    ]
    return advance, swung


def _swung(vector: Floats, gain: float) -> Floats:
    """A leg's vector (N, 2) turned so that it reaches `gain` times as far forward, at its length."""
    length = np.linalg.norm(vector, axis=1)
    forward = np.clip(gain * vector[:, 1], -0.95 * length, 0.95 * length)
    return np.column_stack([-np.sqrt(length**2 - forward**2), forward])


def _height(leg: Leg, paths: Sequence[LegPath], harmonics: Floats, advance: Floats, stride: float) -> Floats:
    """Coefficients (1 + 2 H,) m of the hips' height: least squares over the standing legs, lowered to their reach.

    The straighter the knee, the more a millimetre of height bends it, and the more it counts.
    """
    terms = np.concatenate([_terms(path.phases, harmonics) for path in paths])
    wanted, ceiling, weight, standing = [], [], [], []
    for path in paths:
        foot = path.foot
        behind = path.ahead - stride * PHASES - _terms(path.phases, harmonics)[:, 1:] @ advance
        room = (
            ((CALM_REACH if foot.calm else BUILT_REACH) * leg.length) ** 2
            - (foot.ankle[:, 0] - path.hip[:, 0]) ** 2
            - (behind + foot.ankle[:, 2] - path.hip[:, 2]) ** 2
        )
        wanted.append(foot.ankle[:, 1] - path.vector[:, 0] - path.hip[:, 1])
        lowest = leg.length * np.sqrt(1.0 - FURTHEST**2)  # a foot that is further away gives way, not the hips
        ceiling.append(foot.ankle[:, 1] + np.sqrt(np.maximum(room, lowest**2)) - path.hip[:, 1])
        weight.append(path.standing / (np.maximum(path.knee, 0.0) + 0.05) ** 2 * np.where(PHASES < 0.1, 2.0, 1.0))
        standing.append(foot.stance - 0.17 > PHASES)
    parts = [np.asarray(np.concatenate(part)) for part in (wanted, ceiling, weight)]
    return _below(terms, harmonics, parts[0], parts[1], parts[2], np.concatenate(standing))


def _below(
    terms: Floats, harmonics: Floats, wanted: Floats, ceiling: Floats, weight: Floats, standing: Bools
) -> Floats:
    """Coefficients of the weighted least squares curve that stays below a ceiling where the leg is `standing`."""
    force: Floats = np.zeros(len(terms))
    coefficients: Floats = np.zeros(terms.shape[1])
    for _ in range(12):
        total = weight + force
        target = (weight * wanted + force * (ceiling - CEILING_MARGIN)) / np.maximum(total, 1e-9)
        coefficients = _least_squares(terms, target, total, np.append(0.0, _calming(harmonics, total)))
        over = standing & (terms @ coefficients > ceiling)
        if not over.any():
            break
        force = force + 4.0 * weight.max() * over
    coefficients[0] -= max(0.0, float(np.max((terms @ coefficients - ceiling)[standing])))
    return coefficients


def _pushed_off(sole: Sole, path: LegPath, hips: Floats, stride: float) -> FootPath:
    """The foot with its heel rise at push-off changed, by PUSH_OFF at most, so that the knee stays as captured.

    In double support the hips go where the leading leg carries them; what is left over for the trailing leg is
    made by its heel, which is what a trailing foot is for. hips: (N, 2) m, height and advance on this leg's clock.
    """
    foot = path.foot
    length = np.linalg.norm(path.vector, axis=1)
    hip_up = (hips[:, 0] + path.hip[:, 1])[:, None]
    behind = (path.ahead - stride * PHASES - hips[:, 1] - path.hip[:, 2])[:, None]
    changes = np.linspace(-1.0, 1.0, 41) * (CALM_PUSH_OFF if foot.calm else PUSH_OFF)
    pitches = foot.pitch[:, None] + changes
    forward, up = contact.planted(sole, pitches, contact.toe_bend(pitches, 0.0))
    reached = np.sqrt((up - hip_up) ** 2 + (behind + np.cos(foot.yaw)[:, None] * forward) ** 2)
    misses = (reached - length[:, None]) ** 2 + (0.02 * changes) ** 2
    if foot.calm:  # a foot that pushes off lifts its heel, never its toes, though that would fit as well
        misses = np.where(pitches > np.maximum(foot.pitch, 0.0)[:, None] + 1e-9, np.inf, misses)
    best = changes[np.argmin(misses, axis=1)]
    late = contact.smooth_step((PHASES - 0.36) / 0.1) * contact.smooth_step((foot.stance + 0.1 - PHASES) / 0.1)
    end = int(np.searchsorted(PHASES, foot.stance - 0.01))
    held = np.where(PHASES[end] > PHASES, best, best[end])
    pitch = foot.pitch + late * smoothed(held)
    return pitched(sole, pitch, foot.yaw, foot.knee_yaw, foot.side, foot.stance, foot.calm)


def _terms(phases: Floats, harmonics: Floats) -> Floats:
    """(N, 1 + 2 H): 1, cosines and sines of these harmonics of the cycle, in pairs."""
    angles = 2.0 * np.pi * np.outer(phases, harmonics)
    terms = np.empty((len(phases), 1 + 2 * len(harmonics)))
    terms[:, 0] = 1.0
    terms[:, 1::2] = np.cos(angles)
    terms[:, 2::2] = np.sin(angles)
    return terms


def _calming(harmonics: Floats, weights: Floats) -> Floats:
    """(2 H,) ridge of the coefficients of these harmonics in a least squares fit with weights (N,)."""
    return np.asarray(np.repeat(0.5 * float(np.sum(weights)) * (harmonics / CALM) ** 6, 2))


def _least_squares(design: Floats, wanted: Floats, weights: Floats, hold: Floats) -> Floats:
    """(K,) weighted least squares with a ridge `hold` (K,), by the normal equations: few columns, many rows."""
    weighted = design * weights[:, None]
    return np.asarray(np.linalg.solve(weighted.T @ design + np.diag(hold + 1e-9), weighted.T @ wanted))

"""Who walks where in a crowd: motions, sizes, lanes, speeds and starts, all from one seed; places at any time.

Everybody walks along +Z in a lane. A lane has one speed, so the gaps in it never change, and lanes lie further apart
than people sway: nobody ever meets anybody, however long the crowd walks. Who leaves the stretch at its end comes in
again at its beginning. Paths come from the seed alone, so crowds of one seed differ in their motions only.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from stimuli.crowds.motions import SEXES, UNREMARKABLE, Style, motion_of
from stimuli.skeleton import Floats

LANE = 0.82  # m from lane to lane
SWERVE = 0.09  # m, furthest from the middle of a lane
NEAREST = 1.35  # m, least gap in a lane: a long step and half a body
MEAN_SPEED = 1.57  # m/s, mean of what the walks of the pool have of their own accord
LANE_SPREAD = 0.08  # SD of the speeds of lanes over their mean
SUITED = 0.8
"""Correlation of a walker's own speed with that of the lane it is put in; the rest of it is chance."""

SIZES = {"F": (1.0, 0.040), "M": (1.006, 0.040)}
"""Stature over the body's own, mean and SD: 1.63 (0.065) and 1.76 (0.07) m; draws beyond 2 SD are drawn again."""

POOL = 500
"""Walks per sex that crowds choose from; 1000 in all, as in Niay (2022, section 6.1.1)."""


class CrowdError(ValueError):
    """There can be no such crowd."""


@dataclass(frozen=True, eq=False)
class CrowdPlan:
    """A crowd of N walkers.

    motions: M styles; motion: (N,) which of them each walks
    sizes:   (N,) stature over the unscaled body's
    speed:   (N,) m/s; step_frequency: (N,) steps/min; phase: (N,) at time 0
    aside:   (N,) m, +X; start: (N,) m along the stretch at time 0; length: m of the stretch
    order:   (N,) a random order of the walkers of each sex, from which looks are dealt
    """

    motions: tuple[Style, ...]
    motion: NDArray[np.intp]
    sizes: Floats
    speed: Floats
    step_frequency: Floats
    phase: Floats
    aside: Floats
    start: Floats
    length: float
    order: NDArray[np.intp]

    @property
    def women(self) -> NDArray[np.bool_]:
        """(N,) who is a woman."""
        return np.array([style.sex == "F" for style in self.motions])[self.motion]

    def places(self, seconds: float) -> Floats:
        """(N, 2) m: aside (+X) and along the stretch (+Z, from 0 to its length)."""
        return np.column_stack([self.aside, (self.start + self.speed * seconds) % self.length])

    def phases(self, seconds: float) -> Floats:
        """(N,) of the gait cycle."""
        return (self.phase + self.step_frequency * (seconds / 120.0)) % 1.0


def motions_per_sex(size: int, variation: str, seed: int) -> tuple[int, int]:
    """How many motions women and men have; variation is "1:N", one motion for N walkers, or "1", one for each sex.

    Where the number of motions is odd the seed says which sex has one more.
    """
    if variation == "1":
        return 1, 1
    one, colon, many = variation.partition(":")
    if one != "1" or not colon or not many.isdecimal() or not 1 <= int(many) <= 1000:
        raise CrowdError(
            f'a variation is "1:N", one motion for N walkers, or "1", one motion per sex; not {variation!r}'
        )
    total = max(round(size / int(many)), 2)
    more = int(np.random.default_rng([seed, 5]).integers(2)) if total % 2 else 0
    return total // 2 + more * (total % 2), total - total // 2 - more * (total % 2)


@lru_cache(maxsize=8)
def plan_crowd(size: int, variation: str, seed: int, pool: int, width: float, length: float) -> CrowdPlan:
    """The crowd of so many walkers.

    seed: of paths, sizes and which motions; pool: of the walks that motions are chosen from
    width: m between the kerbs; length: m of the stretch, longer where so many do not fit
    Raises CrowdError for a crowd that cannot be.
    """
    if not 2 <= size <= 4000:
        raise CrowdError(f"a crowd has 2 to 4000 walkers, not {size}")
    lanes, aside, start, length = _slots(size, seed, width, length)
    women = _half(size, seed)
    motions, motion = _motions(women, variation, seed, pool)
    sizes = _sizes(women, seed)
    own = sizes * np.array([motion_of(style).speed for style in motions])[motion]
    rng = np.random.default_rng([seed, 3])
    lane_speeds = MEAN_SPEED * _spread(lanes.max() + 1, rng)
    slot = _suited(own, lane_speeds[lanes], rng)
    lanes, aside, start = lanes[slot], aside[slot], start[slot]
    lengths = sizes * np.array([motion_of(style).step_length for style in motions])[motion]
    return CrowdPlan(
        motions=motions,
        motion=motion,
        sizes=sizes,
        speed=lane_speeds[lanes],
        step_frequency=60.0 * lane_speeds[lanes] / lengths,
        phase=rng.random(size),
        aside=aside,
        start=start,
        length=length,
        order=np.random.default_rng([seed, 4]).permutation(size),
    )


def _slots(size: int, seed: int, width: float, length: float) -> tuple[NDArray[np.intp], Floats, Floats, float]:
    """Lane, aside (m) and start (m) of every walker, and the length of the stretch (m)."""
    rng = np.random.default_rng([seed, 1])
    count = int((width - LANE) / LANE)
    if count < 1:
        raise CrowdError(f"a street {width:g} m wide has no room for a crowd")
    lanes = np.arange(size) % count
    length = max(length, 1.25 * NEAREST * np.ceil(size / count))
    aside = (lanes - 0.5 * (count - 1)) * LANE + rng.uniform(-SWERVE, SWERVE, size)
    start = np.empty(size)
    for lane in range(min(count, size)):
        own = np.flatnonzero(lanes == lane)
        gaps = NEAREST + (length - NEAREST * len(own)) * rng.dirichlet(np.full(len(own), 2.0))
        start[own] = (np.cumsum(gaps) + length * rng.random()) % length
    return lanes, aside, start, float(length)


def _half(size: int, seed: int) -> NDArray[np.bool_]:
    """(N,) half of the walkers, at random."""
    return np.random.default_rng([seed, 2]).permutation(size) < size // 2


def _motions(
    women: NDArray[np.bool_], variation: str, seed: int, pool: int
) -> tuple[tuple[Style, ...], NDArray[np.intp]]:
    """The styles of a crowd, and which of them each walker has."""
    rng = np.random.default_rng([seed, 6])
    styles: list[Style] = []
    motion = np.empty(len(women), np.intp)
    for sex, of_sex, count in zip(SEXES, (women, ~women), motions_per_sex(len(women), variation, seed), strict=True):
        if variation == "1":
            numbers = -1 - rng.integers(UNREMARKABLE, size=1)
        else:
            count = min(count, int(of_sex.sum()))
            numbers = rng.permutation(max(POOL, count))[:count]
        motion[of_sex] = len(styles) + rng.permutation(int(of_sex.sum())) % len(numbers)
        styles += [Style(sex, int(number), pool) for number in numbers]
    return tuple(styles), motion


def _sizes(women: NDArray[np.bool_], seed: int) -> Floats:
    rng = np.random.default_rng([seed, 7])
    normal = rng.standard_normal(len(women))
    while (far := np.abs(normal) > 2.0).any():
        normal[far] = rng.standard_normal(int(far.sum()))
    mean, spread = np.where(women[:, None], SIZES["F"], SIZES["M"]).T
    return np.asarray(mean + spread * normal)


def _spread(count: int, rng: np.random.Generator) -> Floats:
    """(count,) speeds of lanes over their mean: evenly spaced quantiles of a normal distribution, in random order."""
    from scipy.special import ndtri

    return np.asarray(1.0 + LANE_SPREAD * rng.permutation(ndtri((np.arange(count) + 0.5) / count)))


def _suited(own: Floats, offered: Floats, rng: np.random.Generator) -> NDArray[np.intp]:
    """(N,) which slot each walker gets: faster ones rather in faster lanes."""
    spread = max(float(own.std()), 1e-9)
    score = SUITED * (own - own.mean()) / spread + np.sqrt(1.0 - SUITED**2) * rng.standard_normal(len(own))
    slot = np.empty(len(own), np.intp)
    slot[np.argsort(score)] = np.argsort(offered + 1e-9 * rng.random(len(own)))
    return slot

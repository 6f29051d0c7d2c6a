"""240 people to tell apart: bodies, haircuts, builds and colours of clothes, hair and skin, as far apart as can be.

Looks are chosen one after the other, each the farthest from those chosen before (Gonzalez 1985) among many random
ones, by a distance that adds up CIELAB differences of what is worn, weighted by how much of it is seen, and steps of
body. Always the same 240. With equal luminance every garment has one L* (so one luminance) and only hue and chroma
tell people apart, for studies of where people look. Colours: CIELAB for D65 (CIE 15:2004), then linear sRGB.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Literal

import numpy as np

from stimuli.bodies.builds import GIRTHS
from stimuli.bodies.known import hair_names
from stimuli.crowds.motions import BODIES, Sex
from stimuli.skeleton import Floats

Palette = Literal["varied", "equal_luminance"]
Lab = tuple[float, float, float]

LOOKS = 120
"""Per sex; 240 in all, as in Niay (2022, section 6.1)."""

CANDIDATES = 6000
BUILDS = tuple(GIRTHS)

TOPS: tuple[Lab, ...] = (
    (92.0, 0.0, 2.0), (14.0, 0.0, 0.0), (60.0, 0.0, -2.0), (25.0, 8.0, -28.0), (70.0, -8.0, -25.0), (42.0, 56.0, 34.0),
    (28.0, 32.0, 12.0), (65.0, 38.0, 52.0), (72.0, 8.0, 56.0), (35.0, -22.0, 15.0), (80.0, -22.0, 6.0),
    (38.0, 28.0, -30.0), (75.0, 25.0, 2.0), (80.0, 3.0, 16.0), (38.0, 14.0, 22.0), (46.0, -22.0, -12.0),
)  # fmt: skip
BOTTOMS: tuple[Lab, ...] = (
    (33.0, -1.0, -18.0), (19.0, 2.0, -14.0), (13.0, 0.0, 0.0), (62.0, 4.0, 20.0), (46.0, 0.0, -2.0),
    (30.0, 8.0, 14.0), (38.0, -5.0, 20.0), (84.0, 0.0, 5.0), (55.0, -4.0, -20.0), (27.0, 24.0, 8.0),
)  # fmt: skip
HAIRS: tuple[Lab, ...] = (
    (9.0, 1.0, 1.0), (17.0, 6.0, 8.0), (29.0, 10.0, 16.0), (32.0, 24.0, 24.0), (45.0, 9.0, 22.0), (68.0, 5.0, 32.0),
    (66.0, 0.0, 1.0),
)  # fmt: skip
SKINS: tuple[Lab, ...] = (
    (80.0, 9.0, 15.0), (72.0, 12.0, 19.0), (62.0, 15.0, 22.0), (52.0, 16.0, 24.0), (40.0, 14.0, 19.0),
    (29.0, 11.0, 13.0),
)  # fmt: skip
SHOES: tuple[Lab, ...] = (
    (13.0, 0.0, 0.0), (30.0, 12.0, 18.0), (82.0, 0.0, 3.0), (48.0, 0.0, -3.0), (38.0, 45.0, 28.0)
)  # fmt: skip

SEEN = {"shirt": 0.36, "trousers": 0.34, "skin": 0.13, "hair": 0.12, "shoes": 0.05}
"""Weight of each squared difference, by the share of a walker's silhouette."""

HAIRCUT_STEP, BUILD_STEP = 4.2, 3.5
"""What another haircut, and a step of build, count for beside differences of colour."""

EQUAL = {"shirt": (58.0, 26.0, 12), "trousers": (40.0, 18.0, 10), "shoes": (34.0, 14.0, 6)}
"""With equal luminance: L*, largest chroma that every hue has in sRGB, and number of hues, beside grey."""


@dataclass(frozen=True)
class Look:
    """What a walker looks like.

    body, hair: as load_body takes them; build: one of BUILDS; colours: surface name -> CIELAB
    """

    body: str
    hair: str
    build: str
    colours: tuple[tuple[str, Lab], ...]


@cache
def looks(sex: Sex, palette: Palette) -> tuple[Look, ...]:
    """The LOOKS of a sex; always the same, the first ones farthest apart."""
    choices = _choices(palette)
    body = BODIES[sex]
    haircuts = hair_names(body)
    rng = np.random.default_rng([240, 0 if sex == "F" else 1])
    picks = {name: rng.integers(len(colours), size=CANDIDATES) for name, colours in choices.items()}
    haircut, build = rng.integers(len(haircuts), size=CANDIDATES), rng.integers(len(BUILDS), size=CANDIDATES)
    columns = [np.sqrt(SEEN[name]) * np.array(choices[name])[picks[name]] for name in choices]
    bodies = np.column_stack([HAIRCUT_STEP * haircut, BUILD_STEP * build])
    chosen = farthest(np.concatenate([*columns, bodies], axis=1), LOOKS)
    return tuple(
        Look(
            body,
            haircuts[haircut[i]],
            BUILDS[build[i]],
            tuple((name, choices[name][picks[name][i]]) for name in choices),
        )
        for i in chosen
    )


def farthest(points: Floats, count: int) -> list[int]:
    """Indices of `count` points (N, D), each the farthest from those before; the first is the one nearest the mean."""
    chosen = [int(np.argmin(np.sum((points - points.mean(axis=0)) ** 2, axis=1)))]
    distance = np.full(len(points), np.inf)
    while len(chosen) < count:
        distance = np.minimum(distance, np.sum((points - points[chosen[-1]]) ** 2, axis=1))
        chosen.append(int(np.argmax(distance)))
    return chosen


def difference(first: Look, second: Look) -> float:
    """How far apart two looks of a sex are, in CIELAB units of what is seen."""
    worn, other = dict(first.colours), dict(second.colours)
    squares = sum(SEEN[name] * float(np.sum(np.subtract(worn[name], other[name]) ** 2)) for name in worn)
    if first.hair != second.hair:
        squares += HAIRCUT_STEP**2
    return float(np.sqrt(squares + (BUILD_STEP * (BUILDS.index(first.build) - BUILDS.index(second.build))) ** 2))


def _choices(palette: Palette) -> dict[str, tuple[Lab, ...]]:
    """Surface name -> colours it can have."""
    if palette == "varied":
        return {"shirt": TOPS, "trousers": BOTTOMS, "skin": SKINS, "hair": HAIRS, "shoes": SHOES}
    choices: dict[str, tuple[Lab, ...]] = {}
    for name, (lightness, chroma, hues) in EQUAL.items():
        angles = 2.0 * np.pi * np.arange(hues) / hues
        round_the_wheel = [(lightness, float(chroma * np.cos(h)), float(chroma * np.sin(h))) for h in angles]
        choices[name] = ((lightness, 0.0, 0.0), *round_the_wheel)
    return choices


def linear_rgb(lab: Floats) -> Floats:
    """(..., 3) CIELAB (D65) -> linear sRGB; outside 0 .. 1 where sRGB has no such colour."""
    lab = np.asarray(lab, dtype=float)
    fy = (lab[..., 0] + 16.0) / 116.0
    f = np.stack([fy + lab[..., 1] / 500.0, fy, fy - lab[..., 2] / 200.0], axis=-1)
    xyz = np.where(f > 6.0 / 29.0, f**3, 3.0 * (6.0 / 29.0) ** 2 * (f - 4.0 / 29.0)) * WHITE
    return np.asarray(xyz @ XYZ_TO_RGB.T)


WHITE = np.array([0.95047, 1.0, 1.08883])
XYZ_TO_RGB = np.array(
    [[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]]
)
"""IEC 61966-2-1 primaries, D65."""

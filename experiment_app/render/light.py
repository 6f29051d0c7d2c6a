"""Sun and sky: where the light comes from, how strong it is, and the box the shadow map covers. Pure arithmetic."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from experiment_app.render.cameras import as_uniform, look, orthographic
from experiment_app.render.drawn import DrawnWalker
from experiment_app.scene import Ground
from stimuli.skeleton import Floats

SUN_ELEVATION = math.radians(48.0)
SUN_FROM_VIEW = math.radians(42.0)
"""The sun stands to the right of and behind the viewer, whatever the view: walkers go to the right on the
screen, so their faces are lit, and the shadow falls to the left behind them and never hides the feet."""

CONSTANTS = {
    "SUN_WIDTH": "0.045",  # penumbra radius (m) per metre between caster and receiver; the real sun's is 0.0047
    "SEARCH_RADIUS": "0.045",  # m, also the widest penumbra
    "SHARPEST": "0.005",  # m, the narrowest penumbra; about two texels of the shadow map
    "SHADOW_OFFSET": "0.006",  # m along the normal, against a surface shadowing itself
    "BLOCKER_TAPS": "16",
    "SHADOW_TAPS": "40",
}
"""What the shaders' shadow code is compiled with."""

ON_WALKERS = {**CONSTANTS, "BLOCKER_TAPS": "8", "SHADOW_TAPS": "14"}
"""Fewer taps: shadows on clothes and skin are small and among folds, and triangles there are many."""

ON_CROWDS = {**CONSTANTS, "SHADOW_OFFSET": "0.03", "SHARPEST": "0.03", "BLOCKER_TAPS": "0", "SHADOW_TAPS": "4"} | {
    "HAZE_REACH": "160.0"  # m; clearer air, so that the colours of all of a crowd are seen
}
"""One soft edge for all: the map covers a whole street, so its texels are some centimetres."""


@dataclass(frozen=True)
class Lights:
    """Linear light (red, green, blue) on a surface that faces the sun, the sky or the ground; 1: display white."""

    sun: tuple[float, float, float]
    sky: tuple[float, float, float]
    bounce: tuple[float, float, float]


LIGHTS: dict[Ground, Lights] = {
    "open_ground": Lights(sun=(1.12, 1.05, 0.95), sky=(0.42, 0.46, 0.52), bounce=(0.25, 0.235, 0.21)),
    "street": Lights(sun=(1.12, 1.05, 0.95), sky=(0.42, 0.46, 0.52), bounce=(0.25, 0.235, 0.21)),
    "plain": Lights(sun=(0.92, 0.90, 0.86), sky=(0.58, 0.59, 0.60), bounce=(0.30, 0.295, 0.29)),
    "treadmill": Lights(sun=(0.92, 0.90, 0.86), sky=(0.58, 0.59, 0.60), bounce=(0.30, 0.295, 0.29)),
}

REACH = 0.66
"""Radius of the ball round a walker's middle that holds the walker in any pose of walking, per stature."""

MARGIN = 0.06  # m of shadow map round the casters, room for the soft edge


@dataclass(frozen=True, eq=False)
class Sunlight:
    """The sun of one frame.

    lights:        how strong sun, sky and ground are.
    to_sun:        (3,) unit length.
    world_to_clip: (4, 4) world to the clip space of the shadow map.
    world_to_map:  (4, 4) world to the shadow map's x, y and depth, each in [0, 1].
    extent:        (3,) m covered: width, height, depth.
    """

    lights: Lights
    to_sun: Floats
    world_to_clip: Floats
    world_to_map: Floats
    extent: Floats

    @cached_property
    def map_bytes(self) -> bytes:
        """`world_to_map` as the shaders take it, made once for all programs of a frame."""
        return as_uniform(self.world_to_map)


CLIP_TO_MAP = np.array([[0.5, 0, 0, 0.5], [0, 0.5, 0, 0.5], [0, 0, 0.5, 0.5], [0, 0, 0, 1.0]])


def direction_to_sun(view_azimuth: float) -> Floats:
    """(3,) unit vector; view_azimuth: radians, from the walker to the eye."""
    azimuth = view_azimuth + SUN_FROM_VIEW
    flat = math.cos(SUN_ELEVATION)
    return np.array([flat * math.sin(azimuth), math.sin(SUN_ELEVATION), flat * math.cos(azimuth)])


def fit_sunlight(ground: Ground, view_azimuth: float, walkers: Sequence[DrawnWalker], corners: Floats) -> Sunlight:
    """The sun, with the smallest upright box in its light that holds every walker and every corner point.

    corners: (N, 3) m, other things that cast shadows; N may be 0 when there is a walker.
    """
    to_sun = direction_to_sun(view_azimuth)
    turn = look(np.zeros(3), -to_sun)
    if len(walkers) == 1:
        x, y, z = walkers[0].place
        stature = walkers[0].body.stature
        middle = turn[:3, :3] @ (x, y + 0.5 * stature, z)
        low, high = middle - REACH * stature, middle + REACH * stature
    elif not walkers:
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
    else:
        middles = np.array([(w.place[0], w.place[1] + 0.5 * w.body.stature, w.place[2]) for w in walkers])
        reach = REACH * np.array([[walker.body.stature] for walker in walkers])
        seen = middles @ turn[:3, :3].T
        low, high = (seen - reach).min(axis=0), (seen + reach).max(axis=0)
    if len(corners):
        more = corners @ turn[:3, :3].T
        low, high = np.minimum(low, more.min(axis=0)), np.maximum(high, more.max(axis=0))
    low, high = low - MARGIN, high + MARGIN
    turn[:3, 3] = -0.5 * (low + high)
    world_to_clip = orthographic(0.5 * (high - low)) @ turn
    return Sunlight(LIGHTS[ground], to_sun, world_to_clip, CLIP_TO_MAP @ world_to_clip, high - low)

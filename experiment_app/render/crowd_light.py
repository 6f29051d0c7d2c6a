"""The sun over a crowd: which part of the street its shadow map covers. Pure arithmetic: no GL, no state.

What is covered follows from the camera and not from who walks where, and the map's texels have places in the world: so
the edges of shadows do not swim while a crowd walks.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from experiment_app.render.cameras import Viewpoint, orthographic
from experiment_app.render.crowd_levels import distances, within_picture
from experiment_app.render.light import CLIP_TO_MAP, LIGHTS, Sunlight, direction_to_sun
from experiment_app.scene import STREET_HALF_WIDTH, Ground
from stimuli.skeleton import Floats

TEXEL = 0.03  # m
BLOCK = 64  # texels that the map's sides are whole multiples of, as are the tiles of software drivers

SHADED = 75.0  # m from the eye, beyond which the haze leaves little of a shadow
TALLEST = 2.1  # m
AROUND = 0.7  # m from the middle of a person to the farthest limb
STRETCH = 1.0  # m of the street that is covered or left out as a whole


def may_shade(viewpoint: Viewpoint, places: Floats, statures: Floats) -> NDArray[np.bool_]:
    """(N,) whether people of statures (N,) m at places (N, 3) m can cast a shadow that is seen."""
    return _within_picture(viewpoint, places, statures) & (distances(viewpoint, places) < SHADED)


@lru_cache(maxsize=8)
def crowd_sunlight(ground: Ground, viewpoint: Viewpoint) -> Sunlight:
    """The sun, with a box in its light that holds everybody between the kerbs who can cast a shadow that is seen.

    The box lies along the street, which takes a fifth of the texels of an upright one; its corners are on whole blocks.
    A camera that stands still has one viewpoint for all its frames, so its light is found once.
    """
    to_sun = direction_to_sun(viewpoint.azimuth)
    turn = along_street(to_sun)
    soles = _corners(viewpoint) @ turn[:3, :3].T
    crowns = soles + TALLEST * turn[:3, 1]
    low = np.minimum(soles, crowns).min(axis=0) - AROUND
    high = np.maximum(soles, crowns).max(axis=0) + AROUND
    step = np.array([BLOCK * TEXEL, BLOCK * TEXEL, 1.0])
    low, high = np.floor(low / step) * step, np.ceil(high / step) * step
    turn[:3, 3] = -0.5 * (low + high)
    world_to_clip = orthographic(0.5 * (high - low)) @ turn
    return Sunlight(LIGHTS[ground], to_sun, world_to_clip, CLIP_TO_MAP @ world_to_clip, high - low)


def map_size(sunlight: Sunlight) -> tuple[int, int]:
    """Texels across and up of the shadow map for a crowd's sunlight."""
    width, height = np.rint(sunlight.extent[:2] / TEXEL).astype(int).tolist()
    return width, height


def along_street(to_sun: Floats) -> Floats:
    """(4, 4) world to the light's axes: X as the street (+Z) is seen from the sun, Z towards the sun; not along +Z."""
    across = np.array([0.0, 0.0, 1.0]) - to_sun[2] * to_sun
    across /= np.linalg.norm(across)
    turn = np.eye(4)
    turn[:3, :3] = (across, np.cross(to_sun, across), to_sun)
    return turn


def _corners(viewpoint: Viewpoint) -> Floats:
    """(N, 3) m, on the ground round every stretch of the street from which a shadow can be seen; else under the eye."""
    nearest = math.floor(viewpoint.eye[2] / STRETCH) * STRETCH
    along = nearest + np.arange(-SHADED - STRETCH, SHADED + 2.0 * STRETCH, STRETCH)
    across = np.linspace(-STREET_HALF_WIDTH, STREET_HALF_WIDTH, math.ceil(2.0 * STREET_HALF_WIDTH / STRETCH) + 1)
    x, z = np.meshgrid(across, along)
    places = np.stack([x, np.zeros_like(x), z], axis=-1).reshape(-1, 3)
    seen = _within_picture(viewpoint, places, np.full(len(places), TALLEST + 1.5 * STRETCH))
    seen &= distances(viewpoint, places) < SHADED + STRETCH
    stretches = along[seen.reshape(x.shape).any(axis=1)]
    ends = np.concatenate([stretches - 0.5 * STRETCH, stretches + 0.5 * STRETCH])
    if not len(ends):
        return viewpoint.eye[None] * (1.0, 0.0, 1.0)
    return np.array([(x, 0.0, z) for x in (-STREET_HALF_WIDTH, STREET_HALF_WIDTH) for z in (ends.min(), ends.max())])


def _within_picture(viewpoint: Viewpoint, places: Floats, statures: Floats) -> NDArray[np.bool_]:
    """(N,) whether anything of a person or of the shadow on the ground can be in the picture.

    Soles, crown and the shadow's tip lie 0.67 statures from the middle of the last two; limbs reach a little farther.
    """
    to_sun = direction_to_sun(viewpoint.azimuth)
    tip = -to_sun / to_sun[1] * (1.0, 0.0, 1.0)  # m from the soles, per m of stature
    return within_picture(viewpoint, places + 0.5 * statures[:, None] * tip, statures)

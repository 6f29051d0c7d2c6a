"""A scene's crowd to bodies, looks and joint matrices: everybody posed at once for the renderer."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from experiment_app.render.drawn import PLACE, ROW_TEXELS, CrowdLook, DrawnCrowd
from experiment_app.scene import STREET_HALF_WIDTH, Crowd, Palette
from stimuli.blend_tree import Leaf
from stimuli.crowds.bodies import crowd_body
from stimuli.crowds.looks import Look, linear_rgb, looks
from stimuli.crowds.motions import SEXES, figure_of, motion_of
from stimuli.crowds.plan import CrowdPlan, plan_crowd
from stimuli.crowds.posing import poser
from stimuli.crowds.table import Mix, WalkTable, mixed
from stimuli.skeleton import Floats

STRETCH = 110.0  # m that a crowd walks along before it comes in again, where that is long enough for so many
END = 26.0  # z (m) of the stretch's end: walkers go from there back to its beginning
FADING = (4.0, 1.0)  # m at the beginning and the end within which walkers come and go


@dataclass(frozen=True, eq=False)
class CrowdCast:
    """Who is in a crowd, ready to be posed at any time."""

    plan: CrowdPlan
    mix: Mix
    look: CrowdLook


def drawn_crowd(crowd: Crowd) -> DrawnCrowd:
    """Everybody of the crowd, posed and in place at its time."""
    cast = crowd_cast(replace(crowd, seconds=0.0))
    plan = cast.plan
    along = plan.places(crowd.seconds)
    places = along + np.array([0.0, END - plan.length])
    rows = np.zeros((crowd.size, ROW_TEXELS, 4), np.float32)
    transforms = rows[:, :PLACE].reshape(crowd.size, -1, 2, 4)
    poser()(cast.mix, plan.phases(crowd.seconds), transforms, plan.sizes, places)
    rows[:, PLACE, 0], rows[:, PLACE, 2] = places.T
    rows[:, PLACE, 3] = np.arange(crowd.size)
    ends = np.minimum(along[:, 1] / FADING[0], (plan.length - along[:, 1]) / FADING[1])
    return DrawnCrowd(cast.look, rows, np.minimum(ends, 1.0))


def measured_crowd(crowd: Crowd) -> dict[str, float]:
    """How many walkers and motions; mean and SD of speed (m/s), step frequency (steps/min) and step length (m).

    nearest_m: least distance of two people's middles at this time.
    """
    from scipy.spatial import cKDTree

    plan = crowd_cast(replace(crowd, seconds=0.0)).plan
    step_length = 60.0 * plan.speed / plan.step_frequency
    measures = {"speed": plan.speed, "step_frequency": plan.step_frequency, "step_length": step_length}
    found = {"walkers": float(crowd.size), "motions": float(len(plan.motions))}
    for name, values in measures.items():
        found |= {f"{name}_mean": float(values.mean()), f"{name}_sd": float(values.std())}
    places = plan.places(crowd.seconds)
    return found | {"nearest_m": float(cKDTree(places).query(places, k=2)[0][:, 1].min())}


@lru_cache(maxsize=4)
def crowd_cast(crowd: Crowd) -> CrowdCast:
    """Who is in a crowd, at its beginning. Raises CrowdError for a crowd that there cannot be."""
    plan = plan_of(crowd)
    return CrowdCast(plan, _mix(plan), _look(plan, crowd.palette))


def plan_of(crowd: Crowd) -> CrowdPlan:
    """Who walks where; makes the walks that were not made before, some milliseconds each."""
    return plan_crowd(crowd.size, crowd.variation, crowd.seed, crowd.pool, 2.0 * STREET_HALF_WIDTH, STRETCH)


def _mix(plan: CrowdPlan) -> Mix:
    """Who walks which motion; sizes come later, so speeds are those on unscaled bodies."""
    motions = [motion_of(style) for style in plan.motions]
    table = WalkTable.of([(figure_of(motion.style.sex), motion.table, Leaf(0)) for motion in motions])
    return mixed(table, plan.motion, plan.speed / plan.sizes, plan.step_frequency)


def _look(plan: CrowdPlan, palette: Palette) -> CrowdLook:
    """Looks dealt to the walkers of each sex in the plan's random order."""
    everyone = [look for sex in SEXES for look in looks(sex, palette)]
    look = np.empty(len(plan.motion), np.intp)
    first = 0
    for sex, own in zip(SEXES, (plan.women, ~plan.women), strict=True):
        in_order = plan.order[own[plan.order]]
        count = len(looks(sex, palette))
        look[in_order] = first + np.arange(len(in_order)) % count
        first += count
    kinds = sorted({(each.body, each.hair, each.build) for each in everyone})
    bodies = tuple(crowd_body(*kind) for kind in kinds)
    body = np.array([kinds.index((each.body, each.hair, each.build)) for each in everyone])[look]
    materials = tuple(surface.name for surface in bodies[0].levels[0])
    colours = np.array([_colours(each, materials) for each in everyone], np.float32)
    statures = np.array([each.stature for each in bodies])[body] * plan.sizes
    return CrowdLook(bodies, materials, body, colours, look, statures)


def _colours(look: Look, materials: tuple[str, ...]) -> Floats:
    """(materials, 4) linear rgb and roughness of everything that is worn."""
    worn = dict(look.colours)
    if "skin" in worn:
        light, red, yellow = worn["skin"]
        worn["lip"] = (light - 12.0, red + 14.0, yellow - 2.0)
    if "hair" in worn:
        worn["brow"] = worn["lash"] = (0.7 * worn["hair"][0], *worn["hair"][1:])
    rows = np.zeros((len(materials), 4))
    for surface in crowd_body(look.body, look.hair, look.build).levels[0]:
        colour = linear_rgb(np.array(worn[surface.name])) if surface.name in worn else surface.colour
        rows[materials.index(surface.name)] = (*np.clip(colour, 0.0, 1.0), surface.roughness)
    return rows

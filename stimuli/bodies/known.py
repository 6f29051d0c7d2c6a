"""The bodies that come with gaitlab or were imported on this computer; and a body scaled to a person's height."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from importlib.resources import files
from pathlib import Path

import numpy as np

from stimuli.bodies.body import Body, Surface
from stimuli.bodies.builds import GIRTHS, girths_of
from stimuli.bodies.imported_bodies import MATCHED, MISMATCHED, OWN_BUILD, imported_names, path_of
from stimuli.bodies.point_light import FIGURES
from stimuli.bodies.skinning import skin
from stimuli.body_files.baked import haircuts, read_baked
from stimuli.body_files.errors import BodyError
from stimuli.body_files.imported import import_body
from stimuli.skeleton import JOINTS, PARENTS, Floats, Skeleton

__all__ = [
    "BodyError",
    "body_for",
    "body_names",
    "comes_with_gaitlab",
    "hair_names",
    "haircut_names",
    "in_the_build_of",
    "load_body",
    "scaled",
    "shipped_names",
    "variant_names",
    "with_girths",
]

_NAMES = ("woman", "man")
SLIMMEST, STOUTEST = 0.6, 1.8
_THICKENED = tuple(j for j in JOINTS if j != "head" and not j.endswith(("Foot", "Toes")))
TALLEST, SHORTEST = 2.72, 0.5  # m; the tallest person on record measured 2.72 m


def shipped_names() -> tuple[str, ...]:
    """The bodies that come with gaitlab."""
    return _NAMES


def haircut_names() -> dict[str, tuple[str, str]]:
    """Name of a shipped body with another haircut than its usual one, as woman_ponytail -> body and haircut."""
    return {f"{name}_{cut}": (name, cut) for name in _NAMES for cut in hair_names(name)[1:]}


def variant_names() -> dict[str, tuple[str, str]]:
    """Name of a shipped body of another build, as woman_ponytail_stout -> the body's name without it and the build."""
    builds = [build for build, girths in GIRTHS.items() if girths]
    return {f"{name}_{build}": (name, build) for name in (*_NAMES, *haircut_names()) for build in builds}


def body_names() -> tuple[str, ...]:
    """What a study can name as body: shipped and imported ones, those by the actor's sex, figures without a body."""
    return (*_shipped_with_variants(), *imported_names(), MATCHED, MISMATCHED, OWN_BUILD, *FIGURES)


def comes_with_gaitlab(name: str) -> bool:
    """Whether a body is a shipped one, in any haircut and build."""
    return name in _shipped_with_variants()


def _shipped_with_variants() -> tuple[str, ...]:
    return (*_NAMES, *haircut_names(), *variant_names())


def body_for(sex: str, name: str) -> str:
    """The body that a name stands for on an actor of a sex ("F" or "M"): those that depend on the actor, or itself."""
    if name not in (MATCHED, MISMATCHED, OWN_BUILD):
        return name
    return "woman" if (sex == "F") == (name != MISMATCHED) else "man"


def load_body(name: str, hair: str | None = None) -> Body:
    """A shipped or imported body; `hair` is one of `hair_names(name)`, None its usual one."""
    if name not in _NAMES and name in imported_names():
        path = path_of(name)
        return _imported(name, path, path.stat().st_mtime_ns)
    if name in variant_names():
        return _of_build(*variant_names()[name])
    return _shipped(*haircut_names().get(name, (name, hair)))


@cache
def _of_build(name: str, build: str) -> Body:
    return with_girths(load_body(name), GIRTHS[build])


def in_the_build_of(body: Body, sex: str, weight: float, height: float) -> Body:
    """A shipped body as stout or slim as a person of that sex ("F" or "M"), weight (kg) and height (m) is.

    Stouter or slimmer than bodies can be made, it is as stout or slim as they can.
    """
    girths = {j: min(max(g, SLIMMEST), STOUTEST) for j, g in girths_of(sex, weight, height).items()}
    return with_girths(body, girths)


@cache
def _shipped(name: str, hair: str | None) -> Body:
    return read_baked(_file(name), f"body {name!r}", hair)


@cache
def _imported(name: str, path: Path, _changed: int) -> Body:
    return replace(import_body(path), name=name)


@cache
def hair_names(name: str) -> tuple[str, ...]:
    """Haircuts of a body, the usual one first."""
    return haircuts(_file(name), f"body {name!r}")


def scaled(body: Body, stature: float) -> Body:
    """The body of a person `stature` metres tall: everything in proportion, skeleton and skin alike."""
    if not SHORTEST <= stature <= TALLEST:
        raise BodyError(f"a stature of {stature} m is outside {SHORTEST} to {TALLEST} m; is it in metres?")
    factor = stature / body.stature

    def grown(surface: Surface) -> Surface:
        knot = None if surface.knot is None else surface.knot * factor
        return replace(surface, positions=surface.positions * factor, knot=knot)

    return Body(
        body.name,
        Skeleton(body.skeleton.offsets * factor),
        stature,
        tuple(tuple(grown(s) for s in level) for level in body.levels),
    )


def with_girths(body: Body, girths: Mapping[str, float]) -> Body:
    """The body stouter or slimmer, joint by joint: 1.1 makes what a joint carries 10 % wider across its bone.

    girths: factor per joint name, 1 where it is left out. Bones keep their places and lengths; feet and toes can't be
    changed, or the soles would leave the floor.
    """
    unknown = sorted(set(girths) - set(_THICKENED))
    if unknown:
        raise BodyError(f"there is no girth for {', '.join(unknown)}; known joints are {', '.join(_THICKENED)}")
    wrong = {joint: girth for joint, girth in girths.items() if not SLIMMEST <= girth <= STOUTEST}
    if wrong:
        raise BodyError(f"girths must lie between {SLIMMEST} and {STOUTEST} (1 = as it is), not {wrong}")
    places = body.skeleton.positions
    matrices = np.tile(np.eye(3, 4), (len(JOINTS), 1, 1))
    for joint, girth in girths.items():
        index = JOINTS.index(joint)
        bone = _bone(index, places)
        matrices[index, :, :3] = girth * np.eye(3) + (1 - girth) * np.outer(bone, bone)
        matrices[index, :, 3] = places[index] - matrices[index, :, :3] @ places[index]

    def widened(surface: Surface) -> Surface:
        return replace(surface, positions=skin(surface, matrices)[0])

    return replace(body, levels=tuple(tuple(widened(s) for s in level) for level in body.levels))


def _bone(joint: int, places: Floats) -> Floats:
    """(3,) unit direction of a joint's bone: to the next joint of its chain, or on from the joint above for a hand."""
    if JOINTS[joint] in ("hips", "spine", "chest", "neck", "head"):
        return np.array([0.0, 1.0, 0.0])
    child = next((i for i, parent in enumerate(PARENTS) if parent == joint), None)
    ahead = places[joint] - places[PARENTS[joint]] if child is None else places[child] - places[joint]
    unit: Floats = ahead / np.linalg.norm(ahead)
    return unit


def _file(name: str) -> bytes:
    if name not in _NAMES:
        if name in FIGURES:
            raise BodyError(f"{name} is drawn without a body")
        known = (*_shipped_with_variants(), *imported_names())
        raise BodyError(f"there is no body {name!r}; known bodies are {', '.join(known)}")
    return files("stimuli").joinpath("data", "bodies", f"{name}.glb").read_bytes()

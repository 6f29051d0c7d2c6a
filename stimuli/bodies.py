"""The bodies that come with gaitlab, ready to be skinned; and a body scaled to a person's height."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from importlib.resources import files

from stimuli.body import Body, Surface
from stimuli.body_files.baked import haircuts, read_baked
from stimuli.body_files.errors import BodyError
from stimuli.skeleton import Skeleton

__all__ = ["BodyError", "body_names", "hair_names", "load_body", "scaled"]

_NAMES = ("woman", "man")
TALLEST, SHORTEST = 2.72, 0.5  # m; the tallest person on record measured 2.72 m


def body_names() -> tuple[str, ...]:
    """Names that `load_body` knows."""
    return _NAMES


@cache
def load_body(name: str, hair: str | None = None) -> Body:
    """A body that comes with gaitlab; `hair` is one of `hair_names(name)`, None its usual one."""
    return read_baked(_file(name), f"body {name!r}", hair)


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
        return replace(surface, positions=surface.positions * factor)

    return Body(
        body.name,
        Skeleton(body.skeleton.offsets * factor),
        stature,
        tuple(tuple(grown(s) for s in level) for level in body.levels),
    )


def _file(name: str) -> bytes:
    if name not in _NAMES:
        raise BodyError(f"there is no body {name!r}; known bodies are {', '.join(_NAMES)}")
    return files("stimuli").joinpath("data", "bodies", f"{name}.glb").read_bytes()

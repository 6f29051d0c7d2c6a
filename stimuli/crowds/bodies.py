"""The bodies of crowds: haircuts and builds of the woman and the man, with levels of detail for the far distance.

The coarse levels were made from the bodies by body_generator/crowd_levels.py and ship beside them. Knows no GPU.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stimuli.bodies.body import Body, Surface
from stimuli.bodies.builds import GIRTHS
from stimuli.bodies.known import load_body, with_girths

LEVELS = 3  # coarse ones, after the body's own
KEPT = {
    "positions": "f4", "normals": "f4", "occlusion": "f4", "joints": "u1", "weights": "f4", "triangles": "u2",
}  # fmt: skip
"""What of a coarse surface is stored, and in which type; colour and roughness are the body's."""


@cache
def crowd_body(name: str, hair: str, build: str) -> Body:
    """A shipped body with that haircut and build, and coarser levels of detail after its own."""
    body = load_body(name, hair)
    finer = {surface.name: surface for surface in body.levels[-1]}
    coarse = tuple(_coarse(name, hair, level, finer) for level in range(LEVELS))
    return with_girths(replace(body, levels=(*body.levels, *coarse)), GIRTHS[build])


def _coarse(name: str, hair: str, level: int, finer: dict[str, Surface]) -> tuple[Surface, ...]:
    stored = _stored()
    first = f"{name}/{hair}/{level}/"
    names = [surface for surface in finer if f"{first}{surface}/positions" in stored]
    return tuple(
        replace(finer[surface], blush=None, **{array: _as_used(stored[f"{first}{surface}/{array}"]) for array in KEPT})
        for surface in names
    )


def _as_used(values: NDArray[np.generic]) -> Any:
    """In the types that bodies have."""
    return values.astype(np.float64 if values.dtype.kind == "f" else np.int64)


@cache
def _stored() -> dict[str, NDArray[np.generic]]:
    with (files("stimuli") / "data" / "bodies" / "crowd.npz").open("rb") as stream, np.load(stream) as stored:
        return dict(stored)

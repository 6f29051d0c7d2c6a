"""How a walk is to be made, as a value that a scene, a study or a journal can hold; `made.made_walk` makes it.

Imports nothing heavy, so that a scene stays a plain value.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

from stimuli.methods.errors import MethodError

MethodName = Literal["captured", "blend", "timewarp", "fourier", "pca", "poulaine"]
Interpolation = Literal["cubic", "pchip", "hermite"]
Table = Literal["raw", "normalised", "refitted"]

EDITORS = {"height": ("poulaine", "pca"), "sex": ("poulaine",), "walk_ratio": ("poulaine",)}
"""Field of Making -> methods that can use it."""


@dataclass(frozen=True)
class Making:
    """What makes a walk at some speed out of an actor's captured walks.

    method:         "captured" is the actor as captured; the others are the modules of this folder and `poulaine`.
    source_speed:   m/s of the captured walk it is made from. By default timewarp and poulaine start from the nearest
                    other captured speed, blend and fourier from the two around it, pca from all others. At the speed
                    asked for, poulaine rebuilds that walk from its points and fourier from its numbers.
    step_frequency: steps/min of the captured walks; by default the actor's own at their speed.
    points:         4 or 5 points of the poulaine; interpolation: between them.
    table:          regression by which the points move when the poulaine is edited.
    harmonics:      of the Fourier walk; 2 in the source.
    height, sex:    m and "F" or "M" of the person that the walk is edited towards (poulaine; pca knows height).
    walk_ratio:     m·min that the walk is edited towards at its own speed (poulaine).
    style:          one of the named styles of styles.csv that the captured walks are in.
    share:          of the way from the actor's own walk (0) to the style (1) in the space of Fourier walks; beyond 1 it
                    exaggerates (fourier).

    Raises MethodError for a value that no method knows.
    """

    method: MethodName = "captured"
    source_speed: float | None = None
    step_frequency: float | None = None
    points: Literal[4, 5] = 5
    interpolation: Interpolation = "hermite"
    table: Table = "normalised"
    harmonics: int = 2
    height: float | None = None
    sex: Literal["F", "M"] | None = None
    walk_ratio: float | None = None
    style: str | None = None
    share: float = 1.0

    def __post_init__(self) -> None:
        _one_of("method", self.method, get_args(MethodName))
        _one_of("points", self.points, (4, 5))
        _one_of("interpolation", self.interpolation, get_args(Interpolation))
        _one_of("table", self.table, get_args(Table))
        _one_of("sex", self.sex, (None, "F", "M"))
        for field, methods in EDITORS.items():
            if getattr(self, field) is not None and self.method not in methods:
                raise MethodError(f"{field}: {self.method} cannot edit it; {' and '.join(methods)} can")
        if self.share != 1.0 and (self.method != "fourier" or self.style is None):
            raise MethodError("share: only a fourier walk in a style can be part of the way to it")


def _one_of(field: str, value: object, allowed: Sequence[object]) -> None:
    if value not in allowed:
        raise MethodError(f"{field}: there is no {value!r}; there are {', '.join(map(str, allowed))}")

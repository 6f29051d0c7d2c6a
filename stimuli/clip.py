"""A captured motion as every reader returns it: named joints, local motion, metres, Y up. Knows no file format.

Readers turn their data into these axes whole, offsets included, so nothing downstream asks what a file's up was.
The walker may head anywhere on the ground.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from stimuli.rotations import multiply, rotate

Floats = NDArray[np.floating]


@dataclass(frozen=True)
class Source:
    """What a reader understood of its file, to be shown to the person who gave it.

    The axes are those of the file, written as "+Y" or "-X"; forward is "" where nothing moves or points.
    names is the table of joint names that fitted ("CMU", "Mixamo", ... or "topology"); residual is m, the root mean
    square distance of markers from the skeleton fitted to them, nan where there are no markers; left_out are the frames
    of the file before the first and after the last one of the clip, in which markers of feet or pelvis are not seen.
    """

    format: str
    unit_to_m: float
    up: str
    forward: str
    names: str
    file_rate: float  # Hz as written in the file, before it was set to the whole rate meant; nan where none is
    residual: float = float("nan")
    left_out: tuple[int, int] = (0, 0)


@dataclass(frozen=True, order=True)
class FootEvent:
    """One foot touching or leaving the ground."""

    time: float  # s from the first frame
    side: str  # "left" or "right"
    kind: str  # "strike" (heel strike, initial contact) or "off" (toe-off)


@dataclass(frozen=True)
class Subject:
    """What a file says of the person captured; None where it says nothing. Names are never read."""

    sex: str | None = None  # "female" or "male"
    age: float | None = None  # years
    height: float | None = None  # m
    mass: float | None = None  # kg
    leg_length: float | None = None  # m, mean of both sides


@dataclass(frozen=True, eq=False)
class Clip:
    """One captured motion.

    joints:       J names as in the file, parents before children; a bone's end without a joint of its own is
                  named after its joint with " end"
    parents:      J indices into joints; -1 for a root
    offsets:      (J, 3) m, from the parent joint in the file's zero-rotation pose, our axes (Y up)
    translations: (T, J, 3) m, from the parent joint, in the parent's turned axes; equal to the offset where
                  the file moves nothing
    rotations:    (T, J, 4) local rotations x y z w relative to the zero-rotation pose, unit length
    rate:         Hz
    roles:        VRM humanoid joint name -> index into joints; only the roles that were found
    warnings:     sentences for the person who gave the file
    events:       foot events the file itself holds, in order of time; empty when it holds none
    subject:      the person, as far as the file tells
    """

    name: str
    joints: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Floats
    translations: Floats
    rotations: Floats
    rate: float
    roles: Mapping[str, int]
    source: Source
    warnings: tuple[str, ...] = ()
    events: tuple[FootEvent, ...] = ()
    subject: Subject = field(default_factory=Subject)

    def __post_init__(self) -> None:
        object.__setattr__(self, "roles", MappingProxyType(dict(self.roles)))

    @property
    def frame_count(self) -> int:
        """Number of frames T."""
        return len(self.rotations)

    @property
    def duration(self) -> float:
        """s, from the first frame to the last."""
        return (self.frame_count - 1) / self.rate

    @property
    def times(self) -> Floats:
        """(T,) s, 0 at the first frame."""
        return np.arange(self.frame_count) / self.rate


def world_positions(clip: Clip) -> Floats:
    """(T, J, 3) m: place of every joint in the world (Y up; the ground need not be at 0)."""
    return world_pose(clip)[1]


def world_pose(clip: Clip) -> tuple[Floats, Floats]:
    """World rotations (T, J, 4), relative to the zero-rotation pose, and world positions (T, J, 3) m."""
    rotations = np.empty_like(clip.rotations)
    positions = np.empty_like(clip.translations)
    for joint, parent in enumerate(clip.parents):
        if parent < 0:
            rotations[:, joint] = clip.rotations[:, joint]
            positions[:, joint] = clip.translations[:, joint]
        else:
            rotations[:, joint] = multiply(rotations[:, parent], clip.rotations[:, joint])
            offset = rotate(rotations[:, parent], clip.translations[:, joint])
            positions[:, joint] = positions[:, parent] + offset
    return rotations, positions


def cut(clip: Clip, first: int, end: int) -> Clip:
    """The frames first, first + 1, ... end - 1 of a clip, counted as in a Python slice."""
    chosen = slice(first, end)
    return replace(clip, translations=clip.translations[chosen], rotations=clip.rotations[chosen])

"""From places and rotations in the world, as inertial suits and scene files have them, to local motion.

Joint frames are chosen so that the rest pose has no rotations, whatever frames the file used.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stimuli.motion_files.building import Motion
from stimuli.rotations import continuous, inverse, multiply, rotate

Floats = NDArray[np.floating]


def motion_from_world(
    format: str,
    path: Path,
    joints: Sequence[str],
    parents: Sequence[int],
    rest: tuple[Floats, Floats],
    world: tuple[Floats, Floats],
    rate: float,
    file_rate: float,
) -> Motion:
    """Local motion of joints whose parents come before them.

    rest:  rotations (J, 4) and positions (J, 3) of the standing pose; world: (T, J, 4) and (T, J, 3) of every frame;
    rotations x y z w, positions in file units and axes, rate in Hz
    """
    rest_rotations, rest_places = rest
    turned = continuous(multiply(world[0], inverse(rest_rotations)))
    places = world[1]
    rotations, translations = np.array(turned), np.array(places)
    offsets = np.array(rest_places)
    for joint, parent in enumerate(parents):
        if parent >= 0:
            back = inverse(turned[:, parent])
            rotations[:, joint] = multiply(back, turned[:, joint])
            translations[:, joint] = rotate(back, places[:, joint] - places[:, parent])
            offsets[joint] = rest_places[joint] - rest_places[parent]
    return Motion(
        format=format,
        path=path,
        joints=tuple(joints),
        parents=tuple(parents),
        offsets=offsets,
        translations=translations,
        rotations=rotations,
        rate=rate,
        file_rate=file_rate,
    )


def parents_first(parents: Sequence[int]) -> list[int]:
    """An order of joints in which parents come before children; ValueError if a joint is above itself."""
    order: list[int] = []
    placed: set[int] = {-1}
    waiting = list(range(len(parents)))
    while waiting:
        ready = [joint for joint in waiting if parents[joint] in placed]
        if not ready:
            raise ValueError("joints are each other's parents")
        order += ready
        placed.update(ready)
        waiting = [joint for joint in waiting if joint not in placed]
    return order

"""What the renderer is given: each walker's body, joints' matrices at this instant and place; a crowd's as arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stimuli.bodies.body import Body
from stimuli.skeleton import JOINTS, Floats


@dataclass(frozen=True, eq=False)
class DrawnWalker:
    """One walker, ready to be skinned on the GPU.

    body:     the body to draw, already scaled to the actor's stature.
    matrices: (21, 3, 4) float32, from a vertex of the bind pose to the walker's frame
              (origin on the ground under the walker, +Z forward, +Y up, +X left).
    place:    (x, y, z) m, where that frame's origin is in the world.
              On open ground z includes the distance walked; y = 0 is the surface walked upon,
              which on the treadmill is the top of the belt.
    lines:    (N, 2, 3) m, ends of lines in the walker's frame that are drawn instead of the body; a line whose
              ends are the same place is a dot. None draws the body.
    """

    body: Body
    matrices: Floats
    place: tuple[float, float, float] = (0.0, 0.0, 0.0)
    lines: Floats | None = None


@dataclass(frozen=True, eq=False)
class CrowdLook:
    """What does not change about a crowd of N walkers.

    bodies:   B bodies with the same names of surfaces, each drawn for several walkers; body: (N,) which each has.
    colours:  (L, materials, 4) float32 looks: linear rgb and roughness of every material; look: (N,) of each walker.
    statures: (N,) m; a walker's matrices make its body that tall.
    """

    bodies: tuple[Body, ...]
    materials: tuple[str, ...]
    body: NDArray[np.intp]
    colours: Floats
    look: NDArray[np.intp]
    statures: Floats


PLACE = 2 * len(JOINTS)  # of a row, where the walker's place stands
ROW_TEXELS = PLACE + 1


@dataclass(frozen=True, eq=False)
class DrawnCrowd:
    """A crowd at one instant.

    rows:  (N, 43, 4) float32: of each of the 21 joints what brings a vertex of the bind pose to the world, a quaternion
           x y z w, as long as the square root of the walker's size, and a translation x y z (m), 0; then the
           walker's place (x, y, z m) and number.
    shown: (N,) 0 to 1, how much of each is there: less near the ends of the stretch the crowd walks.
    """

    cast: CrowdLook
    rows: NDArray[np.float32]
    shown: Floats


Drawn = DrawnWalker | DrawnCrowd

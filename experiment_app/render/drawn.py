"""What the renderer is given for each walker: a body, its joints' matrices at this instant, and a place."""

from __future__ import annotations

from dataclasses import dataclass

from stimuli.body import Body
from stimuli.skeleton import Floats


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

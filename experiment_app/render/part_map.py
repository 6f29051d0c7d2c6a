"""Which part of which walker is under any point of the picture: a second pass, without multisampling, read late.

The pass writes joint and walker into bytes; the bytes travel to the CPU while the next frame is drawn, so asking for
them does not stall the frame. A point belongs to the region whose joints carry it most; borders between regions are as
fine as the picture, those between joints of one region as the triangles.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import moderngl
import numpy as np
from numpy.typing import NDArray

from experiment_app.render.viewports import Area
from stimuli.skeleton import JOINTS

Region = Literal["legs", "arms", "torso", "head", "elsewhere"]
Side = Literal["left", "right", "middle", ""]


@dataclass(frozen=True)
class Part:
    """What is under a point.

    region: legs, arms (with hands), torso, head or elsewhere; side: the walker's own left or right, or middle.
    joint:  the finer part, a name of JOINTS, "" elsewhere; walker: number in its scene from 0, -1 elsewhere.
    beside: whether the point lies in the scene beside, the right half of the picture.
    """

    region: Region
    side: Side = ""
    joint: str = ""
    walker: int = -1
    beside: bool = False


ELSEWHERE = Part("elsewhere")


def part_of(joint: str, walker: int) -> Part:
    """The part that a joint's flesh is."""
    side: Side = "left" if joint.startswith("left") else "right" if joint.startswith("right") else "middle"
    region: Region = "torso"
    if joint.endswith(("Leg", "Foot", "Toes")):
        region = "legs"
    elif joint.endswith(("Arm", "Hand")):
        region = "arms"
    elif joint in ("head", "neck"):
        region = "head"
    return Part(region, side, joint, walker)


def _shader_constants() -> dict[str, str]:
    regions: tuple[Region, ...] = ("legs", "arms", "torso", "head")
    parts = [part_of(joint, 0) for joint in JOINTS]
    border = {"legs": "UpperLeg", "arms": "UpperArm", "torso": "chest", "head": "neck"}
    edges = {
        side: [JOINTS.index(name if name in JOINTS else f"{side}{name}") + 1 for name in (border[r] for r in regions)]
        for side in ("left", "right")
    }
    signs = {"left": 1, "right": -1}

    def array(values: list[int]) -> str:
        return f"int[{len(values)}]({', '.join(map(str, values))})"

    return {
        "JOINT_COUNT": str(len(JOINTS)),
        "REGIONS": array([regions.index(part.region) for part in parts]),
        "SIDES": array([signs.get(part.side, 0) for part in parts]),
        "LEFT_BORDER": f"uvec4({', '.join(map(str, edges['left']))})",
        "RIGHT_BORDER": f"uvec4({', '.join(map(str, edges['right']))})",
    }


SHADER_CONSTANTS = _shader_constants()
"""What part_map.vert and part_map.frag are compiled with: the region and side of every joint."""


@dataclass(frozen=True, eq=False)
class PartMap:
    """The parts of one frame.

    codes:  (height, width, 4) uint8, top row first: joint + 1, walker + 1 low, high, 255.
    beside: first column of the scene beside, None when one scene fills the picture.
    """

    codes: NDArray[np.uint8]
    beside: int | None = None

    def at(self, x: float, y: float) -> Part:
        """The part at a pixel (from the top left)."""
        column, row = int(x), int(y)
        if not (0 <= row < self.codes.shape[0] and 0 <= column < self.codes.shape[1]):
            return ELSEWHERE
        joint, low, high, _ = (int(value) for value in self.codes[row, column])
        part = part_of(JOINTS[joint - 1], low + 256 * high - 1) if joint else ELSEWHERE
        return replace(part, beside=self.beside is not None and column >= self.beside)


class PartMapTarget:
    """The framebuffer of the pass and two buffers that its bytes travel through in turn."""

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        self._context = context
        self._size = size
        self._codes = context.texture(size, 4)
        self._depth = context.depth_renderbuffer(size)
        self._frame = context.framebuffer([self._codes], self._depth)
        self._buffers = [context.buffer(reserve=4 * size[0] * size[1]) for _ in range(2)]
        self._beside: list[int | None] = [None, None]
        self._drawn = 0

    @property
    def size(self) -> tuple[int, int]:
        """(width, height) in pixels."""
        return self._size

    def begin(self) -> None:
        """Makes the map the framebuffer drawn into, and empties it."""
        self._frame.use()
        self._frame.viewport = (0, 0, *self._size)
        self._frame.clear()
        self._beside[self._drawn % 2] = None
        self._context.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)

    def look_at(self, area: Area) -> None:
        """What follows is drawn into an area of the map; one that does not begin at the left is the scene beside."""
        self._frame.viewport = area
        if area[0]:
            self._beside[self._drawn % 2] = area[0]

    def end(self) -> None:
        """Sends the bytes on their way."""
        whole = (0, 0, *self._size)
        self._frame.read_into(self._buffers[self._drawn % 2], viewport=whole, components=4, alignment=1)
        self._drawn += 1

    def take(self, frames_ago: int = 0) -> PartMap | None:
        """The map drawn last (it may be waited for), or 1 frame before (it has arrived); None when there is none."""
        if not 0 <= frames_ago <= 1 or self._drawn <= frames_ago:
            return None
        asked = (self._drawn - 1 - frames_ago) % 2
        width, height = self._size
        codes = np.frombuffer(self._buffers[asked].read(), np.uint8).reshape(height, width, 4)[::-1]
        return PartMap(codes, self._beside[asked])

    def release(self) -> None:
        """Frees the GPU's memory."""
        for part in (self._frame, self._codes, self._depth, *self._buffers):
            part.release()

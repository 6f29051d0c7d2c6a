"""From frames and gaze samples to what was looked at: each frame is looked up once its samples and its map have come.

The body-part map of a frame arrives one frame later, and an eye tracker's samples some milliseconds later; so a frame
waits here until both are there. Nothing in here waits for the GPU or the network.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Protocol

from experiment_app.gaze.samples import UNKNOWN, GazeSample, GazeTrack, LookedAt, Looking
from experiment_app.render.part_map import PartMap

DELAY = 0.1
"""s that a frame waits for samples that were taken while it was shown but have not come yet."""


class GazeSource(Protocol):
    """An eye tracker, or what stands in for one."""

    def poll(self) -> list[GazeSample]:
        """The samples since the last time, oldest first, on the run's clock."""


class GazeWatch:
    """Collects what is looked at during one trial after the other.

    source: where samples come from.
    """

    def __init__(self, source: GazeSource) -> None:
        self._source = source
        self._track = GazeTrack()
        self._waiting: deque[tuple[float, PartMap]] = deque()
        self._looking = Looking()

    def begin(self) -> None:
        """A new trial: frames of the one before are forgotten."""
        self._waiting.clear()
        self._looking = Looking()

    def shown(self, flip: float, parts: PartMap | None) -> None:
        """A frame was seen at `flip` (s) with this body-part map, None while it has not arrived."""
        if parts is not None:
            self._waiting.append((flip, parts))
        self._settle(flip - DELAY)

    def taken(self) -> Looking:
        """Everything looked at since `begin`; frames still waiting are looked up with the samples there are."""
        self._settle(float("inf"))
        return self._looking

    def _settle(self, until: float) -> None:
        self._track = self._track.after(self._source.poll())
        while self._waiting and self._waiting[0][0] <= until:
            self._looking = self._looking.after(looked_at(*self._waiting.popleft(), self._track.at))


def looked_at(flip: float, parts: PartMap, gaze_at: Callable[[float], GazeSample | None]) -> LookedAt:
    """What lay under the gaze in the frame seen at `flip` (s)."""
    gaze = gaze_at(flip)
    if gaze is None:
        return LookedAt(flip, None, None, UNKNOWN)
    height, width = parts.codes.shape[:2]
    part = parts.at(gaze.x * width, gaze.y * height)
    return LookedAt(flip, round(gaze.x, 5), round(gaze.y, 5), part.region, part.joint, part.walker)

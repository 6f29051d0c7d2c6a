"""Gaze samples and what was looked at in each frame of a trial, as plain values. Knows no eye tracker and no GPU."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from protocols.gaze import REGIONS

UNKNOWN = "unknown"
"""The region of a frame for which the eye tracker gave no gaze, as in a blink."""

REACH = 0.050
"""s: a frame takes the sample nearest to its flip, but none further away; a 30 Hz eye tracker reaches every frame."""

KEPT = 2.0
"""s of samples that are kept for frames still to come."""


@dataclass(frozen=True)
class GazeSample:
    """Where the eyes pointed.

    time: s on the run's clock. x, y: on the picture, from 0 at its top left to 1 at its bottom right.
    """

    time: float
    x: float
    y: float


@dataclass(frozen=True)
class GazeTrack:
    """The newest samples, oldest first."""

    samples: tuple[GazeSample, ...] = ()

    def after(self, new: Iterable[GazeSample]) -> GazeTrack:
        """The track with new samples; those KEPT seconds older than the newest are let go."""
        samples = sorted((*self.samples, *new), key=lambda sample: sample.time)
        oldest = samples[-1].time - KEPT if samples else 0.0
        return GazeTrack(tuple(sample for sample in samples if sample.time >= oldest))

    def at(self, time: float) -> GazeSample | None:
        """The sample nearest to a time (s), None when none lies within REACH."""
        times = [sample.time for sample in self.samples]
        place = bisect_left(times, time)
        near = self.samples[max(place - 1, 0) : place + 1]
        best = min(near, key=lambda sample: abs(sample.time - time), default=None)
        return best if best is not None and abs(best.time - time) <= REACH else None


@dataclass(frozen=True)
class LookedAt:
    """What one frame showed under the gaze.

    flip: s on the run's clock; x, y: the gaze on the picture, None without one.
    region: one of REGIONS or UNKNOWN; joint: the finer part (a VRM joint name, "" elsewhere); walker: from 0, else -1.
    """

    flip: float
    x: float | None
    y: float | None
    region: str
    joint: str = ""
    walker: int = -1


@dataclass(frozen=True)
class Looking:
    """The frames of one trial with what was looked at."""

    frames: tuple[LookedAt, ...] = field(default=())

    def after(self, frame: LookedAt) -> Looking:
        """With one more frame."""
        return replace(self, frames=(*self.frames, frame))

    def shares(self) -> dict[str, float]:
        """`gaze_legs`, ... in % of the frames with a gaze, and `gaze_frames`, their number; no shares without any.

        As Niay (2022, section 4.3.2): the share of frames in which the gaze was on each part.
        """
        known = [frame.region for frame in self.frames if frame.region != UNKNOWN]
        shares = {f"gaze_{region}": 100.0 * known.count(region) / len(known) for region in REGIONS} if known else {}
        return {**shares, "gaze_frames": float(len(known))}

"""The frames of the trial that is on: when each was seen, for when it was drawn, what it cost, what it showed."""

from __future__ import annotations

from experiment_app.windows.window import Flip
from protocols.record import FrameLog, TrialRecord

LATE = 1.5
"""A frame is late when it appears more than this many refresh periods after the one before."""


class TrialFrames:
    """Frames in the order they were seen. A pause parts them into stretches, so its length is no interval."""

    def __init__(self) -> None:
        self._flips: list[float] = []
        self._predicted: list[float] = []
        self._cpu_ms: list[float] = []
        self._poses: list[str] = []
        self._stretches: list[int] = []
        self._paused = True

    def __len__(self) -> int:
        return len(self._flips)

    def add(self, predicted: float, flip: Flip) -> None:
        """One more frame, drawn for `predicted` (s)."""
        if self._paused:
            self._stretches.append(len(self._flips))
            self._paused = False
        self._flips.append(round(flip.time, 6))
        self._predicted.append(predicted)
        self._cpu_ms.append(round(flip.cpu_ms, 3))
        self._poses.append(flip.pose)

    def pause(self) -> None:
        """The trial is not on the screen; its next frame begins a new stretch."""
        self._paused = True

    def log(self, trial: TrialRecord, period: float) -> FrameLog:
        """What the journal keeps of these frames; period: s between refreshes."""
        return FrameLog(
            time=trial.time,
            number=trial.number,
            practice=trial.practice,
            attempt=trial.attempt,
            period=round(period, 9),
            flips=tuple(self._flips),
            predicted=tuple(self._predicted),
            cpu_ms=tuple(self._cpu_ms),
            poses=tuple(self._poses),
            stretches=tuple(self._stretches),
            late=tuple(n for n in self._followers() if self._flips[n] - self._flips[n - 1] > LATE * period),
        )

    def _followers(self) -> list[int]:
        """Numbers of the frames that follow another without a pause between."""
        return sorted(set(range(len(self._flips))) - set(self._stretches))

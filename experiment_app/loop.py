"""The one loop: events to the session, the session to a scene, the scene to the window, records to the journal."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

from experiment_app.scene import Scene
from experiment_app.staging import stage
from experiment_app.windows.window import Window
from protocols.events import Saved, Shown
from protocols.record import FrameIntervals, Record, TrialRecord
from protocols.session import Interval, Session, advance, drained, handle

LATE = 1.5
"""A frame is late when it appears more than this many refresh periods after the one before."""


class Recorder(Protocol):
    """What the loop asks of a journal."""

    def write(self, records: list[Record]) -> None:
        """Takes records in order."""

    @property
    def saved(self) -> bool:
        """True when all records taken are safe."""


def run_session(session: Session, window: Window, journal: Recorder) -> Session:
    """Plays a session to its end and returns it; every record goes to the journal.

    A trial begins only when the journal has said that the trial before is safe.
    """
    frames = Frames()
    while not session.done:
        now, events = window.poll(session)
        for event in events:
            session = handle(session, event)
        session = advance(session, now)
        if isinstance(session.stage, Interval) and not session.stage.saved and not session.emitted and journal.saved:
            session = handle(session, Saved(now))
        session, records = drained(session)
        if records:
            journal.write(_with_frames(records, frames, window))
        if session.done:
            break
        showing = session.trial is not None and session.overlay is None
        scene = stage(_previewed(session, window.next_display_time()))
        flip = window.show(scene)
        if session.shown is None:
            frames = Frames()
            session = handle(session, Shown(flip))
        frames = frames.after(flip, scene) if showing else replace(frames, last=None)
    session, records = drained(session)
    journal.write(list(records))
    return session


def _previewed(session: Session, seen: float) -> Session:
    """The session as it will be when the frame is seen; a preview never ends an interval, only time does."""
    return advance(session, seen) if session.trial is not None else session


@dataclass(frozen=True)
class Frames:
    """The frames of one trial so far; a pause ends a stretch of frames, so its length is no interval.

    last: flip (s) of the frame before, None at the start of a stretch; intervals: s; scene: the newest.
    """

    count: int = 0
    last: float | None = None
    intervals: tuple[float, ...] = ()
    scene: Scene | None = None

    def after(self, flip: float, scene: Scene) -> Frames:
        """The frames once one more was seen at `flip` (s)."""
        new = () if self.last is None else (flip - self.last,)
        return Frames(self.count + 1, flip, self.intervals + new, scene)


def _with_frames(records: tuple[Record, ...], frames: Frames, window: Window) -> list[Record]:
    """The records, a finished trial's with its frames: how many, how many late, and their intervals."""
    whole: list[Record] = []
    for record in records:
        if not isinstance(record, TrialRecord) or not window.period or frames.scene is None:
            whole.append(record)
            continue
        late = sum(interval > LATE * window.period for interval in frames.intervals)
        in_ms = tuple(round(1000.0 * interval, 3) for interval in frames.intervals)
        whole.append(FrameIntervals(record.time, record.number, record.practice, record.attempt, in_ms))
        walker = replace(frames.scene.walkers[0], step_frequency=record.response["step_frequency"])
        measured = window.measure(replace(frames.scene, walkers=(walker,)))
        whole.append(replace(record, frames=frames.count, late_frames=late, measured=measured))
    return whole

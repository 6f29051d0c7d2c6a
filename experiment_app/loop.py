"""The one loop: events to the session, the session to a scene, the scene to the window, records to the journal."""

from __future__ import annotations

import gc
from dataclasses import replace
from typing import Protocol

from experiment_app.scene import Scene, Walker
from experiment_app.staging import stage
from experiment_app.timing.frames import TrialFrames
from experiment_app.windows.window import Window
from protocols.events import Saved, Shown
from protocols.record import Click, Key, Paused, Record, Resumed, TrialRecord
from protocols.session import Interval, Session, advance, drained, handle


class Recorder(Protocol):
    """What the loop asks of a journal."""

    def write(self, records: list[Record]) -> None:
        """Takes records in order."""

    @property
    def saved(self) -> bool:
        """True when all records taken are safe."""


def run_session(session: Session, window: Window, journal: Recorder) -> Session:
    """Plays a session to its end and returns it; every record goes to the journal.

    A trial begins only when the journal has said that the trial before is safe. Between events the session stays
    where it is and only a preview of it is drawn, so that a key whose time stamp arrives a little late still
    counts from its own time, and the same keys give the same trial whatever frames were drawn.
    """
    frames, scene = TrialFrames(), Scene()
    while not session.done:
        now, events = window.poll(session)
        for event in events:
            session = handle(session, event)
        session = _passed(session, now)
        if isinstance(session.stage, Interval) and not session.stage.saved and not session.emitted and journal.saved:
            session = handle(session, Saved(now))
        session = _write(session, journal, window, frames, scene)
        if session.done:
            break
        showing = session.trial is not None and session.overlay is None
        predicted = round(window.next_display_time(), 6)
        newest = stage(_previewed(session, predicted))
        flip = window.show(newest)
        if session.shown is None:
            frames, scene = TrialFrames(), Scene()
            session = handle(session, Shown(flip.time))
        if showing:
            scene = _together(scene, newest)
            frames.add(predicted, flip)
        else:
            frames.pause()
            _collect_garbage(session)
        session = _write(session, journal, window, frames, scene)
    return _write(session, journal, window, frames, scene)


def _passed(session: Session, now: float) -> Session:
    """The session once time alone has moved it on to something new by `now` (s), else as it was."""
    later = advance(session, now)
    return later if later.emitted != session.emitted or later.index != session.index else session


def _previewed(session: Session, seen: float) -> Session:
    """The session as it will be when the frame is seen; a preview never ends an interval, only time does."""
    return advance(session, seen) if session.trial is not None else session


def _collect_garbage(session: Session) -> None:
    """Collects between trials what a live run leaves uncollected in them (`live.without_collection`)."""
    if not gc.isenabled() and isinstance(session.stage, Interval) and not session.stage.saved:
        gc.collect()


def _write(session: Session, journal: Recorder, window: Window, frames: TrialFrames, scene: Scene) -> Session:
    """Hands the session's records to the journal, with what only the loop knows: frames, and the gait as drawn."""
    session, records = drained(session)
    whole: list[Record] = []
    for record in records:
        if isinstance(record, (Key, Click, Paused, Resumed)):
            record = replace(record, frame=len(frames))
        elif isinstance(record, TrialRecord) and window.period and len(frames):
            log = frames.log(record, window.period)
            measured = window.measure(_as_answered(scene, record))
            whole.append(log)
            record = replace(record, frames=len(frames), late_frames=len(log.late), measured=measured)
        whole.append(record)
    if whole:
        journal.write(whole)
    return session


def _together(before: Scene, newest: Scene) -> Scene:
    """What has been seen in a trial so far: the newest scene; of walks that came one after the other, both.

    The second then stands beside the first. Walks that have vanished are kept, so that they can be measured.
    """
    if not newest.visible:
        return before
    if newest.beside is not None or not newest.walkers or not before.walkers:
        return newest
    if _which(newest.walkers[0]) == _which(before.walkers[0]):
        return replace(newest, beside=before.beside)
    return replace(before, beside=newest)


def _which(walker: Walker) -> tuple[object, ...]:
    """What makes a walk another one; step frequency does not, as it may be adjusted."""
    return walker.actor, walker.body, walker.speed, walker.making


def _as_answered(scene: Scene, record: TrialRecord) -> Scene:
    """The last scene of a trial, its walker at the step frequency that was the answer, if one was adjusted."""
    frequency = record.response.get("step_frequency")
    if frequency is None or not scene.walkers:
        return scene
    return replace(scene, walkers=(replace(scene.walkers[0], step_frequency=float(frequency)),))

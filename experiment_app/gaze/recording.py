"""Gaze into the journal: what was looked at in each frame of a trial, and its shares in the trial's record."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

from experiment_app.gaze.samples import GazeSample, Looking
from experiment_app.gaze.stream import GazeStream
from experiment_app.gaze.watching import GazeWatch
from experiment_app.loop import Recorder
from experiment_app.markers.lsl import clock_offset
from experiment_app.windows.desktop import DesktopWindow
from protocols.gaze import GazeSettings
from protocols.record import GazeTrace, Record, TrialBegun, TrialRecord


class GazeRecorder:
    """A recorder that adds to every trial what was looked at, before it passes the record on."""

    def __init__(self, journal: Recorder, watch: GazeWatch) -> None:
        self._journal, self._watch = journal, watch

    def write(self, records: list[Record]) -> None:
        """Writes the records, a trial's with the shares of every region and after its gaze, frame by frame."""
        whole: list[Record] = []
        for record in records:
            if isinstance(record, TrialBegun):
                self._watch.begin()
            elif isinstance(record, TrialRecord):
                looking = self._watch.taken()
                whole.append(gaze_trace(record, looking))
                record = replace(record, measured={**record.measured, **looking.shares()})
            whole.append(record)
        self._journal.write(whole)

    @property
    def saved(self) -> bool:
        """True when the journal has everything."""
        return self._journal.saved


def gaze_trace(trial: TrialRecord, looking: Looking) -> GazeTrace:
    """What the journal keeps of the gaze of one trial."""
    frames = looking.frames
    return GazeTrace(
        time=trial.time,
        number=trial.number,
        practice=trial.practice,
        attempt=trial.attempt,
        flips=tuple(frame.flip for frame in frames),
        x=tuple(frame.x for frame in frames),
        y=tuple(frame.y for frame in frames),
        regions=tuple(frame.region for frame in frames),
        joints=tuple(frame.joint for frame in frames),
        walkers=tuple(frame.walker for frame in frames),
    )


class PointerGaze:
    """The mouse pointer in place of the eyes, one sample at each poll."""

    def __init__(self, pointer: Callable[[], tuple[float, float]], now: Callable[[], float]) -> None:
        self._pointer, self._now = pointer, now

    def poll(self) -> list[GazeSample]:
        """Where the pointer is now."""
        return [GazeSample(self._now(), *self._pointer())]


@contextmanager
def gaze_watched(settings: GazeSettings | None, window: DesktopWindow) -> Iterator[GazeWatch | None]:
    """What watches the participant's gaze in a window, None for a study without gaze.

    Raises UsageError when the eye tracker's stream is not there.
    """
    if settings is None:
        yield None
        return
    stream = None
    if settings.source == "lsl":
        stream = GazeStream(settings, window.display_size, window.on_picture, clock_offset(window.now()))
    watch = GazeWatch(stream or PointerGaze(window.pointer, window.now))
    window.watch(watch)
    try:
        yield watch
    finally:
        if stream is not None:
            stream.close()


def recording_gaze(journal: Recorder, watch: GazeWatch | None) -> Recorder:
    """The recorder itself where nothing watches the gaze, else one that records it too."""
    return journal if watch is None else GazeRecorder(journal, watch)

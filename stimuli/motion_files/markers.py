"""A captured cloud of markers, before anybody made a skeleton of it. Knows no file format."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stimuli.clip import FootEvent, Source, Subject
from stimuli.events import SIDES, FootPaths, GaitError, told_or_found
from stimuli.gait_measures import GaitMeasures, measure_paths

Floats = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class MarkerRecording:
    """Marker paths of one trial in our axes.

    labels:  M labels as in the file, made different with "#2", "#3" where repeated
    points:  (T, M, 3) m, Y up; NaN where a marker was not seen
    rate:    Hz
    places:  place on the body -> index into labels, as in `marker_names.places_of`
    events:  foot events in order of time, s from the first frame of this file
    left_out: labels of points that are no positions (angles, moments, powers, forces)
    """

    name: str
    labels: tuple[str, ...]
    points: Floats
    rate: float
    places: Mapping[str, int]
    events: tuple[FootEvent, ...]
    subject: Subject
    source: Source
    left_out: tuple[str, ...]
    warnings: tuple[str, ...]

    @property
    def frame_count(self) -> int:
        """Number of frames T."""
        return len(self.points)

    def path_of(self, *places: str) -> Floats:
        """(T, 3) m: mean of the markers at these places, NaN in frames where one is missing."""
        return np.mean([self.points[:, self.places[place]] for place in places], axis=0)


PELVIS = ("left_asis", "right_asis", "left_psis", "right_psis", "sacrum")


def marker_foot_paths(recording: MarkerRecording) -> FootPaths:
    """Pelvis, heels and toes of a marker recording, gaps up to its ends filled by straight lines.

    Raises GaitError naming the place where no marker is. An ankle marker serves where there is no heel.
    """
    seen = [place for place, index in recording.places.items() if np.isfinite(recording.points[:, index]).any()]
    pelvis = [place for place in PELVIS if place in seen]
    feet = [[next((p for p in choice if p in seen), choice[0]) for choice in _foot_choices(side)] for side in SIDES]
    missing = [place for place in ("left_asis", "right_asis", *feet[0], *feet[1]) if place not in seen]
    if missing:
        raise GaitError(f"{recording.name}: no marker is seen at {', '.join(missing)}")
    paths = {place: filled(recording.path_of(place)) for place in (*pelvis, *feet[0], *feet[1])}
    return FootPaths(
        pelvis=np.mean([paths[place] for place in pelvis], axis=0),
        left_axis=paths["left_asis"] - paths["right_asis"],
        heels=np.stack([paths[heel] for heel, _ in feet]),
        toes=np.stack([paths[toe] for _, toe in feet]),
        rate=recording.rate,
        heel_markers=all(heel.endswith("heel") for heel, _ in feet),
    )


def measure_markers(recording: MarkerRecording) -> GaitMeasures:
    """The gait of a marker recording, from its file's events where it has them. Raises GaitError."""
    recording = seen_part(recording, [p for p in recording.places if p.endswith(("asis", "heel", "_toe"))])
    paths = marker_foot_paths(recording)
    return measure_paths(paths, told_or_found(recording.events, paths), recording.name)


def seen_part(recording: MarkerRecording, places: Sequence[str]) -> MarkerRecording:
    """The recording from the first to the last frame in which all these places are seen, events moved along.

    Places that are never seen are not asked for. A recording without such a frame is returned as it is. What was left
    out is told in the source and in a warning.
    """
    points = recording.points[:, [recording.places[place] for place in places]]
    seen = np.asarray(np.all(np.isfinite(points), axis=-1))
    frames = np.flatnonzero(seen[:, seen.any(axis=0)].all(axis=1))
    if len(frames) == 0 or (frames[0] == 0 and frames[-1] == len(seen) - 1):
        return recording
    first, last = int(frames[0]), int(frames[-1])
    start, end = first / recording.rate, last / recording.rate
    events = tuple(replace(e, time=e.time - start) for e in recording.events if start <= e.time <= end)
    left_out = first, recording.frame_count - 1 - last
    return replace(
        recording,
        points=recording.points[first : last + 1],
        events=events,
        source=replace(recording.source, left_out=left_out),
        warnings=(*recording.warnings, _left_out_warning(recording.frame_count, *left_out)),
    )


def _left_out_warning(frames: int, first: int, last: int) -> str:
    parts = [f"the {where} {count}" for where, count in (("first", first), ("last", last)) if count]
    frames_of = f"{' and '.join(parts)} of {frames} frames"
    return f"{frames_of} are left out, as markers of pelvis, knees or feet are unseen there"


def filled(path: Floats) -> Floats:
    """(T, 3) with missing frames on the straight line between their neighbours; all NaN stays so."""
    seen = np.all(np.isfinite(path), axis=1)
    if seen.all() or not seen.any():
        return path
    frames = np.arange(len(path))
    return np.stack([np.interp(frames, frames[seen], path[seen, axis]) for axis in range(3)], axis=1)


def _foot_choices(side: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    return (f"{side}_heel", f"{side}_lateral_ankle"), (f"{side}_toe", f"{side}_first_toe", f"{side}_fifth_toe")

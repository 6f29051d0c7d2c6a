"""An eye tracker's stream over Lab Streaming Layer: found by its type, its channels by their labels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil, isfinite
from typing import Any

from experiment_app.errors import UsageError
from experiment_app.gaze.samples import KEPT, GazeSample
from experiment_app.markers.lsl import import_pylsl
from protocols.gaze import GazeSettings

KNOWN_LABELS = (("x", "y"), ("norm_pos_x", "norm_pos_y"), ("gaze_x", "gaze_y"), ("gaze.x", "gaze.y"), ("X", "Y"))
"""Labels of the two channels in common streams, tried in this order when the study file names none."""

OnPicture = Callable[[float, float], tuple[float, float]]

KEPT_SECONDS = ceil(KEPT)
"""Of samples that wait for the next poll, s; during a page nobody asks for them, and older ones are let go anyway."""

FINDING_TIME = 5.0
"""s to wait for the stream."""


class GazeStream:
    """Samples of an eye tracker.

    settings:   which stream and channels, and their unit; display: (width, height) in pixels, for streams in pixels.
    on_picture: a place on the display to the same place on the picture, both from 0 to 1.
    offset:     s from the run's clock to Lab Streaming Layer's.
    Raises UsageError when there is no such stream, or it has no such channels.
    """

    def __init__(self, settings: GazeSettings, display: tuple[int, int], on_picture: OnPicture, offset: float) -> None:
        pylsl = import_pylsl()
        found = pylsl.resolve_byprop("type", settings.stream_type, 1, FINDING_TIME)
        if not found:
            raise UsageError(
                f"no stream of type {settings.stream_type} was found within {FINDING_TIME:g} s; start the eye "
                "tracker's Lab Streaming Layer output on this network, or take `gaze:` out of the study file."
            )
        self._inlet = pylsl.StreamInlet(found[0], max_buflen=KEPT_SECONDS)
        info = self._inlet.info(FINDING_TIME)
        self.name = str(info.name())
        self._settings, self._display, self._on_picture, self._offset = settings, display, on_picture, offset
        self._x, self._y, self._confidence = chosen_channels(_labels(info), settings, self.name)
        self._inlet.time_correction(FINDING_TIME)
        self._inlet.open_stream(FINDING_TIME)

    def poll(self) -> list[GazeSample]:
        """The samples that have come since the last time, oldest first; never waits.

        A pull gives so many at most, and on the first frame after a page there are more.
        """
        samples: list[GazeSample | None] = []
        while (pulled := self._inlet.pull_chunk(0.0))[1]:
            correction = float(self._inlet.time_correction(0.0)) - self._offset
            samples += [self._sample(row, time + correction) for row, time in zip(*pulled, strict=True)]
        return [sample for sample in samples if sample is not None]

    def close(self) -> None:
        """Lets the stream go."""
        self._inlet.close_stream()

    def _sample(self, row: Sequence[float], time: float) -> GazeSample | None:
        x, y = float(row[self._x]), float(row[self._y])
        trusted = self._confidence is None or float(row[self._confidence]) >= self._settings.least_confidence
        if not (trusted and isfinite(x) and isfinite(y)):
            return None
        if self._settings.unit == "pixels":
            x, y = x / self._display[0], y / self._display[1]
        return GazeSample(time, *self._on_picture(x, 1.0 - y if self._settings.origin == "bottom_left" else y))


def chosen_channels(labels: Sequence[str], settings: GazeSettings, stream: str) -> tuple[int, int, int | None]:
    """Numbers of the channels for x, y and confidence (None without one); raises UsageError when one is missing."""
    pairs = ((settings.x, settings.y),) if settings.x and settings.y else KNOWN_LABELS
    for pair in pairs:
        if all(label in labels for label in pair):
            confidence = settings.confidence
            if confidence and confidence not in labels:
                raise UsageError(f"the stream {stream} has no channel {confidence!r}; {_having(labels)}.")
            return labels.index(pair[0]), labels.index(pair[1]), labels.index(confidence) if confidence else None
    wanted = " or ".join(f"{x!r} and {y!r}" for x, y in pairs)
    raise UsageError(
        f"the stream {stream} has no channels {wanted}; {_having(labels)}. Name two of them as x and y under `gaze:`."
    )


def _having(labels: Sequence[str]) -> str:
    return f"it has {', '.join(labels)}" if any(labels) else "its channels have no labels"


def _labels(info: Any) -> list[str]:
    labels: list[str] = []
    channel = info.desc().child("channels").child("channel")
    while not channel.empty():
        labels.append(str(channel.child_value("label")))
        channel = channel.next_sibling("channel")
    return labels

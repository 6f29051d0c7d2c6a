"""A film of a replayed trial: what was seen, when it was seen, late frames too, with the response trace under it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

import numpy as np

from experiment_app.pictures.film import Pixels, film_scenes
from experiment_app.replay.frames import ReplayedFrame
from experiment_app.replay.recorded import RecordedTrial
from experiment_app.replay.trace import HEIGHT, make_strip, watched_times


def film_length(trial: RecordedTrial, rate: Fraction) -> int:
    """How many frames the film of a trial has at `rate` frames/s."""
    watched = watched_times(trial, trial.frames["flips"])
    return int(float(watched[-1]) * float(rate)) + 1


def trial_film(
    trial: RecordedTrial, frames: Sequence[ReplayedFrame], rate: Fraction, size: tuple[int, int]
) -> Iterator[Pixels]:
    """The pictures of a film at `rate` frames/s: each the frame that was on the screen at that time.

    size: (width, height) of the walker's picture; the strip under it adds HEIGHT of that. A frame that stood longer
    because the next was late stands longer here too.
    """
    watched = watched_times(trial, [frame.flip for frame in frames])
    wanted = [float(number / rate) for number in range(film_length(trial, rate))]
    on_screen = np.searchsorted(watched, np.asarray(wanted) + 1e-9, side="right") - 1
    width, height = size
    strip = make_strip(trial, frames, width, 2 * round(0.5 * HEIGHT * height))
    pictures = film_scenes((frames[number].scene for number in np.unique(on_screen)), size)
    number, picture = -1, None
    for time, which in zip(wanted, on_screen, strict=True):
        if which != number:
            number, picture = which, next(pictures)
        assert picture is not None
        yield np.vstack([picture, strip.at(time / max(float(watched[-1]), 1e-9))])

"""The response trace of a trial as a strip under the film: step frequency over time, keys held, late frames, now."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiment_app.replay.frames import ReplayedFrame
from experiment_app.replay.recorded import RecordedTrial
from protocols.events import Clicked, FocusLost, KeyDown, KeyUp

Pixels = NDArray[np.uint8]

HEIGHT = 0.3
"""Of the walker's picture: how high the strip is."""

BACKGROUND, INK, PALE, ACCENT, LATE = "#14181d", "#c9d1d9", "#4a545e", "#ffb454", "#ff5d5d"


@dataclass(frozen=True, eq=False)
class Strip:
    """The strip with everything past and with everything still to come, and where time is on it.

    past, coming: (height, width, 3). left, right: columns of the first and last frame.
    """

    past: Pixels
    coming: Pixels
    left: float
    right: float

    def at(self, share: float) -> Pixels:
        """The strip at a share of the trial in [0, 1]: what has happened in full colour, a line at now."""
        column = round(self.left + share * (self.right - self.left))
        strip = self.coming.copy()
        strip[:, :column] = self.past[:, :column]
        strip[:, max(column - 1, 0) : column + 1] = 240
        return strip


def watched_times(trial: RecordedTrial, flips: Sequence[float]) -> NDArray[np.float64]:
    """s since onset of every frame with pauses taken out: the first frame after one follows a period later."""
    steps = np.diff(np.asarray(flips, dtype=float), prepend=flips[0])
    for number in trial.frames["stretches"]:
        if number > 0:
            steps[number] = trial.frames["period"]
    return np.cumsum(steps)


def make_strip(trial: RecordedTrial, frames: Sequence[ReplayedFrame], width: int, height: int) -> Strip:
    """The strip of a trial, `width` times `height` pixels; frames: all of the trial's."""
    past, left, right = _drawn(trial, frames, width, height, ACCENT, INK)
    coming, _, _ = _drawn(trial, frames, width, height, PALE, PALE)
    return Strip(past, coming, left, right)


def _drawn(
    trial: RecordedTrial, frames: Sequence[ReplayedFrame], width: int, height: int, line: str, mark: str
) -> tuple[Pixels, float, float]:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    dots = 100.0 * width / 1280.0
    figure = Figure((width / dots, height / dots), dpi=dots, facecolor=BACKGROUND)
    canvas = FigureCanvasAgg(figure)
    keys = held_keys(trial)
    times = watched_times(trial, [frame.flip for frame in frames])
    axes: list[Any] = list(figure.subplots(2, 1, sharex=True, height_ratios=(3.0, 0.6 + 0.45 * len(keys))))
    figure.subplots_adjust(0.09, 0.20, 0.985, 0.90, hspace=0.12)
    for walker in range(max(len(_step_frequencies(frame)) for frame in frames)):
        shown = [_step_frequencies(frame) for frame in frames]
        values = [each[walker] if walker < len(each) else np.nan for each in shown]
        axes[0].plot(times, values, color=line, linewidth=2.0, alpha=1.0 if walker == 0 else 0.6)
    low, high = axes[0].get_ylim()
    if high - low < 4.0:
        axes[0].set_ylim(0.5 * (low + high) - 2.0, 0.5 * (low + high) + 2.0)
    axes[0].set_ylabel("steps/min", color=INK, fontsize=9)
    late = [times[number] for number in trial.frames["late"]]
    axes[0].plot(late, np.full(len(late), axes[0].get_ylim()[0]), "|", color=LATE, markersize=9, clip_on=False)
    axes[0].set_title(_title(trial), color=INK, fontsize=9, loc="left")
    for row, spans in enumerate(keys.values()):
        bars = [_watched(times, frames, span) for span in spans]
        axes[1].broken_barh(bars, (row - 0.32, 0.64), color=mark)
    axes[1].set_yticks(range(len(keys)), list(keys))
    axes[1].set_ylim(len(keys) - 0.4, -0.6)
    axes[1].set_xlabel("s since onset, pauses taken out", color=INK, fontsize=9)
    axes[1].set_xlim(0.0, max(float(times[-1]), 1e-3))
    for one in axes:
        one.set_facecolor(BACKGROUND)
        one.tick_params(colors=INK, labelsize=8)
        for side, spine in one.spines.items():
            spine.set_color(PALE)
            spine.set_visible(side in ("left", "bottom"))
    axes[0].tick_params(labelbottom=False)
    canvas.draw()
    ends = axes[1].transData.transform([(0.0, 0.0), (float(times[-1]), 0.0)])
    pixels = np.asarray(canvas.buffer_rgba())[:, :, :3].copy()
    return pixels[:height, :width], float(ends[0][0]), float(ends[1][0])


def held_keys(trial: RecordedTrial) -> dict[str, list[tuple[float, float]]]:
    """Key to the spans (from, to; s on the run's clock) in which it was held; clicks are spans of no length."""
    held: dict[str, list[tuple[float, float]]] = {}
    down: dict[str, float] = {}
    end = float(trial.answer["time"])
    for _, event in trial.events:
        if isinstance(event, KeyDown) and event.key != "escape":
            down[event.key] = event.time
            held.setdefault(event.key, [])
        elif isinstance(event, Clicked):
            held.setdefault("pointer", []).append((event.time, event.time))
        released = [event.key] if isinstance(event, KeyUp) else list(down) if isinstance(event, FocusLost) else []
        for key in released:
            if key in down:
                held[key].append((down.pop(key), event.time))
    for key, since in down.items():
        held[key].append((since, end))
    return held


def _step_frequencies(frame: ReplayedFrame) -> list[float]:
    beside = frame.scene.beside.walkers if frame.scene.beside is not None else ()
    return [walker.step_frequency for walker in (*frame.scene.walkers, *beside)]


def _watched(
    times: NDArray[np.float64], frames: Sequence[ReplayedFrame], span: tuple[float, float]
) -> tuple[float, float]:
    """Start and length of a span in watched time; at least as long as can be seen."""
    flips = [frame.flip for frame in frames]
    start, end = np.interp(span, flips, times)
    least = 0.004 * float(times[-1])
    return float(start), max(float(end - start), least)


def _title(trial: RecordedTrial) -> str:
    levels = ", ".join(f"{name} {level}" for name, level in trial.begun["factors"].items())
    values = trial.answer["response"].items()
    answer = ", ".join(
        f"{name} {value:.4g}" if isinstance(value, float) else f"{name} {value}" for name, value in values
    )
    return f"{trial.name}: {levels}  |  {answer}"

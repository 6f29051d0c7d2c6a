"""What an actor covers, drawn in characters, for the message that refuses what lies outside. Knows trees only."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from stimuli.blend_tree import Branch, Tree, covers

COLUMNS, ROWS = 41, 9
BEYOND = 0.5
"""Share of what is covered by which the drawing grows at most to show what was asked."""

CYCLE, COVERED, ASKED = "o", "·", "X"


def coverage_drawing(tree: Tree, wanted: Mapping[str, float]) -> str:
    """Lines of text: step frequency upwards, speed to the right; the cycles, what lies between, and what was asked.

    Empty for trees over other parameters.
    """
    cycles = _cycles(tree)
    if not cycles or set(wanted) != {"speed", "step_frequency"} or not np.all(np.isfinite(list(wanted.values()))):
        return ""
    speeds = _axis([speed for speed, _ in cycles], wanted["speed"], COLUMNS, 0.1)
    beats = _axis([beat for _, beat in cycles], wanted["step_frequency"], ROWS, 5.0)
    grid = [[COVERED if _covered(tree, speed, beat, beats) else " " for speed in speeds] for beat in beats]
    for speed, beat in cycles:
        grid[_nearest(beats, beat)][_nearest(speeds, speed)] = CYCLE
    grid[_nearest(beats, wanted["step_frequency"])][_nearest(speeds, wanted["speed"])] = ASKED
    lines = [f"{beats[row]:8.0f} |{''.join(grid[row])}|" for row in reversed(range(ROWS))]
    middle = f"{speeds[COLUMNS // 2]:.2f}".center(COLUMNS - 10)
    return "\n".join(
        [
            "steps/min",
            *lines,
            f"{'':8s}  {speeds[0]:<5.2f}{middle}{speeds[-1]:>5.2f} m/s",
            f"{'':8s}  {CYCLE} cycle of the actor   {COVERED} covered   {ASKED} asked for{_far(wanted, speeds, beats)}",
        ]
    )


def _cycles(tree: Tree) -> list[tuple[float, float]]:
    """Speed and step frequency of every cycle of a path or of a metronome's grid."""
    if not isinstance(tree, Branch):
        return []
    if tree.follows:
        return list(zip(tree.places, tree.follows, strict=True))
    if tree.parameter != "step_frequency":
        return []
    return [
        (speed, beat)
        for beat, child in zip(tree.places, tree.children, strict=True)
        if isinstance(child, Branch) and child.parameter == "speed"
        for speed in child.places
    ]


def _axis(values: list[float], asked: float, count: int, least: float) -> list[float]:
    low, high = min(values), max(values)
    room = max(high - low, least)
    low, high = (min(low, max(asked, low - BEYOND * room)), max(high, min(asked, high + BEYOND * room)))
    if high - low < least:
        low, high = low - 0.5 * least, high + 0.5 * least
    return [float(value) for value in np.linspace(low, high, count)]


def _covered(tree: Tree, speed: float, beat: float, beats: list[float]) -> bool:
    if isinstance(tree, Branch) and tree.follows:
        if not tree.places[0] <= speed <= tree.places[-1]:
            return False
        return beats[_nearest(beats, float(np.interp(speed, tree.places, tree.follows)))] == beat
    return covers(tree, {"speed": speed, "step_frequency": beat})


def _nearest(axis: list[float], value: float) -> int:
    return int(np.argmin(np.abs(np.array(axis) - value)))


def _far(wanted: Mapping[str, float], speeds: list[float], beats: list[float]) -> str:
    """A remark where what was asked lies beyond the drawing and stands at its edge."""
    inside = speeds[0] - 1e-9 <= wanted["speed"] <= speeds[-1] + 1e-9
    return "" if inside and beats[0] - 1e-9 <= wanted["step_frequency"] <= beats[-1] + 1e-9 else " (further out)"

"""What every rival script has in common: the crowds to draw, and how a frame is timed. Standard library only."""

from __future__ import annotations

import gc
import json
import resource
import sys
import time
from collections.abc import Callable
from pathlib import Path

SIZE = (1280, 720)
EYE, AIM, FIELD_OF_VIEW = (0.0, 9.0, 30.0), (0.0, 0.9, 0.0), 40.0
RATE = 60.0  # frames/s that phases advance by


def arguments() -> tuple[str, dict[int, list[tuple[float, float, float]]], int]:
    """The GLB file; size of a crowd -> x, z (m) and phase of every walker; frames to time."""
    crowds = json.loads(Path(sys.argv[2]).read_text(encoding="utf-8"))
    return sys.argv[1], {int(size): walkers for size, walkers in crowds.items()}, int(sys.argv[3])


def timed(frame: Callable[[int], float], frames: int) -> dict[str, float]:
    """Milliseconds per frame: wall time (tenth and fiftieth percentile), CPU of all threads, and animation alone.

    frame: draws and finishes one frame, and returns the s that its poses took.
    """
    for number in range(3):
        frame(number)
    walls, poses = [], []
    gc.collect()
    gc.freeze()
    gc.disable()  # as in ours
    used = _used()
    for number in range(3, frames + 3):
        begun = time.perf_counter()
        poses.append(frame(number))
        walls.append(time.perf_counter() - begun)
    used = _used() - used
    walls.sort()
    poses.sort()
    return {
        "wall_p10": 1e3 * walls[len(walls) // 10],
        "wall": 1e3 * walls[len(walls) // 2],
        "cpu": 1e3 * used / frames,
        "poses": 1e3 * poses[len(poses) // 2],
    }


def _used() -> float:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime

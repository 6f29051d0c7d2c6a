"""How a figure is taken and printed: the fastest of several rounds, the machine's name, and the limit beside it."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Callable
from pathlib import Path


def fastest(function: Callable[[], object], rounds: int, repeats: int = 1) -> float:
    """s of CPU time of this thread for one call, the fastest of several rounds."""
    best = float("inf")
    for _ in range(rounds):
        begun = time.thread_time()
        for _ in range(repeats):
            function()
        best = min(best, (time.thread_time() - begun) / repeats)
    return best


def machine() -> str:
    """The processor's name and the number of its cores, as the system tells."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        name = next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        name = platform.processor() or platform.machine()
    return f"{name}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}"


def row(what: str, seconds: float, limit: float) -> None:
    """One line: the figure, its limit, and whether it was kept."""
    unit, factor = ("s", 1.0) if limit >= 1.0 else ("ms", 1e3) if limit >= 1e-4 else ("µs", 1e6)
    verdict = "kept" if seconds <= limit else "MISSED"
    print(f"{what:<64}{seconds * factor:9.3f} {unit:<3} limit {limit * factor:g} {unit}: {verdict}", flush=True)

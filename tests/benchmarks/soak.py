"""`python -m tests.benchmarks.soak 10000`: simulated trials drawn off-screen; memory and handles stay flat."""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

from tests.robustness.soaking import growth, soak

PER_SESSION = 480
MOST_GROWTH = 1.0
"""MiB per 1000 trials that memory may grow by: a session has about a hundred."""


def main() -> int:
    """Soaks, prints memory and handles after every session, and returns 1 when either grows."""
    trials = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    begun, uses = time.perf_counter(), []
    with tempfile.TemporaryDirectory() as folder:
        for use in soak(Path(folder), trials, PER_SESSION):
            uses.append(use)
            took = time.perf_counter() - begun
            print(f"{use.trials:6} trials  {use.memory:7.1f} MiB  {use.handles:3} handles  {took:5.0f} s", flush=True)
    grown, opened = growth(uses), uses[-1].handles - uses[1].handles
    print(f"memory grows by {grown:.2f} MiB per 1000 trials  limit {MOST_GROWTH}")
    print(f"file handles more than after the second session: {opened}  limit 0")
    return 0 if grown <= MOST_GROWTH and opened <= 0 else 1


if __name__ == "__main__":
    sys.exit(main())

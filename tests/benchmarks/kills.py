"""`python -m tests.benchmarks.kills 200`: that many kills of running sessions at random moments, and what they left."""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

from tests.robustness.killing import kill_sessions


def main() -> int:
    """Kills, prints the toll, and returns 1 when anything was lost."""
    kills = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    begun = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        toll = kill_sessions(Path(folder), kills, seed=200)
    print(f"{toll.kills} kills in {time.perf_counter() - begun:.0f} s, {toll.finished} sessions of 96 trials finished")
    print(f"acknowledged trials lost                     {toll.lost}  limit 0")
    print(f"designs with a missing or doubled cell       {toll.wrong_designs}  limit 0")
    print(f"repeated trials not marked as such           {toll.unmarked}  limit 0")
    print(f"torn lines set aside                         {toll.torn}")
    for reason, count in toll.reasons.most_common():
        print(f"interruption told as: {reason}  {count}")
    return 0 if toll.good else 1


if __name__ == "__main__":
    sys.exit(main())

"""`python -m tests.benchmarks` prints how long the things people feel take on this machine, beside their limits.

A figure is the fastest of several rounds, in CPU or wall time as said; the limit is the project's own.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from itertools import product
from pathlib import Path

from tests.benchmarks.beside_others import rivals
from tests.benchmarks.crowds import drawing, graphics_card, own_work
from tests.benchmarks.importing import importing
from tests.benchmarks.measuring import fastest, machine, row
from tests.benchmarks.methods import methods
from tests.benchmarks.poses import poses
from tests.benchmarks.timing import timing


def analysis_of_the_thesis() -> None:
    """The 4 x 3 x 2 x sex ANOVA of 22 x 96 rows (afex in R: 40 ms)."""
    import numpy as np
    import pandas as pd

    from analysis import anova
    from analysis.statistics.studentized_range import survival

    cells = product(range(22), ("F1", "F2", "M1", "M2"), (0.8, 1.0, 1.2), (80, 120), range(4))
    data = pd.DataFrame(cells, columns=["participant", "actor", "speed", "start", "repetition"])
    data["sex"] = np.where(data["participant"] < 10, "f", "m")
    data["walk_ratio"] = np.random.default_rng(1).normal(0.006, 0.0005, len(data))
    within = ("actor", "speed", "start")
    row("ANOVA of 22 x 96 rows", fastest(lambda: anova(data, "walk_ratio", "participant", within, "sex"), 15), 0.015)
    q, df = np.linspace(0.1, 9, 918), np.linspace(20, 200, 918)
    row("918 Tukey p values", fastest(lambda: survival(q, 24, df), 3), 1.0)


def simulation() -> None:
    """22 participants of 96 trials through the real loop and journal."""
    from experiment_app.simulated.simulate import simulate
    from protocols.study_file import read_study

    with tempfile.TemporaryDirectory() as folder:
        begun = time.perf_counter()
        for _ in simulate(read_study("walk_ratio"), 22, Path(folder)):
            pass
        row("22 simulated participants, 2112 trials with fsync (wall)", time.perf_counter() - begun, 10.0)


def help_text() -> None:
    """The command's start-up, as a whole process."""

    def start() -> float:
        begun = time.perf_counter()
        subprocess.run([sys.executable, "-m", "experiment_app", "--help"], check=True, stdout=subprocess.DEVNULL)
        return time.perf_counter() - begun

    start()
    row("gaitlab --help (wall, whole process)", min(start() for _ in range(5)), 0.4)


def main(arguments: list[str]) -> None:
    """Prints the machine and every figure, or those named, as `poses drawing rivals`; `timing [PRESSES]` alone."""
    parts = {
        part.__name__: part
        for part in (
            help_text, poses, methods, importing, timing, simulation, analysis_of_the_thesis, own_work, drawing,
            graphics_card, rivals,
        )
    }  # fmt: skip
    if arguments[:1] != ["timing"] and (unknown := set(arguments) - set(parts)):
        sys.exit(f"there is no benchmark {', '.join(sorted(unknown))}; there are: {', '.join(parts)}")
    print(machine())
    if arguments[:1] == ["timing"]:
        help_text()
        timing(int(arguments[1]) if arguments[1:] else 300)
        return
    for name, benchmark in parts.items():
        if not arguments or name in arguments:
            benchmark()


if __name__ == "__main__":
    main(sys.argv[1:])

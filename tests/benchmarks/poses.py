"""How long poses take: one walker, and a thousand that all change speed and step frequency, with feet on the ground.

The two-level tree of 25 cycles, forward kinematics, foot contact and leg IK are in every figure; weights of the tree
apart, because walkers of a constant speed need them once. (Glardon's engine took 800 µs a pose; ozz-animation, C++,
5 to 10 µs for 67 joints without foot contact.)
"""

from __future__ import annotations

import numpy as np

from stimuli.actors import load_actor
from stimuli.crowds import poses as crowd_poses
from stimuli.crowds import posing as crowd_posing
from stimuli.crowds.table import WalkTable, mixed
from stimuli.walker import drawn_pose, skin_matrices
from tests.benchmarks.measuring import fastest, row

WALKERS = 1000


def poses() -> None:
    """Prints the pose figures, with numba too where it is installed."""
    actor = load_actor("F1")
    one = fastest(lambda: skin_matrices(actor, drawn_pose(actor, 1.0, 87.0, 0.3)), 7, 200)
    row("a walker's pose and joint matrices, NumPy", one, 4e-4)
    actors = [load_actor(name) for name in ("F1", "F2", "M1", "M2")]
    table = WalkTable.of([(actor.figure, actor.table, actor.tree) for actor in actors])
    rng = np.random.default_rng(1)
    who, phases = rng.integers(0, len(actors), WALKERS), rng.random(WALKERS)
    speed, step_frequency = rng.uniform(0.8, 1.2, WALKERS), rng.uniform(80.0, 120.0, WALKERS)
    mix = mixed(table, who, speed, step_frequency)
    out = np.empty((WALKERS, 21, 2, 4), np.float32)
    weights = fastest(lambda: mixed(table, who, speed, step_frequency), 9, 20) / WALKERS
    planes = fastest(lambda: crowd_poses.many_transforms(mix, phases, out), 9, 20) / WALKERS
    row("one of 1000 walkers' poses, NumPy", planes, 5e-6)
    row("the same with the tree's weights made anew", planes + weights, 5e-6)
    if not crowd_posing.accelerated():
        print("numba is not installed (extra `fast`), so its figures are left out")
        return
    from stimuli.crowds import compiled_poses as crowd_poses_compiled

    compiled = fastest(lambda: crowd_poses_compiled.many_transforms(mix, phases, out), 9, 20) / WALKERS
    row("one of 1000 walkers' poses, numba, one thread", compiled, 1.5e-6)
    short = fastest(lambda: crowd_posing.one_walker(actor, 1.0, 87.0, 0.3), 9, 200)
    row("a walker's pose and joint matrices, numba", short, 5e-5)

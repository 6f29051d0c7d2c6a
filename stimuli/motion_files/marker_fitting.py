"""The pose of a body that fits all markers best, many frames at a time. Knows joints and points; no label, no file.

Global optimisation (Lu & O'Connor, J. Biomech. 32, 1999) by Newton's method (newton_step.py), damped in the frames
where a step would not lead down (D. W. Marquardt, J. SIAM 11, 1963). From the anatomical first guess it takes two or
three steps.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from stimuli.motion_files.marked_body import Body, Wanted
from stimuli.motion_files.newton_step import newton_step

Floats = NDArray[np.floating]

STEPS = 60
STILL = 5e-4  # m: a frame is solved once no joint moves more; all are then within 0.03 mm of where they would end
ROUNDING = 1e-11  # m², by which a cost may seem to rise
DAMPING = 1e-3  # m², the least that is worth having: a segment without markers turns as easily
EASING = 10.0  # by which damping rises after a step that was no good, and falls after one that was


def fitted(body: Body, targets: Sequence[Floats | None], centres: Floats, guess: Floats) -> tuple[Floats, Floats]:
    """World rotations (T, J, 3, 3) of the joints and the root's path (T, 3) m; arguments as in Wanted.of."""
    level, order = body.sorted()
    origin = centres[:, order[:1]]  # the root's, so that no digits are lost far from the file's origin
    near = [None if targets[joint] is None else targets[joint] - origin for joint in order]
    wanted = Wanted.of(level, near, centres[:, order] - origin, guess[:, order])
    turns = np.ascontiguousarray(np.moveaxis(guess[:, order], 0, -1))
    turns, root = _solved(level, wanted, turns)
    rotations = np.empty_like(guess)
    rotations[:, order] = np.moveaxis(turns, -1, 0)
    return rotations, root.T + origin[:, 0]


def places(body: Body, rotations: Floats, root: Floats) -> Floats:
    """(T, J, 3) m: joints by forward kinematics from rotations (T, J, 3, 3) and root (T, 3)."""
    return np.moveaxis(body.places(np.moveaxis(rotations, 0, -1), root.T), -1, 0)


def _solved(body: Body, wanted: Wanted, turns: Floats) -> tuple[Floats, Floats]:
    """Rotations (J, 3, 3, T) and root (3, T) m of least cost, from a first guess with the root at 0."""
    there = body.places(turns, np.zeros((3, turns.shape[-1])))
    rotations, root = np.empty_like(turns), np.empty_like(there[0])
    moving = np.arange(turns.shape[-1])  # frames that are not solved yet
    cost: Floats = wanted.cost(turns, there)
    damping: Floats = np.zeros(len(moving))
    for _ in range(STEPS):
        turned, moved, convex = newton_step(body, wanted, turns, there, damping)
        reached = wanted.cost(turned, moved)
        good = convex & (reached < cost + ROUNDING)
        still = good & (damping == 0) & (np.max(np.abs(moved - there), axis=(0, 1)) < STILL)
        turns, there, cost = (np.where(good, *two) for two in ((turned, turns), (moved, there), (reached, cost)))
        damping = np.where(good, damping / EASING, np.maximum(damping * EASING, DAMPING))
        damping[damping < DAMPING] = 0.0
        rotations[..., moving], root[:, moving] = turns, there[0]
        if still.all():
            break
        moving, wanted = moving[~still], wanted.frames(~still)
        turns, there, cost, damping = (np.compress(~still, v, axis=-1) for v in (turns, there, cost, damping))
    return rotations, root

"""Which way poses are made on this computer: with numba where the extra `fast` is there and works, else with NumPy."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib.util import find_spec

import numpy as np

from stimuli.actors import Actor
from stimuli.blend_tree import blend_weights
from stimuli.crowds.poses import many_transforms as planes
from stimuli.crowds.table import Mix, Singles, WalkTable
from stimuli.skeleton import Floats
from stimuli.walker import drawn_pose, skin_matrices

Poser = Callable[[Mix, Floats, Singles | None, Floats | None, Floats | None], Singles]
"""`poses.many_transforms`, in whichever way."""


@cache
def accelerated() -> bool:
    """Whether numba is there and works: it refuses a NumPy newer than itself, and folders it cannot keep code in."""
    if find_spec("numba") is None:
        return False
    try:
        import stimuli.crowds.compiled_poses  # noqa: F401
    except (ImportError, OSError, RuntimeError, SystemError):
        return False
    return True


@cache
def poser() -> Poser:
    """The fastest way there is; both give the same within 1e-4. With numba, compiled by the first call."""
    if accelerated():
        from stimuli.crowds.compiled_poses import many_transforms

        return many_transforms
    return planes


def one_walker(actor: Actor, speed: float, step_frequency: float, phase: float) -> Singles:
    """(21, 3, 4) float32 skinning matrices of one walker, as drawn_pose and skin_matrices give them.

    For programs of one's own that pose a walker many times: scenes use drawn_pose, which needs no compiling.
    speed m/s, step_frequency steps/min, phase any number. Raises CoverageError outside the actor's blend tree.
    """
    if not accelerated():
        return np.asarray(skin_matrices(actor, drawn_pose(actor, speed, step_frequency, phase)), np.float32)
    from stimuli.crowds.compiled_poses import many_transforms, matrices_of_one

    weighted = blend_weights(actor.tree, {"speed": speed, "step_frequency": step_frequency})
    table = _table_of(actor)
    cycles = np.fromiter(weighted, np.intp, len(weighted))
    weights = np.fromiter(weighted.values(), np.float64, len(weighted))
    contacts = weights @ table.contacts[cycles]
    mix = Mix(
        table=table,
        who=np.zeros(1, np.intp),
        rows=table.first_row[cycles][None],
        weights=weights.astype(np.float32)[None],
        samples=table.samples[:1],
        stance=contacts[None, :2],
        ahead=contacts[None, 2:4],
        left_strike=contacts[None, 4],
        stride=np.array([120.0 * speed / step_frequency]),
    )
    matrices: Singles = matrices_of_one(many_transforms(mix, np.array([phase]))[0])
    return matrices


@cache
def _table_of(actor: Actor) -> WalkTable:
    return WalkTable.of([(actor.figure, actor.table, actor.tree)])

"""The walks that methods start from: any actor's, default or imported, as `Cycle`s like those of a capture."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stimuli.actors import Actor
from stimuli.blend_tree import Tree, coverage, followed_step_frequency
from stimuli.cycle import PHASES, Cycle, Provenance
from stimuli.measure import poses
from stimuli.methods.making import MethodError
from stimuli.rotations import continuous
from stimuli.skeleton import JOINTS, PARENTS, Floats


def actor_walk(actor: Actor, speed: float, step_frequency: float | None = None, phases: int = PHASES) -> Cycle:
    """The actor as drawn at a speed (m/s), as a cycle of `phases` samples.

    step_frequency: steps/min; by default the actor's own walk ratio at that speed, kept inside what the actor covers.
    Raises CoverageError outside the actor's cycles.
    """
    frequency = natural_step_frequency(actor, speed) if step_frequency is None else step_frequency
    drawn = poses(actor, speed, frequency, np.arange(phases) / phases)
    stance = float(np.mean(actor.table.contacts[:, :2]))
    return Cycle(
        joints=JOINTS,
        parents=PARENTS,
        offsets=np.asarray(actor.skeleton.offsets, dtype=float),
        rotations=continuous(drawn.rotations),
        hips=drawn.hips,
        stride_length=120.0 * speed / frequency,
        stride_time=120.0 / frequency,
        stance_share=(stance, stance),
        provenance=Provenance(
            clip=f"{actor.name} at {speed:.2f} m/s",
            format=f"actor ({actor.provenance})",
            first_frame=0,
            last_frame=phases,
            frame_rate=phases * frequency / 120.0,
            pose_difference=0.0,
            seam_phase=0.0,
            rest="zero pose",
        ),
    )


def natural_step_frequency(actor: Actor, speed: float) -> float:
    """steps/min: what the captures went with, or the actor's walk ratio, SF = sqrt(60 v / WR), within the cycles."""
    return step_frequency_of(actor.tree, actor.captured_walk_ratio, speed)


def step_frequency_of(tree: Tree, walk_ratio: float, speed: float) -> float:
    """The same of somebody whose cycles need not be made for it. walk_ratio: m·min, the person's own."""
    followed = followed_step_frequency(tree, speed)
    if followed is not None:
        return followed
    frequency = float(np.sqrt(60.0 * speed / walk_ratio))
    low, high = coverage(tree).get("step_frequency", (frequency, frequency))
    return min(max(frequency, low), high)


def actor_speeds(actor: Actor, count: int = 7) -> Floats:
    """(count,) m/s, evenly over what the actor covers."""
    if count < 2:
        raise MethodError(f"{count} speed is too few to compare; give at least 2")
    low, high = coverage(actor.tree)["speed"]
    return np.linspace(low, high, count)


def actor_walks(actor: Actor, speeds: Sequence[float] | Floats, phases: int = PHASES) -> tuple[Cycle, ...]:
    """The actor as drawn at several speeds (m/s), each at its natural step frequency."""
    return tuple(actor_walk(actor, float(speed), phases=phases) for speed in speeds)

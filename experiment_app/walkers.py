"""A scene's walkers to bodies and joint matrices, ready for the renderer, and what they measure as drawn."""

from __future__ import annotations

from functools import cache

from experiment_app.render.drawn import DrawnWalker
from experiment_app.scene import Scene, Walker
from stimuli.actors import Actor, load_actor
from stimuli.bodies import load_body, scaled
from stimuli.body import Body
from stimuli.measure import delivered_gait
from stimuli.walker import drawn_pose, skin_matrices


@cache
def cast(actor: str, body: str) -> tuple[Actor, Body]:
    """The actor, and the body at the actor's height that wears the motion; body "" is the actor's own.

    Raises ActorError or BodyError for a name that is not known.
    """
    chosen = load_actor(actor, load_body(body)) if body else load_actor(actor)
    return chosen, scaled(load_body(chosen.body), chosen.height)


def drawn_walkers(scene: Scene) -> tuple[DrawnWalker, ...]:
    """Every walker of the scene with the matrices of its pose, in the world at its place and distance."""
    return tuple(_drawn(walker, scene.ground == "treadmill") for walker in scene.walkers)


def _drawn(walker: Walker, on_the_spot: bool) -> DrawnWalker:
    actor, body = cast(walker.actor, walker.body)
    pose = drawn_pose(actor, walker.speed, walker.step_frequency, walker.phase)
    x, z = walker.place
    return DrawnWalker(body, skin_matrices(actor, pose), (x, 0.0, z if on_the_spot else z + walker.distance))


def measured_gait(scene: Scene) -> dict[str, float]:
    """Speed (m/s), step frequency (steps/min), step length (m), walk ratio (m·min) and foot slide (mm) as drawn.

    Of the scene's first walker; empty without one.
    """
    if not scene.walkers:
        return {}
    walker = scene.walkers[0]
    gait = delivered_gait(cast(walker.actor, walker.body)[0], walker.speed, walker.step_frequency)
    return {
        "speed": gait.speed,
        "step_frequency": gait.step_frequency,
        "step_length": gait.step_length,
        "walk_ratio": gait.walk_ratio,
        "slide_mean_mm": gait.slide_mean,
        "slide_peak_mm": gait.slide_peak,
    }

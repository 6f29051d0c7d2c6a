"""Walks of a study in which an imported body's legs are too short for the step, so that its feet slide."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from experiment_app.checking.coverage import walks_of
from experiment_app.staging import making_of
from protocols.stimulus import Walk
from protocols.study import Study


@dataclass(frozen=True)
class _Slide:
    walk: Walk
    step_frequency: float  # steps/min
    size: float  # mm


def sliding_bodies(study: Study) -> Iterator[str]:
    """A sentence for every imported body of a study whose feet slide, with the walk in which they slide most."""
    from stimuli.bodies.imported_bodies import imported_names
    from stimuli.bodies.retarget import SLIDES

    imported = imported_names()
    walks = [walk for walk in walks_of(study) if walk.body in imported and making_of(walk) is None]
    for body in dict.fromkeys(walk.body for walk in walks):
        slides = [_slide(walk) for walk in walks if walk.body == body]
        sliding = [slide for slide in slides if slide.size > SLIDES]
        if sliding:
            most = max(sliding, key=lambda slide: slide.size)
            yield (
                f"the feet of {body} slide in {len(sliding)} of the {len(slides)} walks at the ends of what is shown, "
                f"most by {most.size / 10:.0f} cm a step (actor {most.walk.actor}, {most.walk.speed:g} m/s, "
                f"{most.step_frequency:.0f} steps/min): its legs are too short for these steps."
            )


def _slide(walk: Walk) -> _Slide:
    """How far a foot slides in a walk as captured, measured on what is drawn."""
    from experiment_app.scene import Scene, Walker
    from experiment_app.walkers import measured_gait, own_step_frequency

    step_frequency = walk.step_frequency or own_step_frequency(walk.actor, walk.body, None, walk.speed)
    scene = Scene((Walker(walk.actor, walk.speed, step_frequency, 0.0, body=walk.body),))
    return _Slide(walk, step_frequency, measured_gait(scene)["slide_peak_mm"])

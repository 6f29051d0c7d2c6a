"""Walks of a study that cannot be: speeds outside what an actor can walk at, and walks that no method makes so.

A mistake stands where its cause is: at the speed where the actor as captured cannot walk at it either, else at the
value of the making without which the walk could be made.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace

from experiment_app.staging import OWN_WAY, making_of
from protocols.mistakes.mistake import Mistake, Place
from protocols.mistakes.shown import Shown, shown_trials, value_place
from protocols.stimulus import MakingPart, Walk
from protocols.study import Study


def coverage_mistakes(study: Study) -> Iterator[Mistake]:
    """Every place of the study that makes a walk impossible, once, with why."""
    known: dict[Walk, str] = {}
    found: set[Place] = set()
    for shown in shown_trials(study):
        for walk in study.task.extremes(study.stimulus, shown.levels):
            if walk.crowd is not None:
                continue
            if walk not in known:
                known[walk] = _why_not(walk)
            place = _cause(study, shown, walk) if known[walk] else ()
            if place and place not in found:
                found.add(place)
                yield Mistake(place, f"actor {walk.actor}: {known[walk]}")


def walks_of(study: Study) -> Iterator[Walk]:
    """Every walk at the ends of what a trial can show, once; crowds left out."""
    known: set[Walk] = set()
    for shown in shown_trials(study):
        for walk in study.task.extremes(study.stimulus, shown.levels):
            if walk.crowd is None and walk not in known:
                known.add(walk)
                yield walk


def _why_not(walk: Walk) -> str:
    """Why a walk cannot be, as a sentence; "" when it can."""
    from experiment_app.walkers import cast, own_step_frequency
    from stimuli.actors import tree_of
    from stimuli.blend_tree import blend_weights

    try:
        if _has_imported(walk):
            cast(walk.actor, walk.body)
        making = making_of(walk)
        own = own_step_frequency(walk.actor, walk.body, making, walk.speed)
        if making is None:
            blend_weights(tree_of(walk.actor), {"speed": walk.speed, "step_frequency": walk.step_frequency or own})
    except ValueError as error:
        return str(error)
    return ""


def _has_imported(walk: Walk) -> bool:
    """Whether a walk is to be tried: gaitlab's own actors wear all of its bodies, imported files may be damaged."""
    from stimuli import actor_library
    from stimuli.bodies import imported_bodies

    return walk.actor in actor_library.imported_names() or walk.body in imported_bodies.imported_names()


def _cause(study: Study, shown: Shown, walk: Walk) -> Place:
    """Where the value stands that makes a walk impossible."""
    of = _alternative(study, shown, walk)
    own = getattr(study.task, "alternatives", {}).get(of)
    if walk.making == OWN_WAY or _why_not(replace(walk, making=OWN_WAY)):
        if own is not None and own.speed is not None:
            return value_place(study, shown, own.speed, ("task", "alternatives", of, "speed"))
        return value_place(study, shown, study.stimulus.speed, ("stimulus", "speed"))
    makings: list[tuple[MakingPart | None, Place]] = [
        (own.making if own is not None else None, ("task", "alternatives", of, "making")),
        (study.stimulus.making, ("stimulus", "making")),
    ]
    given = [(making, place) for making, place in makings if making is not None]
    for making, place in given:
        for name in _in_doubt(making):
            mended = replace(walk, making=replace(walk.making, **{name: getattr(OWN_WAY, name)}))
            if not _why_not(mended):
                return value_place(study, shown, getattr(making, name), (*place, name))
    return given[0][1]


def _in_doubt(given: MakingPart) -> list[str]:
    """The values that a making gives, the method last: without it any walk is as captured."""
    names = [field.name for field in fields(OWN_WAY) if field.name in given.model_fields_set]
    return sorted(names, key=lambda name: name == "method")


def _alternative(study: Study, shown: Shown, walk: Walk) -> str:
    """The name of the alternative that a walk is of; "" where there is one walk only."""
    walks = study.task.walks(study.stimulus, shown.levels)
    return next((name for name, one in walks.items() if one == walk), "")

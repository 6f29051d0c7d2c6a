"""Mistakes that no single value shows: references to factors that do not exist, levels out of range.

Each check returns Mistakes with their place; knows no actor or body (see experiment_app.checking.check).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from itertools import product
from typing import Any

from protocols.mistakes.mistake import Mistake, Place, no_such
from protocols.mistakes.order_mistakes import order_mistakes
from protocols.mistakes.planned_analysis import analysis_mistakes
from protocols.mistakes.table_columns import taken_columns
from protocols.mistakes.views import view_mistakes
from protocols.orders.assignment import groups
from protocols.orders.design import conditions
from protocols.parts import Level
from protocols.setting import Given, lacking, references, setting_mistakes, unfit
from protocols.stimulus import Walk
from protocols.study import ChoiceQuestion, Study

OR_ASSIGNED = "; or name it in participants.assigned, and the program assigns it"

MOST_TRIALS = 10_000
"""Trials a run may have; more is a slip of the keyboard."""


def inconsistencies(study: Study) -> list[Mistake]:
    """Every contradiction inside a study, in no particular order; an empty list when there is none."""
    if incomplete := list(_stimulus(study)):
        return incomplete
    return [
        *_levels(study),
        *_references(study),
        *_practice(study),
        *study.task.mistakes(study),
        *_between(study),
        *order_mistakes(study),
        *analysis_mistakes(study),
        *_questions(study),
        *view_mistakes(study),
    ]


def settings_of(study: Study) -> Iterator[Given]:
    """Every setting of the stimulus and the task, with its place and the type of its values."""
    yield from study.stimulus.settings(("stimulus",))
    yield from study.task.settings(("task",))


def referred_factors(study: Study) -> dict[str, Place]:
    """Factors that the stimulus and the task depend on, and where."""
    return {factor: place for setting, place, _ in settings_of(study) for factor in references(setting)}


def shown_walks(study: Study) -> set[Walk]:
    """Every walk that the study's conditions and training trials show."""
    return _walks(study, [*conditions(study), *(trial.levels for trial in study.practice)])


def _walks(study: Study, trials: Iterable[Mapping[str, Level]]) -> set[Walk]:
    """The walks of trials with these levels; none where a setting has no value, which has a sentence of its own."""
    walks: set[Walk] = set()
    for levels, group in product(list(trials), groups(study)):
        try:
            walks.update(study.task.walks(study.stimulus, {**group, **levels}).values())
        except (KeyError, ValueError):
            continue
    return walks


def _stimulus(study: Study) -> Iterator[Mistake]:
    """One actor with a speed, or a crowd; not both."""
    look = study.stimulus
    if look.crowd is None:
        changed = [name for name, a in getattr(study.task, "alternatives", {}).items() if a.crowd is not None]
        for name in changed:
            yield Mistake(("task", "alternatives", name, "crowd"), "there is no stimulus.crowd that it could change")
        for key in ("actor", "speed"):
            if getattr(look, key) is None:
                yield Mistake(("stimulus",), f"{key} is missing; it can be left out with a crowd only")
        return
    for key in ("actor", "speed", "body", "making"):
        if getattr(look, key) is not None:
            yield Mistake(("stimulus", key), "a crowd has its own people and speeds; remove this, or the crowd")
    if study.task.kind == "adjustment":
        yield Mistake(("task", "kind"), "a crowd has no step frequency to adjust; choose choice or rating")


def _levels(study: Study) -> Iterator[Mistake]:
    placed = study.order.placed_factor
    trials = study.repetitions * math.prod(len(levels) for name, levels in study.factors.items() if name != placed)
    if trials > MOST_TRIALS:
        yield Mistake(("repetitions",), f"the design has {trials} trials; at most {MOST_TRIALS} fit a run")
    taken = taken_columns(study)
    for factor, levels in study.factors.items():
        if factor in taken:
            yield Mistake(("factors", factor), "is the name of a column of the tables; rename the factor", on_key=True)
        for i, level in enumerate(levels):
            if level in levels[:i] or str(level) in map(str, levels[:i]):
                yield Mistake(("factors", factor, i), f"level {level} stands twice; remove one")
        if factor in study.participants.between:
            yield Mistake(("factors", factor), "is also a between-participant factor; rename one", on_key=True)


def _references(study: Study) -> Iterator[Mistake]:
    found: dict[Place, Mistake] = {}
    factors: dict[str, list[Level]] = {**study.factors}
    factors.update({name: [*study.participants.between.get(name, [])] for name in study.participants.assigned})
    observers = study.simulation
    simulated = [
        *observers.choice.settings(("simulation", "choice")),
        *observers.rating.settings(("simulation", "rating")),
    ]
    for given in [*settings_of(study), *simulated]:
        for mistake in setting_mistakes(given, factors):
            found.setdefault(mistake.where, mistake)
    yield from found.values()


def _practice(study: Study) -> Iterator[Mistake]:
    needed = referred_factors(study)
    for i, trial in enumerate(study.practice):
        for factor in needed:
            if factor in study.factors and factor not in trial.levels:
                yield Mistake(("practice", i), f"{factor} is missing; a training trial sets {', '.join(needed)}")
        for factor, level in trial.levels.items():
            where: Place = ("practice", i, factor)
            if factor not in study.factors:
                yield Mistake(where, no_such(factor, study.factors, "factor"), on_key=True)
            else:
                yield from _training_level(study, factor, level, where)
        yield from _without_value(study, trial.levels, ("practice", i))


def _training_level(study: Study, factor: str, level: Any, where: Place) -> Iterator[Mistake]:
    """A training trial may have levels of its own, of the kind that the factor has and the settings take."""
    if all(isinstance(known, (int, float)) for known in study.factors[factor]):
        if isinstance(level, bool) or not isinstance(level, (int, float)) or not math.isfinite(level):
            yield Mistake(where, f"{level!r} is not a number")
            return
    elif all(isinstance(known, str) for known in study.factors[factor]) and not isinstance(level, str):
        if not any(
            setting == f"${factor}" and not list(unfit(level, kind, where, place))
            for setting, place, kind in settings_of(study)
        ):  # else the factor's own levels are the mistake
            yield Mistake(where, f"{level!r} is not a name")
        return
    for setting, place, kind in settings_of(study):
        if setting == f"${factor}":
            yield from unfit(level, kind, where, place)
            return


def _without_value(study: Study, levels: Mapping[str, Level], where: Place) -> Iterator[Mistake]:
    """The first table of a setting without a value for a level of a training trial, for each factor."""
    found: dict[str, Mistake] = {}
    for (setting, place, _), group in product(list(settings_of(study)), groups(study)):
        for factor, level, known in lacking(setting, {**group, **levels}):
            name = ".".join(map(str, place))
            message = f"{level} has no value in {name}, which has {', '.join(map(str, known))}; add one there"
            found.setdefault(factor, Mistake((*where, factor), message))
    yield from found.values()


def _choices(study: Study) -> dict[str, ChoiceQuestion]:
    return {q.id: q for q in study.participants.questions if isinstance(q, ChoiceQuestion)}


def _between(study: Study) -> Iterator[Mistake]:
    choices = _choices(study)
    for factor, levels in study.participants.between.items():
        where: Place = ("participants", "between", factor)
        for i, level in enumerate(levels):
            if level in levels[:i]:
                yield Mistake((*where, i), f"level {level} stands twice; remove one")
        if factor in study.participants.assigned:
            if factor in taken_columns(study):
                yield Mistake(where, "is the name of a column of the tables; rename the factor", on_key=True)
            continue
        if factor not in choices:
            yield Mistake(where, no_such(factor, choices, "choice question") + OR_ASSIGNED, on_key=True)
            continue
        for i, level in enumerate(levels):
            if level not in choices[factor].options:
                yield Mistake((*where, i), no_such(level, choices[factor].options, f"option of {factor}"))


def _questions(study: Study) -> Iterator[Mistake]:
    taken: set[str] = {*study.factors, *taken_columns(study)}
    for i, question in enumerate(study.participants.questions):
        if question.id in taken:
            where: Place = ("participants", "questions", i, "id")
            yield Mistake(where, f"{question.id} is already the name of a question, factor or column")
        taken.add(question.id)
        if question.kind == "number" and question.minimum > question.maximum:
            where = ("participants", "questions", i, "minimum")
            yield Mistake(where, f"{question.minimum} is above maximum {question.maximum}")
    if "preferred_walk_ratio" in study.simulation.model_fields_set:
        for name in sorted({walk.actor for walk in _walks(study, conditions(study)) if walk.crowd is None}):
            if name not in study.simulation.preferred_walk_ratio:
                yield Mistake(("simulation", "preferred_walk_ratio"), f"actor {name} is missing", on_key=True)

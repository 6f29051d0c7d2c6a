"""Mistakes that no single value shows: references to factors that do not exist, levels out of range.

Each check returns Mistakes with their place; knows no actor or body (see experiment_app.check).
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from protocols.order import AdaptiveOrder
from protocols.order_mistakes import order_mistakes
from protocols.planned_analysis import analysis_mistakes, no_such
from protocols.study import ChoiceQuestion, Study
from protocols.study_file import Mistake, Place
from protocols.viewing import viewing_mistakes

TAKEN_COLUMNS = frozenset({"study", "participant", "run", "trial", "block", "repetition"})
"""Columns that every table of trials has."""

OR_ASSIGNED = "; or name it in participants.assigned, and the program assigns it"

MOST_TRIALS = 10_000
"""Trials a run may have; more is a slip of the keyboard."""


def inconsistencies(study: Study) -> list[Mistake]:
    """Every contradiction inside a study, in no particular order; an empty list when there is none."""
    return [
        *_levels(study),
        *_references(study),
        *_practice(study),
        *_range(study),
        *_between(study),
        *order_mistakes(study),
        *analysis_mistakes(study),
        *_questions(study),
        *(Mistake(place, message) for place, message in viewing_mistakes(study.stimulus, study.display)),
    ]


def referred_factors(study: Study) -> dict[str, Place]:
    """Factors that the stimulus and the task refer to with `$factor`, and where they do."""
    places: list[tuple[object, Place]] = [
        (study.stimulus.actor, ("stimulus", "actor")),
        (study.stimulus.speed, ("stimulus", "speed")),
        (study.stimulus.body, ("stimulus", "body")),
        (study.task.start, ("task", "start")),
    ]
    return {value[1:]: place for value, place in places if isinstance(value, str) and value.startswith("$")}


def _levels(study: Study) -> Iterator[Mistake]:
    placed = study.order.of if isinstance(study.order, AdaptiveOrder) else None
    trials = study.repetitions * math.prod(len(levels) for name, levels in study.factors.items() if name != placed)
    if trials > MOST_TRIALS:
        yield Mistake(("repetitions",), f"the design has {trials} trials; at most {MOST_TRIALS} fit a run")
    for factor, levels in study.factors.items():
        if factor in TAKEN_COLUMNS:
            yield Mistake(("factors", factor), "is the name of a column of the tables; rename the factor", on_key=True)
        for i, level in enumerate(levels):
            if level in levels[:i] or str(level) in map(str, levels[:i]):
                yield Mistake(("factors", factor, i), f"level {level} stands twice; remove one")
        if factor in study.participants.between:
            yield Mistake(("factors", factor), "is also a between-participant factor; rename one", on_key=True)


def _references(study: Study) -> Iterator[Mistake]:
    for factor, place in referred_factors(study).items():
        if factor not in study.factors and factor not in study.participants.assigned:
            yield Mistake(place, no_such(f"${factor}", [f"${f}" for f in study.factors], "factor"))
    for place, value in (
        (("stimulus", "speed"), study.stimulus.speed),
        (("task", "start"), study.task.start),
    ):
        if isinstance(value, str) and value[1:] in study.factors:
            for i, level in enumerate(study.factors[value[1:]]):
                if not isinstance(level, (int, float)):
                    message = f"{level!r} is not a number, and {'.'.join(place)} takes it from here"
                    yield Mistake(("factors", value[1:], i), message)
                elif level <= 0:
                    yield Mistake(("factors", value[1:], i), f"{level} must be more than 0")


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
            elif all(isinstance(known, (int, float)) for known in study.factors[factor]):
                if isinstance(level, bool) or not isinstance(level, (int, float)) or not math.isfinite(level):
                    yield Mistake(where, f"{level!r} is not a number")
                elif level <= 0:
                    yield Mistake(where, f"{level} must be more than 0")
            elif all(isinstance(known, str) for known in study.factors[factor]) and not isinstance(level, str):
                yield Mistake(where, f"{level!r} is not a name")


def _range(study: Study) -> Iterator[Mistake]:
    reach = study.task.range
    if reach.minimum >= reach.maximum:
        yield Mistake(("task", "range"), f"minimum {reach.minimum:g} is not below maximum {reach.maximum:g}")
        return
    inside = f"outside the range {reach.minimum:g} to {reach.maximum:g} steps/min of task.range"
    start = study.task.start
    if isinstance(start, str):
        for i, level in enumerate(study.factors.get(start[1:], [])):
            if isinstance(level, (int, float)) and not reach.minimum <= level <= reach.maximum:
                yield Mistake(("factors", start[1:], i), f"{level} is {inside}")
        for i, trial in enumerate(study.practice):
            given = trial.levels.get(start[1:])
            if isinstance(given, (int, float)) and not reach.minimum <= given <= reach.maximum:
                yield Mistake(("practice", i, start[1:]), f"{given} is {inside}")
    elif not reach.minimum <= start <= reach.maximum:
        yield Mistake(("task", "start"), f"{start:g} is {inside}")
    keys = study.task.keys
    told = " ".join(page.text for page in [*study.pages.instructions, study.pages.before_practice] if page)
    if keys.counterbalanced and not ("{lower}" in told and "{raise}" in told):
        message = "the instructions must name the keys as {lower} and {raise}, which differ between participants"
        yield Mistake(("task", "keys", "counterbalanced"), message)
    used: dict[str, str] = {}
    for name, key in (("lower", keys.lower), ("raise", keys.raise_), ("confirm", keys.confirm),
                      ("break", keys.take_break)):  # fmt: skip
        if key == "escape":
            yield Mistake(("task", "keys", name), "escape is kept for the pause page; choose another key")
        if key in used:
            yield Mistake(("task", "keys", name), f"{key} is also the key for {used[key]}; choose another")
        used[key] = name


def _choices(study: Study) -> dict[str, ChoiceQuestion]:
    return {q.id: q for q in study.participants.questions if isinstance(q, ChoiceQuestion)}


def _between(study: Study) -> Iterator[Mistake]:
    choices = _choices(study)
    for factor, levels in study.participants.between.items():
        where: Place = ("participants", "between", factor)
        if factor in study.participants.assigned:
            continue
        if factor not in choices:
            yield Mistake(where, no_such(factor, choices, "choice question") + OR_ASSIGNED, on_key=True)
            continue
        for i, level in enumerate(levels):
            if level not in choices[factor].options:
                yield Mistake((*where, i), no_such(level, choices[factor].options, f"option of {factor}"))


def _questions(study: Study) -> Iterator[Mistake]:
    taken: set[str] = {*study.factors, *TAKEN_COLUMNS}
    for i, question in enumerate(study.participants.questions):
        if question.id in taken:
            where: Place = ("participants", "questions", i, "id")
            yield Mistake(where, f"{question.id} is already the name of a question, factor or column")
        taken.add(question.id)
        if question.kind == "number" and question.minimum > question.maximum:
            where = ("participants", "questions", i, "minimum")
            yield Mistake(where, f"{question.minimum} is above maximum {question.maximum}")
    if "preferred_walk_ratio" in study.simulation.model_fields_set:
        actor = study.stimulus.actor
        actors = study.factors.get(actor[1:], []) if actor.startswith("$") else [actor]
        for name in actors:
            if str(name) not in study.simulation.preferred_walk_ratio:
                yield Mistake(("simulation", "preferred_walk_ratio"), f"actor {name} is missing", on_key=True)

"""Mistakes that no single value shows: references to factors that do not exist, levels out of range.

Each check returns Mistakes with their place; knows no actor or body (see experiment_app.check).
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Iterator

from protocols.study import ChoiceQuestion, Study
from protocols.study_file import Mistake, Place

RESPONSE_COLUMNS = ("walk_ratio", "step_frequency", "step_length", "response_time")
"""Columns of a trial that an exclusion may name, besides the factors and the frame counts."""


def inconsistencies(study: Study) -> list[Mistake]:
    """Every contradiction inside a study, in no particular order; an empty list when there is none."""
    return [
        *_levels(study),
        *_references(study),
        *_practice(study),
        *_range(study),
        *_between(study),
        *_planned_analysis(study),
        *_questions(study),
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


def _unknown(name: str, known: Iterable[str], what: str) -> str:
    known = list(known)
    near = difflib.get_close_matches(name, known, n=1)
    way = f"did you mean {near[0]}?" if near else f"there are: {', '.join(known) or 'none'}"
    return f"{name} is no {what}; {way}"


def _levels(study: Study) -> Iterator[Mistake]:
    for factor, levels in study.factors.items():
        seen: set[str] = set()
        for i, level in enumerate(levels):
            if isinstance(level, bool):
                yield Mistake(("factors", factor, i), f"{level} is not a level; write it in quotes")
            if str(level) in seen:
                yield Mistake(("factors", factor, i), f"level {level} stands twice; remove one")
            seen.add(str(level))
        if factor in study.participants.between:
            yield Mistake(("factors", factor), "is also a between-participant factor; rename one", on_key=True)


def _references(study: Study) -> Iterator[Mistake]:
    for factor, place in referred_factors(study).items():
        if factor not in study.factors:
            yield Mistake(place, _unknown(f"${factor}", [f"${f}" for f in study.factors], "factor"))
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
                yield Mistake(where, _unknown(factor, study.factors, "factor"), on_key=True)
            elif all(isinstance(known, (int, float)) for known in study.factors[factor]):
                if isinstance(level, bool) or not isinstance(level, (int, float)):
                    yield Mistake(where, f"{level!r} is not a number")
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
        if factor not in choices:
            yield Mistake(where, _unknown(factor, choices, "choice question"), on_key=True)
            continue
        for i, level in enumerate(levels):
            if level not in choices[factor].options:
                yield Mistake((*where, i), _unknown(level, choices[factor].options, f"option of {factor}"))


def _planned_analysis(study: Study) -> Iterator[Mistake]:
    plan = study.analysis
    within, between = list(study.factors), list(study.participants.between)
    for kind, names, known in (
        ("within", plan.anova.within, within),
        ("between", plan.anova.between, between),
    ):
        for i, name in enumerate(names):
            if name not in known:
                yield Mistake(("analysis", "anova", kind, i), _unknown(name, known, f"{kind} factor"))
            elif kind == "within" and len(study.factors[name]) < 2:
                yield Mistake(("analysis", "anova", kind, i), f"{name} has one level; a factor needs two")
    for i, test in enumerate(plan.t_tests):
        if test.each not in study.factors:
            yield Mistake(("analysis", "t_tests", i, "each"), _unknown(test.each, within, "factor"))
            continue
        levels = [str(level) for level in study.factors[test.each]]
        without = [level for level in levels if level not in test.against]
        for level in test.against:
            # values for levels that are not shown do no harm, unless one of them may be misspelt
            if level not in levels and without:
                message = _unknown(level, levels, f"level of {test.each}")
                yield Mistake(("analysis", "t_tests", i, "against", level), message, on_key=True)
    labels = [test.label for test in plan.t_tests]
    for i, figure in enumerate(plan.figures):
        for field, factor in (("x", figure.x), ("lines", figure.lines)):
            if factor is not None and factor not in within + between:
                yield Mistake(("analysis", "figures", i, field), _unknown(factor, within + between, "factor"))
        if figure.kind == "interaction" and figure.lines is None:
            yield Mistake(("analysis", "figures", i), "an interaction needs lines: the factor drawn as lines")
        if figure.reference is not None and figure.reference not in labels:
            where: Place = ("analysis", "figures", i, "reference")
            yield Mistake(where, _unknown(figure.reference, labels, "label of a t-test"))
    columns = [*RESPONSE_COLUMNS, *within, *between, "late_frames", "key_presses", "reversals"]
    for i, exclusion in enumerate(plan.exclusions):
        parts = re.fullmatch(r"\s*(\w+)\s*(<=|>=|==|!=|<|>)\s*(\S.*?)\s*", exclusion.where)
        where = ("analysis", "exclusions", i, "where")
        if parts is None:
            yield Mistake(where, f"{exclusion.where!r} is no condition; write one as `late_frames > 5`")
        elif parts[1] not in columns:
            yield Mistake(where, _unknown(parts[1], columns, "column"))


def _questions(study: Study) -> Iterator[Mistake]:
    taken: set[str] = {*study.factors, "study", "participant", "run", "trial", "block", "repetition"}
    for i, question in enumerate(study.participants.questions):
        if question.id in taken:
            where: Place = ("participants", "questions", i, "id")
            yield Mistake(where, f"{question.id} is already the name of a question, factor or column")
        taken.add(question.id)
        if question.kind == "number" and question.minimum > question.maximum:
            where = ("participants", "questions", i, "minimum")
            yield Mistake(where, f"{question.minimum} is above maximum {question.maximum}")
    if study.simulation is not None:
        actor = study.stimulus.actor
        actors = study.factors.get(actor[1:], []) if actor.startswith("$") else [actor]
        for name in actors:
            if str(name) not in study.simulation.preferred_walk_ratio:
                yield Mistake(("simulation", "preferred_walk_ratio"), f"actor {name} is missing", on_key=True)

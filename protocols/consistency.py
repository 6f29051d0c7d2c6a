"""Mistakes that no single value shows: references to factors that do not exist, levels out of range.

Each check returns Mistakes with their place; knows no actor or body (see experiment_app.check).
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterable, Iterator

from protocols.study import ChoiceQuestion, FurtherAnalysis, Study
from protocols.study_file import Mistake, Place

TAKEN_COLUMNS = frozenset({"study", "participant", "run", "trial", "block", "repetition"})
"""Columns that every table of trials has."""

MOST_TRIALS = 10_000
"""Trials a run may have; more is a slip of the keyboard."""

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
    trials = study.repetitions * math.prod(len(levels) for levels in study.factors.values())
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
        if factor not in choices:
            yield Mistake(where, _unknown(factor, choices, "choice question"), on_key=True)
            continue
        for i, level in enumerate(levels):
            if level not in choices[factor].options:
                yield Mistake((*where, i), _unknown(level, choices[factor].options, f"option of {factor}"))


def _planned_analysis(study: Study) -> Iterator[Mistake]:
    """Factors, levels and columns that the planned analysis, or one of those in `also`, names in vain."""
    measures: set[str] = set()
    top: Place = ("analysis",)
    for at, plan in [(top, study.analysis), *(((*top, "also", i), p) for i, p in enumerate(study.analysis.also))]:
        if plan.measure in measures:
            yield Mistake((*at, "measure"), f"{plan.measure} is analysed twice; put all its tests into one analysis")
        measures.add(plan.measure)
        yield from _measure(study, plan, at)
        yield from _factors_of_tests(study, plan, at)
        yield from _t_tests(study, plan, at)
        yield from _equivalence_and_regression(study, plan, at)
        yield from _figures(study, plan, at)
    columns = [
        *RESPONSE_COLUMNS,
        *study.factors,
        *study.participants.between,
        "late_frames",
        "key_presses",
        "reversals",
    ]
    for i, exclusion in enumerate(study.analysis.exclusions):
        parts = re.fullmatch(r"\s*(\w+)\s*(<=|>=|==|!=|<|>)\s*(\S.*?)\s*", exclusion.where)
        where: Place = ("analysis", "exclusions", i, "where")
        if parts is None:
            yield Mistake(where, f"{exclusion.where!r} is no condition; write one as `late_frames > 5`")
        elif parts[1] not in columns:
            yield Mistake(where, _unknown(parts[1], columns, "column"))


def _covered(study: Study, where: Place, given: Iterable[str], factor: str, what: str) -> Iterator[Mistake]:
    known = list(given)
    missing = [str(level) for level in study.factors[factor] if str(level) not in known]
    if missing:
        yield Mistake(where, f"{what} of {', '.join(missing)} is missing; give one for every level of {factor}")


def _measure(study: Study, plan: FurtherAnalysis, at: Place) -> Iterator[Mistake]:
    actor = study.stimulus.actor
    if plan.measure != "normalised_walk_ratio":
        if plan.heights is not None:
            yield Mistake((*at, "heights"), f"{plan.measure} needs no heights; remove them", on_key=True)
    elif plan.heights is None:
        yield Mistake((*at, "measure"), "normalised_walk_ratio needs heights: the height of every actor in m")
    elif actor.startswith("$") and actor[1:] in study.factors:
        yield from _covered(study, (*at, "heights"), plan.heights, actor[1:], "the height")
    elif not actor.startswith("$") and actor not in plan.heights:
        yield Mistake((*at, "heights"), f"the height of {actor} is missing")
    if plan.measure == "confusion_rate" and study.task.kind == "adjustment":
        message = "confusion_rate needs trials in which one of two walks is chosen; in adjustment trials none is"
        yield Mistake((*at, "measure"), message)


def _factors_of_tests(study: Study, plan: FurtherAnalysis, at: Place) -> Iterator[Mistake]:
    within, between = list(study.factors), list(study.participants.between)
    named = [
        (("anova", "within"), plan.anova.within, within, "within factor"),
        (("anova", "between"), plan.anova.between, between, "between factor"),
    ]
    if (ranks := plan.aligned_rank_transform) is not None:
        part = "aligned_rank_transform"
        named += [
            ((part, "within"), ranks.within, within, "within factor"),
            ((part, "between"), ranks.between, between, "between factor"),
        ]
        if not ranks.within + ranks.between:
            yield Mistake((*at, part), "name at least one factor, within or between")
    if (mixed := plan.mixed_model) is not None:
        named.append((("mixed_model", "factors"), mixed.factors, within + between, "factor"))
        if mixed.stimulus not in within:
            yield Mistake((*at, "mixed_model", "stimulus"), _unknown(mixed.stimulus, within, "within factor"))
        elif mixed.stimulus in mixed.factors:
            message = f"{mixed.stimulus} is the random stimulus already; leave it out of the factors"
            yield Mistake((*at, "mixed_model", "factors"), message)
    for place, names, known, what in named:
        for i, name in enumerate(names):
            if name not in known:
                yield Mistake((*at, *place, i), _unknown(name, known, what))
            elif name in study.factors and len(study.factors[name]) < 2:
                yield Mistake((*at, *place, i), f"{name} has one level; a factor needs two")
            elif name in names[:i]:
                yield Mistake((*at, *place, i), f"{name} stands twice; remove one")


def _t_tests(study: Study, plan: FurtherAnalysis, at: Place) -> Iterator[Mistake]:
    for i, test in enumerate(plan.t_tests):
        if test.each not in study.factors:
            yield Mistake((*at, "t_tests", i, "each"), _unknown(test.each, study.factors, "factor"))
            continue
        levels = [str(level) for level in study.factors[test.each]]
        without = [level for level in levels if level not in test.against]
        for level in test.against:
            # values for levels that are not shown do no harm, unless one of them may be misspelt
            if level not in levels and without:
                message = _unknown(level, levels, f"level of {test.each}")
                yield Mistake((*at, "t_tests", i, "against", level), message, on_key=True)


def _equivalence_and_regression(study: Study, plan: FurtherAnalysis, at: Place) -> Iterator[Mistake]:
    in_anova = plan.anova.within + plan.anova.between
    for i, same in enumerate(plan.equivalence):
        for field, factor in (("factor", same.factor), ("by", same.by)):
            if factor is not None and factor not in in_anova:
                yield Mistake((*at, "equivalence", i, field), _unknown(factor, in_anova, "factor of the anova"))
        if same.by == same.factor:
            yield Mistake((*at, "equivalence", i, "by"), f"{same.by} is the factor compared; name another or none")
    if plan.regression is None:
        return
    of, on = plan.regression.of, plan.regression.on
    if of not in study.factors:
        yield Mistake((*at, "regression", "of"), _unknown(of, study.factors, "within factor"))
        return
    for name, values in on.items():
        yield from _covered(study, (*at, "regression", "on", name), values, of, f"the {name}")
    cases, needed = len(study.factors[of]), len(on) + 2
    if cases < needed:
        message = f"{cases} levels of {of} are too few for {len(on)} predictors; at least {needed} are needed"
        yield Mistake((*at, "regression", "on"), message)


def _figures(study: Study, plan: FurtherAnalysis, at: Place) -> Iterator[Mistake]:
    factors, labels = [*study.factors, *study.participants.between], [test.label for test in plan.t_tests]
    for i, figure in enumerate(plan.figures):
        where: Place = (*at, "figures", i)
        for field, factor in (("x", figure.x), ("lines", figure.lines)):
            if factor is not None and factor not in factors:
                yield Mistake((*where, field), _unknown(factor, factors, "factor"))
        if figure.kind in ("means", "interaction", "raincloud") and figure.x is None:
            yield Mistake(where, f"a figure of kind {figure.kind} needs x: the factor on the x axis")
        if figure.kind == "interaction" and figure.lines is None:
            yield Mistake(where, "an interaction needs lines: the factor drawn as lines")
        if figure.reference is not None and figure.reference not in labels:
            yield Mistake((*where, "reference"), _unknown(figure.reference, labels, "label of a t-test"))


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
    if study.simulation is not None:
        actor = study.stimulus.actor
        actors = study.factors.get(actor[1:], []) if actor.startswith("$") else [actor]
        for name in actors:
            if str(name) not in study.simulation.preferred_walk_ratio:
                yield Mistake(("simulation", "preferred_walk_ratio"), f"actor {name} is missing", on_key=True)

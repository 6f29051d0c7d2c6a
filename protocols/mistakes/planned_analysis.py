"""Mistakes in the planned analysis of a study file: factors, levels, labels and columns it names in vain."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from protocols.gaze import REGIONS
from protocols.mistakes.measure_ranges import unreachable
from protocols.mistakes.mistake import Mistake, Place, no_such
from protocols.mistakes.planned_tests import Columns, anova_factor_mistakes, test_mistakes
from protocols.mistakes.possible import Possible, Span, condition_mistakes
from protocols.mistakes.table_columns import COUNTS, taken_columns
from protocols.study import FurtherAnalysis, Level, Study

GAZE_SHARE = "gaze_share"
"""The measure that any task gives when gaze is recorded: % of looking time on every region."""


def analysis_mistakes(study: Study) -> Iterator[Mistake]:
    """Factors, levels and columns that the planned analysis, or one of those in `also`, names in vain."""
    yield from _groups(study)
    measures: set[str] = set()
    top: Place = ("analysis",)
    for at, plan in [(top, study.analysis), *(((*top, "also", i), p) for i, p in enumerate(study.analysis.also))]:
        if plan.measure in measures:
            yield Mistake((*at, "measure"), f"{plan.measure} is analysed twice; put all its tests into one analysis")
        measures.add(plan.measure)
        yield from _measure(study, plan, at)
        yield from _factors_of_tests(study, plan, at)
        within, columns = within_factors(study, plan), columns_of(study, plan)
        yield from test_mistakes(study, plan, at, within, columns)
        if (span := {**study.task.ranges, GAZE_SHARE: Span(0.0, 100.0)}.get(plan.measure)) is not None:
            yield from unreachable(plan, at, within, span)
        yield from _equivalence_and_regression(study, plan, at)
        yield from _figures(study, plan, at)
        for i, test in enumerate(plan.t_tests):
            if test.where is not None:
                yield from _conditions(test.where, (*at, "t_tests", i, "where"), columns, both_ways=False)
    columns = columns_of(study)
    for i, exclusion in enumerate(study.analysis.exclusions):
        yield from _conditions(exclusion.where, ("analysis", "exclusions", i, "where"), columns)


def columns_of(study: Study, plan: FurtherAnalysis | None = None) -> dict[str, Possible | None]:
    """Columns that a condition may name, to what they can hold; None where a study of this kind does not fill one."""
    columns: dict[str, Possible | None] = dict.fromkeys(study.task.responses)
    columns |= {**study.task.recorded, **dict.fromkeys(COUNTS, Span())}
    columns |= {name: tuple(levels) for name, levels in study.participants.between.items()}
    return columns | {name: tuple(levels) for name, levels in within_factors(study, plan).items()}


def within_factors(study: Study, plan: FurtherAnalysis | None = None) -> dict[str, list[Level]]:
    """Within-participant factors and their levels: of the design, made of groups of levels, and regions of gaze."""
    made: dict[str, list[Level]] = {name: [*groups.levels] for name, groups in study.analysis.groups.items()}
    regions: dict[str, list[Level]] = {"region": [*REGIONS]} if plan and plan.measure == GAZE_SHARE else {}
    return {**study.factors, **made, **regions}


def _conditions(text: str, where: Place, columns: Columns, both_ways: bool = True) -> Iterator[Mistake]:
    for part in text.split(" and "):
        yield from condition_mistakes(part, where, columns, both_ways=both_ways)


def _groups(study: Study) -> Iterator[Mistake]:
    taken = {*study.factors, *(q.id for q in study.participants.questions), *taken_columns(study)}
    for name, groups in study.analysis.groups.items():
        where: Place = ("analysis", "groups", name)
        if name in taken:
            yield Mistake(where, f"{name} is already the name of a factor, question or column", on_key=True)
        if groups.of not in study.factors:
            yield Mistake((*where, "of"), no_such(groups.of, study.factors, "within factor"))
            continue
        known = [str(level) for level in study.factors[groups.of]]
        grouped = [(group, str(level)) for group, levels in groups.levels.items() for level in levels]
        for group, level in grouped:
            if level not in known:
                yield Mistake((*where, "levels", group), no_such(level, known, f"level of {groups.of}"))
        for level in known:
            count = sum(level == member for _, member in grouped)
            if count != 1:
                often = "in no group" if count == 0 else "in more than one group"
                yield Mistake((*where, "levels"), f"{level} is {often}; every level of {groups.of} is in one")


def _covered(study: Study, where: Place, given: Iterable[str], factor: str, what: str) -> Iterator[Mistake]:
    known = list(given)
    missing = [str(level) for level in study.factors[factor] if str(level) not in known]
    if missing:
        yield Mistake(where, f"{what} of {', '.join(missing)} is missing; give one for every level of {factor}")


def _measure(study: Study, plan: FurtherAnalysis, at: Place) -> Iterator[Mistake]:
    actor = study.stimulus.actor
    if plan.measure == GAZE_SHARE and "region" in study.factors:
        yield Mistake(("factors", "region"), "is what gaze_share calls the part looked at; rename it", on_key=True)
    if plan.measure not in (*study.task.measures, GAZE_SHARE):
        given = ", ".join((*study.task.measures, GAZE_SHARE))
        message = f"{plan.measure} is not what {study.task.kind} trials give; they give {given}"
        yield Mistake((*at, "measure"), message)
        return
    column = "correct" if plan.measure == "confusion_rate" else plan.measure
    if column in study.task.responses and column not in study.task.recorded:
        needs = "task.original" if column == "correct" else "walks one after the other"
        yield Mistake((*at, "measure"), f"{plan.measure} needs {needs}, which this study does not have")
    if plan.measure != "normalised_walk_ratio":
        if plan.heights is not None:
            yield Mistake((*at, "heights"), f"{plan.measure} needs no heights; remove them", on_key=True)
    elif plan.heights is None:
        yield Mistake((*at, "measure"), "normalised_walk_ratio needs heights: the height of every actor in m")
    elif isinstance(actor, str) and actor.startswith("$") and actor[1:] in study.factors:
        yield from _covered(study, (*at, "heights"), plan.heights, actor[1:], "the height")
    elif isinstance(actor, str) and not actor.startswith("$") and actor not in plan.heights:
        yield Mistake((*at, "heights"), f"the height of {actor} is missing")


def _factors_of_tests(study: Study, plan: FurtherAnalysis, at: Place) -> Iterator[Mistake]:
    factors = within_factors(study, plan)
    within, between = list(factors), list(study.participants.between)
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
            yield Mistake((*at, "mixed_model", "stimulus"), no_such(mixed.stimulus, within, "within factor"))
        elif mixed.stimulus in mixed.factors:
            message = f"{mixed.stimulus} is the random stimulus already; leave it out of the factors"
            yield Mistake((*at, "mixed_model", "factors"), message)
    for place, names, known, what in named:
        for i, name in enumerate(names):
            if name not in known and name in within + between:
                other = "within" if name in within else "between"
                yield Mistake((*at, *place, i), f"{name} is a {other} factor; name it under {other}")
            elif name not in known:
                yield Mistake((*at, *place, i), no_such(name, known, what))
            elif name in factors and len(factors[name]) < 2:
                yield Mistake((*at, *place, i), f"{name} has one level; a factor needs two")
            elif name in names[:i]:
                yield Mistake((*at, *place, i), f"{name} stands twice; remove one")


def _equivalence_and_regression(study: Study, plan: FurtherAnalysis, at: Place) -> Iterator[Mistake]:
    factors = [*within_factors(study, plan), *study.participants.between]
    for i, same in enumerate(plan.equivalence):
        for field, factor in (("factor", same.factor), ("by", same.by)):
            if factor is not None:
                yield from anova_factor_mistakes(plan, factor, factors, (*at, "equivalence", i, field))
        if same.by == same.factor:
            yield Mistake((*at, "equivalence", i, "by"), f"{same.by} is the factor compared; name another or none")
    if plan.regression is None:
        return
    of, on = plan.regression.of, plan.regression.on
    if of not in study.factors:
        yield Mistake((*at, "regression", "of"), no_such(of, study.factors, "within factor"))
        return
    for name, values in on.items():
        yield from _covered(study, (*at, "regression", "on", name), values, of, f"the {name}")
    for name in plan.regression.units.keys() - on.keys():
        yield Mistake((*at, "regression", "units", name), no_such(name, on, "predictor"))
    cases, needed = len(study.factors[of]), len(on) + 2
    if cases < needed:
        message = f"{cases} levels of {of} are too few for {len(on)} predictors; at least {needed} are needed"
        yield Mistake((*at, "regression", "on"), message)


def _figures(study: Study, plan: FurtherAnalysis, at: Place) -> Iterator[Mistake]:
    factors = [*within_factors(study, plan), *study.participants.between]
    labels = [test.label for test in plan.t_tests]
    for i, figure in enumerate(plan.figures):
        where: Place = (*at, "figures", i)
        for field, factor in (("x", figure.x), ("lines", figure.lines)):
            if factor is not None and factor not in factors:
                yield Mistake((*where, field), no_such(factor, factors, "factor"))
        if figure.kind in ("means", "interaction", "raincloud") and figure.x is None:
            yield Mistake(where, f"a figure of kind {figure.kind} needs x: the factor on the x axis")
        if figure.kind == "t_tests" and figure.reference is None:
            yield Mistake(where, "a figure of t_tests needs reference: the label of the t-test it shows")
        if figure.kind in ("proportions", "psychometric") and not getattr(plan, figure.kind):
            yield Mistake(where, f"a figure of kind {figure.kind} needs {figure.kind} in this analysis")
        if figure.kind == "regression" and plan.regression is None:
            yield Mistake(where, "a figure of the regression needs a regression in this analysis")
        if figure.panels is not None and figure.panels not in study.analysis.groups:
            yield Mistake((*where, "panels"), no_such(figure.panels, study.analysis.groups, "name under groups"))
        if figure.kind == "interaction" and figure.lines is not None and figure.lines == figure.x:
            yield Mistake((*where, "lines"), f"{figure.lines} is on the x axis already; name another factor")
        if figure.kind == "interaction" and figure.lines is None:
            yield Mistake(where, "an interaction needs lines: the factor drawn as lines")
        if figure.reference is not None and figure.reference not in labels:
            yield Mistake((*where, "reference"), no_such(figure.reference, labels, "label of a t-test"))

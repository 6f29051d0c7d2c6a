"""Mistakes in the tests of protocols.further_tests: factors, columns and combinations named in vain."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from difflib import get_close_matches

from protocols.further_tests import DPrime, Proportions, Psychometric, TTest
from protocols.mistakes.mistake import Mistake, Place, no_such
from protocols.mistakes.possible import Possible, condition_mistakes
from protocols.study import FurtherAnalysis, Level, Study

Columns = Mapping[str, Possible | None]
EXAMPLE = "correct == 1` or `chosen != $original"


def test_mistakes(
    study: Study, plan: FurtherAnalysis, at: Place, within: Mapping[str, Sequence[Level]], columns: Columns
) -> Iterator[Mistake]:
    """What t tests, pairs, proportions, d' and psychometric functions name in vain.

    within: within-participant factors and their levels; columns: of trials, to what they hold.
    """
    for i, test in enumerate(plan.t_tests):
        yield from _t_test(study, test, (*at, "t_tests", i), within)
    factors = [*within, *study.participants.between]
    for i, pairs in enumerate(plan.pairs):
        for field, names in (("factors", pairs.factors), ("by", pairs.by or [])):
            for j, name in enumerate(names):
                yield from anova_factor_mistakes(plan, name, factors, (*at, "pairs", i, field, j))
        for name in set(pairs.factors) & set(pairs.by or []):
            yield Mistake((*at, "pairs", i, "by"), f"{name} is a factor compared; name another or none")
    for i, test_of in enumerate(plan.proportions):
        yield from _answers(test_of, (*at, "proportions", i), factors, columns)
    if plan.d_prime is not None:
        yield from _answers(plan.d_prime, (*at, "d_prime"), list(within), columns)
    if plan.psychometric is not None:
        yield from _psychometric(plan.psychometric, (*at, "psychometric"), within, columns)


test_mistakes.__test__ = False  # type: ignore[attr-defined]  # not a test of ours, whatever its name


def anova_factor_mistakes(plan: FurtherAnalysis, name: str, factors: Sequence[str], where: Place) -> Iterator[Mistake]:
    """What is wrong with a name that must stand in the anova, too; factors: those that the study has.

    Only they are suggested, never what somebody misspelt in the anova; that is told there.
    """
    in_anova = [*plan.anova.within, *plan.anova.between]
    if name not in factors:
        yield Mistake(where, no_such(name, factors, "factor of the anova"))
    elif name not in in_anova and not get_close_matches(name, [f for f in in_anova if f not in factors], n=1):
        yield Mistake(where, f"{name} is not in the anova; add it there, or remove it here")


def _known(names: Iterable[str], known: Sequence[str], where: Place, what: str) -> Iterator[Mistake]:
    for i, name in enumerate(names):
        if name not in known:
            yield Mistake((*where, i), no_such(name, known, what))


def _t_test(study: Study, test: TTest, where: Place, within: Mapping[str, Sequence[Level]]) -> Iterator[Mistake]:
    kinds = [name for name in ("against", "paired", "independent") if getattr(test, name) is not None]
    if len(kinds) != 1:
        yield Mistake(where, "a t-test has one of against, paired and independent")
        return
    between = list(study.participants.between)
    named = [("each", test.each, [*within, *between]), ("paired", test.paired, list(within)),
             ("independent", test.independent, between)]  # fmt: skip
    for field, name, known in named:
        if name is not None and name not in known:
            what = {"each": "factor", "paired": "within factor", "independent": "between factor"}[field]
            yield Mistake((*where, field), no_such(name, known, what))
    if test.each is not None and test.each in (test.paired, test.independent):
        yield Mistake((*where, "each"), f"{test.each} is the factor compared; name another or none")
    if test.paired in within and len(within[test.paired or ""]) < 2:
        yield Mistake((*where, "paired"), f"{test.paired} has one level; a pair needs two")
    if isinstance(test.against, dict):
        yield from _values(test, where, within)


def _values(test: TTest, where: Place, within: Mapping[str, Sequence[Level]]) -> Iterator[Mistake]:
    """Values for levels that are none; those of levels not shown do no harm, unless one may be misspelt."""
    assert isinstance(test.against, dict)
    if test.each is None:
        yield Mistake((*where, "against"), "values by level need each: the factor whose levels these are")
        return
    levels = [str(level) for level in within.get(test.each, test.against)]
    without = [level for level in levels if level not in test.against]
    for level in test.against:
        if level not in levels and without:
            message = no_such(level, levels, f"level of {test.each}")
            yield Mistake((*where, "against", level), message, on_key=True)


def _answers(test: Proportions | DPrime, where: Place, factors: Sequence[str], columns: Columns) -> Iterator[Mistake]:
    for field in ("success", "signal", "answer"):
        if hasattr(test, field):
            yield from condition_mistakes(getattr(test, field), (*where, field), columns, example=EXAMPLE)
    yield from _known(test.each or [], factors, (*where, "each"), "factor")


def _psychometric(
    test: Psychometric, where: Place, within: Mapping[str, Sequence[Level]], columns: Columns
) -> Iterator[Mistake]:
    yield from condition_mistakes(test.success, (*where, "success"), columns, example=EXAMPLE)
    yield from _known(test.each or [], list(within), (*where, "each"), "within factor")
    if test.level not in within:
        yield Mistake((*where, "level"), no_such(test.level, within, "within factor"))
        return
    if test.level in (test.each or []):
        yield Mistake((*where, "each"), f"{test.level} is the level the function runs along; leave it out")
    odd = [level for level in within[test.level] if not isinstance(level, (int, float))]
    if odd:
        yield Mistake((*where, "level"), f"{test.level} has the level {odd[0]!r}, which is no number")
    if len(within[test.level]) < 3:
        count = len(within[test.level])
        yield Mistake((*where, "level"), f"{test.level} has {count} level(s); a psychometric function needs 3 or more")

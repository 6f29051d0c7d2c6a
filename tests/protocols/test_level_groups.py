"""Factors made of groups of levels, tests of some trials only, and their figures: what a study file gets wrong."""

from __future__ import annotations

import pytest

from protocols.mistakes.consistency import inconsistencies
from protocols.study_file import parse_study
from tests.protocols.studies import changed

GROUPS = "  groups: {actor_sex: {of: actor, levels: {women: [F1, F2], men: [M1, M2]}}}\n"


def mistakes(groups: str, *more: tuple[str, str]) -> list[str]:
    text = changed(("analysis:\n", f"analysis:\n{groups}"), *more)
    return [f"{'.'.join(map(str, m.where))}: {m.message}" for m in inconsistencies(parse_study("s.yaml", text).study)]


def test_groups_are_factors_of_every_part_of_the_analysis() -> None:
    assert not mistakes(
        GROUPS,
        ("within: [actor, speed, start]", "within: [actor_sex, speed]"),
        ("{kind: interaction, x: actor, lines: sex}", "{kind: interaction, x: actor_sex, lines: sex}"),
        ("{kind: means, x: actor,", "{kind: t_tests, panels: actor_sex,"),
        ("label: captured walk ratio\n", "label: captured walk ratio\n      where: actor_sex == women\n"),
    )


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("of: actor", "of: actors", "analysis.groups.actor_sex.of: actors is no within factor; did you mean actor?"),
        ("[F1, F2]", "[F1, F3]", "F3 is no level of actor"),
        ("[F1, F2]", "[F1]", "F2 is in no group; every level of actor is in one"),
        ("[M1, M2]", "[M1, M2, F1]", "F1 is in more than one group"),
        ("actor_sex:", "sex:", "sex is already the name of a factor, question or column"),
    ],
)
def test_groups_that_cannot_be(old: str, new: str, says: str) -> None:
    found = mistakes(GROUPS.replace(old, new))
    assert any(says in sentence for sentence in found), found


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("{kind: means, x: actor, reference: captured walk ratio}", "{kind: t_tests}", "needs reference"),
        ("{kind: order}", "{kind: regression}", "needs a regression in this analysis"),
        ("{kind: means, x: actor,", "{kind: t_tests, panels: speed,", "speed is no name under groups"),
        ("label: captured walk ratio\n", "label: captured walk ratio\n      where: face == red\n", "face is no column"),
        ("label: captured walk ratio\n", "label: captured walk ratio\n      where: red\n", "'red' is no condition"),
    ],
)
def test_tests_and_figures_that_cannot_be(old: str, new: str, says: str) -> None:
    found = mistakes(GROUPS, (old, new))
    assert len(found) == 1
    assert says in found[0]


ANOVA = "within: [actor, speed, start]"
EQUAL = "{factor: speed, bound: 0.0003}"


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ([(ANOVA, "within: [actor, sped, start]")], ["sped is no within factor; did you mean speed?"]),
        ([(ANOVA, "within: [actor, sped, start]"), (EQUAL, "{factor: spede, bound: 0.0003}")],
         ["sped is no within factor; did you mean speed?", "spede is no factor of the anova; did you mean speed?"]),
        ([(ANOVA, "within: [actor, sped, start]"), (EQUAL, "{factor: sped, bound: 0.0003}")],
         ["sped is no within factor; did you mean speed?", "sped is no factor of the anova; did you mean speed?"]),
        ([(ANOVA, "within: [actor, start]")], ["speed is not in the anova; add it there, or remove it here"]),
        ([(ANOVA, "within: [actor, speed, start, sex]"), ("between: [sex]\n", "between: []\n")],
         ["sex is a between factor; name it under between"]),
    ],
)  # fmt: skip
def test_only_factors_that_the_study_has_are_suggested(changes, says) -> None:
    found = mistakes("", *changes)
    assert [one.partition(": ")[2] for one in found] == says, found

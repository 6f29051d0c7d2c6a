"""What walks in a trial: factors and tables replaced, alternatives over the stimulus."""

from __future__ import annotations

import pytest

from protocols.setting import references, value_of
from protocols.stimulus import Alternative, Making, MakingPart, Stimulus

STIMULUS = Stimulus(actor="$actor", speed=1.1, body="man", making=MakingPart(style="$style", harmonics=3))
LEVELS = {"actor": "F1", "style": "sad", "pace": "fast"}


def test_an_alternative_changes_what_it_names_and_leaves_the_rest():
    walk = STIMULUS.walk(LEVELS, Alternative(speed=0.9, making=MakingPart(method="fourier")))
    assert (walk.actor, walk.body, walk.speed) == ("F1", "man", 0.9)
    assert walk.making == Making("fourier", harmonics=3, style="sad")


def test_an_alternative_without_changes_is_the_stimulus():
    assert STIMULUS.walk(LEVELS, Alternative()) == STIMULUS.walk(LEVELS)


def test_a_table_goes_by_one_factor_after_the_other():
    table = {"$actor": {"F1": {"$pace": {"slow": 0.9, "fast": 1.3}}, "M1": 1.0}}
    assert value_of(table, LEVELS) == 1.3
    assert value_of(table, {**LEVELS, "actor": "M1"}) == 1.0
    assert sorted(references(table)) == ["actor", "pace"]
    with pytest.raises(KeyError):
        value_of(table, {**LEVELS, "pace": "brisk"})


def test_numbers_are_levels_of_a_table_however_they_are_written():
    assert value_of({"$speed": {1.0: "one"}}, {"speed": 1}) == "one"

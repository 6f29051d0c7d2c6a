"""Who the default actors are: the people of Niay 2022, table 4.1, with their captured walk ratios of table 3.4."""

import csv
import time
from pathlib import Path

import numpy as np
import pytest

from stimuli.actors import ActorError, actor_names, load_actor
from stimuli.blend_tree import coverage
from stimuli.bodies.known import load_body

SHARED = Path(__file__).parents[2].parent / "shared"


def test_the_sixteen_actors_are_those_of_table_4_1():
    table = SHARED / "studies" / "published" / "actors16.csv"
    if not table.exists():
        pytest.skip("the shared study tables are not here")
    rows = [row for row in csv.reader(table.read_text().splitlines()) if row and not row[0].startswith("#")]
    for name, sex, age, height, weight, speed in rows[1:]:
        actor = load_actor(name)
        assert (actor.sex, actor.age, actor.weight) == (sex, float(age), float(weight))
        assert actor.height == pytest.approx(float(height) / 100)
        assert actor.comfort_speed == float(speed)
        assert actor.body == {"F": "woman", "M": "man"}[sex]


@pytest.mark.parametrize(("name", "walk_ratio"), [("F1", 0.0069), ("F2", 0.0056), ("M1", 0.0070), ("M2", 0.0070)])
def test_captured_walk_ratios_are_those_of_table_3_4(name, walk_ratio):
    assert load_actor(name).captured_walk_ratio == walk_ratio


def test_there_are_two_training_actors_one_of_each_sex():
    assert (load_actor("T1").sex, load_actor("T2").sex) == ("F", "M")
    assert len(actor_names()) == 18


def test_every_actor_has_25_cycles_that_cover_the_studies():
    for name in actor_names():
        actor = load_actor(name)
        assert actor.table.body.shape[0] == 25
        low, high = coverage(actor.tree)["speed"]
        assert low <= 0.8
        assert high >= 1.35
        assert coverage(actor.tree)["step_frequency"] == (80.0, 120.0)


@pytest.mark.parametrize("name", ["F2", "M3"])
def test_the_skeleton_has_the_actors_height(name):
    actor, body = load_actor(name), load_body("woman" if name[0] == "F" else "man")
    np.testing.assert_allclose(
        actor.skeleton.positions * body.stature / actor.height, body.skeleton.positions, atol=1e-9
    )


def test_no_two_actors_walk_alike():
    rotations = [load_actor(name).table.body[12, :-1, 3:] for name in actor_names()]
    for first in range(len(rotations)):
        for second in range(first):
            assert np.abs(rotations[first] - rotations[second]).max() > 0.02


def test_a_misspelt_actor_gets_a_suggestion():
    with pytest.raises(ActorError, match="Did you mean F1"):
        load_actor("f1")
    with pytest.raises(ActorError, match="The actors are F1, F2"):
        load_actor("nobody at all")


def test_an_actor_is_made_in_under_a_second():
    body = load_body("man")
    load_actor("M1", body)
    start = time.perf_counter()
    load_actor("M1", body)
    assert time.perf_counter() - start < 1.0

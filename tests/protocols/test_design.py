"""The design: 4 actors x 3 speeds x 2 starts x 4 repetitions = 96 trials (Niay 2022, section 3.2.2)."""

from __future__ import annotations

import hashlib
import json
from collections import Counter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protocols.orders.design import conditions, default_seed, make_trials, practice_trials
from tests.protocols.studies import ordered, study


def cell(trial):
    return tuple(trial.levels.values())


def test_the_walk_ratio_study_has_96_trials_and_every_condition_four_times():
    trials = make_trials(study(), seed=1)
    assert [t.number for t in trials] == list(range(1, 97))
    assert set(Counter(map(cell, trials)).values()) == {4}
    assert len(conditions(study())) == 24


@given(st.integers(0, 2**48))
def test_the_same_seed_gives_the_same_list_and_repetitions_count_up(seed):
    trials = make_trials(study(), seed)
    assert trials == make_trials(study(), seed)
    for condition in {cell(t) for t in trials}:
        assert [t.repetition for t in trials if cell(t) == condition] == [1, 2, 3, 4]


def test_other_seeds_give_other_orders():
    orders = {tuple(map(cell, make_trials(study(), seed))) for seed in range(50)}
    assert len(orders) == 50


def test_blocked_order_shows_every_condition_once_per_block():
    blocked = ordered(study(), kind="blocked")
    trials = make_trials(blocked, 3)
    for block in (1, 2, 3, 4):
        assert len({cell(t) for t in trials if t.block == block}) == 24


def test_sequential_order_is_the_order_of_the_file():
    trials = make_trials(ordered(study(), kind="sequential"), 3)
    assert cell(trials[0]) == ("F1", 0.8, 80)
    assert cell(trials[1]) == ("F1", 0.8, 120)
    assert cell(trials[24]) == ("F1", 0.8, 80)


def test_over_many_participants_every_condition_stands_everywhere_equally_often():
    first = Counter(cell(make_trials(study(), seed)[0]) for seed in range(2400))
    # 24 conditions, expected 100 each, binomial s.d. 9.8: all within five of them
    assert len(first) == 24
    assert max(abs(count - 100) for count in first.values()) < 49


def test_training_uses_actors_who_are_not_in_the_experiment_at_one_speed_from_high_and_low():
    practice = practice_trials(study())
    assert [t.levels["actor"] for t in practice] == ["T1", "T2"]
    assert not {"T1", "T2"} & set(study().factors["actor"])
    assert {t.levels["speed"] for t in practice} == {1.0}
    assert [t.levels["start"] for t in practice] == [120, 80]


def test_default_seeds_differ_between_participants_and_runs():
    seeds = {default_seed("walk_ratio", f"P{p:02d}", run) for p in range(100) for run in (1, 2)}
    assert len(seeds) == 200


@pytest.mark.parametrize(
    ("kind", "digest"),
    [("random", "abf23ea96750b829"), ("blocked", "aa76dd71984f8aca"), ("sequential", "380cc16790c56585")],
)
def test_the_orders_of_the_first_released_version_are_kept_for_ever(kind, digest):
    # recorded with version 0.1.0 of protocols/orders/design.py before squares and limits existed
    trials = make_trials(ordered(study(), kind=kind), 5)
    text = json.dumps([[t.number, t.block, t.repetition, dict(t.levels)] for t in trials])
    assert hashlib.sha256(text.encode()).hexdigest()[:16] == digest

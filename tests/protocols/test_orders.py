"""Squares and limited orders: balance counted by hand and as properties, and sentences for what cannot be."""

from __future__ import annotations

from collections import Counter
from itertools import pairwise, product
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from protocols.mistakes.order_mistakes import order_mistakes
from protocols.orders.design import make_trials, square_row, square_rows
from protocols.orders.feasibility import order_limits_mistakes
from protocols.orders.latin import balanced_latin_square, latin_square
from protocols.orders.limits import Limit, limited_order
from tests.protocols.studies import ordered, study


def longest_run(values):
    longest, run = 0, 0
    for i, value in enumerate(values):
        run = run + 1 if i and values[i - 1] == value else 1
        longest = max(longest, run)
    return longest


def least_distance(values):
    places = {}
    for i, value in enumerate(values):
        places.setdefault(value, []).append(i)
    return min((b - a for at in places.values() for a, b in pairwise(at)), default=len(values))


def of(trials, factor):
    return [trial.levels[factor] for trial in trials]


def test_the_balanced_square_of_four_is_bradleys():
    # Bradley (1958), J. Am. Stat. Assoc. 53, 525-528: first row 1, 2, n, 3, n - 1, ... and then cyclically
    assert balanced_latin_square(4) == [[0, 1, 3, 2], [1, 2, 0, 3], [2, 3, 1, 0], [3, 0, 2, 1]]
    assert balanced_latin_square(6)[0] == [0, 1, 5, 2, 4, 3]
    assert balanced_latin_square(5)[0] == [0, 1, 4, 2, 3]


def test_three_conditions_need_all_six_orders_to_balance_successors():
    assert sorted(balanced_latin_square(3)) == [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]]


@given(st.integers(2, 15))
def test_every_condition_stands_equally_often_in_every_place(size):
    for square, times in ((latin_square(size), 1), (balanced_latin_square(size), 1 + size % 2)):
        for place in range(size):
            assert Counter(row[place] for row in square) == dict.fromkeys(range(size), times)
        assert all(sorted(row) == list(range(size)) for row in square)


@given(st.integers(2, 15))
def test_in_a_balanced_square_every_condition_follows_every_other_equally_often(size):
    followed = Counter(pair for row in balanced_latin_square(size) for pair in pairwise(row))
    assert followed == {(a, b): 1 + size % 2 for a, b in product(range(size), repeat=2) if a != b}


def test_participants_take_the_rows_of_the_square_in_turn():
    by_speed = ordered(study(), kind="latin_square", of="speed")
    assert [square_row(by_speed, number) for number in (1, 2, 3, 4)] == [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 1, 2]]
    for number in (1, 2, 3, 4):
        trials = make_trials(by_speed, 7, number)
        assert of(trials, "speed") == [(0.8, 1.0, 1.2)[i] for i in square_row(by_speed, number) for _ in range(32)]
        assert set(Counter(tuple(t.levels.values()) for t in trials).values()) == {4}
        assert [t.block for t in trials] == [1] * 32 + [2] * 32 + [3] * 32
        assert trials == make_trials(by_speed, 7, number)
        assert trials != make_trials(by_speed, 8, number)


def test_a_square_of_two_factors_orders_their_combinations():
    both = ordered(study(), kind="balanced_latin_square", of=["speed", "start"])
    assert len(square_rows(both)) == 6
    first = [(t.levels["speed"], t.levels["start"]) for t in make_trials(both, 1, 1)][:: 96 // 6]
    # parts in the order of the file: (0.8, 80) (0.8, 120) (1.0, 80) (1.0, 120) (1.2, 80) (1.2, 120); row 0 1 5 2 4 3
    assert first == [(0.8, 80), (0.8, 120), (1.2, 120), (1.0, 80), (1.2, 80), (1.0, 120)]


def test_a_square_of_the_conditions_goes_through_them_once_per_repetition_by_the_next_row():
    few = ordered(study(), kind="balanced_latin_square", factors={"speed": [0.8, 1.0, 1.2, 1.4]}, repetitions=2)
    shown = of(make_trials(few, 1, 4), "speed")
    assert shown == [1.4, 0.8, 1.2, 1.0, 0.8, 1.0, 1.4, 1.2]  # row 4, then row 1 of Bradley's square


def test_eight_participants_in_a_square_of_four_see_every_condition_first_twice():
    few = ordered(study(), kind="balanced_latin_square", factors={"speed": [0.8, 1.0, 1.2, 1.4]}, repetitions=1)
    first = Counter(of(make_trials(few, 1, number), "speed")[0] for number in range(1, 9))
    assert first == {0.8: 2, 1.0: 2, 1.2: 2, 1.4: 2}


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**40), st.sampled_from(["random", "blocked"]))
def test_limits_are_kept_and_every_condition_is_still_shown_as_often(seed, kind):
    limits = {"at_most_in_a_row": {"actor": 2, "start": 3}, "at_least_apart": {"speed": 2}, "repeats_at_least_apart": 6}
    limited = ordered(study(), kind=kind, **limits)
    trials = make_trials(limited, seed)
    assert longest_run(of(trials, "actor")) <= 2
    assert longest_run(of(trials, "start")) <= 3
    assert least_distance(of(trials, "speed")) >= 2
    assert least_distance([tuple(t.levels.values()) for t in trials]) >= 6
    assert set(Counter(tuple(t.levels.values()) for t in trials).values()) == {4}
    if kind == "blocked":
        assert [t.block for t in trials] == [block for block in (1, 2, 3, 4) for _ in range(24)]
        assert all(t.repetition == t.block for t in trials)
    assert trials == make_trials(limited, seed)


@settings(max_examples=25, deadline=None)
@given(st.lists(st.integers(2, 4), min_size=1, max_size=3), st.integers(1, 4), st.data())
def test_whatever_single_limit_counting_allows_an_order_is_found(sizes, repetitions, data):
    factors = {f"f{i}": list(range(size)) for i, size in enumerate(sizes)}
    factor = data.draw(st.sampled_from(list(factors)))
    limit = data.draw(
        st.one_of(
            st.integers(1, 4).map(lambda most: {"at_most_in_a_row": {factor: most}}),
            st.integers(2, len(factors[factor])).map(lambda apart: {"at_least_apart": {factor: apart}}),
        )
    )
    limited = ordered(study(), kind="random", factors=factors, repetitions=repetitions, **limit)
    assert not list(order_limits_mistakes(limited))
    make_trials(limited, data.draw(st.integers(0, 1000)))


def test_limits_hold_inside_the_blocks_of_a_square_and_across_them():
    limited = ordered(study(), kind="latin_square", of="speed", at_most_in_a_row={"actor": 1, "start": 2})
    trials = make_trials(limited, 3, 2)
    assert of(trials, "speed") == [1.0] * 32 + [1.2] * 32 + [0.8] * 32
    assert longest_run(of(trials, "actor")) == 1
    assert longest_run(of(trials, "start")) <= 2


def test_without_limits_the_search_gives_every_order_of_three_equally_often():
    conditions = [{"a": level} for level in (1, 2, 3)]
    rng = Random(1)
    counts = Counter(tuple(c["a"] for c in limited_order([conditions], [], rng)) for _ in range(6000))
    # 6 orders, expected 1000 each, binomial s.d. 29: all within five of them
    assert len(counts) == 6
    assert max(abs(count - 1000) for count in counts.values()) < 145


def test_the_tightest_distance_is_a_fixed_cycle():
    tight = ordered(study(), kind="random", at_least_apart={"speed": 3})
    shown = of(make_trials(tight, 11), "speed")
    assert shown == shown[:3] * 32


@pytest.mark.parametrize(
    ("order", "where", "says"),
    [
        ({"at_least_apart": {"speed": 4}}, ("order", "at_least_apart", "speed"),
         "a level returns after at most 3 trials, as 3 different ones share 96 trials; ask for 3 at most"),
        ({"repeats_at_least_apart": 30}, ("order", "repeats_at_least_apart"),
         "a condition returns after at most 24 trials, as 24 different ones share 96 trials; ask for 24 at most"),
        ({"kind": "latin_square", "of": "speed", "at_most_in_a_row": {"speed": 4}},
         ("order", "at_most_in_a_row", "speed"),
         "level 0.8 would stand at least 32 times in a row"),
        # actor 4 apart fixes the actor by place modulo 4, start 2 apart the start by place modulo 2: never all pairs
        ({"at_least_apart": {"actor": 4, "start": 2}}, ("order",),
         "no order was found that keeps at_least_apart actor (4) and at_least_apart start (2) together; an order is "
         "found with at_least_apart actor 3 or without at_least_apart start"),
    ],
)  # fmt: skip
def test_limits_that_cannot_be_kept_are_a_sentence_with_the_way_out(order, where, says):
    impossible = ordered(study(), **{"kind": "random", **order})
    (mistake,) = order_limits_mistakes(impossible)
    assert mistake.where == where
    assert says in mistake.message


def test_what_a_sentence_says_would_do_does():
    for order in ({"at_least_apart": {"speed": 3}}, {"repeats_at_least_apart": 24}, {"at_least_apart": {"actor": 4}}):
        assert not list(order_limits_mistakes(ordered(study(), kind="random", **order)))
    assert not list(order_limits_mistakes(ordered(study(), kind="random", at_least_apart={"actor": 3, "start": 2})))


@pytest.mark.parametrize(
    ("order", "where", "says"),
    [
        ({"kind": "latin_square", "of": "sped"}, ("order", "of", 0), "did you mean speed?"),
        ({"kind": "random", "of": "speed"}, ("order", "of"), "only squares have parts"),
        ({"kind": "random", "at_most_in_a_row": {"actr": 2}}, ("order", "at_most_in_a_row", "actr"),
         "did you mean actor?"),
        ({"kind": "sequential", "at_most_in_a_row": {"actor": 2}}, ("order", "kind"), "is fixed"),
        ({"kind": "latin_square", "factors": {"actor": ["F1"]}}, ("order", "kind"), "not 1"),
    ],
)  # fmt: skip
def test_an_order_that_names_something_in_vain_is_a_sentence_at_its_place(order, where, says):
    (mistake,) = order_mistakes(ordered(study(), **order))
    assert mistake.where == where
    assert says in mistake.message


def test_one_row_may_use_its_level_up_to_its_limit():
    assert Limit("most", lambda c: c, most=2).allowed(["a", "a"], "b")
    assert not Limit("most", lambda c: c, most=2).allowed(["b", "a", "a"], "a")
    assert not Limit("apart", lambda c: c, apart=3).allowed(["a", "b"], "a")
    assert Limit("apart", lambda c: c, apart=3).allowed(["a", "b", "c"], "a")

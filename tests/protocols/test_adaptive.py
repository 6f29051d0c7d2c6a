"""Adaptive placement: staircases by hand, QUEST+ against the package questplus, and where each settles."""

from __future__ import annotations

import math
from collections import Counter
from random import Random
from statistics import mean

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protocols.condition import read_condition
from protocols.mistakes.order_mistakes import order_mistakes
from protocols.orders.adaptive import after_response, begin_tracks, placed
from protocols.orders.design import make_trials
from protocols.orders.quest_plus import quest_plus, rise
from protocols.orders.staircase import Staircase, fewest_trials, reversal_mean
from tests.protocols.studies import ordered, study

ANSWERS = [bool(a) for a in (1, 1, 0, 1, 1, 1, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1, 0, 1)]
LEVELS = tuple(float(level) for level in range(10))


def shown(placement, answers):
    """The levels shown while the answers are given, and the placement after them."""
    levels = []
    for yes in answers:
        levels.append(placement.level)
        placement = placement.after(placement.level, yes)
    return levels, placement


def test_one_up_two_down_by_hand():
    # from 9: yes yes -> 8, no -> 9 (reversal at 8), yes yes -> 8 (reversal at 9), yes yes -> 7, no no -> 9
    levels, stairs = shown(Staircase(LEVELS, 9), [True, True, False, True, True, True, True, False, False])
    assert levels == [9, 9, 8, 9, 9, 8, 8, 7, 8]
    assert stairs.level == 9
    assert stairs.reversals == (8, 9, 7)


def test_steps_get_smaller_after_each_reversal():
    # 9 -2-> 7 -2-> 5, no: reversal, step 1 -> 6, yes yes: reversal -> 5
    levels, stairs = shown(Staircase(LEVELS, 9, steps=(2, 1)), [True] * 4 + [False] + [True] * 2)
    assert levels == [9, 9, 7, 7, 5, 6, 6]
    assert (stairs.level, stairs.reversals) == (5, (5, 6))


def test_a_weighted_staircase_goes_one_down_and_three_up():
    levels, _ = shown(Staircase(LEVELS, 5, 1, 1, down=1, up=3), [True, True, False, True, False, False])
    assert levels == [5, 4, 3, 6, 5, 8]


@pytest.mark.parametrize(
    ("stairs", "settles"),
    [  # Levitt (1971), table I: 0.707, 0.794, 0.841; Kaernbach (1991): S_up p = S_down (1 - p)
        (Staircase(LEVELS, 9, 2, 1), 0.7071), (Staircase(LEVELS, 9, 3, 1), 0.7937),
        (Staircase(LEVELS, 9, 4, 1), 0.8409), (Staircase(LEVELS, 9, 1, 2), 0.2929),
        (Staircase(LEVELS, 9, 1, 1, 1, 3), 0.75), (Staircase(LEVELS, 9, 1, 1), 0.5),
    ],
)  # fmt: skip
def test_staircases_settle_where_their_authors_say(stairs, settles):
    assert stairs.settles_at == pytest.approx(settles, abs=5e-5)
    # an observer with P(yes) = (level + 1) / 101 over 0 ... 100: the mean level shows where the staircase stays
    rng, levels = Random(3), tuple(float(level) for level in range(101))
    stairs = Staircase(levels, 60, stairs.down_after, stairs.up_after, stairs.down, stairs.up)
    seen = []
    for _ in range(40_000):
        seen.append(stairs.level)
        stairs = stairs.after(stairs.level, rng.random() < (stairs.level + 1.0) / 101.0)
    # steps of a hundredth of the range and a straight psychometric function: half a step of bias at most
    assert mean(seen) / 100.0 == pytest.approx(settles, abs=0.015)


def test_a_staircase_ends_with_its_last_reversal_and_then_nothing_moves_it():
    # 1 up 1 down from 5: 5 y, 4 y, 3 n (turn), 4 y (turn), 3 n (turn), 4 n, 5 y (turn): four reversals in seven trials
    levels, stairs = shown(Staircase(LEVELS, 5, 1, 1, stops_after=4), [True, True, False, True, False, False, True])
    assert levels == [5, 4, 3, 4, 3, 4, 5]
    assert (stairs.ended, stairs.reversals) == (True, (3, 4, 3, 5))
    assert stairs.after(4, True) == stairs
    assert not shown(Staircase(LEVELS, 5, 1, 1, stops_after=4), [True, True, False, True, False, False])[1].ended


@given(st.lists(st.booleans(), max_size=80), st.integers(1, 3), st.integers(1, 3), st.integers(4, 8))
def test_up_to_its_end_a_staircase_goes_as_one_without_end_and_never_ends_too_soon(answers, down, up, reversals):
    free, ending = Staircase(LEVELS, 5, down, up), Staircase(LEVELS, 5, down, up, stops_after=reversals)
    for trial, yes in enumerate(answers, start=1):
        assert ending.level == free.level
        free, ending = free.after(free.level, yes), ending.after(ending.level, yes)
        assert ending.reversals == free.reversals
        if ending.ended:
            assert len(free.reversals) == reversals
            assert trial >= fewest_trials(reversals, down, up)
            break


@pytest.mark.parametrize(("down", "up"), [(1, 1), (2, 1), (1, 3), (3, 2)])
def test_the_fewest_trials_are_those_of_the_quickest_answers(down, up):
    def needed(first: bool) -> int:
        stairs, yes, trials = Staircase(LEVELS, 5, down, up, stops_after=5), first, 0
        while not stairs.ended:
            place = stairs.place
            stairs, trials = stairs.after(stairs.level, yes), trials + 1
            yes = yes if stairs.place == place else not yes
        return trials

    assert fewest_trials(5, down, up) == min(needed(True), needed(False))


def test_tracks_that_end_after_eight_reversals_average_where_levitt_says():
    """Levitt (1971), table I: one up two down estimates the 70.7 % point, from the turning points of its runs."""
    rng, levels = Random(11), tuple(float(level) for level in range(101))
    found, trials = [], []
    for _ in range(400):
        stairs = Staircase(levels, 80, steps=(16, 8, 4, 2), stops_after=12)
        count = 0
        while not stairs.ended:
            stairs, count = stairs.after(stairs.level, rng.random() < (stairs.level + 1.0) / 101.0), count + 1
        found.append(reversal_mean(stairs, 4))
        trials.append(count)
    assert mean(found) / 100.0 == pytest.approx(0.7071, abs=0.02)
    assert len(set(trials)) > 10  # a number of trials is no longer what ends them


@given(st.lists(st.booleans(), max_size=60), st.integers(1, 3), st.integers(1, 3), st.integers(0, 9))
def test_a_staircase_never_leaves_its_levels_and_only_moves_after_enough_answers(answers, down_after, up_after, start):
    stairs = Staircase(LEVELS, start, down_after, up_after)
    for yes in answers:
        before, stairs = stairs, stairs.after(stairs.level, yes)
        assert stairs.level in LEVELS
        assert abs(stairs.place - before.place) <= 1
        assert stairs.place <= before.place if yes else stairs.place >= before.place


def test_the_threshold_is_the_mean_of_an_even_number_of_reversals_without_the_first_two():
    assert reversal_mean(Staircase(LEVELS, 0, reversals=(9, 3, 6, 4, 7))) == pytest.approx(5.5)
    assert reversal_mean(Staircase(LEVELS, 0, reversals=(9, 3, 6))) is None


def floats(*span):
    return tuple(float(value) for value in range(*span))


@pytest.mark.parametrize(
    ("start", "levels", "estimate"),
    [  # made with questplus 2023.1 (norm_cdf and weibull, stim_scale="linear", min_entropy, mean), the same answers
        (quest_plus(floats(0, 41, 4), floats(1, 40, 3), (2.0, 4.5, 9.0), function="normal", lapses=(0.01, 0.05)),
         [20, 20, 16, 24, 24, 24, 20, 28, 32, 28, 28, 32, 32, 32, 28, 28, 32, 32, 32, 32],
         (29.902000430641085, 6.114719996784227, 0.031152419920279985)),
        (quest_plus(floats(2, 41, 3), floats(3, 40, 4), (1.5, 3.5, 5.0), function="weibull"),
         [17, 14, 14, 23, 23, 20, 20, 26, 29, 29, 29, 32, 32, 32, 32, 32, 35, 35, 35, 26],
         (33.731266576551484, 2.9170996744348576, 0.02)),
        (quest_plus(floats(-20, 22, 3), floats(-16, 17, 5), (3.0, 6.5), function="normal", guess=0.0,
                    lapses=(0.0, 0.03)),
         [-2, -8, -11, -8, -14, -14, -11, -14, -17, -14, -11, -14, -11, -11, -11, -11, -11, -11, -11, -14],
         (-15.634644539010514, 6.468544552508516, 0.01580854392082178)),
    ],
)  # fmt: skip
def test_quest_plus_shows_the_same_levels_and_believes_the_same_as_the_package_questplus(start, levels, estimate):
    shown_levels, after = shown(start, ANSWERS)
    assert shown_levels == levels
    assert after.mean() == pytest.approx(estimate, rel=1e-12)


def test_quest_plus_recovers_the_threshold_of_an_observer():
    rng, levels = Random(5), floats(0, 41, 2)
    found = []
    for _ in range(20):
        quest = quest_plus(levels, levels, (2.0, 4.0, 6.0))
        for _ in range(60):
            p = 0.5 + 0.48 * rise("logistic", quest.level, 17.0, 4.0)
            quest = quest.after(quest.level, rng.random() < p)
        found.append(quest.mean()[0])
        assert 0.0 < quest.threshold_sd() < 6.0
    # 20 estimates with a posterior s.d. of about 2: their mean is within 1.5 of the truth with a wide margin
    assert mean(found) == pytest.approx(17.0, abs=1.5)


@given(st.lists(st.booleans(), max_size=12))
def test_what_quest_plus_believes_stays_a_probability(answers):
    _, after = shown(quest_plus(floats(1, 8), floats(1, 8), (1.0, 2.0), lapses=(0.0, 0.04)), answers)
    assert math.fsum(after.belief) == pytest.approx(1.0, abs=1e-12)
    assert min(after.belief) >= 0.0


@pytest.mark.parametrize("function", ["logistic", "normal"])
def test_the_functions_rise_from_0_through_a_half_to_1(function):
    assert rise(function, 3.0, 3.0, 2.0) == pytest.approx(0.5)
    assert rise(function, -500.0, 3.0, 2.0) == pytest.approx(0.0, abs=1e-12)
    assert rise(function, 500.0, 3.0, 2.0) == pytest.approx(1.0)
    assert rise("weibull", 3.0, 3.0, 2.0) == pytest.approx(1.0 - math.exp(-1.0))


STAIRS = {"kind": "adaptive", "of": "start", "yes": "walk_ratio >= 0.006",
          "rule": {"kind": "staircase", "start": [120, 80]}}  # fmt: skip
FACTORS = {"actor": ["F1", "M1"], "speed": [1.0], "start": [80, 90, 100, 110, 120]}


def test_tracks_are_interleaved_every_condition_with_every_start_once_per_block():
    trials = make_trials(ordered(study(), **STAIRS, factors=FACTORS, repetitions=10), 3)
    assert len(trials) == 2 * 2 * 10
    for block in range(1, 11):
        assert sorted(t.track for t in trials if t.block == block) == [1, 2, 3, 4]
    assert {t.track: (t.levels["actor"], t.levels["start"]) for t in trials} == {
        1: ("F1", 120), 2: ("F1", 80), 3: ("M1", 120), 4: ("M1", 80),
    }  # fmt: skip
    assert len({tuple(t.track for t in trials if t.block == block) for block in range(1, 11)}) > 3
    assert [t.repetition for t in trials if t.track == 2] == list(range(1, 11))


def test_every_track_follows_its_own_answers_alone():
    adaptive = ordered(study(), **STAIRS, factors=FACTORS, repetitions=10)
    tracks = begin_tracks(adaptive)
    for trial in make_trials(adaptive, 3):
        trial = placed(adaptive, tracks, trial)
        ratio = 0.007 if trial.levels["actor"] == "F1" else 0.005
        tracks = after_response(adaptive, tracks, trial.track, {**trial.levels, "walk_ratio": ratio})
    # ten times yes: five moves down; ten times no: ten moves up; both end at the end of the list
    assert [tracks[n].level for n in (1, 2, 3, 4)] == [80, 80, 120, 120]


@pytest.mark.parametrize(
    ("text", "columns", "holds"),
    [
        ("rating >= 3", {"rating": 3}, True),
        ("rating >= 3", {"rating": 2.9}, False),
        ("chosen == left", {"chosen": "left"}, True),
        ("chosen == $original", {"chosen": "M1", "original": "M1"}, True),
        ("chosen != $original", {"chosen": "M1", "original": "M1"}, False),
        ("chosen == 'left'", {"chosen": "left"}, True),
        ("chosen > left", {"chosen": "right"}, False),
        ("correct == 1", {"correct": True}, True),
        ("level == 0.80", {"level": 0.8}, True),
    ],
)
def test_a_condition_compares_numbers_as_numbers_and_words_as_words(text, columns, holds):
    condition = read_condition(text)
    assert condition is not None
    assert condition.holds(columns) is holds


@pytest.mark.parametrize(
    ("changes", "where", "says"),
    [
        ({"of": "strat"}, ("order", "of"), "did you mean start?"),
        ({"of": "actor"}, ("factors", "actor", 0), "'F1' is not a number"),
        ({"yes": "walk_ratio"}, ("order", "yes"), "is no condition"),
        ({"rule": {"kind": "staircase", "reversals": 8}}, ("order", "rule", "reversals"),
         "cannot turn 8 times within its 4 trials (repetitions); it needs 13 at least"),
        ({"yes": "walkratio > 0.006"}, ("order", "yes"), "did you mean walk_ratio?"),
        ({"rule": {"kind": "weighted", "start": [95]}}, ("order", "rule", "start", 0),
         "there are: 80, 90, 100, 110, 120"),
        ({"rule": {"kind": "quest_plus", "function": "weibull", "spreads": [3.5], "thresholds": [0.0, 1.0]}},
         ("order", "rule", "thresholds"), "above 0"),
    ],
)  # fmt: skip
def test_an_adaptive_order_that_cannot_be_is_a_sentence_at_its_place(changes, where, says):
    mistakes = list(order_mistakes(ordered(study(), **{**STAIRS, **changes}, factors=FACTORS)))
    assert mistakes[0].where == where
    assert says in mistakes[0].message


def test_the_same_seed_interleaves_the_same():
    adaptive = ordered(study(), **STAIRS, factors=FACTORS, repetitions=20)
    assert make_trials(adaptive, 9) == make_trials(adaptive, 9)
    orders = Counter(tuple(t.track for t in make_trials(adaptive, seed)) for seed in range(50))
    assert max(orders.values()) == 1

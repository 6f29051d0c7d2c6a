"""The choice task: times by hand, sides counted, and what the record says."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protocols.events import KeyDown, Shown
from protocols.orders.design import Trial
from protocols.stimulus import Walk
from protocols.tasks.choice import ChoiceTask, ChoiceTrial, begin
from protocols.tasks.showing import Showing
from protocols.tasks.sides import balanced_orders
from protocols.tasks.task import Setup

KEYS = {"first": "left", "second": "right", "replay": "r", "break": "b"}
SIDE_BY_SIDE = Showing()
WALKS = {"captured": Walk("F1", "", 1.0), "rebuilt": Walk("F1", "", 1.2)}


def started(showing: Showing = SIDE_BY_SIDE, minimum: float = 0.0, time: float = 10.0) -> ChoiceTrial:
    task = ChoiceTask(showing, "captured", minimum)
    return begin(task, Setup(WALKS, {}, KEYS, "Which?")).handle(Shown(time))


def pressed(trial: ChoiceTrial, *presses: tuple[float, str]) -> ChoiceTrial:
    for time, key in presses:
        trial = trial.handle(KeyDown(time, key))
    return trial


def names(trial: ChoiceTrial, at: float) -> list[str]:
    return [seen.name for seen in trial.advance(at).view.walks]


def test_the_right_key_chooses_the_right_walk_and_the_time_is_from_the_flip():
    trial = pressed(started(), (12.5, "right"))
    assert trial.done
    assert trial.looked == 2.5
    assert trial.response == {
        "chosen": "rebuilt", "side": "right", "left": "captured", "right": "rebuilt",
        "original": "captured", "correct": 0, "views": 1,
    }  # fmt: skip


def test_choosing_the_original_is_correct():
    assert pressed(started(), (11.0, "left")).response["correct"] == 1


def test_without_a_limit_the_walks_stay_until_the_answer():
    assert names(started(), 500.0) == ["captured", "rebuilt"]


def test_after_the_limit_the_walks_vanish_and_the_question_stays_until_a_choice_is_made():
    trial = started(Showing(time_limit=10.0))
    assert names(trial, 19.99) == ["captured", "rebuilt"]
    late = trial.advance(20.0)
    assert (late.view.walks, late.view.question, late.done) == ((), "Which?", False)
    assert pressed(late, (23.0, "left")).looked == 13.0


def test_one_after_the_other_shows_first_gap_second_and_hears_a_choice_only_then():
    trial = started(Showing("one_after_the_other", time_limit=2.0, gap=0.5))
    assert [names(trial, at) for at in (10.0, 11.9, 12.1, 12.5, 14.4, 14.6)] == [
        ["captured"], ["captured"], [], ["rebuilt"], ["rebuilt"], [],
    ]  # fmt: skip
    early = pressed(trial, (12.1, "left"))
    assert (early.done, early.counts["early_confirms"]) == (False, 1)
    chosen = pressed(early, (13.1, "left"))
    assert (chosen.response["side"], chosen.looked) == ("first", pytest.approx(3.1))
    assert chosen.response["decision_time"] == pytest.approx(0.6)  # the second appeared at 12.5 s


def test_a_walk_begins_anew_when_it_is_its_turn():
    trial = started(Showing("one_after_the_other", time_limit=2.0, gap=0.5)).advance(13.0)
    (seen,) = trial.view.walks
    assert (seen.time, seen.distance) == pytest.approx((0.5, 0.6))


def test_replay_begins_another_view_as_often_as_is_allowed():
    trial = started(Showing(time_limit=3.0, views=2))
    again = pressed(trial, (14.0, "r"))
    assert names(again, 16.9) == ["captured", "rebuilt"]
    assert names(again, 17.1) == []
    twice = pressed(again, (18.0, "r"))
    assert twice.viewing.view == 2
    assert names(twice, 18.1) == []
    assert pressed(twice, (19.0, "right")).response["views"] == 2


def test_seeing_the_first_walk_again_is_not_seeing_the_second():
    trial = started(Showing("one_after_the_other", time_limit=2.0, gap=0.5, views=None))
    again = pressed(trial, (11.0, "r"), (12.0, "left"))
    assert not again.done
    chosen = pressed(again, (14.0, "left"))  # the second appeared 2.5 s after the replay, at 13.5 s
    assert chosen.response["decision_time"] == pytest.approx(0.5)


def test_a_choice_before_the_minimum_looking_time_is_counted_and_refused():
    trial = pressed(started(minimum=1.0), (10.5, "left"))
    assert (trial.done, trial.counts["early_confirms"]) == (False, 1)
    assert pressed(trial, (11.0, "left")).done


def test_a_pause_takes_no_looking_time_and_moves_nothing():
    trial = started().advance(11.0).resumed(71.0).advance(72.0)
    assert trial.looked == 2.0
    assert trial.view.walks[0].distance == pytest.approx(2.0)


@given(st.lists(st.tuples(st.floats(0.01, 5.0), st.sampled_from(["r", "x", "b"])), max_size=6), st.floats(20.0, 144.0))
def test_the_same_keys_give_the_same_choice_at_any_frame_rate(keys, frame_rate):
    time, events = 0.0, []
    for wait, key in [*keys, (1.0, "left")]:
        time += wait
        events.append(KeyDown(time, key))
    showing = Showing(time_limit=2.0, views=None)
    whole = started(showing, time=0.0)
    for event in events:
        whole = whole.handle(event)
    trial, waiting = started(showing, time=0.0), list(events)
    for frame in range(1, math.ceil(time * frame_rate) + 1):
        while waiting and waiting[0].time <= frame / frame_rate:
            trial = trial.handle(waiting.pop(0))
        trial = trial.advance(frame / frame_rate)
    assert trial.response == whole.response
    assert trial.looked == pytest.approx(whole.looked, abs=1e-9)


def test_a_choice_between_three_is_refused_in_words():
    with pytest.raises(ValueError, match="between two alternatives, not 3"):
        begin(ChoiceTask(Showing()), Setup({**WALKS, "third": WALKS["captured"]}, {}, KEYS))


@given(st.integers(1, 12), st.integers(1, 4), st.integers(0, 1000))
def test_sides_are_balanced_over_all_trials_and_within_every_condition(conditions, repetitions, seed):
    trials = [
        Trial(r * conditions + c + 1, r + 1, r + 1, {"a": c}) for r in range(repetitions) for c in range(conditions)
    ]
    orders = balanced_orders(trials, ("x", "y"), str(seed))
    left = [order[0] for order in orders]
    assert abs(left.count("x") - left.count("y")) <= (1 if len(trials) % 2 or conditions % 2 else 0)
    for c in range(conditions):
        own = [order[0] for order, trial in zip(orders, trials, strict=True) if trial.levels["a"] == c]
        assert abs(own.count("x") - own.count("y")) <= len(own) % 2


def test_the_same_seed_gives_the_same_sides_and_another_seed_others():
    trials = [Trial(i + 1, 1, 1, {"a": i}) for i in range(40)]
    assert balanced_orders(trials, ("x", "y"), "1") == balanced_orders(trials, ("x", "y"), "1")
    assert balanced_orders(trials, ("x", "y"), "1") != balanced_orders(trials, ("x", "y"), "2")

"""The adjustment task: expected numbers by hand from v = SL SF / 60, WR = SL / SF and the rate in the study file."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protocols.events import FocusLost, KeyDown, KeyUp, Shown
from protocols.stimulus import Walk
from protocols.tasks.adjustment import AdjustmentTask, AdjustmentTrial, Stage, begin

TASK = AdjustmentTask(minimum=80.0, maximum=120.0, rate=10.0, minimum_looking_time=1.0)


def started(start: float = 80.0, speed: float = 1.0, time: float = 0.0) -> AdjustmentTrial:
    return begin(TASK, Walk("F1", "", speed), start).handle(Shown(time))


def played(trial: AdjustmentTrial, *events: object) -> AdjustmentTrial:
    for event in events:
        trial = trial.handle(event)  # type: ignore[arg-type]
    return trial


def test_holding_right_for_1_5_s_at_10_per_second_raises_80_to_95_steps_per_minute():
    trial = played(started(), KeyDown(2.0, "right"), KeyUp(3.5, "right"))
    assert trial.setting == pytest.approx(95.0, abs=1e-12)


def test_walk_ratio_at_1_m_per_s_and_100_steps_per_minute_is_0_006():
    trial = replace(started(), setting=100.0)
    assert trial.step_length == pytest.approx(0.6)
    assert trial.walk_ratio == pytest.approx(0.006)


@given(
    st.lists(st.tuples(st.floats(0.0, 1.5), st.floats(0.0, 1.5), st.sampled_from(["left", "right"])), max_size=8),
    st.sampled_from([24.0, 60.0, 144.0, 1000.0 / 7.0]),
)
def test_the_same_keys_give_the_same_response_at_any_frame_rate(holds, frame_rate):
    events, time = [], 0.1
    for wait, length, key in holds:
        events += [KeyDown(time + wait, key), KeyUp(time + wait + length, key)]
        time += wait + length
    end = time + 1.0
    whole = played(started(), *events).advance(end)
    trial, waiting = started(), list(events)
    for frame in range(1, math.ceil(end * frame_rate)):
        while waiting and waiting[0].time <= frame / frame_rate:
            trial = trial.handle(waiting.pop(0))
        trial = trial.advance(min(frame / frame_rate, end))
    trial = played(trial, *waiting).advance(end)
    assert trial.setting == pytest.approx(whole.setting, abs=1e-9)
    assert trial.strides == pytest.approx(whole.strides, abs=1e-9)
    assert trial.distance == pytest.approx(whole.distance, abs=1e-9)


@given(st.floats(80.0, 120.0), st.floats(0.0, 20.0), st.sampled_from(["left", "right"]))
def test_the_setting_never_leaves_the_range(start, length, key):
    trial = played(started(start), KeyDown(0.5, key))
    assert 80.0 <= trial.advance(0.5 + length).setting <= 120.0


def test_strides_are_the_integral_of_step_frequency_also_past_the_end_of_the_range():
    # 110 -> 120 in 1 s (mean 115), then 120 for 2 s: (115 + 240) / 120 strides
    trial = played(started(110.0), KeyDown(0.0, "right")).advance(3.0)
    assert trial.strides == pytest.approx((115.0 + 240.0) / 120.0, abs=1e-12)
    assert trial.distance == pytest.approx(3.0)


@given(st.floats(0.0, 5.0), st.floats(1e-9, 1e-3))
def test_the_walker_does_not_jump_when_a_key_goes_down_or_up(at, later):
    before = started().advance(at)
    after = before.handle(KeyDown(at, "right")).advance(at + later)
    assert abs(after.strides - before.strides) <= 120.0 / 120.0 * later * 1.001
    assert before.handle(KeyDown(at, "right")).strides == before.strides


def test_both_keys_held_cancel_each_other():
    trial = played(started(100.0), KeyDown(0.0, "left"), KeyDown(0.0, "right"))
    assert trial.advance(2.0).setting == 100.0
    trial = trial.advance(2.0).handle(KeyUp(2.0, "left"))
    assert trial.advance(2.5).setting == pytest.approx(105.0)


def test_losing_focus_releases_every_key():
    trial = played(started(100.0), KeyDown(0.0, "right"), FocusLost(0.5))
    assert trial.advance(5.0).setting == pytest.approx(105.0)


def test_a_second_press_of_a_held_key_counts_once():
    trial = played(started(100.0), KeyDown(0.0, "right"), KeyDown(0.2, "right"), KeyUp(1.0, "right"))
    assert trial.setting == pytest.approx(110.0)
    assert trial.key_presses == 1


def test_confirming_before_the_minimum_looking_time_is_counted_and_refused():
    trial = played(started(), KeyDown(0.4, "enter"))
    assert (trial.stage, trial.early_confirms) == (Stage.ADJUSTING, 1)
    assert played(trial, KeyDown(1.0, "enter")).done


def test_nothing_moves_before_the_first_frame_and_after_confirmation():
    waiting = played(begin(TASK, Walk("F1", "", 1.0), 80.0), KeyDown(0.5, "right"))
    assert waiting.advance(3.0).setting == 80.0
    done = played(started(), KeyDown(2.0, "enter"), KeyDown(2.1, "right"))
    assert done.advance(9.0) == done


def test_a_pause_takes_no_looking_time_and_moves_nothing():
    trial = started().advance(1.0)
    trial = trial.resumed(61.0).advance(62.0)
    assert trial.looked == pytest.approx(2.0)
    assert trial.distance == pytest.approx(2.0)


def test_reversals_are_changes_of_direction_between_presses():
    keys = ["right", "left", "left", "right"]
    events = [e for i, k in enumerate(keys) for e in (KeyDown(i + 0.1, k), KeyUp(i + 0.2, k))]
    assert played(started(100.0), *events).reversals == 2


def test_a_start_outside_the_range_is_refused_in_words():
    with pytest.raises(ValueError, match=r"130 steps/min is outside the range 80 to 120"):
        begin(TASK, Walk("F1", "", 1.0), 130.0)

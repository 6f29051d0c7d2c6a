"""The rating task: the mark by keys, digits and clicks; times by hand."""

from __future__ import annotations

import pytest

from protocols.events import Clicked, FocusLost, KeyDown, KeyUp, Shown
from protocols.stimulus import Walk
from protocols.tasks.rating import RatingTask, RatingTrial, begin
from protocols.tasks.showing import Showing
from protocols.tasks.task import Scale, Setup

KEYS = {"lower": "left", "raise": "right", "confirm": "enter", "replay": "r", "break": "b"}
POINTS = Scale(0.0, 4.0, 1.0, "not realistic", "as natural as the original")
LINE = Scale(0.0, 100.0, None, "not at all", "completely")
WALKS = {"original": Walk("F1", "", 1.0), "made": Walk("F1", "", 1.0)}


def started(scale: Scale = POINTS, minimum: float = 0.0) -> RatingTrial:
    task = RatingTask(Showing(views=None), scale, minimum)
    return begin(task, Setup(WALKS, {}, KEYS, "How natural?")).handle(Shown(0.0))


def played(trial: RatingTrial, *events: object) -> RatingTrial:
    for event in events:
        trial = trial.handle(event)  # type: ignore[arg-type]
    return trial


def test_a_digit_marks_its_point_and_enter_confirms():
    trial = played(started(), KeyDown(3.0, "3"), KeyDown(4.0, "enter"))
    assert trial.done
    assert trial.response == {"rating": 3.0, "views": 1}
    assert trial.looked == 4.0


def test_points_of_a_fine_scale_are_the_numbers_a_study_file_writes():
    trial = started(Scale(0.0, 1.0, 0.1, "not at all", "completely"))
    marks = []
    for i in range(11):
        trial = played(trial, KeyDown(1.0 + i, "right"))
        marks.append(trial.mark)
    assert marks == [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
    assert played(trial, Clicked(20.0, "scale:0.7")).mark == 0.7


def test_arrows_move_the_mark_from_an_end_and_stop_at_the_other():
    up = [KeyDown(float(i), "right") for i in range(1, 4)]
    assert played(started(), *up).mark == 2.0
    assert played(started(), *[KeyDown(float(i), "right") for i in range(1, 20)]).mark == 4.0
    assert played(started(), KeyDown(1.0, "left")).mark == 4.0


def test_a_click_marks_the_nearest_point_and_the_button_confirms():
    trial = played(started(), Clicked(1.0, "scale:2.4"))
    assert trial.mark == 2.0
    assert played(trial, Clicked(2.0, "confirm")).response["rating"] == 2.0


def test_nothing_is_confirmed_without_a_mark_or_too_early():
    trial = played(started(minimum=2.0), KeyDown(0.5, "enter"), KeyDown(1.0, "1"), KeyDown(1.5, "enter"))
    assert (trial.done, trial.counts["early_confirms"]) == (False, 2)
    assert played(trial, KeyDown(2.0, "enter")).done


def test_a_confirmation_without_a_mark_is_answered_until_there_is_one():
    assert not started().view.unanswered
    refused = played(started(), KeyDown(0.5, "enter"))
    assert refused.view.unanswered
    assert played(refused, Clicked(0.7, "confirm")).advance(9.0).view.unanswered
    assert not played(refused, KeyDown(1.0, "1")).view.unanswered


def test_a_confirmation_that_comes_too_early_with_a_mark_misses_no_answer():
    assert not played(started(minimum=2.0), KeyDown(0.5, "1"), KeyDown(1.0, "enter")).view.unanswered


def test_digits_beyond_the_scale_and_other_keys_change_nothing():
    assert played(started(), KeyDown(1.0, "7"), KeyDown(2.0, "x")).mark is None


def test_holding_sweeps_a_continuous_scale_from_its_middle_at_a_quarter_per_second():
    trial = played(started(LINE), KeyDown(1.0, "right"), KeyUp(2.0, "right"))
    assert trial.mark == pytest.approx(75.0)
    assert trial.advance(9.0).mark == pytest.approx(75.0)
    assert played(started(LINE), KeyDown(1.0, "left")).advance(60.0).mark == 0.0


def test_a_click_on_a_continuous_scale_is_its_value():
    assert played(started(LINE), Clicked(1.0, "scale:41.5")).mark == 41.5


def test_losing_focus_and_pausing_release_the_keys():
    assert not played(started(LINE), KeyDown(1.0, "right"), FocusLost(1.1)).held
    assert not played(started(LINE), KeyDown(1.0, "right")).paused().held


def test_both_walks_are_shown_in_step_and_replay_begins_them_again():
    trial = started().advance(5.0)
    assert [seen.time for seen in trial.view.walks] == [5.0, 5.0]
    again = played(trial, KeyDown(6.0, "r")).advance(6.5)
    assert [seen.time for seen in again.view.walks] == pytest.approx([0.5, 0.5])
    assert again.viewing.view == 2


def test_a_pause_takes_no_looking_time():
    assert started().advance(1.0).resumed(61.0).advance(62.0).looked == 2.0

"""Pacing on displays made of numbers: absolute deadlines, missed refreshes, and what counts as synchronised."""

from __future__ import annotations

import math
from itertools import pairwise
from random import Random
from statistics import median

import pytest
from hypothesis import given
from hypothesis import strategies as st

from experiment_app.windows.pacing import Pacing, measured

PERIOD = 1.0 / 60.0


def play(pacing: Pacing, costs: list[float], wake_late: float = 0.0) -> list[tuple[float, float]]:
    """(predicted, flip) of frames with these costs of drawing, on a true display or on our own deadlines."""
    frames, now = [], pacing.refresh
    for cost in costs:
        now = max(now, pacing.draw_time() + wake_late)
        predicted = pacing.display_time(now)
        ready = now + cost
        refresh = math.ceil(ready / PERIOD) * PERIOD  # those of the true display are at whole periods
        flip = refresh if pacing.throttled else max(ready, predicted)
        frames.append((predicted, flip))
        pacing, now = pacing.after(flip, cost, predicted), flip
    return frames


@pytest.mark.parametrize("throttled", [True, False])
@given(usual=st.floats(0.0005, 0.009), more=st.lists(st.floats(0.0, 0.0019), min_size=60, max_size=60))
def test_frames_that_are_drawn_in_time_are_seen_when_predicted_one_period_apart(throttled, usual, more):
    frames = play(Pacing(PERIOD, throttled, costs=(0.011, 0.011)), [usual + extra for extra in more])
    for number, (predicted, flip) in enumerate(frames, start=1):
        assert flip == pytest.approx(predicted, abs=1e-9)
        assert flip == pytest.approx(number * PERIOD, abs=1e-9)


def test_lateness_never_adds_up_where_the_driver_does_not_wait():
    random = Random(1)
    costs = [random.uniform(0.001, 0.012) for _ in range(2000)]
    frames = play(Pacing(PERIOD, False), costs, wake_late=0.0004)
    off_the_grid = [abs(flip / PERIOD - round(flip / PERIOD)) * PERIOD for _, flip in frames]
    assert median(off_the_grid) < 1e-9
    assert frames[-1][1] <= (len(costs) + 20) * PERIOD


def test_drawing_that_takes_longer_than_a_period_gives_every_second_refresh_and_says_so_beforehand():
    frames = play(Pacing(PERIOD, True), [0.020] * 40)[5:]
    assert [flip for _, flip in frames] == pytest.approx([predicted for predicted, _ in frames], abs=1e-6)
    assert [later[1] - earlier[1] for earlier, later in pairwise(frames)] == pytest.approx([2 * PERIOD] * 34, abs=1e-6)


def test_after_a_stall_the_next_frame_is_predicted_right_again():
    frames = play(Pacing(PERIOD, True, costs=(0.004, 0.004)), [0.004] * 10 + [0.044] + [0.004] * 60)
    assert frames[10][1] - frames[10][0] == pytest.approx(3 * PERIOD, abs=1e-6)
    assert all(flip == pytest.approx(predicted, abs=1e-6) for predicted, flip in frames[12:])


def test_the_estimate_of_a_throttled_display_follows_jitter_of_the_stamps_only_a_little():
    random, pacing, now = Random(2), Pacing(PERIOD, True, costs=(0.004, 0.004)), 0.0
    errors = []
    for number in range(1, 400):
        now = max(now, pacing.draw_time())
        predicted = pacing.display_time(now)
        errors.append(abs(predicted - number * PERIOD))
        flip = number * PERIOD + random.uniform(0.0, 0.001)  # the finish returns up to a millisecond late
        pacing, now = pacing.after(flip, 0.004, predicted), flip
    assert max(errors[20:]) < 0.001
    assert median(errors[20:]) == pytest.approx(0.0005, abs=0.0002)


def test_a_display_that_shows_its_rate_is_synchronised_and_its_measured_period_counts():
    pacing = measured(60.0, [0.01668] * 18)
    assert (pacing.throttled, pacing.period) == (True, 0.01668)


@pytest.mark.parametrize(
    ("reported", "intervals"),
    [
        (0.0, [0.0002] * 18),  # a virtual display: no rate, no waiting
        (60.0, [0.0002] * 18),  # vertical synchronisation switched off
        (60.0, [1 / 144] * 18),  # the rate of another monitor
        (60.0, [0.0002, 0.0332] * 9),  # bursts, whose mean only is right
    ],
)
def test_a_display_that_does_not_wait_is_never_called_synchronised(reported, intervals):
    pacing = measured(reported, intervals)
    assert (pacing.throttled, pacing.period) == (False, pytest.approx(PERIOD))

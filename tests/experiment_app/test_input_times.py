"""Times of keys without a keyboard: clocks in whole milliseconds, stamps in order, a gamepad made of numbers."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field

import glfw
import pytest
from hypothesis import given
from hypothesis import strategies as st

from experiment_app.errors import UsageError
from experiment_app.windows import psychtoolbox_times
from experiment_app.windows.gamepad import Gamepad
from experiment_app.windows.key_times import NotedTimes, Stamp, open_key_times
from experiment_app.windows.x_server_times import WRAP_MS, possible, unwrapped
from protocols.events import FocusLost, KeyDown, KeyUp, Shown
from protocols.stimulus import Walk
from protocols.tasks.adjustment import AdjustmentTask, AdjustmentTrial, begin


@given(moment=st.floats(1.0, 3e7), delay=st.floats(0.0, 60.0))
def test_a_time_of_the_server_survives_its_clocks_starting_again_every_49_days(moment, delay):
    shown = int(moment * 1e3) % WRAP_MS
    assert unwrapped(shown, moment + delay) == pytest.approx(moment, abs=0.001 + 1e-6)


@given(part=st.floats(0.0, 0.000999), delay=st.floats(0.0, 0.03))
def test_a_servers_time_and_the_arrival_bound_when_a_key_was_pressed(part, delay):
    happened = 100.0 + part
    middle, half = possible(100.0, happened + delay)
    assert middle - half - 1e-9 <= happened <= middle + half + 1e-9
    assert half <= 0.0005 + 1e-12
    assert half <= (part + delay) / 2 + 1e-9


def test_each_stamp_is_handed_out_once_oldest_first_and_forgotten_when_nobody_asks():
    noted = NotedTimes()
    first, second, third = (Stamp(time, "x-server", 0.5) for time in (1.0, 2.0, 3.0))
    for stamp in (first, second, third):
        noted.note(38, True, stamp)
    noted.note(38, False, second)
    assert [noted.take(38, True), noted.take(38, False), noted.take(38, False)] == [first, second, None]
    noted.forget(2.5)
    assert [noted.take(38, True), noted.take(38, True)] == [third, None]
    noted.note(40, True, third)
    noted.forget()
    assert noted.take(40, True) is None


def begun() -> AdjustmentTrial:
    task = AdjustmentTask(minimum=80.0, maximum=120.0, rate=10.0, minimum_looking_time=1.0)
    return begin(task, Walk("F1", "", 1.0), 100.0).handle(Shown(0.0))


@dataclass
class FakeGamepad:
    """Buttons and axes as GLFW's mapping numbers them."""

    buttons: list[int] = field(default_factory=lambda: [0] * (glfw.GAMEPAD_BUTTON_LAST + 1))
    axes: list[float] = field(default_factory=lambda: [0.0] * (glfw.GAMEPAD_AXIS_LAST + 1))


def test_a_gamepad_adjusts_as_the_keys_do():
    state = FakeGamepad()
    pad = Gamepad(lambda: state)
    trial = begun()
    for now, change in (
        (0.998, lambda: None),
        (1.000, lambda: state.buttons.__setitem__(glfw.GAMEPAD_BUTTON_DPAD_RIGHT, 1)),
        (1.500, lambda: None),  # still held: no event
        (2.000, lambda: state.buttons.__setitem__(glfw.GAMEPAD_BUTTON_DPAD_RIGHT, 0)),
        (2.500, lambda: state.axes.__setitem__(glfw.GAMEPAD_AXIS_LEFT_X, -0.9)),
        (2.700, lambda: state.axes.__setitem__(glfw.GAMEPAD_AXIS_LEFT_X, -0.4)),  # not yet let go
        (3.000, lambda: state.axes.__setitem__(glfw.GAMEPAD_AXIS_LEFT_X, 0.1)),
        (3.500, lambda: state.buttons.__setitem__(glfw.GAMEPAD_BUTTON_A, 1)),
    ):
        change()
        for event in pad.look(now):
            trial = trial.handle(event)
    assert trial.done
    assert trial.setting == pytest.approx(100.0 + 10.0 * 1.0 - 10.0 * 0.5)
    assert (trial.key_presses, trial.reversals) == (2, 1)


def test_a_gamepads_events_name_their_source_and_the_time_since_the_last_look():
    state = FakeGamepad()
    pad = Gamepad(lambda: state)
    pad.look(1.000)
    state.buttons[glfw.GAMEPAD_BUTTON_DPAD_LEFT] = 1
    assert pad.look(1.002) == [KeyDown(1.002, "left", "gamepad", 2.0)]


def test_unplugging_a_gamepad_lets_everything_go():
    state: FakeGamepad | None = FakeGamepad()
    pad = Gamepad(lambda: state)
    state.buttons[glfw.GAMEPAD_BUTTON_DPAD_LEFT] = 1  # type: ignore[union-attr]
    pad.look(1.0)
    state = None
    assert pad.look(1.5) == [KeyUp(1.5, "left", "gamepad", 500.0)]


def test_losing_the_focus_ends_a_hold_at_that_moment():
    trial = begun()
    for event in (KeyDown(1.0, "right"), FocusLost(1.25), KeyUp(1.9, "right"), KeyDown(2.0, "enter")):
        trial = trial.handle(event)
    assert trial.setting == pytest.approx(102.5)


@pytest.mark.parametrize("keyboard", ["x-server", "psychtoolbox"])
def test_a_source_of_key_times_that_is_not_there_is_a_sentence_with_the_way_out(monkeypatch, keyboard):
    monkeypatch.setattr(psychtoolbox_times, "find_spec", lambda _: None)
    monkeypatch.delitem(sys.modules, "psychtoolbox", raising=False)
    with pytest.raises(UsageError, match=rf"--keyboard {keyboard}: .*; leave --keyboard out"):
        open_key_times(keyboard, None)


def test_without_an_x_server_keys_count_from_their_arrival():
    assert open_key_times("auto", None).name == "arrival"

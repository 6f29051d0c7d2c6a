"""Keys injected into the real window: none lost or doubled, repeats are no events, losing the focus lets go."""

from __future__ import annotations

import subprocess
import sys
import time

import glfw
import pytest

from experiment_app.pictures.film import condition_of, walking
from experiment_app.scene import Camera, Crowd, Scene, Walker
from experiment_app.timing.injected_keys import KEY, KEYSYM, NOBODY, matched, measure_keys
from experiment_app.timing.key_injector import Injector, can_inject
from experiment_app.windows.desktop import DesktopWindow
from experiment_app.windows.offscreen import offscreen_context
from experiment_app.windows.patch import Patch
from protocols.events import Event, FocusLost, KeyDown, KeyUp
from protocols.study_file import read_study
from tests.benchmarks.measuring import machine

pytestmark = [
    pytest.mark.window,
    pytest.mark.slow,
    pytest.mark.skipif(not can_inject(), reason="needs an X display and libXtst (`sh setup.sh test` brings both)"),
]


def small(**settings: object) -> DesktopWindow:
    return DesktopWindow(full_screen=False, size=(320, 200), samples=1, **settings)  # type: ignore[arg-type]


def frame(window: DesktopWindow) -> list[Event]:
    """One frame with a walker; the events that came in."""
    _, events = window.poll(NOBODY)
    seen = window.next_display_time()
    window.show(Scene((Walker("F1", 1.2, 105.0, 0.875 * seen % 1.0),)))
    return list(events)


@pytest.mark.parametrize("keyboard", ["auto", "arrival"])
def test_no_injected_press_is_lost_or_doubled(capsys, keyboard):
    with small(keyboard=keyboard) as window:
        for _ in range(5):
            frame(window)

        def show() -> None:
            window.show(Scene((Walker("F1", 1.2, 105.0, window.now() % 1.0),)))

        errors = measure_keys(window, show, 40)
        if errors.lost or errors.doubled:  # a server that stood still stamps two presses alike, and GLFW drops one
            errors = measure_keys(window, show, 40)
    assert errors.source == ("x-server" if keyboard == "auto" else "arrival")
    assert (errors.lost, errors.doubled, len(errors.presses), len(errors.releases)) == (0, 0, 40, 40)
    with capsys.disabled():
        print(f"\n  {machine()}: {errors.summary()}")


def test_a_window_opens_after_something_was_drawn_off_screen():
    context = offscreen_context()  # stays current on this thread
    with small() as window:
        assert window.period > 0.0
    context.release()


def test_holding_a_key_past_its_repeats_is_one_press_and_one_release_as_long_as_it_was_held():
    with small() as window, Injector() as injector:
        injector.begin([(KEYSYM, True, 0.3), (KEYSYM, False, 1.2)])
        events: list[Event] = []
        while (times := injector.times()) is None:
            events += frame(window)
        for _ in range(10):
            events += frame(window)
    keys = [event for event in events if isinstance(event, (KeyDown, KeyUp)) and event.key == KEY]
    assert [type(event) for event in keys] == [KeyDown, KeyUp]
    assert keys[1].time - keys[0].time == pytest.approx(times[1] - times[0], abs=0.1)


def test_an_injector_that_is_ended_early_leaves_no_key_down():
    with small() as window:
        for _ in range(3):
            frame(window)
        events: list[Event] = []
        with Injector() as injector:
            injector.begin([(KEYSYM, True, 0.1), (KEYSYM, False, 60.0)])
            until = time.monotonic() + 20.0
            while not any(isinstance(event, KeyDown) for event in events) and time.monotonic() < until:
                events += frame(window)
        for _ in range(10):
            events += frame(window)
    assert [type(event) for event in events] == [KeyDown, KeyUp]


def test_losing_the_focus_says_so_and_releases_what_is_held():
    with small() as window, Injector() as injector:
        for _ in range(3):
            frame(window)
        injector.begin([(KEYSYM, True, 0.3), (KEYSYM, False, 4.0)])
        events: list[Event] = []
        until = time.monotonic() + 20.0
        while not any(isinstance(event, KeyDown) for event in events) and time.monotonic() < until:
            events += frame(window)
        take_the_focus()
        while not any(isinstance(event, KeyUp) for event in events) and time.monotonic() < until:
            events += frame(window)
    assert [type(event) for event in events if not isinstance(event, FocusLost)] == [KeyDown, KeyUp]
    assert any(isinstance(event, FocusLost) for event in events)


def take_the_focus() -> None:
    """Gives the keyboard to the root window, as another program's window would take it."""
    code = (
        "from Xlib import X, display; d = display.Display(); "
        "d.set_input_focus(X.PointerRoot, X.RevertToNone, 0); d.sync()"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_the_square_for_a_photodiode_is_white_with_a_walker_or_a_crowd_and_black_without():
    crowd = Scene((), Camera("elevated", 34.0, 10.0, 40.0, 180.0), "street", crowd=Crowd(2))
    with small(patch=Patch("bottom-right")) as window:
        levels = []
        for scene in (Scene((Walker("F1", 1.2, 105.0, 0.25),)), Scene(), crowd):
            window.poll(NOBODY)
            window.show(scene)
            levels.append(corner_level())
    assert levels == [255, 0, 255]


@pytest.mark.parametrize(("study", "answers"), [("poulaine_reconstruction", ["left"]), ("fourier_naturalness", [])])
def test_the_mouses_buttons_answer_where_a_question_has_nothing_to_click(study, answers):
    asked = read_study(study).study
    with small(devices=("mouse",)) as window:
        window.poll(NOBODY)
        window.show(walking(asked, condition_of(asked, []), 1.0))
        on_button = window._callbacks[2]
        on_button(None, glfw.MOUSE_BUTTON_LEFT, glfw.PRESS, 0)
        _, events = window.poll(NOBODY)
    assert [event.key for event in events if isinstance(event, KeyDown)] == answers


def corner_level() -> int:
    """The code of the pixel near the lower right corner of gaitlab's window, read from the X server."""
    code = (
        "from Xlib import X, display; d = display.Display(); r = d.screen().root\n"
        "w = next(c for c in r.query_tree().children if c.get_wm_name() == 'gaitlab'); g = w.get_geometry()\n"
        "print(w.get_image(g.width - 6, g.height - 6, 1, 1, X.ZPixmap, 0xffffffff).data[1])"
    )
    return int(subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout)


def test_stamps_belong_to_presses_in_order_or_to_the_nearest():
    assert matched([1.0, 2.0], [1.3, 2.3]) == [0, 1]
    assert matched([1.0, 2.0, 3.0], [1.001, 3.001]) == [0, None, 1]

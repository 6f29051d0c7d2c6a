"""A window or a keyboard that fails while it is opened gives back what was open already."""

from __future__ import annotations

import sys
from types import SimpleNamespace

import pytest

from experiment_app.errors import UsageError
from experiment_app.windows import desktop, psychtoolbox_times
from experiment_app.windows.desktop import DesktopWindow
from experiment_app.windows.psychtoolbox_times import PsychtoolboxTimes


class Opening:
    """Says what was opened and closed, in order; the one named `failing` cannot be opened."""

    def __init__(self, failing: str, error: BaseException) -> None:
        self.failing, self.error = failing, error
        self.said: list[str] = []

    def open(self, name: str, **more: object) -> SimpleNamespace:
        if name == self.failing:
            raise self.error
        self.said.append(name)
        return SimpleNamespace(close=lambda: self.said.append(f"{name} closed"), name="arrival", **more)


@pytest.fixture
def opening(monkeypatch, request) -> Opening:
    """A window whose parts are all made up."""
    opening = Opening(*request.param)

    def swaps(count: int) -> list[float]:
        opening.open("probe")
        return [0.02 * i for i in range(count)]

    class Glfw:
        PLATFORM_X11, terminate = 1, staticmethod(lambda: opening.said.append("window closed"))
        get_framebuffer_size, get_window_content_scale = (lambda _, __: (8, 8)), (lambda _, __: (1.0, 1.0))

        def __getattr__(self, name: str):  # type: ignore[no-untyped-def]
            return lambda *_: None

    def open_window(*_: object) -> tuple[object, None]:
        opening.open("window")
        return object(), None

    monkeypatch.setattr(desktop, "glfw", Glfw())
    monkeypatch.setattr(desktop, "open_window", open_window)
    monkeypatch.setattr(desktop, "open_key_times", lambda *_: opening.open("keys"))
    monkeypatch.setattr(desktop, "WaitingInGlfw", lambda: opening.open("waiting", wake=lambda: None))
    monkeypatch.setattr(desktop, "Drawing", lambda *_: opening.open("drawing", bare_swaps=swaps))
    return opening


PARTS = ["window", "keys", "waiting", "drawing", "probe"]


@pytest.mark.parametrize("opening", [(part, RuntimeError("no")) for part in PARTS], indirect=True, ids=PARTS)
def test_a_window_that_fails_half_way_closes_what_was_opened_latest_first(opening):
    interval = sys.getswitchinterval()
    before = PARTS[: PARTS.index(opening.failing)]
    wanted = UsageError if opening.failing in ("keys", "waiting", "drawing") else RuntimeError
    with pytest.raises(wanted, match="no"):
        DesktopWindow()
    assert opening.said == [*before, *(f"{part} closed" for part in reversed(before))]
    assert sys.getswitchinterval() == interval


@pytest.mark.parametrize("opening", [("drawing", KeyboardInterrupt())], indirect=True)
def test_a_window_closes_what_was_opened_when_somebody_presses_ctrl_c_meanwhile(opening):
    with pytest.raises(KeyboardInterrupt):
        DesktopWindow()
    assert opening.said == ["window", "keys", "waiting", "waiting closed", "keys closed", "window closed"]


@pytest.mark.parametrize("opening", [("nothing", RuntimeError())], indirect=True)
def test_a_window_that_opened_is_closed_once(opening):
    interval = sys.getswitchinterval()
    with DesktopWindow():
        assert opening.said == PARTS
    assert opening.said[len(PARTS) :] == ["drawing closed", "waiting closed", "keys closed", "window closed"]
    assert sys.getswitchinterval() == interval


@pytest.mark.parametrize("failing", ["KbQueueCreate", "KbQueueStart"])
def test_a_keyboard_queue_that_does_not_start_gives_the_others_back(monkeypatch, failing):
    open_queues, running = set(), set()

    def hid(verb: str, number: int):  # type: ignore[no-untyped-def]
        if verb == "Devices":
            return [{"index": 3.0}, {"index": 5.0}]
        if (verb, number) == (failing, 5):
            raise Exception("device is busy")  # as PsychHID does
        queues = open_queues if verb in ("KbQueueCreate", "KbQueueRelease") else running
        (queues.add if verb in ("KbQueueCreate", "KbQueueStart") else queues.remove)(number)
        return None

    modules = {"PsychHID": SimpleNamespace(PsychHID=hid), "GetSecs": SimpleNamespace(GetSecs=lambda: 0.0)}
    monkeypatch.setattr(psychtoolbox_times, "_module", modules.__getitem__)
    with pytest.raises(RuntimeError, match="does not start \\(device is busy\\)"):
        PsychtoolboxTimes()
    assert (open_queues, running) == (set(), set())
    failing = "nothing"
    times = PsychtoolboxTimes()
    assert (open_queues, running) == ({3, 5}, {3, 5})
    times.close()
    assert (open_queues, running) == (set(), set())

"""The X server's own time of every key event, read from the events on GLFW's connection before GLFW handles them.

The server stamps an event when the device reports it, so neither drawing nor Python's lock delays the stamp. Its
clock is CLOCK_MONOTONIC in whole ms on local servers; that is measured when the source is opened, not believed.
"""

from __future__ import annotations

import ctypes
import time
from typing import Any

from experiment_app.windows.key_times import NotedTimes, Stamp
from experiment_app.windows.xlib import KEY_PRESS, KEY_RELEASE, PROPERTY_CHANGE_MASK, QUEUED_AFTER_READING, XEvent, xlib

WRAP_MS = 1 << 32
"""The server's clock is 32 bits wide and starts again every 49.7 days."""

STEP = 0.001
"""s between two readings of the server's clock."""

EXCHANGES = 20
"""Questions asked to measure the server's clock, about 2 ms in all."""

REMOTE = 0.005
"""s: a server whose clock can only be known less well than this is not on this computer and not used."""


class XServerTimes:
    """Times of the key events on an X connection (address of GLFW's Display). Raises OSError or RuntimeError."""

    name = "x-server"
    notes_repeats = True

    def __init__(self, glfw_display: int) -> None:
        self._x11 = xlib()
        self._display = ctypes.c_void_p(glfw_display)
        self._noted = NotedTimes()
        self._events: list[XEvent] = []
        lowest, highest = measured_clock(self._x11)
        same_clock = lowest <= 0.0 <= highest
        self._offset = 0.0 if same_clock else (lowest + highest) / 2.0
        self._error = 0.0 if same_clock else (highest - lowest) / 2.0
        if self._error > REMOTE:
            raise RuntimeError("the X server's clock is too far away to be used")
        self._bounds = (lowest, highest)

    def collect(self) -> None:
        """Looks through the queue of events and leaves it as it was."""
        now = time.perf_counter()
        count = self._x11.XEventsQueued(self._display, QUEUED_AFTER_READING)
        if not count:
            return
        while len(self._events) < count:
            self._events.append(XEvent())
        for event in self._events[:count]:
            self._x11.XNextEvent(self._display, ctypes.byref(event))
            if event.type in (KEY_PRESS, KEY_RELEASE):
                self._noted.note(event.key.keycode, event.type == KEY_PRESS, self._stamp(event.key.time, now))
        for event in reversed(self._events[:count]):
            self._x11.XPutBackEvent(self._display, ctypes.byref(event))

    def take(self, keycode: int, down: bool) -> Stamp | None:
        """The server's time of the oldest event of this key not yet taken."""
        return self._noted.take(keycode, down)

    def forget(self) -> None:
        """All that was noted has been handled."""
        self._noted.forget()

    def description(self) -> dict[str, Any]:
        """The clock: steps of 1 ms, and between which offsets (ms) from ours it was found to lie."""
        lowest, highest = self._bounds
        return {
            "source": self.name,
            "resolution_ms": 1.0,
            "clock_offset_between_ms": [round(1e3 * lowest, 3), round(1e3 * highest, 3)],
            "clock_error_ms": round(0.5 + 1e3 * self._error, 3),
        }

    def close(self) -> None:
        """GLFW closes its connection itself."""

    def _stamp(self, server_ms: int, arrived: float) -> Stamp:
        """The stamp of an event that the server put at `server_ms` and that had arrived by `arrived` (s)."""
        middle, half = possible(unwrapped(server_ms, arrived + self._offset) - self._offset, arrived)
        return Stamp(middle, self.name, round(1e3 * (half + self._error), 3))


def possible(server: float, arrived: float) -> tuple[float, float]:
    """s: middle and half the length of the time in which an event can have happened.

    It happened in the ms that began at `server`, as the server's clock is cut to whole ms, and before it arrived.
    """
    latest = min(max(arrived, server), server + STEP)
    return (server + latest) / 2.0, (latest - server) / 2.0


def unwrapped(server_ms: int, now: float) -> float:
    """s: the moment within 24 days of `now` at which a 32-bit clock in ms shows `server_ms`."""
    now_ms = int(now * 1e3)
    behind = (now_ms - server_ms + WRAP_MS // 2) % WRAP_MS - WRAP_MS // 2
    return (now_ms - behind) / 1e3


def measured_clock(x11: Any) -> tuple[float, float]:
    """Between which offsets (s) the server's clock lies from ours.

    A change of a property is stamped by the server between our question and its answer; the offset must agree with
    all of EXCHANGES such stamps. Uses a connection of its own.
    """
    display = ctypes.c_void_p(x11.XOpenDisplay(None))
    if not display:
        raise RuntimeError("the X server allows no second connection")
    try:
        window = x11.XCreateSimpleWindow(display, x11.XDefaultRootWindow(display), 0, 0, 1, 1, 0, 0, 0)
        x11.XSelectInput(display, window, PROPERTY_CHANGE_MASK)
        atom = x11.XInternAtom(display, b"GAITLAB_CLOCK", 0)
        lowest, highest = -float("inf"), float("inf")
        event = XEvent()
        for _ in range(EXCHANGES):
            asked = time.perf_counter()
            x11.XChangeProperty(display, window, atom, atom, 8, 0, b"x", 1)
            x11.XNextEvent(display, ctypes.byref(event))
            answered = time.perf_counter()
            stamp = unwrapped(event.property.time, answered)
            lowest, highest = max(lowest, stamp - answered), min(highest, stamp + STEP - asked)
        return lowest, highest
    finally:
        x11.XCloseDisplay(display)

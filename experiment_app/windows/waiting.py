"""Waiting for events without sleeping through them: on the X connection where there is one, else in GLFW."""

from __future__ import annotations

import os
import select
from typing import Protocol

import glfw

from experiment_app.windows.xlib import QUEUED_AFTER_READING, xlib


class Waiting(Protocol):
    """Waits for events, and can be woken from any thread."""

    def wait(self, timeout: float) -> None:
        """Returns when events may have come in, when woken, or after `timeout` (s)."""

    def wake(self) -> None:
        """Ends a wait; safe from any thread and from signal handlers."""

    def close(self) -> None:
        """Gives back what was opened."""


class WaitingInGlfw:
    """GLFW's own waiting, which handles the events at once."""

    def wait(self, timeout: float) -> None:
        """Handles events until one came, until woken, or for `timeout` (s)."""
        glfw.wait_events_timeout(max(timeout, 1e-4))

    def wake(self) -> None:
        """Posts an empty event."""
        glfw.post_empty_event()

    def close(self) -> None:
        """Nothing was opened."""


class WaitingForX:
    """Waits on GLFW's X connection (address of its Display) and handles nothing, so that times can be read first."""

    def __init__(self, glfw_display: int) -> None:
        self._x11, self._display = xlib(), glfw_display
        self._connection = self._x11.XConnectionNumber(glfw_display)
        self._woken, self._waker = os.pipe()
        os.set_blocking(self._woken, False)
        os.set_blocking(self._waker, False)

    def wait(self, timeout: float) -> None:
        """Returns when the connection has something to read, when woken, or after `timeout` (s)."""
        if self._x11.XEventsQueued(self._display, QUEUED_AFTER_READING):
            return
        ready, _, _ = select.select([self._connection, self._woken], [], [], max(timeout, 0.0))
        if self._woken in ready:
            os.read(self._woken, 4096)

    def wake(self) -> None:
        """Writes into the pipe; when it is full, a wake is under way already."""
        try:
            os.write(self._waker, b".")
        except BlockingIOError:
            return

    def close(self) -> None:
        """Closes the pipe."""
        os.close(self._woken)
        os.close(self._waker)

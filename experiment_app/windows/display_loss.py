"""What happens when the X server takes the window or goes away: libX11 would end the program without a word.

A request about a window that another program destroyed is an error that Xlib reports to a handler, after which the
program may go on; a lost connection is reported to another, which may not return (Xlib manual, section 11.8.2).
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from experiment_app.windows.xlib import xlib

WINDOW_LOST = "window destroyed by another program"
DISPLAY_LOST = "the display went away"

Handler = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)
LostHandler = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p)
IGNORING = Handler(lambda _display, _event: 0)
"""Stays after a loss: closing what is left of the window causes further errors."""


@contextmanager
def display_loss(request_end: Callable[[str], None], last_words: Callable[[str], None]) -> Iterator[None]:
    """While open, a lost window asks the session to end; a lost display says `last_words` and exits with status 1."""
    try:
        x11 = xlib()
    except OSError:  # a system without X has no such errors
        yield
        return

    window_lost = False

    def error(_display: int, _event: int) -> int:
        nonlocal window_lost
        window_lost = True
        request_end(WINDOW_LOST)
        return 0

    def lost(_display: int) -> int:
        try:
            last_words(DISPLAY_LOST)
        finally:
            os._exit(1)

    handlers = Handler(error), LostHandler(lost)
    x11.XSetErrorHandler.restype = x11.XSetIOErrorHandler.restype = ctypes.c_void_p
    x11.XSetErrorHandler.argtypes = x11.XSetIOErrorHandler.argtypes = [ctypes.c_void_p]
    before = x11.XSetErrorHandler(handlers[0]), x11.XSetIOErrorHandler(handlers[1])
    try:
        yield
    finally:
        x11.XSetErrorHandler(IGNORING if window_lost else before[0])
        x11.XSetIOErrorHandler(before[1])

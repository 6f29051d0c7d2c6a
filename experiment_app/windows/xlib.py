"""What is used of libX11, through ctypes: events and their times, properties, owners of selections."""

from __future__ import annotations

import ctypes
import ctypes.util
from functools import cache
from typing import Any

KEY_PRESS, KEY_RELEASE = 2, 3
PROPERTY_CHANGE_MASK = 1 << 22
QUEUED_AFTER_READING = 1

EVERY_EVENT = (
    ("type", ctypes.c_int),
    ("serial", ctypes.c_ulong),
    ("send_event", ctypes.c_int),
    ("display", ctypes.c_void_p),
    ("window", ctypes.c_ulong),
)
"""XAnyEvent of Xlib.h: what every event begins with."""


class KeyEvent(ctypes.Structure):
    """XKeyEvent of Xlib.h."""

    _fields_ = (
        *EVERY_EVENT,
        ("root", ctypes.c_ulong),
        ("subwindow", ctypes.c_ulong),
        ("time", ctypes.c_ulong),
        ("x", ctypes.c_int),
        ("y", ctypes.c_int),
        ("x_root", ctypes.c_int),
        ("y_root", ctypes.c_int),
        ("state", ctypes.c_uint),
        ("keycode", ctypes.c_uint),
        ("same_screen", ctypes.c_int),
    )


class PropertyEvent(ctypes.Structure):
    """XPropertyEvent of Xlib.h."""

    _fields_ = (
        *EVERY_EVENT,
        ("atom", ctypes.c_ulong),
        ("time", ctypes.c_ulong),
        ("state", ctypes.c_int),
    )


class XEvent(ctypes.Union):
    """XEvent of Xlib.h."""

    _fields_ = (
        ("type", ctypes.c_int),
        ("key", KeyEvent),
        ("property", PropertyEvent),
        ("pad", ctypes.c_long * 24),
    )


@cache
def xlib() -> Any:
    """libX11 with the signatures used here; raises OSError where there is none."""
    x11 = ctypes.CDLL(ctypes.util.find_library("X11") or "libX11.so.6")
    display: Any = ctypes.c_void_p
    window: Any = ctypes.c_ulong
    event: Any = ctypes.POINTER(XEvent)
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XDefaultRootWindow.restype = window
    x11.XCreateSimpleWindow.restype = window
    x11.XInternAtom.restype = ctypes.c_ulong
    x11.XGetSelectionOwner.restype = window
    x11.XOpenDisplay.argtypes = [ctypes.c_char_p]
    for function, arguments in (
        (x11.XCloseDisplay, [display]),
        (x11.XDefaultRootWindow, [display]),
        (x11.XEventsQueued, [display, ctypes.c_int]),
        (x11.XNextEvent, [display, event]),
        (x11.XPutBackEvent, [display, event]),
        (x11.XSelectInput, [display, window, ctypes.c_long]),
        (x11.XInternAtom, [display, ctypes.c_char_p, ctypes.c_int]),
        (x11.XConnectionNumber, [display]),
        (x11.XFlush, [display]),
        (x11.XKeysymToKeycode, [display, ctypes.c_ulong]),
        (x11.XGetSelectionOwner, [display, ctypes.c_ulong]),
        (
            x11.XCreateSimpleWindow,
            [display, window, *[ctypes.c_int] * 2, *[ctypes.c_uint] * 3, *[ctypes.c_ulong] * 2],
        ),
        (
            x11.XChangeProperty,
            [display, window, *[ctypes.c_ulong] * 2, *[ctypes.c_int] * 2, ctypes.c_char_p, ctypes.c_int],
        ),
    ):
        function.argtypes = arguments
    return x11

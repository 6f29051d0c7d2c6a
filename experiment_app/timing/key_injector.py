"""A program that presses keys at exact times through the X server's test extension; for measurements and tests.

`python -m experiment_app.timing.key_injector` reads one line of JSON, a list of [keysym, down (1 or 0), s since the one
before], presses and releases the keys, and prints the moments just before each as JSON (s, `time.perf_counter`). It is
a process of its own, so that the program that is measured cannot delay it.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import json
import os
import signal
import sys
import time
from collections.abc import Sequence
from subprocess import PIPE, Popen

from experiment_app.windows.xlib import xlib

SPIN = 0.001
"""s before each moment that are waited for awake, because sleep overshoots."""

Step = tuple[int, bool, float]
"""Keysym, whether it goes down, and s since the step before."""


def can_inject() -> bool:
    """Whether this computer has an X server and the library of its test extension."""
    return bool(os.environ.get("DISPLAY") and ctypes.util.find_library("Xtst"))


def inject(steps: Sequence[Step]) -> list[float]:
    """Takes the steps, from a fifth of a second from now; the moments (s) just before each. Raises OSError."""
    x11 = xlib()
    tests = ctypes.CDLL(ctypes.util.find_library("Xtst") or "libXtst.so.6")
    tests.XTestFakeKeyEvent.argtypes = [ctypes.c_void_p, ctypes.c_uint, ctypes.c_int, ctypes.c_ulong]
    display = x11.XOpenDisplay(None)
    if not display:
        raise OSError("there is no X server to inject keys into")
    codes = {keysym: x11.XKeysymToKeycode(display, keysym) for keysym, _, _ in steps}
    times, at = [], time.perf_counter() + 0.2
    held: set[int] = set()
    try:
        for keysym, down, later in steps:
            at += later
            time.sleep(max(at - time.perf_counter() - SPIN, 0.0))
            while (now := time.perf_counter()) < at:
                pass
            tests.XTestFakeKeyEvent(display, codes[keysym], int(down), 0)
            x11.XFlush(display)
            times.append(now)
            (held.add if down else held.discard)(codes[keysym])
    finally:  # a key that stayed down would be down for every program that comes after
        for code in held:
            tests.XTestFakeKeyEvent(display, code, 0, 0)
        x11.XCloseDisplay(display)
    return times


class Injector:
    """The program, started and waiting for its steps. Use as a context manager."""

    def __init__(self) -> None:
        self._process = Popen(
            [sys.executable, "-m", "experiment_app.timing.key_injector"], stdin=PIPE, stdout=PIPE, text=True
        )

    def __enter__(self) -> Injector:
        return self

    def __exit__(self, *_: object) -> None:
        if self._process.poll() is None:
            self._process.terminate()  # it lets go of what it holds
        self._process.communicate()

    def begin(self, steps: Sequence[Step]) -> None:
        """Lets it take the steps."""
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(steps) + "\n")
        self._process.stdin.flush()

    def times(self) -> list[float] | None:
        """The moments of the steps once all are taken, else None; raises OSError when keys could not be injected."""
        if self._process.poll() is None:
            return None
        assert self._process.stdout is not None
        said = self._process.stdout.read()
        if self._process.returncode:
            raise OSError("keys cannot be injected here")
        return [float(moment) for moment in json.loads(said)]


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    print(json.dumps(inject(json.loads(sys.stdin.readline()))))

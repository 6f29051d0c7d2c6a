"""Keys pressed by a program at known times, through the X server's test extension, to measure how keys are stamped.

`python -m experiment_app.injected_keys COUNT` waits for a line on standard input, presses a key that no study uses
COUNT times at random moments and prints the times as JSON. A process of its own, so that what is measured cannot
delay it.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from random import Random
from statistics import median, quantiles
from subprocess import PIPE, Popen
from typing import TYPE_CHECKING, cast

from experiment_app.windows.xlib import xlib
from protocols.events import KeyDown, KeyUp
from protocols.session import Session

if TYPE_CHECKING:
    from experiment_app.windows.desktop import DesktopWindow

KEY, KEYSYM = "key-345", 0xFFE4  # the right Control key, which no study uses
SPACING = (0.08, 0.14)
"""s from one press to the next, uniform."""

HELD = (0.03, 0.05)
"""s from press to release, uniform."""

NOBODY = cast(Session, None)
"""A window with a person before it ignores the session."""


@dataclass(frozen=True)
class KeyErrors:
    """How far the stamps of injected keys were off, ms: stamp minus the moment just before the injection.

    presses, releases: of every event. once_per_frame: the errors of a program that stamps presses when it asks for
    them, once per frame, in the same run. injected: keys pressed; lost, doubled: presses without or beside a stamp.
    """

    source: str
    injected: int
    presses: tuple[float, ...]
    releases: tuple[float, ...]
    once_per_frame: tuple[float, ...]
    lost: int
    doubled: int

    def summary(self) -> dict[str, object]:
        """For a journal or a certificate: medians and 90th percentiles of the absolute errors."""
        return {
            "source": self.source,
            "presses": self.injected,
            "lost": self.lost,
            "doubled": self.doubled,
            "median_ms": round(median(self.presses), 3) if self.presses else None,
            "p90_ms": round(percentile_90([abs(error) for error in self.presses]), 3) if self.presses else None,
        }


def percentile_90(values: Sequence[float]) -> float:
    """The value below which nine tenths lie, interpolated."""
    return quantiles(values, n=10, method="inclusive")[-1] if len(values) > 1 else values[0]


def can_inject() -> bool:
    """Whether this computer has an X server and the library of its test extension."""
    return bool(os.environ.get("DISPLAY") and ctypes.util.find_library("Xtst"))


def inject(count: int) -> list[tuple[float, float]]:
    """Presses the key `count` times; the moments (s, `time.perf_counter`) just before each press and release."""
    x11 = xlib()
    tests = ctypes.CDLL(ctypes.util.find_library("Xtst") or "libXtst.so.6")
    tests.XTestFakeKeyEvent.argtypes = [ctypes.c_void_p, ctypes.c_uint, ctypes.c_int, ctypes.c_ulong]
    display = x11.XOpenDisplay(None)
    keycode = x11.XKeysymToKeycode(display, KEYSYM)

    def press(down: bool, at: float) -> float:
        time.sleep(max(at - time.perf_counter() - 0.001, 0.0))
        while (now := time.perf_counter()) < at:
            pass
        tests.XTestFakeKeyEvent(display, keycode, down, 0)
        x11.XFlush(display)
        return now

    random = Random(1)
    times, at = [], time.perf_counter() + 0.2
    for _ in range(count):
        at += random.uniform(*SPACING)
        times.append((press(True, at), press(False, at + random.uniform(*HELD))))
    return times


def measure_keys(window: DesktopWindow, show: Callable[[], object], count: int) -> KeyErrors:
    """Injects `count` presses while `show` draws frame after frame in the window, and compares the stamps.

    Raises OSError where keys cannot be injected (no X server, or one without the test extension).
    """
    down: list[KeyDown] = []
    up: list[KeyUp] = []
    polled: list[float] = []
    command = [sys.executable, "-m", "experiment_app.injected_keys", str(count)]
    with Popen(command, stdin=PIPE, stdout=PIPE, text=True) as injector:
        assert injector.stdin is not None
        assert injector.stdout is not None
        injector.stdin.write("go\n")
        injector.stdin.flush()
        ended = None
        while ended is None or window.now() < ended + 0.3:
            if ended is None and injector.poll() is not None:
                ended = window.now()
            now, events = window.poll(NOBODY)
            for event in events:
                if isinstance(event, KeyDown) and event.key == KEY:
                    down.append(event)
                    polled.append(now)
                elif isinstance(event, KeyUp) and event.key == KEY:
                    up.append(event)
            show()
        said = injector.stdout.read()
        if injector.returncode:
            raise OSError("keys cannot be injected here")
    times = [(press - window.origin, release - window.origin) for press, release in json.loads(said)]
    return _compared(times, down, up, polled)


def _compared(
    times: Sequence[tuple[float, float]], down: Sequence[KeyDown], up: Sequence[KeyUp], polled: Sequence[float]
) -> KeyErrors:
    """The errors of the events that belong to injected ones: the first within half a spacing of each."""
    pressed = [_belonging(at, [event.time for event in down]) for at, _ in times]
    released = [_belonging(at, [event.time for event in up]) for _, at in times]
    found = [index for index in pressed if index is not None]
    ms = 1e3
    return KeyErrors(
        source=down[0].source if down else "none",
        injected=len(times),
        presses=tuple(ms * (down[i].time - at) for i, (at, _) in zip(pressed, times, strict=True) if i is not None),
        releases=tuple(ms * (up[i].time - at) for i, (_, at) in zip(released, times, strict=True) if i is not None),
        once_per_frame=tuple(ms * (polled[i] - at) for i, (at, _) in zip(pressed, times, strict=True) if i is not None),
        lost=len(times) - len(set(found)),
        doubled=len(down) - len(set(found)),
    )


def _belonging(at: float, stamps: Sequence[float]) -> int | None:
    nearest = min(range(len(stamps)), key=lambda i: abs(stamps[i] - at), default=None)
    return nearest if nearest is not None and abs(stamps[nearest] - at) < SPACING[0] / 2 else None


def main() -> None:
    """Waits for the word, then injects."""
    sys.stdin.readline()
    print(json.dumps(inject(int(sys.argv[1]))))


if __name__ == "__main__":
    main()

"""How far the times of keys are off: keys are injected at known times while a window draws, and the stamps compared."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from random import Random
from statistics import median
from typing import TYPE_CHECKING, cast

from experiment_app.timing.facts import percentile_90
from experiment_app.timing.key_injector import Injector, Step
from protocols.events import KeyDown, KeyUp
from protocols.session import Session

if TYPE_CHECKING:
    from experiment_app.windows.desktop import DesktopWindow

KEY, KEYSYM = "key-345", 0xFFE4
"""The right Control key, which no study uses: its name here, and X's number for it."""

SPACING = (0.08, 0.14)
"""s from one press to the next, uniform."""

HELD = (0.03, 0.05)
"""s from press to release, uniform."""

NOBODY = cast(Session, None)
"""A window with a person before it ignores the session."""


@dataclass(frozen=True)
class KeyErrors:
    """How far the stamps of injected keys were off, ms: stamp minus the moment just before the injection.

    pressed_at: those moments (s, `time.perf_counter`). presses, releases: of every event that arrived.
    once_per_frame: the errors of a program that stamps presses when it asks for them, once per frame, in the same run.
    lost, doubled: presses without a stamp, and stamps without a press of their own.
    """

    source: str
    pressed_at: tuple[float, ...]
    presses: tuple[float, ...]
    releases: tuple[float, ...]
    once_per_frame: tuple[float, ...]
    lost: int
    doubled: int

    def summary(self) -> dict[str, object]:
        """For a certificate: the median error and the 90th percentile of its size."""
        return {
            "source": self.source,
            "presses": len(self.pressed_at),
            "lost": self.lost,
            "doubled": self.doubled,
            "median_ms": round(median(self.presses), 3) if self.presses else None,
            "p90_ms": round(percentile_90([abs(error) for error in self.presses]), 3) if self.presses else None,
        }


def measure_keys(window: DesktopWindow, show: Callable[[], object], count: int) -> KeyErrors:
    """Injects `count` presses while `show` draws frame after frame in the window, and compares the stamps.

    Raises OSError where keys cannot be injected (no X server, or one without the test extension).
    """
    down: list[KeyDown] = []
    up: list[KeyUp] = []
    polled: list[float] = []
    with Injector() as injector:
        injector.begin(_presses(count))
        times, ended = injector.times(), 0.0
        while times is None or window.now() < ended + 0.3:
            if times is None:
                times, ended = injector.times(), window.now()
            now, events = window.poll(NOBODY)
            for event in events:
                if isinstance(event, KeyDown) and event.key == KEY:
                    down.append(event)
                    polled.append(now)
                elif isinstance(event, KeyUp) and event.key == KEY:
                    up.append(event)
            show()
    pressed = [moment - window.origin for moment in times[0::2]]
    released = [moment - window.origin for moment in times[1::2]]
    presses = matched(pressed, [event.time for event in down])
    return KeyErrors(
        source=down[0].source if down else "none",
        pressed_at=tuple(times[0::2]),
        presses=_errors(pressed, [event.time for event in down], presses),
        releases=_errors(released, [event.time for event in up], matched(released, [event.time for event in up])),
        once_per_frame=_errors(pressed, polled, presses),
        lost=presses.count(None),
        doubled=len(down) - len(set(presses) - {None}),
    )


def _presses(count: int) -> list[Step]:
    random = Random(1)
    steps: list[Step] = []
    held = 0.0
    for _ in range(count):
        steps.append((KEYSYM, True, random.uniform(*SPACING) - held))
        held = random.uniform(*HELD)
        steps.append((KEYSYM, False, held))
    return steps


def matched(moments: Sequence[float], stamps: Sequence[float]) -> list[int | None]:
    """For every moment (s) the number of its stamp; None where there is none.

    As many stamps as moments belong to them in order, even when the whole computer stood still for a while; else a
    moment's stamp is the nearest within half a spacing.
    """
    if len(stamps) == len(moments):
        return list(range(len(moments)))
    found: list[int | None] = []
    for moment in moments:
        nearest = min(range(len(stamps)), key=lambda i: abs(stamps[i] - moment), default=None)
        near = nearest is not None and abs(stamps[nearest] - moment) < SPACING[0] / 2
        found.append(nearest if near else None)
    return found


def _errors(moments: Sequence[float], stamps: Sequence[float], found: Sequence[int | None]) -> tuple[float, ...]:
    """ms: stamp minus moment, where there is a stamp."""
    return tuple(1e3 * (stamps[i] - at) for at, i in zip(moments, found, strict=True) if i is not None)

"""Psychtoolbox's keyboard queue as a source of key times, for laboratories that compare with PsychoPy or MATLAB.

Its thread waits on a connection of its own and reads the clock when it wakes (Linux), or takes the device's own
times (macOS). Optional: `pip install 'gaitlab[psychtoolbox]'`.
"""

from __future__ import annotations

import importlib
import sys
import time
from contextlib import ExitStack
from importlib.metadata import version
from importlib.util import find_spec
from types import ModuleType
from typing import Any

from experiment_app.windows.key_times import NotedTimes, Stamp

UNCERTAINTY_MS = 1.0
"""Its p90 under a virtual display on a busy machine was below this (docs/trust.md)."""

KEYBOARDS = 4
"""Its number for the class of devices that are keyboards."""

AHEAD = 0.05
"""s that Psychtoolbox may know of a key before GLFW does."""

CLOCKS = 15
"""Comparisons of its clock with ours when it is opened."""


class PsychtoolboxTimes:
    """Times from the queues of all keyboards. Raises ImportError or RuntimeError where it cannot run."""

    name = "psychtoolbox"
    notes_repeats = False

    def __init__(self) -> None:
        self._hid = _module("PsychHID").PsychHID
        seconds = _module("GetSecs").GetSecs
        pairs = [(time.perf_counter(), seconds(), time.perf_counter()) for _ in range(CLOCKS)]
        before, theirs, after = min(pairs, key=lambda pair: pair[2] - pair[0])
        self._offset = theirs - (before + after) / 2.0
        self._noted = NotedTimes()
        self._keyboards: list[int] = []
        try:
            with ExitStack() as queues:  # those of the other keyboards are given back, if one does not start
                for keyboard in self._hid("Devices", KEYBOARDS):
                    index = int(keyboard["index"])
                    self._hid("KbQueueCreate", index)
                    queues.callback(self._hid, "KbQueueRelease", index)
                    self._hid("KbQueueStart", index)
                    queues.callback(self._hid, "KbQueueStop", index)
                    self._keyboards.append(index)
                self._queues = queues.pop_all()
        except Exception as error:  # PsychHID raises bare Exceptions
            raise RuntimeError(f"Psychtoolbox's keyboard queue does not start ({error})") from None

    def collect(self) -> None:
        """Drains the queues."""
        for keyboard in self._keyboards:
            left = 1
            while left:
                event, left = self._hid("KbQueueGetEvent", keyboard)
                if isinstance(event, dict):
                    stamp = Stamp(float(event["Time"]) - self._offset, self.name, UNCERTAINTY_MS)
                    self._noted.note(_code(int(event["Keycode"]) - 1), bool(event["Pressed"]), stamp)

    def take(self, keycode: int, down: bool) -> Stamp | None:
        """The queue's time of the oldest event of this key not yet taken."""
        return self._noted.take(_code(keycode), down)

    def forget(self) -> None:
        """Drops what GLFW has not reported for a while; its connection may be ahead of GLFW's for a moment."""
        self._noted.forget(time.perf_counter() - AHEAD)

    def description(self) -> dict[str, Any]:
        """Its version and how many keyboards it listens to."""
        return {
            "source": self.name,
            "version": version("psychtoolbox"),
            "keyboards": len(self._keyboards),
            "clock_error_ms": UNCERTAINTY_MS,
        }

    def close(self) -> None:
        """Stops its thread."""
        self._queues.close()


def _code(keycode: int) -> int:
    """What tells keys apart: X's code; elsewhere the two programs count keys differently, so only their order does."""
    return keycode if sys.platform.startswith("linux") else 0


def _module(name: str) -> ModuleType:
    """One compiled module of Psychtoolbox, without the sound library that importing the whole package needs."""
    if "psychtoolbox" not in sys.modules:
        spec = find_spec("psychtoolbox")
        if spec is None or not spec.submodule_search_locations:
            raise ImportError("psychtoolbox is not installed (pip install 'gaitlab[psychtoolbox]')")
        package = ModuleType("psychtoolbox")
        package.__path__ = list(spec.submodule_search_locations)
        sys.modules["psychtoolbox"] = package
    return importlib.import_module(f"psychtoolbox.{name}")

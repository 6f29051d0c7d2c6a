"""Listens to the keyboard with PsychoPy or Psychtoolbox beside gaitlab, for `tests.benchmarks.timing`.

`PYTHON rival_keyboards.py psychopy|psychtoolbox KEYCODE KEYNAME` prints a line when it listens, stops at the first
line on its standard input, and prints the times of the presses as JSON, s on `time.perf_counter`. It runs in the
rival's own environment, so it imports nothing of gaitlab.
"""

from __future__ import annotations

import json
import select
import sys
import time
from importlib.util import find_spec
from types import ModuleType


def psychtoolbox_module(name: str):  # type: ignore[no-untyped-def]
    """A compiled module of Psychtoolbox, without the sound library that importing the whole package needs."""
    import importlib

    if "psychtoolbox" not in sys.modules:
        spec = find_spec("psychtoolbox")
        if spec is None or not spec.submodule_search_locations:
            raise ImportError("psychtoolbox is not installed")
        package = ModuleType("psychtoolbox")
        package.__path__ = list(spec.submodule_search_locations)
        sys.modules["psychtoolbox"] = package
    return importlib.import_module(f"psychtoolbox.{name}")


def offset(seconds) -> float:  # type: ignore[no-untyped-def]
    """s that a clock is ahead of ours, from the quickest of many readings."""
    readings = [(time.perf_counter(), seconds(), time.perf_counter()) for _ in range(50)]
    before, theirs, after = min(readings, key=lambda reading: reading[2] - reading[0])
    return float(theirs) - (before + after) / 2.0


def told_to_stop() -> bool:
    """Whether a line has come in."""
    return bool(select.select([sys.stdin], [], [], 0.0)[0])


def with_psychopy(_: int, name: str) -> list[float]:
    """PsychoPy's default keyboard, asked once per frame."""
    import psychtoolbox
    from psychopy import logging
    from psychopy.hardware import keyboard

    listener = keyboard.Keyboard()
    if listener.getBackend() != "ptb":
        raise ImportError(f"PsychoPy's keyboard uses {listener.getBackend()}, not its default")
    listener.start()
    ahead = offset(psychtoolbox.GetSecs) - logging.defaultClock.getLastResetTime()
    print("listening", flush=True)
    presses = []
    while not told_to_stop():
        presses += [key.tDown - ahead for key in listener.getKeys(waitRelease=True) if key.name == name]
        time.sleep(1 / 60)
    return presses


def with_psychtoolbox(keycode: int, _: str) -> list[float]:
    """Psychtoolbox's queues of all keyboards."""
    hid = psychtoolbox_module("PsychHID").PsychHID
    ahead = offset(psychtoolbox_module("GetSecs").GetSecs)
    keyboards = [int(keyboard["index"]) for keyboard in hid("Devices", 4)]
    for keyboard in keyboards:
        hid("KbQueueCreate", keyboard)
        hid("KbQueueStart", keyboard)
    print("listening", flush=True)
    while not told_to_stop():
        time.sleep(0.05)
    presses = []
    for keyboard in keyboards:
        left = 1
        while left:
            event, left = hid("KbQueueGetEvent", keyboard)
            if isinstance(event, dict) and event["Pressed"] and int(event["Keycode"]) - 1 == keycode:
                presses.append(float(event["Time"]) - ahead)
    return sorted(presses)


if __name__ == "__main__":
    listen = {"psychopy": with_psychopy, "psychtoolbox": with_psychtoolbox}[sys.argv[1]]
    print(json.dumps(listen(int(sys.argv[2]), sys.argv[3])))

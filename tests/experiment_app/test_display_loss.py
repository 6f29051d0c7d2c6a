"""A window that another program destroys, or a display that goes away, ends a run with its reason and a sentence."""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from experiment_app.run_folder import participant_runs
from experiment_app.windows.xlib import xlib
from tests.protocols.studies import changed

ROOT = Path(__file__).parents[2]
TITLE = "A study whose window is lost"


@pytest.mark.window
@pytest.mark.skipif(not os.environ.get("DISPLAY"), reason="needs an X display (Xvfb will do)")
@pytest.mark.parametrize(
    ("request_of_x", "reason", "told"),
    [
        ("XDestroyWindow", "window destroyed by another program", "window destroyed by another program"),
        ("XKillClient", "crashed: the display went away", "the display went away"),
    ],
)
def test_a_lost_window_ends_the_run_with_its_reason_and_the_way_to_go_on(tmp_path, request_of_x, reason, told):
    study = tmp_path / "mine.yaml"
    study.write_text(changed(("title: Which walk looks most natural?", f"title: {TITLE}")), encoding="utf-8")
    process = subprocess.Popen(
        [sys.executable, "-m", "experiment_app", "run", str(study), "--participant", "P01",
         "--data", str(tmp_path / "data"), "--window", "--size", "320x200"],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=ROOT,
    )  # fmt: skip
    journal = tmp_path / "data/walk_ratio/sourcedata/sub-P01/run-1/journal.jsonl"
    _wait_for_a_line(journal, process)
    _of_the_window(TITLE, request_of_x)
    said = process.communicate(timeout=60)[0]
    assert process.returncode == 1, said
    assert f"the run ended early ({told}); everything recorded is in {journal}. To go on: gaitlab run" in said
    assert "X Error" not in said
    assert "Traceback" not in said
    (run,) = participant_runs(tmp_path / "data", "walk_ratio", "P01")
    assert run.interruption == reason


def _wait_for_a_line(journal: Path, process: subprocess.Popen[str]) -> None:
    end = time.monotonic() + 60
    while not (journal.exists() and journal.stat().st_size):
        assert process.poll() is None, process.communicate()[0]
        assert time.monotonic() < end
        time.sleep(0.02)
    time.sleep(1.5)  # the handlers are set after the header is safe


def _of_the_window(title: str, request: str) -> None:
    """Does to the window of that title what another X client can do to it."""
    x11 = ctypes.CDLL(xlib()._name)  # signatures of its own
    x11.XOpenDisplay.restype, x11.XDefaultRootWindow.restype = ctypes.c_void_p, ctypes.c_ulong
    display = ctypes.c_void_p(x11.XOpenDisplay(None))
    root = ctypes.c_ulong(x11.XDefaultRootWindow(display))
    ignored, count, children = ctypes.c_ulong(), ctypes.c_uint(), ctypes.POINTER(ctypes.c_ulong)()
    x11.XQueryTree(
        display, root, ctypes.byref(ignored), ctypes.byref(ignored), ctypes.byref(children), ctypes.byref(count)
    )
    for window in [ctypes.c_ulong(children[place]) for place in range(count.value)]:
        name = ctypes.c_char_p()
        x11.XFetchName(display, window, ctypes.byref(name))
        if name.value == title.encode():
            getattr(x11, request)(display, window)
            x11.XSync(display, 0)
            break
    else:
        raise AssertionError(f"no window is called {title}")
    x11.XCloseDisplay(display)

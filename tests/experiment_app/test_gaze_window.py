"""Gaze in the real window: the pointer, and a synthetic eye tracker, on the body parts of a walker; markers beside."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import uuid
from pathlib import Path

import pytest

from tests.experiment_app.test_lsl import ALONE
from tests.experiment_app.test_window import Sitting, number_of, short_text, sit, to_the_first_trial

pytestmark = [
    pytest.mark.window,
    pytest.mark.slow,
    pytest.mark.skipif(
        not os.environ.get("DISPLAY") or shutil.which("xdotool") is None,
        reason="needs an X display and xdotool (`sh setup.sh test` brings both)",
    ),
]
__all__ = ["sit"]

TRACKER = """
import sys, time, pylsl
info = pylsl.StreamInfo("synthetic", "Gaze", 2, 120.0, "float32", "synthetic-1")
channels = info.desc().append_child("channels")
for label in ("y", "x"):
    channels.append_child("channel").append_child_value("label", label)
outlet = pylsl.StreamOutlet(info)
inlet = None
print("ready", flush=True)
while True:
    outlet.push_sample([float(sys.argv[2]), float(sys.argv[1])])
    if inlet is None:
        found = pylsl.resolve_byprop("type", "Markers", 1, 0.005)
        inlet = pylsl.StreamInlet(found[0]) if found else None
    else:
        sample, stamp = inlet.pull_sample(0.0)
        if sample:
            print(stamp, sample[0], flush=True)
    time.sleep(1 / 120)
"""


def with_gaze(folder: Path, gaze: str) -> None:
    """The short study with gaze, and a walker that stays in the middle of the picture."""
    text = short_text().replace("task:\n", f"gaze: {gaze}\ntask:\n", 1)
    (folder / "short.yaml").write_text(text, encoding="utf-8")


def finished_trial(person: Sitting) -> tuple[dict, dict]:
    """Plays the training trial; its gaze and its record."""
    to_the_first_trial(person)
    person.hold("Left", 2.0)
    person.until_key("Return", "trial")
    lines = person.lines()
    return next(line for line in lines if line["kind"] == "gaze"), next(
        line for line in lines if line["kind"] == "trial"
    )


def test_the_pointer_on_the_body_gives_its_part_in_every_frame(sit, tmp_path):
    with_gaze(tmp_path, "{source: mouse}")
    person = sit()
    person.wait(lambda lines: lines[0]["kind"] == "header")
    window = subprocess.run(
        ["xdotool", "search", "--onlyvisible", "--pid", str(person.process.pid)], capture_output=True, text=True
    ).stdout.split()[-1]
    subprocess.run(["xdotool", "mousemove", "--window", window, "320", "140"], check=True)  # the walker's chest
    gaze, trial = finished_trial(person)
    assert number_of(person.lines(), "gaze") == 1
    assert len(gaze["flips"]) >= trial["frames"] - 2
    assert gaze["regions"].count("torso") > 0.8 * len(gaze["regions"])
    assert trial["measured"]["gaze_torso"] == pytest.approx(
        100 * gaze["regions"].count("torso") / trial["measured"]["gaze_frames"]
    )
    shares = [value for name, value in trial["measured"].items() if name.startswith("gaze_") and name != "gaze_frames"]
    assert sum(shares) == pytest.approx(100.0)


def test_a_synthetic_eye_tracker_fills_the_shares_and_hears_the_markers(sit, tmp_path, monkeypatch):
    pytest.importorskip("pylsl", reason="pylsl is not installed (extra lsl)", exc_type=Exception)
    settings = tmp_path / "lsl.cfg"
    settings.write_text(ALONE.format(session=uuid.uuid4().hex))
    monkeypatch.setenv("LSLAPICFG", str(settings))
    with_gaze(tmp_path, "{unit: pixels}")
    width, height = (int(n) for n in subprocess.run(
        ["xdotool", "getdisplaygeometry"], capture_output=True, text=True, check=True
    ).stdout.split())  # fmt: skip
    heard = tmp_path / "markers.txt"
    with open(heard, "w") as file:
        # the window stands in the middle of the display, and the walker's legs in its lower half
        tracker = subprocess.Popen(
            [sys.executable, "-c", TRACKER, str(width / 2), str(height / 2 + 80)], stdout=file, text=True
        )
    try:
        gaze, trial = finished_trial(sit("P01", "--lsl"))
    finally:
        tracker.terminate()
        tracker.wait()
    assert trial["measured"]["gaze_frames"] >= 0.8 * len(gaze["flips"]) > 0
    assert trial["measured"]["gaze_legs"] > 30.0  # the legs swing past the point
    assert trial["measured"]["gaze_legs"] + trial["measured"]["gaze_elsewhere"] > 99.0
    markers = [
        json.loads(line.split(" ", 1)[1])
        for line in heard.read_text().splitlines()
        if line.startswith(tuple("0123456789"))
    ]
    assert [marker["kind"] for marker in markers[:2]] == ["begin", "trial"]


def test_a_missing_eye_tracker_is_said_before_anything_is_recorded(sit, tmp_path, monkeypatch):
    pytest.importorskip("pylsl", reason="pylsl is not installed (extra lsl)", exc_type=Exception)
    settings = tmp_path / "lsl.cfg"
    settings.write_text(ALONE.format(session=uuid.uuid4().hex))
    monkeypatch.setenv("LSLAPICFG", str(settings))
    with_gaze(tmp_path, "{}")
    person = sit()
    status, said = person.ended()
    assert status == 2
    assert "no stream of type Gaze" in said
    assert not person.journal.exists()

"""Markers out and gaze in over Lab Streaming Layer, with synthetic streams on this machine alone."""

import json
import os
import subprocess
import sys
import uuid
from pathlib import Path

import pytest

from experiment_app.errors import UsageError
from experiment_app.gaze.stream import chosen_channels
from experiment_app.markers.stream import marker
from protocols.gaze import GazeSettings
from protocols.record import Answered, Ended, Paused, TrialBegun

ROOT = Path(__file__).resolve().parents[2]

ALONE = """
[multicast]
ResolveScope = machine
[lab]
KnownPeers = {{127.0.0.1}}
SessionID = {session}
[ports]
IPv6 = disable
[log]
level = -3
"""


def run_alone(script: str, folder: Path) -> dict:
    """Runs a script in a process whose streams no other test sees, and returns the JSON it prints."""
    pytest.importorskip("pylsl", reason="pylsl is not installed (extra lsl)", exc_type=Exception)
    settings = folder / "lsl.cfg"
    settings.write_text(ALONE.format(session=uuid.uuid4().hex))
    environment = {**os.environ, "LSLAPICFG": str(settings)}
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, env=environment, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.strip().splitlines()[-1])


MARKERS = """
import json, time, pylsl
from experiment_app.markers.lsl import clock_offset
from experiment_app.markers.stream import MarkerStream
from experiment_app.run_folder import Run
from protocols.record import TrialBegun, PageShown

class Kept:
    def __init__(self): self.records, self.saved = [], True
    def write(self, records): self.records += records

journal = Kept()
origin = time.perf_counter()
run = Run(None, "walk_ratio", "P01", 1)
with MarkerStream(journal, run, "abc", clock_offset(time.perf_counter() - origin)) as stream:
    found = pylsl.resolve_byprop("type", "Markers", 1, 10.0)
    inlet = pylsl.StreamInlet(found[0])
    about = inlet.info(5.0).desc().child_value("participant")
    inlet.open_stream(5.0)
    flip = time.perf_counter() - origin - 1.0
    stream.write([PageShown(flip, "instructions-1", 0.0), TrialBegun(flip, 7, False, 1, {"actor": "Élodie"})])
    sample, stamp = inlet.pull_sample(5.0)
print(json.dumps({"text": sample[0], "error": stamp - (flip + origin), "about": about, "kept": len(journal.records),
                  "name": found[0].name()}))
"""


def test_a_marker_arrives_with_the_flip_time_of_what_it_announces(tmp_path):
    got = run_alone(MARKERS, tmp_path)
    told = json.loads(got["text"])
    assert told == {
        "kind": "begin", "code": 1, "trial": 7, "practice": False, "attempt": 1, "factors": {"actor": "Élodie"},
    }  # fmt: skip
    assert abs(got["error"]) < 0.001
    assert (got["about"], got["name"]) == ("P01", "gaitlab walk_ratio")
    assert got["kept"] == 2  # the journal has everything, also what no marker announces


GAZE = """
import json, time, pylsl
from experiment_app.gaze.stream import GazeStream
from experiment_app.markers.lsl import clock_offset
from protocols.gaze import GazeSettings

info = pylsl.StreamInfo("tracker", "Gaze", 4, 250.0, "float32", "tracker-1")
channels = info.desc().append_child("channels")
for label in ("pupil", "norm_pos_y", "confidence", "norm_pos_x"):
    channels.append_child("channel").append_child_value("label", label)
outlet = pylsl.StreamOutlet(info)
origin = time.perf_counter() - 100.0
settings = GazeSettings(confidence="confidence", origin="bottom_left")
stream = GazeStream(settings, (1920, 1080), lambda x, y: (x, y), clock_offset(time.perf_counter() - origin))
taken = time.perf_counter() - origin
for confidence, y in ((1.0, 0.25), (0.1, 0.9), (1.0, float("nan"))):
    outlet.push_sample([3.0, y, confidence, 0.75], pylsl.local_clock())
samples, until = [], time.time() + 5.0
while not samples and time.time() < until:
    samples += stream.poll()
time.sleep(0.2)
samples += stream.poll()
stream.close()
print(json.dumps({"samples": [(s.time - taken, s.x, s.y) for s in samples], "name": stream.name}))
"""


def test_gaze_comes_by_label_in_any_order_without_blinks_and_on_the_clock_of_the_run(tmp_path):
    got = run_alone(GAZE, tmp_path)
    assert got["name"] == "tracker"
    assert len(got["samples"]) == 1  # the others had too little confidence or no number
    late, x, y = got["samples"][0]
    assert -0.001 <= late < 0.05  # the streams estimate the difference of their clocks
    assert (x, y) == pytest.approx((0.75, 0.75))  # a quarter from the bottom is three quarters from the top


AFTER_A_PAGE = """
import json, time, pylsl
from experiment_app.gaze.stream import GazeStream
from protocols.gaze import GazeSettings

info = pylsl.StreamInfo("tracker", "Gaze", 2, 1000.0, "float32", "tracker-2")
channels = info.desc().append_child("channels")
for label in ("x", "y"):
    channels.append_child("channel").append_child_value("label", label)
outlet = pylsl.StreamOutlet(info)
stream = GazeStream(GazeSettings(), (1920, 1080), lambda x, y: (x, y), 0.0)
outlet.wait_for_consumers(5.0)
begun = pylsl.local_clock()
for number in range(1800):
    outlet.push_sample([number / 1800.0, 0.5], begun + number / 1000.0)
time.sleep(0.5)
first, second = stream.poll(), stream.poll()
stream.close()
print(json.dumps({"first": len(first), "last": first[-1].x, "second": len(second)}))
"""


def test_what_came_during_a_page_does_not_hold_up_the_gaze_of_the_first_frames_after_it(tmp_path):
    got = run_alone(AFTER_A_PAGE, tmp_path)
    assert got["first"] > 1024  # what pylsl gives at a time
    assert got["last"] == pytest.approx(1799.0 / 1800.0)
    assert got["second"] == 0


def test_a_missing_stream_is_a_sentence(tmp_path):
    script = (
        "import json\n"
        "import experiment_app.gaze.stream as stream\n"
        "from protocols.gaze import GazeSettings\n"
        "stream.FINDING_TIME = 0.2\n"
        "try:\n    stream.GazeStream(GazeSettings(), (1, 1), None, 0.0)\n"
        "except Exception as error:\n    print(json.dumps([type(error).__name__, str(error)]))\n"
    )
    kind, sentence = run_alone(script, tmp_path)
    assert kind == "UsageError"
    assert "no stream of type Gaze was found" in sentence
    assert "take `gaze:` out" in sentence


def test_channels_are_found_by_label_never_by_place():
    assert chosen_channels(["t", "y", "x"], GazeSettings(), "tracker") == (2, 1, None)
    assert chosen_channels(["gaze.x", "gaze.y"], GazeSettings(), "tracker") == (0, 1, None)
    assert chosen_channels(["a", "b", "x", "y"], GazeSettings(x="a", y="b"), "tracker") == (0, 1, None)


def test_channels_that_are_not_there_are_named_with_those_that_are():
    with pytest.raises(UsageError, match=r"no channels 'a' and 'b'; it has left, right\. Name two of them"):
        chosen_channels(["left", "right"], GazeSettings(x="a", y="b"), "tracker")
    with pytest.raises(UsageError, match="no channel 'trust'; it has x, y"):
        chosen_channels(["x", "y"], GazeSettings(confidence="trust"), "tracker")


def test_markers_announce_trials_pauses_and_the_end_but_no_answers():
    assert json.loads(marker(Ended(1.0, "finished")))["code"] == 5
    assert json.loads(marker(Paused(1.0, "break"))) == {"kind": "pause", "code": 3, "why": "break"}
    assert json.loads(marker(TrialBegun(1.0, 1, True, 2, {})))["attempt"] == 2
    assert marker(Answered(1.0, "age", 31)) is None

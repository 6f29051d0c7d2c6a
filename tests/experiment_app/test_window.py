"""The real window under a virtual display, driven by injected keys, through every page of a session."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from experiment_app.run_folder import journal_lines
from tests.protocols.studies import changed

pytestmark = [
    pytest.mark.window,
    pytest.mark.slow,
    pytest.mark.skipif(
        not os.environ.get("DISPLAY") or shutil.which("xdotool") is None,
        reason="needs an X display and xdotool (`sh setup.sh test` brings both)",
    ),
]

PATIENCE = 60.0
"""s to wait for something to appear in the journal; the software rasteriser is slow on a busy machine."""


def number_of(lines: list[dict], kind: str) -> int:
    """How many records of a kind there are."""
    return sum(line["kind"] == kind for line in lines)


class Sitting:
    """A participant sitting at a running gaitlab: types keys, waits for what the journal says."""

    def __init__(self, folder: Path, participant: str = "P01", *more: str) -> None:
        self.folder = folder
        self.study = folder / "short.yaml"
        if not self.study.exists():
            self.study.write_text(short_text(), encoding="utf-8")
        self.process = subprocess.Popen(
            [sys.executable, "-m", "experiment_app", "run", str(self.study), "--participant", participant,
             "--data", str(folder / "data"), "--window", "--size", "640x360", *more],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        )  # fmt: skip
        self.journal = folder / "data" / "walk_ratio" / "sourcedata" / f"sub-{participant}" / "run-1" / "journal.jsonl"

    def lines(self) -> list[dict]:
        return list(journal_lines(self.journal)[0]) if self.journal.exists() else []

    def wait(self, what: Callable[[list[dict]], bool]) -> list[dict]:
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            lines = self.lines()
            if lines and what(lines):
                return lines
            assert self.process.poll() is None or (self.lines() and what(self.lines())), self.process.communicate()[0]
            time.sleep(0.02)
        raise AssertionError([line["kind"] for line in self.lines()])

    def count(self, kind: str) -> int:
        return number_of(self.lines(), kind)

    def key(self, *names: str) -> None:
        subprocess.run(["xdotool", "key", "--delay", "60", *names], check=True)

    def until_key(self, name: str, kind: str) -> None:
        """Presses a key, again if the page was not there yet, until one more record of a kind is written."""
        before, end = self.count(kind), time.monotonic() + PATIENCE
        while self.count(kind) == before and time.monotonic() < end:
            self.key(name)
            time.sleep(0.4)
        assert self.count(kind) > before

    def hold(self, name: str, seconds: float) -> None:
        subprocess.run(["xdotool", "keydown", name], check=True)
        time.sleep(seconds)
        subprocess.run(["xdotool", "keyup", name], check=True)

    def ended(self) -> tuple[int, str]:
        said = self.process.communicate(timeout=PATIENCE)[0]
        return self.process.returncode, said


def short_text() -> str:
    """Two trials after one training trial, with short waits."""
    return changed(
        ("actor: [F1, F2, M1, M2]  ", "actor: [F1]"),
        ("speed: [0.8, 1.0, 1.2]  ", "speed: [1.0]"),
        ("repetitions: 4  ", "repetitions: 1"),
        ("  - {actor: T2, speed: 1.0, start: 80}\n", ""),
        ("minimum_looking_time: 2 ", "minimum_looking_time: 0.2 "),
        ("interval: 0.7 ", "interval: 0.1 "),
        ("within: [actor, speed, start]", "within: [start]"),
        ("{factor: speed, bound: 0.0003}", "{factor: start, bound: 0.0003}"),
        ("F1: 0.00690, F2: 0.00560, M1: 0.00700, M2: 0.00700", "F1: 0.00690"),
    )


@pytest.fixture
def sit(tmp_path) -> Iterator[Callable[..., Sitting]]:
    sittings: list[Sitting] = []

    def begin(*arguments: str) -> Sitting:
        sittings.append(Sitting(tmp_path, *arguments))
        return sittings[-1]

    yield begin
    for sitting in sittings:
        if sitting.process.poll() is None:
            sitting.process.kill()
            sitting.process.communicate()


def consent_and_questions(person: Sitting) -> None:
    person.wait(lambda lines: lines[0]["kind"] == "header")
    time.sleep(1.0)
    person.key("Right", "Return")
    person.wait(lambda lines: number_of(lines, "consent") == 1)
    time.sleep(0.5)
    person.key("3", "4", "Tab", "Right", "Right", "Tab", "Right", "Tab", "Return")
    person.wait(lambda lines: any(line.get("page") == "questions-1" for line in lines))


def to_the_first_trial(person: Sitting) -> None:
    consent_and_questions(person)
    for _ in range(3):
        person.until_key("Return", "page")
    person.wait(lambda lines: number_of(lines, "begin") == 1)


def test_a_whole_session_with_a_pause_is_in_the_journal(sit):
    person = sit()
    to_the_first_trial(person)
    person.hold("Left", 1.0)  # training starts at 120
    person.until_key("Return", "trial")
    person.until_key("Return", "page")
    person.wait(lambda lines: number_of(lines, "begin") == 2)
    person.key("Escape")
    person.wait(lambda lines: number_of(lines, "pause") == 1)
    person.until_key("Return", "resume")
    start = [line for line in person.lines() if line["kind"] == "begin"][-1]["factors"]["start"]
    person.hold("Right" if start == 80 else "Left", 1.5)
    person.until_key("Return", "trial")
    person.wait(lambda lines: number_of(lines, "begin") == 3)
    person.until_key("Return", "trial")
    person.wait(lambda lines: number_of(lines, "end") == 1)
    time.sleep(0.5)
    person.key("Return")
    status, said = person.ended()
    assert status == 0, said
    lines = person.lines()
    assert {line["question"]: line["value"] for line in lines if line["kind"] == "answer"} == {
        "age": 34, "sex": "male", "vision": "yes",
    }  # fmt: skip
    training, first, second = (line for line in lines if line["kind"] == "trial")
    keys = [line for line in lines if line["kind"] == "key" and line["trial"] == 1 and line["key"] in ("left", "right")]
    for trial, begun in ((training, 120), (first, start)):
        mine = [k for k in keys if k["practice"] == trial["practice"]]
        held = sum(k["time"] * (-1 if k["down"] else 1) for k in mine)
        sign = 1 if mine[0]["key"] == "right" else -1
        assert trial["response"]["step_frequency"] == pytest.approx(begun + sign * 10.0 * held, abs=1e-9)
    assert first["pauses"] == 1
    assert second["response"]["step_frequency"] == second["factors"]["start"]
    for trial in (training, first, second):
        assert trial["frames"] > 0
        assert trial["measured"]["step_frequency"] == pytest.approx(trial["response"]["step_frequency"], rel=0.005)
        assert trial["measured"]["speed"] == pytest.approx(trial["factors"]["speed"], rel=0.005)
    frames = [line for line in lines if line["kind"] == "frames"]
    assert len(frames[0]["flips"]) == len(frames[0]["poses"]) == training["frames"]
    # a machine too busy to bring the server's note in time falls back on the arrival, and says so
    assert {line["source"] for line in keys} <= {"x-server", "arrival"}
    assert any(line["source"] == "x-server" and line["uncertainty_ms"] <= 1.0 for line in keys)
    assert lines[0]["display"]["swap_waits_for_display"] is False
    certificate = (person.folder / "data" / "walk_ratio" / "sourcedata" / "sub-P01" / "run-1" / "timing.md").read_text()
    assert "Not synchronised" in certificate
    assert "Timing: not publishable" in said
    assert (len(frames[0]["stretches"]), len(frames[1]["stretches"])) == (1, 2)  # the second trial was paused


def test_refusing_consent_ends_politely_and_stores_only_the_refusal(sit):
    person = sit("P02")
    person.wait(lambda lines: lines[0]["kind"] == "header")
    time.sleep(1.0)
    person.key("Right", "Right", "Return")
    person.wait(lambda lines: number_of(lines, "end") == 1)
    time.sleep(0.5)
    person.key("Return")
    status, said = person.ended()
    assert (status, "declined" in said) == (0, True)
    assert [line["kind"] for line in person.lines()] == ["header", "consent", "end"]


@pytest.mark.parametrize(("number", "name"), [(signal.SIGTERM, "SIGTERM"), (signal.SIGINT, "SIGINT")])
def test_a_signal_in_a_trial_records_its_name_and_the_run_goes_on_later(sit, number, name):
    person = sit()
    to_the_first_trial(person)
    person.process.send_signal(number)
    status, said = person.ended()
    assert status == 1
    assert name in said
    assert "Traceback" not in said
    assert person.lines()[-1] == {"kind": "end", "time": person.lines()[-1]["time"], "reason": name}
    again = sit("P01", "--resume", "yes")
    again.wait(lambda lines: number_of(lines, "continue") == 1)
    time.sleep(1.0)
    for _ in range(3):  # welcome back, and the two pages of instructions again
        again.until_key("Return", "page")
    lines = again.wait(lambda lines: number_of(lines, "begin") == 2)
    begun = [line for line in lines if line["kind"] == "begin"][-1]
    assert (begun["practice"], begun["attempt"]) == (True, 2)


def test_closing_the_window_mid_trial_is_recorded_and_nothing_is_lost(sit):
    person = sit()
    to_the_first_trial(person)
    person.hold("Left", 0.3)
    person.until_key("Return", "trial")
    window = subprocess.run(["xdotool", "search", "--name", "natural"], capture_output=True, text=True).stdout.split()
    close_window(window[-1])
    status, said = person.ended()
    assert status == 1
    assert "window closed" in said
    assert person.count("trial") == 1


def close_window(window: str) -> None:
    """Asks the window to close as a window manager does (there is none here): WM_DELETE_WINDOW."""
    code = (
        "import sys; from Xlib import display, protocol; d=display.Display(); w=d.create_resource_object('window', "
        "int(sys.argv[1])); e=protocol.event.ClientMessage(window=w, client_type=d.intern_atom('WM_PROTOCOLS'), "
        "data=(32,[d.intern_atom('WM_DELETE_WINDOW'),0,0,0,0])); w.send_event(e); d.sync()"
    )
    subprocess.run([sys.executable, "-c", code, window], check=True)


def test_without_a_terminal_an_unfinished_run_says_how_to_resume(sit):
    person = sit()
    consent_and_questions(person)
    person.process.kill()
    person.process.communicate()
    again = subprocess.run(
        [sys.executable, "-m", "experiment_app", "run", str(person.study), "--participant", "P01",
         "--data", str(person.folder / "data"), "--window"],
        stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=PATIENCE,
    )  # fmt: skip
    assert again.returncode == 2
    assert "--resume yes" in again.stderr

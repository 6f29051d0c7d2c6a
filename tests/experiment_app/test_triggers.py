"""Trigger pulses: each record's code on the line, in order and in the journal; a line that goes away loses nothing."""

from __future__ import annotations

import os
import pty
import re
import sys
import types
from contextlib import suppress

import pytest

from analysis.exports.runs import read_runs
from analysis.recorded.journal import read_study
from experiment_app.command import run
from experiment_app.errors import RunError, UsageError
from experiment_app.markers import triggers
from experiment_app.markers.triggers import Triggering, open_line, trigger_line, triggering
from experiment_app.participants.arrivals import arrivals
from experiment_app.run_folder import journal_lines
from protocols.record import Ended, Paused, Resumed, TrialBegun, TriggerSent
from tests.experiment_app.sessions import opened, play
from tests.journals import rewrite


class Line:
    """Remembers codes; breaks after `good` of them."""

    def __init__(self, good: int = 100) -> None:
        self.codes: list[int] = []
        self.good = good

    def send(self, code: int) -> None:
        if len(self.codes) == self.good:
            raise OSError(5, "Input/output error")
        self.codes.append(code)

    def close(self) -> None:
        self.codes.append(0)


class Kept:
    """A recorder that keeps."""

    saved = True

    def __init__(self) -> None:
        self.records: list[object] = []

    def write(self, records) -> None:
        self.records += records


RECORDS = [TrialBegun(1.0, 1, False, 1, {}), Paused(2.0, "pause"), Resumed(3.0, 1.0), Ended(4.0, "finished")]


def test_every_record_that_has_a_code_is_announced_and_the_pulse_recorded_after_it():
    line, kept = Line(), Kept()
    Triggering(kept, line, "serial:X", now=lambda: 7.5).write(RECORDS)
    assert line.codes == [1, 3, 4, 5]
    assert [record.kind for record in kept.records] == [
        "begin", "trigger", "pause", "trigger", "resume", "trigger", "end", "trigger",
    ]  # fmt: skip
    assert kept.records[1] == TriggerSent(7.5, 1, "begin", "serial:X")


def test_when_the_line_is_pulled_out_everything_is_still_recorded():
    kept = Kept()
    with pytest.raises(RunError, match="serial:X is gone"):
        Triggering(kept, Line(good=1), "serial:X", now=lambda: 0.0).write(RECORDS)
    assert [record for record in kept.records if not isinstance(record, TriggerSent)] == RECORDS


def test_a_place_is_free_again_though_the_pulse_of_the_end_or_a_failure_is_written_after_it(tmp_path):
    run, line = opened(tmp_path), Line(good=1)
    with suppress(RunError), run.journal as journal:
        recorder = Triggering(journal, line, "serial:X", now=lambda: 1.0)
        recorder.write([Ended(4.0, "declined")])
        recorder.write([Paused(5.0, "pause")])
    kinds = [record["kind"] for record in journal_lines(run.run.journal)[0]]
    assert kinds[-4:] == ["end", "trigger", "pause", "end"]
    assert [one.ended for one in arrivals(tmp_path, "walk_ratio")] == ["declined"]
    other = opened(tmp_path, "P02")
    other.journal.close()
    assert other.participant_number == run.participant_number


def test_who_has_finished_counts_though_the_line_went_away_on_the_last_page(tmp_path):
    run = opened(tmp_path)
    play(run)
    late = {"kind": "end", "time": 99.0, "reason": "failed: RunError: the trigger line serial:X is gone"}
    rewrite(run.run.journal, lambda records: [*records, late])
    (recorded,) = read_study(tmp_path / "walk_ratio").runs
    (exported,), _ = read_runs(tmp_path / "walk_ratio")
    assert (recorded.ended, exported.ended) == ("finished", "finished")


@pytest.mark.parametrize("text", ["serial", "usb:1", "parallel:", "parallel:/dev/there-is-no-such-port"])
def test_a_line_that_cannot_be_opened_is_a_sentence(text):
    with pytest.raises(UsageError, match="--trigger"):
        open_line(text)


@pytest.mark.skipif(sys.platform == "win32", reason="needs a pseudo-terminal")
def test_a_serial_line_carries_one_byte_per_code(monkeypatch):
    reader, writer = pty.openpty()

    class Port:
        """What pyserial's Serial does here: bytes to a file."""

        def __init__(self, port: str, baud: int, write_timeout: float) -> None:
            assert (port, baud) == ("/dev/box", 115200)

        def write(self, data: bytes) -> None:
            os.write(writer, data)

        def close(self) -> None:
            os.close(writer)

    module = types.ModuleType("serial")
    module.Serial = Port  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "serial", module)
    with trigger_line("serial:/dev/box") as line:
        triggering(Kept(), line, "serial:/dev/box", now=lambda: 0.0).write(RECORDS[1:3])
        assert os.read(reader, 1) + os.read(reader, 1) == bytes([3, 4])
    os.close(reader)


def test_without_a_line_the_recorder_is_the_journal_itself():
    kept = Kept()
    with trigger_line("") as line:
        assert triggering(kept, line, "", now=lambda: 0.0) is kept


@pytest.mark.parametrize("wrong", [["--trigger", "usb:1"], ["--lsl"]])
def test_what_is_missing_for_other_recorders_is_said_before_a_run_is_begun(wrong, tmp_path, monkeypatch, capfd):
    monkeypatch.setitem(sys.modules, "pylsl", None)
    assert run(["run", "walk_ratio", "--participant", "P01", "--data", str(tmp_path / "data"), *wrong]) == 2
    assert re.search("--trigger usb:1|gaitlab\\[lsl\\]", capfd.readouterr().err)
    assert not list(tmp_path.rglob("journal.jsonl"))


def test_a_parallel_line_sets_the_pins_and_clears_them(monkeypatch, tmp_path):
    requests: list[tuple[int, bytes]] = []
    port = tmp_path / "parport0"
    port.touch()
    monkeypatch.setattr(triggers.ParallelLine, "_request", lambda self, r, a=b"": requests.append((r, a)))
    line = triggers.ParallelLine(str(port))
    line.send(5)
    line.close()
    assert requests[:3] == [(triggers.PPCLAIM, b""), (triggers.PPWDATA, b"\0"), (triggers.PPWDATA, b"\5")]
    assert requests[-2:] == [(triggers.PPWDATA, b"\0"), (triggers.PPRELEASE, b"")]

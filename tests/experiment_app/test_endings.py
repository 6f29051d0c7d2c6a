"""However a run ends, what was acknowledged is on the disk, why it ended is known, and it can be continued."""

from __future__ import annotations

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from experiment_app import opening
from experiment_app.command import run as run_command
from experiment_app.errors import RunError, UsageError
from experiment_app.live import ScreenOptions, ending_signals, run_live
from experiment_app.loop import run_session
from experiment_app.opening import open_new
from experiment_app.participants.arrivals import first_headers
from experiment_app.participants.earlier import default_data, refuse_lookalike, tell_changes
from experiment_app.run_folder import participant_runs
from experiment_app.simulated.observer import SimulatedParticipant, draw_observer
from experiment_app.windows.undrawn import UndrawnWindow
from protocols.events import Closed
from protocols.session import begin
from protocols.study_file import parse_study, read_study
from tests.experiment_app.sessions import opened, play
from tests.protocols.studies import changed, short

ROOT = Path(__file__).parents[2]


def interrupted(data: Path, reason: str = "SIGTERM", after: int = 3) -> list[int]:
    """Plays until `after` records of trials are there, then ends as a signal does; returns the order planned."""
    run = opened(data)
    person = SimulatedParticipant(run.plan.study, draw_observer(run.plan.study, 1, run.seed), run.seed)

    class Ending(UndrawnWindow):
        def poll(self, session):  # type: ignore[no-untyped-def]
            now, events = super().poll(session)
            if run.journal.path.read_bytes().count(b'"kind":"trial"') >= after and session.trial is not None:
                return now, [Closed(now, reason)]
            return now, events

    with run.journal as journal:
        run_session(begin(run.plan), Ending(person, journal.wait), journal)
    return [step.trial.number for step in run.plan.steps if hasattr(step, "trial")]


@pytest.mark.parametrize("reason", ["SIGTERM", "SIGINT", "SIGHUP", "window closed"])
def test_the_reason_of_an_end_is_recorded_and_told_again_when_the_run_goes_on(tmp_path, reason):
    interrupted(tmp_path, reason)
    (run,) = participant_runs(tmp_path, "walk_ratio", "P01")
    assert run.interruption == reason
    play(opened(tmp_path))
    (run,) = participant_runs(tmp_path, "walk_ratio", "P01")
    assert [line["interrupted"] for line in run.lines if line["kind"] == "continue"] == [reason]
    assert run.end == "finished"


def test_a_continued_run_has_the_same_order_as_an_uninterrupted_one_and_marks_the_repeated_trial(tmp_path):
    interrupted(tmp_path / "a")
    play(opened(tmp_path / "a"))
    play(opened(tmp_path / "b"))
    runs = [participant_runs(tmp_path / folder, "walk_ratio", "P01")[0] for folder in "ab"]
    cells = [[(x["number"], x["factors"]) for x in run.lines if x["kind"] == "trial"] for run in runs]
    assert cells[0] == cells[1]
    attempts = [[x["attempt"] for x in run.lines if x["kind"] == "trial"] for run in runs]
    assert attempts == [[1, 1, 1, 2, 1, 1], [1] * 6]


def test_an_error_of_the_program_itself_is_recorded_as_the_end(tmp_path):
    run = opened(tmp_path)
    with pytest.raises(ZeroDivisionError), run.journal:
        _ = 1 / 0
    (run,) = participant_runs(tmp_path, "walk_ratio", "P01")
    assert run.interruption == "failed: ZeroDivisionError: division by zero"


def test_a_run_that_was_killed_says_that_no_end_was_recorded(tmp_path):
    run = opened(tmp_path)
    run.journal.close()
    (run,) = participant_runs(tmp_path, "walk_ratio", "P01")
    assert run.interruption == "no end was recorded: killed, or the power failed"


def test_a_clock_that_is_set_back_between_two_sittings_changes_no_order_and_no_time_of_a_trial(tmp_path, monkeypatch):
    monkeypatch.setattr(opening, "_utc_now", lambda: "2030-01-01T12:00:00Z")
    interrupted(tmp_path)
    monkeypatch.setattr(opening, "_utc_now", lambda: "1999-12-31T23:59:59Z")
    play(opened(tmp_path))
    (run,) = participant_runs(tmp_path, "walk_ratio", "P01")
    trials = [line for line in run.lines if line["kind"] == "trial"]
    assert run.end == "finished"
    assert len(trials) == 6
    assert all(0.0 < trial["response_time"] < 60.0 and trial["time"] > trial["onset"] for trial in trials)


def test_a_file_the_system_lets_grow_no_further_ends_the_run_with_its_reason(tmp_path):
    """RLIMIT_FSIZE: the operating system itself refuses to write, in the middle of a line."""
    run = opened(tmp_path)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    full = run.run.journal.stat().st_size + 3000
    resource.setrlimit(resource.RLIMIT_FSIZE, (full, limits[1]))
    try:
        with pytest.raises(RunError, match="File too large"):
            play(run)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    (left,) = participant_runs(tmp_path, "walk_ratio", "P01")
    assert left.lines[-1]["kind"] != "trial" or left.lines[-1]["number"], "whole lines only"
    play(opened(tmp_path))
    assert participant_runs(tmp_path, "walk_ratio", "P01")[0].end == "finished"


DISK = """
import json, subprocess, sys
from pathlib import Path
from experiment_app.errors import RunError
from experiment_app.run_folder import participant_runs
from experiment_app.opening import open_unfinished
from tests.experiment_app.sessions import opened, play
disk = Path(sys.argv[1])
subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "gaitlab", disk], check=True)
run, said = opened(disk), ""
ballast = open(disk / "ballast", "wb", buffering=0)
try:
    while ballast.write(bytes(4096)):
        pass
except OSError:
    ballast.truncate(ballast.tell() - 4096)
try:
    play(run)
except RunError as error:
    said = str(error)
subprocess.run(["mount", "-o", "remount,rw,size=4m", disk], check=True)
(before,) = participant_runs(disk, "walk_ratio", "P01")
play(opened(disk))
(after,) = participant_runs(disk, "walk_ratio", "P01")
print(json.dumps({"said": said, "interruption": before.interruption, "end": after.end,
                  "kept": [x["number"] for x in before.lines if x["kind"] == "trial"],
                  "trials": [x["number"] for x in after.lines if x["kind"] == "trial" and not x["practice"]]}))
"""


def on_a_disk_of_its_own(folder: Path) -> dict:
    """Plays a session on a small file system mounted for this process only."""
    alone = ["unshare", "--map-root-user", "--mount"]
    if shutil.which("unshare") is None or subprocess.run([*alone, "true"], capture_output=True).returncode:
        pytest.skip("no namespace of one's own can be made here (unshare --map-root-user --mount)")
    folder.mkdir()
    done = subprocess.run(
        [*alone, sys.executable, "-c", DISK, str(folder)], capture_output=True, text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_a_disk_that_is_really_full_ends_the_run_says_so_and_the_run_is_finished_on_a_larger_one(tmp_path):
    found = on_a_disk_of_its_own(tmp_path / "disk")
    assert "No space left on device" in found["said"]
    assert found["interruption"].startswith(("not written: No space left", "no end was recorded"))
    assert found["kept"]
    assert found["trials"] == [1, 2, 3, 4]
    assert found["end"] == "finished"


class ReadOnly:
    """An open file whose file system has been remounted read-only, as Linux does after an error of the disk."""

    def __init__(self, file) -> None:  # type: ignore[no-untyped-def]
        self._file = file

    def write(self, _: bytes) -> int:
        raise OSError(30, "Read-only file system")

    truncate = write

    def __getattr__(self, name: str):  # type: ignore[no-untyped-def]
        return getattr(self._file, name)


def test_a_disk_that_turns_read_only_ends_the_run_with_a_sentence_and_the_run_goes_on_later(tmp_path):
    run = opened(tmp_path)
    wait = run.journal.wait

    def pull() -> None:
        wait()
        if run.journal.path.read_bytes().count(b'"kind":"trial"') == 3:
            run.journal._file = ReadOnly(run.journal._file)  # type: ignore[assignment]

    run.journal.wait = pull  # type: ignore[method-assign]
    with pytest.raises(RunError, match=r"Read-only file system\); everything up to the last finished trial is safe"):
        play(run)
    (left,) = participant_runs(tmp_path, "walk_ratio", "P01")
    assert left.interruption == "no end was recorded: killed, or the power failed"
    assert sum(line["kind"] == "trial" for line in left.lines) == 3
    play(opened(tmp_path))
    assert participant_runs(tmp_path, "walk_ratio", "P01")[0].end == "finished"


def interrupted_once(data: Path, policy: str):
    file = parse_study("s.yaml", changed(("interval: 0.7 ", f"resume: {policy}\ninterval: 0.7 ")))
    run = open_new(file, "P01", data, display={}, simulated=False)
    run.journal.close()
    return file


@pytest.mark.parametrize(
    ("policy", "reason"),
    [("{policy: never}", "an interrupted run is not continued"), ("{longest_gap: 5}", "allows 5 min")],
)
def test_a_run_that_its_study_does_not_let_go_on_is_refused_before_a_window_opens(
    tmp_path, monkeypatch, policy, reason
):
    monkeypatch.setattr(opening, "_utc_now", lambda: "2020-01-01T00:00:00Z")
    file = interrupted_once(tmp_path / "data", policy)
    (tmp_path / "s.yaml").write_text(file.text, encoding="utf-8")
    with pytest.raises(UsageError, match=reason) as refused:
        run_live(
            str(tmp_path / "s.yaml"), "P01", tmp_path / "data", screen=ScreenOptions(full_screen=False), seed=None,
            new_run=False, resume="yes", ask=lambda _: True, say=lambda _: None,
        )  # fmt: skip
    assert "--new-run" in str(refused.value)


@pytest.mark.parametrize(
    ("first", "second"),
    [("real", "pilot"), ("pilot", "real"), ("pilot", "simulated"), ("real", "simulated"), ("simulated", "pilot")],
)
def test_real_pilot_and_simulated_runs_never_share_a_folder(tmp_path, first, second):
    def begin_one(participant: str, kind: str) -> None:
        run = open_new(short(), participant, tmp_path, display={}, simulated=kind == "simulated", pilot=kind == "pilot")
        run.journal.close()

    begin_one("P01", first)
    begin_one("P02", first)
    with pytest.raises(UsageError, match=f"holds {first} participants .*{second} ones must not be mixed"):
        begin_one("P03", second)


@pytest.mark.parametrize(
    ("study", "why"),
    [
        ("speed_editing", "its task is adjustment, here choice"),
        ("walk_ratio_actors", "its factors are actor, speed, start, here"),
    ],
)
def test_another_study_of_the_same_name_is_refused_before_a_window_opens_but_its_runs_go_on(tmp_path, study, why):
    open_new(short(), "P01", tmp_path, display={}, simulated=False).journal.close()
    text = read_study(study).text.replace(f"study: {study}", "study: walk_ratio")
    (tmp_path / "s.yaml").write_text(text, encoding="utf-8")
    said: list[str] = []

    def sits_down(participant: str) -> str:
        with pytest.raises(UsageError) as refused:
            run_live(
                str(tmp_path / "s.yaml"), participant, tmp_path, screen=ScreenOptions(display=99), seed=None,
                new_run=False, resume="yes", ask=lambda _: True, say=said.append,
            )  # fmt: skip
        return str(refused.value)

    assert f"holds another study of that name (P01: {why}" in sits_down("P02")
    assert "another study" not in sits_down("P01")  # goes on with the study it was begun with
    assert said[-1] == "The study file has changed since; the run goes on with the study it was begun with."


@pytest.mark.parametrize(
    ("known", "new", "refused"),
    [
        ("P01", "p01", True), ("P01", "P1", True), ("P01", "p001", True), ("100", "0100", True),
        ("P01", "P01", False), ("P01", "P10", False), ("P10", "P1", False), ("A1B", "A01B", True), ("P0", "P00", True),
    ],
)  # fmt: skip
def test_an_id_that_differs_in_case_or_zeros_only_is_refused_with_the_one_there_is(known, new, refused):
    if not refused:
        refuse_lookalike([{"participant": known}], new)
        return
    with pytest.raises(UsageError, match=f"there is a participant {known} already"):
        refuse_lookalike([{"participant": known}], new)


def test_data_beside_the_study_file_are_not_split_by_a_run_from_another_working_folder(tmp_path, monkeypatch, capfd):
    lab, here = tmp_path / "my lab", tmp_path / "desktop"
    here.mkdir()
    open_new(short(), "P01", lab / "data", display={}, simulated=False).journal.close()
    (lab / "s.yaml").write_text(short().text, encoding="utf-8")
    monkeypatch.chdir(here)
    assert default_data("walk_ratio", "walk_ratio", False) == Path("data")
    assert default_data("../my lab/s.yaml", "walk_ratio", True) == Path("pilot")
    with pytest.raises(
        UsageError, match=r"Say --data ['\"]../my lab/data['\"] to go on there, or --data data to begin"
    ):
        default_data("../my lab/s.yaml", "walk_ratio", False)
    assert run_command(["run", "../my lab/s.yaml", "--participant", "P01"]) == 2
    assert "no data of walk_ratio in this working folder" in " ".join(capfd.readouterr().err.split())
    Path("data/walk_ratio").mkdir(parents=True)
    assert default_data("../my lab/s.yaml", "walk_ratio", False) == Path("data")


def test_who_took_part_with_another_version_of_the_study_file_is_told_with_what_differs(tmp_path):
    file = parse_study("s.yaml", short().text.replace("about half", "roughly half"))
    for participant in ("P01", "P02"):
        open_new(short(), participant, tmp_path, display={}, simulated=False).journal.close()
    said: list[str] = []
    tell_changes(first_headers(tmp_path, "walk_ratio"), file, said.append)
    tell_changes(first_headers(tmp_path, "walk_ratio"), short(), said.append)
    assert said == ["Note: P01, P02 took part with another version of this study file, which differs in pages.consent."]


@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="needs POSIX signals")
@pytest.mark.parametrize("nohup", [False, True])
def test_a_closed_terminal_ends_a_run_unless_nohup_says_it_must_not(nohup):
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN if nohup else signal.SIG_DFL)
    ended: list[str] = []
    try:
        with ending_signals(ended.append):
            signal.raise_signal(signal.SIGHUP)
            signal.raise_signal(signal.SIGTERM)
        assert signal.getsignal(signal.SIGHUP) == (signal.SIG_IGN if nohup else signal.SIG_DFL)
    finally:
        signal.signal(signal.SIGHUP, before)
    assert ended == (["SIGTERM"] if nohup else ["SIGHUP", "SIGTERM"])


@pytest.mark.slow
@pytest.mark.window
@pytest.mark.skipif(not os.environ.get("DISPLAY"), reason="needs an X display (Xvfb will do)")
@pytest.mark.parametrize(
    ("number", "reason"),
    [
        (signal.SIGTERM, "SIGTERM"),
        (signal.SIGINT, "SIGINT"),
        (signal.SIGHUP, "SIGHUP"),
        (signal.SIGSEGV, "crashed: Segmentation fault"),
        (signal.SIGABRT, "crashed: Aborted"),
        (signal.SIGKILL, "no end was recorded: killed, or the power failed"),
    ],
)
def test_every_signal_leaves_a_known_reason_in_a_real_run(tmp_path, number, reason):
    study = tmp_path / "short.yaml"
    study.write_text(short().text, encoding="utf-8")
    process = subprocess.Popen(
        [sys.executable, "-m", "experiment_app", "run", str(study), "--participant", "P01", "--pilot",
         "--data", str(tmp_path / "data"), "--window", "--size", "320x200"],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=ROOT,
        preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_DFL),  # the tests may run under nohup
    )  # fmt: skip
    journal = tmp_path / "data/walk_ratio/sourcedata/sub-P01/run-1/journal.jsonl"
    _wait_for_a_line(journal, process)
    process.send_signal(number)
    said = process.communicate(timeout=60)[0]
    assert process.returncode != 0, said
    (run,) = participant_runs(tmp_path / "data", "walk_ratio", "P01")
    assert run.interruption == reason
    assert run.header["pilot"] is True


def _wait_for_a_line(journal: Path, process: subprocess.Popen) -> None:  # type: ignore[type-arg]
    import time

    end = time.monotonic() + 60
    while not (journal.exists() and journal.stat().st_size):
        assert process.poll() is None, process.communicate()[0]
        assert time.monotonic() < end
        time.sleep(0.02)
    time.sleep(1.0)  # the signal handlers are set after the header is safe

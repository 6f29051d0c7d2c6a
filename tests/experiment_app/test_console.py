"""The experimenter's console: what it shows is what the journal says, what it asks happens, no frame waits for it."""

from __future__ import annotations

import io
import os
import subprocess
import sys
import time
from collections import deque
from pathlib import Path

import pytest
from rich.console import Console

from experiment_app.command import run as gaitlab
from experiment_app.console.asking import FILE, Listening, ask, listening
from experiment_app.console.progress import Watched, after, status
from experiment_app.console.screen import panel
from experiment_app.console.status_line import status_line
from experiment_app.console.watching import Watching, newest_run
from experiment_app.errors import UsageError
from experiment_app.loop import run_session
from experiment_app.run_folder import journal_lines
from experiment_app.simulated.observer import SimulatedParticipant, draw_observer
from experiment_app.windows.undrawn import UndrawnWindow
from protocols.events import Asked, Clicked, KeyDown, Shown
from protocols.plan import make_plan
from protocols.record import Ended, Paused, Resumed
from protocols.session import begin, drained, handle
from tests.experiment_app.sessions import opened, play
from tests.protocols.studies import short


def trial_line(number: int, time_: float, late: int = 0, practice: bool = False) -> dict:
    return {
        "kind": "trial", "time": time_, "number": number, "practice": practice, "attempt": 1, "frames": 100,
        "late_frames": late, "factors": {"actor": "F1", "speed": 1.2}, "response": {"walk_ratio": 0.00612345},
        "response_time": 4.25,
    }  # fmt: skip


def test_time_left_is_the_median_length_of_a_trial_times_the_trials_left():
    """Responses at 10, 20, 30 and 90 s: lengths 10, 10, 60, median 10; 4 of 10 done, so 60 s are left."""
    watched = Watched(total=10)
    for number, moment in enumerate((10.0, 20.0, 30.0, 90.0), start=1):
        watched = after(watched, trial_line(number, moment, late=number % 2))
    assert watched.minutes_left == pytest.approx(1.0)
    assert (watched.frames, watched.late, watched.late_now) == (400, 2, 0)
    assert watched.responses[-1].strip() == "4  F1 1.2: walk ratio 0.00612; 4.2 s"


def test_training_and_a_trial_done_again_do_not_count_as_progress():
    watched = after(Watched(total=10), trial_line(1, 5.0, practice=True))
    assert len(watched.done) == 0
    watched = after(after(watched, trial_line(1, 9.0)), trial_line(1, 14.0))
    assert len(watched.done) == 1


def test_what_the_console_knows_follows_a_journal_while_it_grows(tmp_path):
    run = opened(tmp_path)
    play(run)
    whole = run.journal.path.read_bytes()
    lines = whole.split(b"\n")
    run.journal.path.write_bytes(lines[0] + b"\n")
    watching = Watching(newest_run(tmp_path / "walk_ratio"))
    assert watching.look().total == 4
    for size in range(len(lines[0]) + 1, len(whole), 700):
        run.journal.path.write_bytes(whole[:size])  # lines that are only half there are not read yet
        watching.look()
    run.journal.path.write_bytes(whole)
    watched = watching.look()
    assert watched.done == {1, 2, 3, 4}
    assert watched.ended == "finished"
    assert status(watched) == "P01  4 of 4 trials  0 of 0 frames late  ended: finished"


def test_the_panel_shows_progress_late_frames_responses_and_that_it_is_a_pilot(tmp_path):
    play(opened(tmp_path))
    watching = Watching(newest_run(tmp_path / "walk_ratio"))
    watching.look()
    watched = after(after(Watched(96, "P01"), trial_line(1, 10.0)), trial_line(2, 20.0, late=3))
    console = Console(file=io.StringIO(), width=120)
    console.print(panel(watching, watched, 200.0, ""))
    shown = console.file.getvalue()  # type: ignore[attr-defined]
    for words in ("simulated, run 1", "2 of 96", "about 16 min", "3 of 200 (1.50 %); 3 in the last trial",
                  "walk ratio 0.00612", "nothing new for 3 min", "p pause"):  # fmt: skip
        assert words in shown, words


def in_a_trial():
    session = begin(make_plan(short().study, 1, 1))
    session = handle(session, Shown(1.0))
    session = handle(session, Clicked(2.0, "agree"))
    time_ = 2.0
    while session.trial is None:
        session = handle(session, Shown(time_ + 0.1))
        for question in getattr(session.step, "questions", ()):
            if question.kind == "choice":
                session = handle(session, Clicked(time_ + 1.0, f"{question.id}:{next(iter(question.options))}"))
            else:
                from protocols.events import Typed

                session = handle(handle(session, Clicked(time_ + 1.0, question.id)), Typed(time_ + 1.0, "30"))
        time_ += 2.0
        session = handle(
            session, Clicked(time_, "next") if hasattr(session.step, "questions") else KeyDown(time_, "enter")
        )
    return handle(session, Shown(time_)), time_


def test_the_experimenters_pause_has_no_button_and_ends_when_they_say_so():
    session, now = in_a_trial()
    session = handle(session, Asked(now + 1.0, "pause"))
    assert session.overlay is not None
    assert session.overlay.form.buttons == ()
    session = handle(session, KeyDown(now + 2.0, "enter"))
    assert session.overlay is not None, "the participant cannot go on by themselves"
    session = handle(session, Asked(now + 3.0, "pause"))
    session = handle(session, Asked(now + 5.0, "resume"))
    assert session.overlay is None
    _, records = drained(session)
    pauses = [record for record in records if isinstance(record, (Paused, Resumed))]
    assert [type(record) for record in pauses] == [Paused, Resumed]
    assert pauses[0].why == "experimenter"  # type: ignore[union-attr]
    assert pauses[1].paused == pytest.approx(4.0)  # type: ignore[union-attr]
    assert session.trial is not None
    assert session.trial.looked == pytest.approx(1.0)


def test_escape_ends_the_experimenters_pause_should_the_console_be_gone():
    session, now = in_a_trial()
    session = handle(handle(session, Asked(now + 1.0, "pause")), KeyDown(now + 2.0, "escape"))
    assert session.overlay is None


@pytest.mark.parametrize("paused", [False, True])
def test_the_experimenters_stop_is_recorded_at_once_and_shows_a_last_page(paused):
    session, now = in_a_trial()
    if paused:
        session = handle(session, Asked(now + 1.0, "pause"))
    session = handle(session, Asked(now + 2.0, "stop"))
    session, records = drained(session)
    assert [r.reason for r in records if isinstance(r, Ended)] == ["stopped by the experimenter"]
    assert not session.done, "the participant reads a last page"
    session = handle(handle(session, Shown(now + 3.0)), KeyDown(now + 4.0, "enter"))
    assert session.ended == "stopped by the experimenter"
    assert drained(session)[1] == ()


def test_only_whole_known_words_of_this_sitting_are_heard(tmp_path):
    ask(tmp_path, "stop")  # of an earlier sitting
    window = UndrawnWindow(SimulatedParticipant(short().study, draw_observer(short().study, 1, 1), 1), lambda: None)
    session = begin(make_plan(short().study, 1, 1))
    with listening(window, tmp_path) as heard:
        with open(tmp_path / FILE, "ab") as file:
            file.write(b"dance\npause\n\xff\xfe\nresume\npau")
        end, words = time.monotonic() + 5.0, []
        while len(words) < 2 and time.monotonic() < end:
            words += [e.what for e in heard.poll(session)[1] if isinstance(e, Asked)]
            time.sleep(0.02)
        with open(tmp_path / FILE, "ab") as file:
            file.write(b"se\n")
        while len(words) < 3 and time.monotonic() < end:
            words += [e.what for e in heard.poll(session)[1] if isinstance(e, Asked)]
            time.sleep(0.02)
    assert words == ["pause", "resume", "pause"]


def test_a_session_that_is_asked_to_stop_ends_and_can_be_continued(tmp_path):
    run = opened(tmp_path)
    person = SimulatedParticipant(run.plan.study, draw_observer(run.plan.study, 1, run.seed), run.seed)
    asked: deque = deque()

    class Counting(UndrawnWindow):
        def poll(self, session):  # type: ignore[no-untyped-def]
            if run.journal.path.read_bytes().count(b'"kind":"trial"') == 3 and not asked and session.trial is not None:
                asked.append("stop")
            return super().poll(session)

    with run.journal as journal:
        session = run_session(begin(run.plan), Listening(Counting(person, journal.wait), asked), journal)
    assert session.ended == "stopped by the experimenter"
    play(opened(tmp_path))
    lines = journal_lines(run.journal.path)[0]
    assert [line["interrupted"] for line in lines if line["kind"] == "continue"] == ["stopped by the experimenter"]
    assert lines[-2]["reason"] == "finished"


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_the_status_line_of_a_run_is_written_by_its_own_thread_and_only_to_a_terminal(tmp_path):
    run = opened(tmp_path)
    person = SimulatedParticipant(run.plan.study, draw_observer(run.plan.study, 1, run.seed), run.seed)
    terminal, file = Terminal(), io.StringIO()
    with (
        run.journal as journal,
        status_line(journal, Watched(4, "P01"), terminal) as recorder,
        status_line(recorder, Watched(4, "P01"), file) as same,
    ):
        assert same is recorder, "a file gets no status line"
        run_session(begin(run.plan), UndrawnWindow(person, journal.wait), recorder)
    newest = terminal.getvalue().rstrip().split("\r")[-1]
    assert newest.startswith("P01  4 of 4 trials")
    assert newest.rstrip().endswith("ended: finished")


def test_the_run_that_is_going_on_is_watched_though_an_old_one_was_copied_later(tmp_path, capfd):
    play(opened(tmp_path, "P01"))
    going_on = opened(tmp_path, "P02")
    old = tmp_path / "walk_ratio/sourcedata/sub-P01/run-1/journal.jsonl"
    os.utime(old, (time.time() + 60, time.time() + 60))  # as copying and unzipping do
    assert newest_run(tmp_path / "walk_ratio").participant == "P02"
    going_on.journal.close()
    assert newest_run(tmp_path / "walk_ratio").participant == "P01"


def test_a_run_that_nobody_has_open_is_watched_and_asked_with_a_note(tmp_path, capfd):
    run = opened(tmp_path, "P01")
    once = ["console", str(tmp_path / "walk_ratio"), "--once"]
    assert gaitlab(once) == 0
    assert "no gaitlab on this computer has this run open" not in " ".join(capfd.readouterr().err.split())
    run.journal.close()  # as after a power cut: no end is recorded
    assert gaitlab(once) == 0
    assert "no gaitlab on this computer has this run open" in " ".join(capfd.readouterr().err.split())


def test_the_console_names_what_is_missing(tmp_path):
    with pytest.raises(UsageError, match="holds no run of participant P09"):
        newest_run(tmp_path, "P09")


@pytest.mark.slow
@pytest.mark.window
@pytest.mark.skipif(not os.environ.get("DISPLAY"), reason="needs an X display (Xvfb will do)")
def test_a_real_run_is_paused_resumed_and_stopped_from_another_process(tmp_path, capfd):
    study = tmp_path / "short.yaml"
    study.write_text(short().text, encoding="utf-8")
    process = subprocess.Popen(
        [sys.executable, "-m", "experiment_app", "run", str(study), "--participant", "P01",
         "--data", str(tmp_path / "data"), "--window", "--size", "320x200"],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=Path(__file__).parents[2],
    )  # fmt: skip
    folder = tmp_path / "data" / "walk_ratio"
    journal = folder / "sourcedata/sub-P01/run-1/journal.jsonl"

    def wait_for(kind: str, word: str = "") -> list[dict]:
        end = time.monotonic() + 60
        while time.monotonic() < end:
            lines = list(journal_lines(journal)[0]) if journal.exists() else []
            if any(line["kind"] == kind for line in lines):
                return lines
            if word and lines:  # asked again, should the run not have been listening yet
                assert gaitlab(["console", str(folder), "--ask", word]) == 0
            time.sleep(0.3)
        raise AssertionError(process.communicate(timeout=5))

    try:
        wait_for("header")
        wait_for("pause", "pause")
        wait_for("resume", "resume")
        lines = wait_for("end", "stop")
        assert gaitlab(["console", str(folder), "--once"]) == 0
        assert "ended: stopped by the experimenter" in capfd.readouterr().out
        assert next(line["why"] for line in lines if line["kind"] == "pause") == "experimenter"
    finally:
        process.kill()
        process.communicate()


def test_a_title_or_a_level_cannot_write_on_the_terminal_what_it_likes(tmp_path):
    """Markup of the terminal library, and control characters, come out as text or not at all."""
    play(opened(tmp_path))
    watching = Watching(newest_run(tmp_path / "walk_ratio"))
    watching.look()
    watching.title = "[/] [red]A title[/red]"
    console = Console(file=io.StringIO(), width=120)
    console.print(panel(watching, watching.watched, 0.0, ""))
    assert "[red]A title" in console.file.getvalue()  # type: ignore[attr-defined]
    line = {"kind": "begin", "time": 1.0, "number": 1, "practice": False, "attempt": 1, "factors": {"a": "\x1b[2J\r\n"}}
    assert status(after(Watched(3, "P01"), line)).isprintable()

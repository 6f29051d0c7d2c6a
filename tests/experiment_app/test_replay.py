"""Replay: from the journal alone, every frame is the one that was drawn, whatever happened in the trial."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from random import Random

import pytest

from experiment_app.command import run
from experiment_app.errors import UsageError
from experiment_app.loop import run_session
from experiment_app.opening import open_new, recorded_plan
from experiment_app.replay.command import opened
from experiment_app.replay.film import film_length
from experiment_app.replay.frames import replayed_frames
from experiment_app.replay.recorded import RecordedTrial, recorded_trials
from experiment_app.replay.trace import held_keys, watched_times
from experiment_app.run_folder import run_at
from experiment_app.scene import Scene
from experiment_app.walkers import drawn_walkers, pose_checksum
from experiment_app.windows.window import Flip
from protocols.events import Clicked, Event, FocusLost, KeyDown, KeyUp, Shown
from protocols.plan import TrialStep
from protocols.session import Session, begin
from tests.journals import rewrite
from tests.protocols.studies import short

PERIOD = 1.0 / 30.0


class Scripted:
    """A 30 Hz display that keeps its scenes, and a person who presses what a seed says.

    Every event comes up to 30 ms after it happened, as the time stamps of an X server do, some frames are late, and
    the person pauses, loses the window's focus and presses both keys at once.
    wait: returns once the journal is safe, so that the disk's speed decides nothing.
    """

    period = PERIOD

    def __init__(self, seed: int, wait: Callable[[], None]) -> None:
        self._chance = Random(seed)
        self._wait = wait
        self._waiting: list[tuple[float, Event]] = []
        self._script_for = ""
        self.now = 0.0
        self.scenes: list[Scene] = []

    def poll(self, session: Session) -> tuple[float, list[Event]]:
        self._wait()
        step = session.step
        if isinstance(step, TrialStep) and session.shown is not None and self._script_for != step.id:
            self._script_for = step.id
            self._write_script(session.shown)
        come = [event for at, event in self._waiting if at <= self.now]
        self._waiting = [(at, event) for at, event in self._waiting if at > self.now]
        return self.now, come

    def next_display_time(self) -> float:
        return self.now + PERIOD

    def show(self, scene: Scene) -> Flip:
        self.now += PERIOD * (1 + (self._chance.random() < 0.1) + 0.01 * self._chance.random())
        if scene.walkers and scene.page is None:
            self.scenes.append(scene)
        return Flip(self.now, 1.0, pose_checksum(drawn_walkers(scene)))

    def measure(self, scene: Scene) -> dict[str, float]:
        return {}

    def _write_script(self, onset: float) -> None:
        time = onset
        for kind in self._chance.choices(("left", "right", "both", "pause", "break", "focus"), k=6):
            time += self._chance.uniform(0.05, 0.4)
            held = self._chance.uniform(0.02, 0.5)
            if kind in ("pause", "break"):
                self._at(KeyDown(time, "escape" if kind == "pause" else "b"), KeyDown(time + held, "escape"))
            elif kind == "focus":
                self._at(KeyDown(time, "left"), FocusLost(time + held))
            else:
                keys = ("left", "right") if kind == "both" else (kind,)
                for key in keys:
                    self._at(KeyDown(time, key), KeyUp(time + held, key))
            time += held
        self._at(KeyDown(time + 2.0, "enter"))

    def _at(self, *events: Event) -> None:
        for event in events:
            self._waiting.append((event.time + self._chance.uniform(0.0, 0.03), event))
        self._waiting.sort(key=lambda pair: pair[1].time)


def recorded(data: Path, seed: int, practice: bool = False) -> tuple[Path, Scripted]:
    """The folder of a run of two trials (or of training alone) that a scripted person did, and what she saw."""
    run = open_new(short(), "P01", data, display={}, simulated=True)
    trials = tuple(step for step in run.plan.steps if isinstance(step, TrialStep) and step.trial.practice == practice)
    with run.journal as journal:
        window = Scripted(seed, journal.wait)
        run_session(begin(replace(run.plan, steps=trials[:2])), window, journal)
    return run.run.folder, window


@pytest.mark.parametrize("seed", range(6))
def test_every_frame_of_a_replay_is_the_scene_that_was_shown(tmp_path, seed):
    folder, window = recorded(tmp_path, seed)
    run = run_at(folder)
    frames = [f for trial in recorded_trials(run.lines) for f in replayed_frames(recorded_plan(run), trial)]
    assert len(frames) > 100
    assert [frame.scene for frame in frames] == window.scenes
    assert all(frame.same for frame in frames)


def test_a_key_altered_by_a_twentieth_of_a_second_is_noticed(tmp_path):
    folder, _ = recorded(tmp_path, 0)
    run = run_at(folder)
    same = []
    for trial in recorded_trials(run.lines):
        moved = tuple((frame, later(event)) for frame, event in trial.events)
        same += [frame.same for frame in replayed_frames(recorded_plan(run), replace(trial, events=moved))]
    assert same[0]  # nothing had been pressed yet
    assert not all(same)


def test_a_run_of_training_alone_says_how_to_replay_it(tmp_path):
    folder, _ = recorded(tmp_path, 0, practice=True)
    with pytest.raises(UsageError, match="no finished trial but training trials; say --practice for those"):
        opened(folder, None, False)
    assert len(opened(folder, None, True)[2]) == 2
    with pytest.raises(UsageError, match=r"--trial 9: .* has training trials 1 to 2 with frames"):
        opened(folder, 9, True)


def later(event: Event) -> Event:
    """A key let go 50 ms later; any other event as it was."""
    return replace(event, time=event.time + 0.05) if isinstance(event, KeyUp) else event


def test_the_command_says_what_it_checked_and_fails_when_a_pose_differs(tmp_path, capsys):
    folder, _ = recorded(tmp_path, 1)
    assert run(["replay", str(folder)]) == 0
    said = capsys.readouterr().out
    assert "trial 1: " in said
    assert "trial 2: " in said
    assert "every pose as it was drawn" in said
    assert run(["replay", str(folder / "journal.jsonl"), "--trial", "2"]) == 0
    assert run(["replay", str(folder), "--trial", "7"]) == 2
    assert run(["replay", str(tmp_path)]) == 2
    alter_a_pose(folder / "journal.jsonl")
    assert run(["replay", str(folder), "--trial", "1"]) == 1
    assert "1 of" in capsys.readouterr().out


def alter_a_pose(path: Path) -> None:
    """Writes another checksum of a pose into the first frame log, with the right checksums of the lines."""

    def altered(records: list[dict]) -> list[dict]:
        next(one for one in records if one["kind"] == "frames")["poses"][5] = "00000000"
        return records

    rewrite(path, altered)


def trial_of(flips: list[float], stretches: tuple[int, ...], events: list[Event]) -> RecordedTrial:
    """A recorded trial made by hand."""
    begun = {"kind": "begin", "number": 1, "practice": False, "time": flips[0], "factors": {}}
    frames = {"flips": flips, "stretches": stretches, "period": 0.1, "late": ()}
    answer = {"kind": "trial", "time": flips[-1], "response": {}}
    return RecordedTrial(begun, frames, answer, tuple((0, event) for event in events))


def test_pauses_are_taken_out_of_the_film_and_late_frames_are_not():
    flips = [5.0, 5.1, 5.4, 9.0, 9.1]  # the third frame was late, the fourth came after a pause
    trial = trial_of(flips, (0, 3), [])
    assert watched_times(trial, flips) == pytest.approx([0.0, 0.1, 0.4, 0.5, 0.6])
    assert film_length(trial, Fraction(10)) == 7


def test_keys_are_shown_as_long_as_they_were_held():
    events = [
        Shown(0.0), KeyDown(1.0, "left"), KeyDown(1.5, "right"), KeyUp(2.0, "left"), FocusLost(2.5),
        KeyDown(3.0, "escape"), Clicked(3.5, "scale:2"), KeyDown(3.9, "enter"),
    ]  # fmt: skip
    trial = trial_of([0.0, 4.0], (0,), events)
    assert held_keys(trial) == {
        "left": [(1.0, 2.0)], "right": [(1.5, 2.5)], "pointer": [(3.5, 3.5)], "enter": [(3.9, 4.0)],
    }  # fmt: skip


@pytest.mark.slow
def test_a_film_of_a_replay_has_the_trace_under_the_walker(tmp_path):
    av = pytest.importorskip("av", reason="PyAV is not installed (extra video)")
    folder, _ = recorded(tmp_path, 2)
    path = tmp_path / "clip.mp4"
    assert run(["replay", str(folder), "--trial", "1", "--film", str(path), "--rate", "4", "--size", "320x200"]) == 0
    with av.open(str(path)) as file:
        pictures = [frame.to_ndarray(format="rgb24") for frame in file.decode(video=0)]
    recorded_trial = next(iter(recorded_trials(run_at(folder).lines)))
    assert len(pictures) == film_length(recorded_trial, Fraction(4))
    assert pictures[0].shape == (260, 320, 3)
    strips = [picture[200:].astype(int) for picture in (pictures[2], pictures[-2])]
    orange = [int((strip[..., 0] - strip[..., 2] > 25).sum()) for strip in strips]
    assert orange[1] > 2 * orange[0] > 0  # the trace grows with time

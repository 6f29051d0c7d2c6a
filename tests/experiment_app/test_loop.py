"""The loop with a display and a disk made of numbers: flips, onsets, late frames and waiting, to the digit."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import pytest

from experiment_app.loop import run_session
from experiment_app.scene import Scene
from experiment_app.simulated.observer import SimulatedParticipant, draw_observer
from experiment_app.windows.window import Flip
from protocols.events import KeyDown, KeyUp
from protocols.plan import TrialStep, make_plan
from protocols.record import FrameLog, Key, TrialBegun, TrialRecord
from protocols.session import begin
from tests.protocols.studies import short

PERIOD = 1.0 / 60.0


class Display:
    """A 60 Hz display whose swap waits for the refresh; drawing takes `cost` s; one frame may stall.

    first_seen: flip of the first frame of each trial, as a camera before the screen would see it.
    """

    period = PERIOD

    def __init__(self, person: SimulatedParticipant, cost: float, stall_at: int = -1, stall: float = 0.0) -> None:
        self.person, self.cost, self.stall_at, self.stall = person, cost, stall_at, stall
        self.now = self.flip = 0.0
        self.frames = 0
        self.first_seen: list[float] = []
        self.phases: list[float] = []
        self.walking = False

    def poll(self, session):
        self.now = max(self.now, self.flip + PERIOD - min(self.cost + 0.002, PERIOD))
        self.person.look(session)
        return self.now, self.person.take(self.now)

    def next_display_time(self) -> float:
        return self.flip + PERIOD * (int((self.now - self.flip) / PERIOD) + 1)

    def show(self, scene: Scene) -> Flip:
        drawn = self.now + self.cost + (self.stall if self.frames == self.stall_at else 0.0)
        self.frames += 1
        refreshes = max(1, -(-(drawn - self.flip) // PERIOD))
        self.flip += refreshes * PERIOD
        self.now = self.flip
        walking = bool(scene.walkers) and scene.page is None
        if walking and not self.walking:
            self.first_seen.append(self.flip)
        self.walking = walking
        return Flip(self.flip, 1e3 * self.cost, f"{self.frames:08x}")

    def measure(self, scene: Scene) -> dict[str, float]:
        return {"speed": scene.walkers[0].speed}


class Disk:
    """A recorder that is done only some polls after it was given something."""

    def __init__(self, polls: int = 0) -> None:
        self.polls, self.waiting = polls, 0
        self.records: list[object] = []
        self.unsaved_begins = 0

    def write(self, records) -> None:
        if self.waiting and any(isinstance(r, TrialBegun) for r in records):
            self.unsaved_begins += 1
        if any(isinstance(r, TrialRecord) for r in records):
            self.waiting = self.polls
        self.records += records

    @property
    def saved(self) -> bool:
        self.waiting = max(self.waiting - 1, 0)
        return self.waiting == 0


def play(cost: float = 0.004, polls: int = 0, **stall: float) -> tuple[Display, Disk]:
    study = short().study
    person = SimulatedParticipant(study, draw_observer(study, 1, 1), 1)
    display, disk = Display(person, cost, **stall), Disk(polls)  # type: ignore[arg-type]
    run_session(begin(make_plan(study, 1, 1)), display, disk)
    return display, disk


def of(disk: Disk, kind: type) -> list:
    return [record for record in disk.records if isinstance(record, kind)]


@pytest.mark.parametrize("cost", [0.001, 0.004, 0.008, 0.014, 0.020])
def test_onset_is_the_flip_of_the_trials_first_frame(cost):
    display, disk = play(cost)
    assert [record.onset for record in of(disk, TrialRecord)] == pytest.approx(display.first_seen, abs=1e-12)


def test_without_a_stall_no_frame_is_late_and_every_interval_is_a_period():
    _, disk = play()
    assert [record.late_frames for record in of(disk, TrialRecord)] == [0] * 6
    for frames in of(disk, FrameLog):
        intervals = [later - earlier for earlier, later in pairwise(frames.flips)]
        assert intervals == pytest.approx([PERIOD] * len(intervals), abs=2e-6)
        assert frames.flips == pytest.approx(frames.predicted, abs=2e-6)


def test_a_stall_of_40_ms_marks_exactly_its_trial():
    display, disk = play()
    third = of(disk, TrialRecord)[2]
    frame = round((third.onset + 1.0) / PERIOD)
    _, disk = play(stall_at=frame, stall=0.040)
    late = [record.late_frames for record in of(disk, TrialRecord)]
    assert late == [0, 0, 1, 0, 0, 0]
    logs = of(disk, FrameLog)
    first = round(third.onset / PERIOD)
    assert [log.late for log in logs] == [(), (), (frame - first + 1,), (), (), ()]
    assert display.frames > frame


def test_no_trial_begins_before_the_one_before_is_saved():
    _, disk = play(polls=120)  # two seconds at 60 Hz
    assert disk.unsaved_begins == 0
    trials, begun = of(disk, TrialRecord), of(disk, TrialBegun)
    for record, following in zip(trials[2:4], begun[3:5], strict=True):
        assert following.time - record.time > 1.9


def test_the_interval_between_trials_is_as_long_as_the_study_says():
    _, disk = play()
    trials, begun = of(disk, TrialRecord), of(disk, TrialBegun)
    gap = begun[3].time - trials[2].time
    assert 0.7 <= gap <= 0.7 + 3 * PERIOD


def test_the_same_observer_gives_the_same_responses_at_any_drawing_cost():
    responses = [[r.response["step_frequency"] for r in of(play(cost)[1], TrialRecord)] for cost in (0.001, 0.014)]
    assert responses[0] == pytest.approx(responses[1], abs=1e-9)


def test_a_drawn_trial_holds_its_measured_gait_and_frame_count():
    _, disk = play()
    for record, frames in zip(of(disk, TrialRecord), of(disk, FrameLog), strict=True):
        assert record.measured == {"speed": 1.0}
        assert record.frames == len(frames.flips) == len(frames.predicted) == len(frames.poses) == len(frames.cpu_ms)


def test_each_key_names_the_first_frame_drawn_with_it_known():
    _, disk = play()
    logs = iter(of(disk, FrameLog))
    log = next(logs)
    for record in disk.records:
        if isinstance(record, Key):
            assert all(predicted > record.time for predicted in log.predicted[record.frame :])
            assert record.frame == 0 or log.flips[record.frame - 1] < record.time + PERIOD
        elif isinstance(record, TrialRecord):
            log = next(logs, log)


class OneHold(Display):
    """A display whose person holds the left key for half a second, and whose events come `delay` s late."""

    def __init__(self, delay: float) -> None:
        super().__init__(None, 0.004)  # type: ignore[arg-type]
        self.delay, self.planned, self.shown = delay, [], False

    def poll(self, session):
        self.now = max(self.now, self.flip + PERIOD - 0.006)
        if session.trial is not None and session.shown is not None and not self.shown:
            self.shown = True
            names = ((0.5, KeyDown, "left"), (1.0, KeyUp, "left"), (2.7, KeyDown, "enter"))
            self.planned = [kind(session.shown + after, key) for after, kind, key in names]
        due = [event for event in self.planned if event.time + self.delay <= self.now]
        self.planned = self.planned[len(due) :]
        return self.now, due


@pytest.mark.parametrize("delay", [0.0, 0.003, 0.011, 0.040])
def test_a_key_that_is_learned_of_late_counts_from_its_own_time(delay):
    plan = make_plan(short().study, 1, 1)
    trial = next(step for step in plan.steps if isinstance(step, TrialStep))
    disk = Disk()
    run_session(begin(replace(plan, steps=(trial,))), OneHold(delay), disk)
    (record,) = of(disk, TrialRecord)
    start = begin(replace(plan, steps=(trial,))).trial.start
    assert record.response["step_frequency"] == pytest.approx(start - 0.5 * 10.0, abs=1e-9)
    assert record.response_time == pytest.approx(2.7, abs=1e-9)

"""A whole session as a value: order of pages and trials, pauses, refusal, going on after an interruption."""

from __future__ import annotations

from dataclasses import replace

import pytest

from protocols.events import Clicked, Closed, FocusLost, KeyDown, KeyUp, Saved, Shown, Typed
from protocols.mistakes.consistency import inconsistencies
from protocols.plan import TrialStep, make_plan
from protocols.record import Ended, Key, TrialRecord
from protocols.resuming import Progress, remaining
from protocols.session import Interval, Session, advance, begin, drained, handle
from protocols.study_file import parse_study
from tests.protocols.studies import changed, short


class Player:
    """Plays a session step by step, one second a step, keeping what it emits."""

    def __init__(self, session: Session) -> None:
        self.session, self.time, self.records = session, 0.0, []

    def do(self, *events: object) -> Player:
        for event in events:
            self.time += 1.0
            self.session = handle(self.session, replace(event, time=self.time))
            self.session, records = drained(self.session)
            self.records += records
        return self

    def page(self) -> Player:
        """Shows and leaves whatever page is on, answering what it asks."""
        self.do(Shown(0))
        step = self.session.step.id
        if step == "consent":
            return self.do(Clicked(0, "agree"))
        if step.startswith("questions"):
            asked = (Clicked(0, "age"), Typed(0, "30"), Clicked(0, "sex:male"), Clicked(0, "vision:yes"))
            return self.do(*asked, Clicked(0, "next"))
        return self.do(KeyDown(0, "enter"))

    def trial(self) -> Player:
        """One trial: hold right for a second, look, confirm, save, wait."""
        self.do(Shown(0), KeyDown(0, "right"), KeyUp(0, "right"), KeyDown(0, "a"), KeyDown(0, "enter"))
        return self.saved()

    def saved(self) -> Player:
        self.do(Saved(0))
        self.time += 1.0
        self.session = advance(self.session, self.time)
        return self

    def until(self, step: str) -> Player:
        while self.session.step.id != step and not self.session.done:
            self.trial() if self.session.trial is not None else self.page()
        return self


@pytest.fixture
def player() -> Player:
    return Player(begin(make_plan(short().study, seed=1, participant_number=1)))


def test_the_short_study_of_these_tests_is_itself_consistent():
    assert inconsistencies(short().study) == []


def test_the_order_is_consent_questions_instructions_training_trials_with_a_break_debrief():
    steps = [step.id for step in make_plan(short().study, 1, 1).steps]
    assert steps == [
        "consent", "questions-1", "instructions-1", "instructions-2", "before-practice", "practice-1", "practice-2",
        "before-trials", "trial-1", "trial-2", "break-2", "trial-3", "trial-4", "debrief",
    ]  # fmt: skip


def test_a_session_runs_to_its_end_and_records_every_trial_once(player):
    player.until("debrief").page()
    trials = [r for r in player.records if isinstance(r, TrialRecord) and not r.practice]
    assert [t.number for t in trials] == [1, 2, 3, 4]
    assert player.session.ended == "finished"
    assert [r.reason for r in player.records if isinstance(r, Ended)] == ["finished"]


def test_the_next_trial_waits_until_the_record_is_saved(player):
    player.until("trial-1")
    player.do(Shown(0), KeyDown(0, "x"), KeyDown(0, "x"), KeyDown(0, "enter"))
    assert isinstance(player.session.stage, Interval)
    assert isinstance(advance(player.session, player.time + 1000.0).stage, Interval)
    player.saved()
    assert player.session.step.id == "trial-2"


def test_refusing_stores_nothing_but_the_refusal(player):
    player.do(Shown(0), Clicked(0, "decline"), Shown(0), KeyDown(0, "enter"))
    assert player.session.ended == "declined"
    assert [r.kind for r in player.records] == ["consent", "end"]
    assert player.records[0].agreed is False


def test_closing_the_window_on_the_last_page_is_a_finished_run(player):
    player.until("debrief").do(Shown(0), Closed(0, "window closed"))
    assert player.session.ended == "finished"
    assert [r.reason for r in player.records if isinstance(r, Ended)] == ["finished"]


def test_closing_the_window_in_a_trial_ends_the_run_with_the_reason(player):
    player.until("trial-2").do(Shown(0), Closed(0, "SIGTERM"))
    assert player.session.ended == "SIGTERM"
    assert player.records[-1] == Ended(player.time, "SIGTERM")


def test_escape_pauses_the_walker_and_go_on_lets_it_walk(player):
    player.until("trial-1").do(Shown(0), KeyDown(0, "right"), KeyDown(0, "escape"))
    before = player.session.trial
    assert before is not None
    assert not before.held
    player.do(KeyUp(0, "right"), KeyDown(0, "enter"))
    after = player.session.trial
    assert after is not None
    assert (after.setting, after.strides) == (before.setting, before.strides)
    assert [r.kind for r in player.records][-2:] == ["pause", "resume"]


def test_stopping_asks_once_more_and_keeps_everything(player):
    player.until("trial-3").do(Shown(0), KeyDown(0, "escape"), Clicked(0, "stop"))
    assert not player.session.done
    player.do(Clicked(0, "stop_really"))
    assert [r.reason for r in player.records if isinstance(r, Ended)] == ["stopped"]
    assert not player.session.done  # a last page says thank you
    player.do(Shown(0), KeyDown(0, "enter"))
    assert player.session.ended == "stopped"


def test_the_break_key_pauses_and_is_recorded_as_a_break(player):
    player.until("trial-1").do(Shown(0), KeyDown(0, "b"))
    assert player.session.overlay is not None
    assert player.records[-1].why == "break"
    player.do(KeyDown(0, "enter"))
    assert player.session.overlay is None


def test_every_task_key_is_recorded_with_its_time(player):
    player.until("trial-1")
    player.records.clear()
    player.do(Shown(0), KeyDown(0, "right"), KeyUp(0, "right"))
    keys = [r for r in player.records if isinstance(r, Key)]
    assert [(k.key, k.down, k.trial) for k in keys] == [("right", True, 1), ("right", False, 1)]


def test_counterbalanced_keys_swap_for_every_second_participant():
    text = changed(("counterbalanced: false", "counterbalanced: true"))
    study = parse_study("s.yaml", text).study
    plans = [make_plan(study, 1, n) for n in (1, 2, 3)]
    keys = [(plan.keys["lower"], plan.keys["raise"]) for plan in plans]
    assert keys == [("left", "right"), ("right", "left"), ("left", "right")]
    told = [next(s.page.text for s in plan.steps if s.id == "instructions-1") for plan in plans]  # type: ignore[union-attr]
    assert "Hold ← for fewer" in told[0]
    assert "Hold → for fewer" in told[1]


def test_a_page_is_not_left_by_a_key_meant_for_the_page_before(player):
    player.until("instructions-1").do(Shown(0))
    player.session = handle(player.session, KeyDown(player.time + 1.0, "enter"))
    assert player.session.step.id == "instructions-2"
    player.session = handle(player.session, KeyDown(player.time + 1.01, "enter"))  # not seen yet
    player.session = handle(player.session, Shown(player.time + 1.02))
    player.session = handle(player.session, KeyDown(player.time + 1.1, "enter"))  # hardly seen
    assert player.session.step.id == "instructions-2"
    player.session = handle(player.session, KeyDown(player.time + 2.0, "enter"))
    assert player.session.step.id == "before-practice"


def test_escape_before_a_trials_first_frame_does_not_start_it_under_the_pause_page(player):
    player.until("trial-1").do(KeyDown(0, "escape"), Shown(0))
    assert [r.kind for r in player.records][-1] == "pause"
    player.do(KeyDown(0, "enter"), Shown(0))
    assert [r.kind for r in player.records][-2:] == ["resume", "begin"]


def test_a_break_can_be_taken_between_trials_too(player):
    player.until("trial-1").do(Shown(0), KeyDown(0, "x"), KeyDown(0, "x"), KeyDown(0, "enter"), KeyDown(0, "b"))
    assert player.session.overlay is not None
    player.do(KeyDown(0, "enter")).saved()
    assert player.session.step.id == "trial-2"


def test_nothing_is_added_after_a_refusal(player):
    player.do(Shown(0), Clicked(0, "decline"), Shown(0), KeyDown(0, "escape"), Closed(0))
    assert player.session.ended == "declined"
    assert [r.kind for r in player.records] == ["consent", "end"]


def test_a_pause_has_its_length_and_counts_in_its_trial(player):
    player.until("trial-1").do(Shown(0), KeyDown(0, "right"), KeyDown(0, "escape"))
    player.time += 60.0
    player.do(KeyDown(0, "enter"), KeyDown(0, "enter"))
    resume = next(r for r in player.records if r.kind == "resume")
    record = player.records[-1]
    assert resume.paused == 61.0
    assert (record.pauses, record.response_time) == (1, 3.0)  # 2 s before the pause, 1 s after


def test_a_set_break_is_recorded_as_a_pause(player):
    player.until("trial-3")
    assert [r.why for r in player.records if r.kind == "pause"] == ["set break"]


def test_losing_focus_while_holding_is_recorded(player):
    player.until("trial-1").do(Shown(0), KeyDown(0, "right"), FocusLost(0))
    assert player.records[-1].key == "focus"


@pytest.mark.parametrize("finished", [0, 1, 2, 3, 4])
def test_going_on_repeats_nothing_that_is_done_and_keeps_the_order(finished):
    plan = make_plan(short().study, 7, 1)
    left = {s.id for s in plan.steps if not s.id.startswith(("trial", "break", "debrief"))} - {"consent"}
    left |= {f"trial-{n}" for n in range(1, finished + 1)}
    begun = {f"trial-{finished + 1}": 1}
    rest = remaining(plan, Progress(frozenset(left), begun, consented=True))
    trials = [s for s in rest.steps if isinstance(s, TrialStep)]
    assert [t.trial for t in trials] == [s.trial for s in plan.steps if isinstance(s, TrialStep)][2 + finished :]
    assert [t.attempt for t in trials] == ([2] + [1] * (3 - finished) if finished < 4 else [])
    if finished < 4:
        assert [s.id for s in rest.steps[:3]] == ["welcome-back", "instructions-1", "instructions-2"]
    assert [s.id for s in rest.steps if s.id == "debrief"] == ["debrief"]
    assert len(rest.steps) == (3 + len(trials) + (finished < 2) + 1 if finished < 4 else 1)


def test_a_run_interrupted_before_consent_begins_with_consent():
    plan = make_plan(short().study, 7, 1)
    assert remaining(plan, Progress()).steps[0].id == "consent"

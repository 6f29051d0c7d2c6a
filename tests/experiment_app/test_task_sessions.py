"""Choices and ratings in whole sessions: what is recorded, measured, resumed and placed by the answers."""

from __future__ import annotations

from dataclasses import replace

import pytest

from experiment_app.loop import run_session
from experiment_app.run_folder import journal_lines
from experiment_app.scene import Page
from experiment_app.simulated.behaviour import Observer
from experiment_app.simulated.observer import SimulatedParticipant, draw_observer
from experiment_app.simulated.simulate import simulate
from experiment_app.staging import stage, view_scene
from protocols.events import Clicked, KeyDown, Shown
from protocols.plan import TrialStep, make_plan
from protocols.record import Click, Key, TrialRecord
from protocols.resuming import Progress, remaining
from protocols.session import Session, advance, begin, drained, handle
from protocols.study_file import parse_study
from tests.experiment_app.test_loop import Disk, Display
from tests.protocols.studies import edited, few_choices


def at_a_trial(study, number: int = 1) -> Session:
    """A session whose first frame of a trial has just been seen, at 100 s."""
    plan = make_plan(study, 1, 1)
    steps = tuple(s for s in plan.steps if isinstance(s, TrialStep) and not s.trial.practice)[number - 1 :]
    return drained(handle(begin(replace(plan, steps=steps)), Shown(100.0)))[0]


def test_a_choice_is_recorded_with_its_key_and_its_sides():
    session = handle(at_a_trial(few_choices().study), KeyDown(102.0, "left"))
    key, record = drained(session)[1]
    assert isinstance(key, Key)
    assert (key.key, key.down) == ("left", True)
    assert isinstance(record, TrialRecord)
    assert record.response_time == 2.0
    assert record.response["chosen"] == record.response["left"]
    assert record.response["side"] == "left"


def test_a_click_on_the_scale_is_recorded_and_counts():
    study = edited("fourier_naturalness").study
    session = handle(at_a_trial(study), Clicked(102.0, "scale:3"))
    session = handle(session, Clicked(103.0, "confirm"))
    marked, confirmed, record = drained(session)[1]
    assert isinstance(marked, Click)
    assert (marked.target, confirmed.target) == ("scale:3", "confirm")
    assert record.response == {"rating": 3.0, "views": 1}


def test_the_strip_says_in_the_studys_words_that_the_mark_is_missing_until_it_is_set():
    study = edited("fourier_naturalness", ("interval: 0.5", "interval: 0.5\nwords: {missing: Bitte antworten.}")).study

    def sentence(session: Session) -> str:
        page = stage(session).page
        assert page is not None
        return page.rows[0].error

    session = at_a_trial(study)
    assert sentence(session) == ""
    session = handle(session, Clicked(102.0, "confirm"))
    assert sentence(session) == "Bitte antworten."
    assert sentence(handle(session, Clicked(103.0, "scale:3"))) == ""


def test_a_break_and_a_pause_in_a_choice_take_none_of_its_time():
    session = at_a_trial(few_choices().study)
    for time, key in ((101.0, "b"), (160.0, "enter"), (161.0, "escape"), (200.0, "enter"), (202.0, "right")):
        session = handle(session, KeyDown(time, key))
    record = drained(session)[1][-1]
    assert (record.response_time, record.pauses) == (4.0, 2)


def test_two_walks_stand_beside_each_other_over_the_question_and_vanish_after_the_limit():
    session = at_a_trial(few_choices().study)
    scene = stage(advance(session, 109.0))
    assert scene.beside is not None
    assert len(scene.walkers) == len(scene.beside.walkers) == 1
    assert scene.page is not None
    assert "Which walk looks more natural?   ← left   → right" in scene.page.lines[0].text
    after = stage(advance(session, 110.5))
    assert not after.visible
    assert after.page == replace(scene.page, over_scene=False)


def test_walks_made_in_different_ways_walk_at_the_step_frequency_their_method_gives():
    study = edited("speed_editing", ("method: [poulaine, blend, timewarp]", "method: [timewarp]")).study
    for number in range(1, 9):
        session = at_a_trial(study, number)
        scene = stage(advance(session, 103.0))
        walkers = {walker.making is None: walker for walker in scene.everyone}
        warped = walkers[False]
        assert warped.making is not None
        # time warping changes only how long a stride takes, so its length stays: v / f is that of its source
        slower = warped.making.source_speed < warped.speed
        assert slower == (warped.step_frequency > walkers[True].step_frequency)


def test_a_rated_pair_is_in_step():
    scene = stage(advance(at_a_trial(edited("fourier_naturalness").study), 102.345))
    left, right = scene.everyone
    assert left.phase == pytest.approx(right.phase, abs=1e-9)
    assert left.step_frequency == pytest.approx(right.step_frequency)


def test_one_walk_alone_can_be_rated_in_the_whole_picture():
    file = edited("fourier_naturalness")
    start, end = file.text.index("    original: {"), file.text.index("    synthetic:")
    text = file.text[:start] + file.text[end:]
    scene = stage(at_a_trial(parse_study("one.yaml", text).study))
    assert (len(scene.walkers), scene.beside) == (1, None)
    assert scene.page is not None
    assert scene.page.rows[0].slider is not None


def test_one_after_the_other_shows_one_walk_then_nothing_then_the_other():
    ways = ("arrangement: side_by_side", "arrangement: one_after_the_other"), ("time_limit: 10 ", "time_limit: 2 ")
    study = few_choices(*ways).study
    session = at_a_trial(study)
    scenes = [stage(advance(session, at)) for at in (101.0, 102.2, 103.0)]
    assert [len(scene.everyone) for scene in scenes] == [1, 0, 1]
    assert scenes[0].walkers[0].making != scenes[2].walkers[0].making


class MeasuringDisplay(Display):
    """A display that remembers which scenes were measured."""

    def __init__(self, person) -> None:
        super().__init__(person, 0.004)
        self.measured = []

    def measure(self, scene):
        self.measured.append(scene)
        return {}


@pytest.mark.parametrize("arrangement", ["side_by_side", "one_after_the_other"])
def test_both_walks_are_measured_also_when_they_have_vanished(arrangement):
    ways = ("arrangement: side_by_side", f"arrangement: {arrangement}"), ("time_limit: 10 ", "time_limit: 0.3 ")
    study = few_choices(*ways).study
    plan = make_plan(study, 1, 1)
    trial = next(s for s in plan.steps if isinstance(s, TrialStep) and not s.trial.practice)
    person = SimulatedParticipant(study, draw_observer(study, 1, 1), 1)
    display, disk = MeasuringDisplay(person), Disk()
    run_session(begin(replace(plan, steps=(trial,))), display, disk)
    (scene,) = display.measured
    assert scene.beside is not None
    assert scene.walkers[0].making != scene.beside.walkers[0].making


def test_a_run_that_goes_on_keeps_the_sides():
    plan = make_plan(few_choices().study, 3, 1)
    left = {step.id for step in plan.steps if not step.id.startswith(("trial", "debrief"))} | {"trial-1", "trial-2"}
    rest = remaining(plan, Progress(frozenset(left), {"trial-3": 1}, consented=True))
    orders = {s.id: s.order for s in plan.steps if isinstance(s, TrialStep)}
    again = [s for s in rest.steps if isinstance(s, TrialStep)]
    assert [s.id for s in again][:2] == ["trial-3", "trial-4"]
    assert all(s.order == orders[s.id] for s in again)


def test_the_question_is_drawn_in_the_participants_words():
    study = few_choices(("keys: {first: left, second: right, break: b}", 'keys: {first: "1", second: "2", break: b}'))
    scene = stage(at_a_trial(study.study))
    assert scene.page is not None
    assert "1 left   2 right" in scene.page.lines[0].text


def test_an_adjustment_has_neither_question_nor_strip():
    from protocols.tasks.task import View

    scene = view_scene(edited("walk_ratio").study, View(), {})
    assert (scene.page, scene.strip) == (None, 0.0)
    assert Page().strip == 0.0


def test_a_staircase_on_choices_settles_where_seven_in_ten_are_right(tmp_path):
    # one up, two down settles at 70.7 % correct (Levitt 1971); these observers are right with 0.5 + level / 20
    confusion = "{$level: {" + ", ".join(f"{level}: {0.5 - level / 20:g}" for level in range(1, 10)) + "}}"
    file = few_choices(
        ("method: [poulaine, blend, timewarp]", "method: [timewarp]\n  level: [1, 2, 3, 4, 5, 6, 7, 8, 9]"),
        ("direction: [sped_up, slowed_down] ", "direction: [sped_up] "),
        ("repetitions: 2 ", "repetitions: 160 "),
        ("order: random", "order: {kind: adaptive, of: level, yes: correct == 1, rule: {kind: staircase, start: [9]}}"),
    )
    text = file.text[: file.text.index("simulation:")]
    text += f"simulation:\n  choice: {{confusion: {confusion}, spread: 0.0}}\n"
    text = text.replace("{method: timewarp, actor: T1,", "{level: 5, method: timewarp, actor: T1,")
    text = text.replace("{method: blend, actor: T2,", "{level: 5, method: blend, actor: T2,")
    (run,) = simulate(parse_study("stairs.yaml", text), 1, tmp_path)
    lines = [line for line in journal_lines(run.journal)[0] if line["kind"] == "trial" and not line["practice"]]
    assert len(lines) == 160
    late = lines[60:]
    assert sum(line["response"]["correct"] for line in late) / len(late) == pytest.approx(0.707, abs=0.08)
    assert sum(line["factors"]["level"] for line in late) / len(late) == pytest.approx(4.14, abs=1.2)


def test_two_observers_of_one_population_differ_and_the_same_seed_gives_the_same():
    study = few_choices().study
    first, second = draw_observer(study, 1, 1), draw_observer(study, 2, 2)
    assert isinstance(first, Observer)
    assert first.leaning != second.leaning
    assert draw_observer(study, 1, 1) == first

"""What becomes of an interrupted run under each policy of the study file."""

from __future__ import annotations

import pytest

from protocols import resuming
from protocols.plan import TrialStep, make_plan
from protocols.resuming import Progress, remaining
from protocols.study import Resume
from protocols.study_file import StudyFileError, parse_study
from tests.protocols.studies import changed


def study(policy: str, *more: tuple[str, str]):
    return parse_study("s.yaml", changed(("interval: 0.7 ", f"resume: {{policy: {policy}}}\ninterval: 0.7 "), *more))


def numbers_left(file, done: int) -> list[tuple[int, int]]:
    """Number and attempt of the experimental trials that follow when `done` are finished and one more was begun."""
    plan = make_plan(file.study, 5, 1)
    trials = [f"trial-{n}" for n in range(1, done + 1)]
    begun = dict.fromkeys([*trials, f"trial-{done + 1}"], 1)
    progress = Progress(frozenset({"practice-1", "practice-2", *trials}), begun, consented=True)
    plan = remaining(plan, resuming.again(plan, progress))
    return [(s.trial.number, s.attempt) for s in plan.steps if isinstance(s, TrialStep)]


def test_policy_trial_goes_on_with_the_interrupted_trial_as_its_second_attempt():
    assert numbers_left(study("trial"), 30)[:2] == [(31, 2), (32, 1)]


def test_policy_block_begins_again_after_the_last_set_break_and_marks_what_is_repeated():
    left = numbers_left(study("block"), 30)  # breaks after 24, 48, 72
    assert left[:8] == [(25, 2), (26, 2), (27, 2), (28, 2), (29, 2), (30, 2), (31, 2), (32, 1)]
    assert len(left) == 72


def test_policy_block_repeats_nothing_when_the_break_itself_was_interrupted():
    assert numbers_left(study("block"), 48)[0] == (49, 2)


def test_policy_block_follows_the_blocks_of_a_blocked_design_without_breaks():
    file = study("block", ("order: random  ", "order: blocked  "), ("every: 24  ", "every: 96  "))
    assert numbers_left(file, 30)[0] == (25, 2)  # 24 conditions a block


def test_a_run_may_go_on_within_the_longest_gap_only():
    fifteen = Resume(policy="trial", longest_gap=15.0)
    assert resuming.refusal(fifteen, 14.9) == ""
    assert "16 min ago, and its study file allows 15 min" in resuming.refusal(fifteen, 16.0)
    assert resuming.refusal(fifteen, -600.0) == "", "a clock that was set back tells nothing"


@pytest.mark.parametrize(
    ("resume", "words"),
    [
        (Resume(), "goes on with the interrupted trial"),
        (Resume(policy="block", longest_gap=30.0), "goes on with the first trial since the last break, within 30 min"),
        (Resume(policy="never"), "is not continued"),
    ],
)
def test_check_says_what_becomes_of_an_interrupted_run(resume, words):
    assert resuming.in_words(resume) == words


def test_policy_never_refuses_at_once():
    assert "not continued" in resuming.refusal(Resume(policy="never"), 0.0)


def test_a_policy_that_does_not_exist_is_named_with_what_is_allowed():
    with pytest.raises(
        StudyFileError, match=r"resume\.policy: 'blocks' is not allowed; allowed: trial, block or never"
    ):
        study("blocks")

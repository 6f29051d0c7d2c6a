"""What becomes of an interrupted run: whether it may go on, what of it is done again, and what is left of its plan.

Knows no file and no clock; what a journal says has been done is an argument.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from protocols.orders.adaptive import Tracks, after_response, ended
from protocols.orders.assignment import GIVEN_BACK
from protocols.plan import Plan, Step, TextStep, TrialStep
from protocols.study import Resume, TextPage

FINAL = ("finished", *GIVEN_BACK)
"""Ends after which a run cannot go on."""


def over(ends: Iterable[str]) -> str:
    """Why a run is over, from the reasons of its ends in order; "" while it can go on.

    What goes wrong after the first final one, as with a device on the last page, is another end and changes nothing.
    """
    return next((reason for reason in ends if reason in FINAL), "")


@dataclass(frozen=True)
class Progress:
    """What a journal says has already happened in a run.

    left:     ids of the pages left and trials finished.
    begun:    how often each trial was begun, by step id.
    consented, finished: whether the participant agreed, and whether the run is over.
    answers:  (trial number, factors and response) of every finished trial, in order; practice left out.
    """

    left: frozenset[str] = frozenset()
    begun: Mapping[str, int] = field(default_factory=dict)
    consented: bool = False
    finished: bool = False
    answers: tuple[tuple[int, Mapping[str, object]], ...] = ()


def refusal(resume: Resume, gap: float) -> str:
    """Why a run interrupted `gap` minutes ago may not go on, as half a sentence; "" when it may.

    A negative gap means that the computer's clock was set back meanwhile; it refuses nothing.
    """
    if resume.policy == "never":
        return "its study file says that an interrupted run is not continued (resume: policy: never)"
    if resume.longest_gap is not None and gap > resume.longest_gap:
        return (
            f"it was interrupted {gap:.0f} min ago, and its study file allows {resume.longest_gap:g} min "
            "(resume: longest_gap)"
        )
    return ""


def in_words(resume: Resume) -> str:
    """What the policy does to an interrupted run, as half a sentence."""
    if resume.policy == "never":
        return "is not continued"
    what = {"trial": "with the interrupted trial", "block": "with the first trial since the last break"}[resume.policy]
    within = "" if resume.longest_gap is None else f", within {resume.longest_gap:g} min"
    return f"goes on {what}{within}"


def again(plan: Plan, progress: Progress) -> Progress:
    """The progress without what the study's policy says is to be done again, though it was finished.

    With policy block these are the trials since the last set break, or since the block of the design began, up to
    the first unfinished one. Their records stay in the journal; the new ones are further attempts.
    """
    if plan.study.resume.policy != "block":
        return progress
    repeated = _begun_block(plan, progress)
    answers = tuple(answer for answer in progress.answers if f"trial-{answer[0]}" not in repeated)
    return replace(progress, left=progress.left - repeated, answers=answers)


def _begun_block(plan: Plan, progress: Progress) -> set[str]:
    """Ids of the finished trials of the block in which the first unfinished trial lies."""
    tracks = _answered(plan, progress)
    finished: set[str] = set()
    block = 0
    for step in plan.steps:
        if isinstance(step, TextStep) and step.kind == "break":
            finished = set()
        if not isinstance(step, TrialStep) or step.trial.practice:
            continue
        if step.trial.block != block:
            finished, block = set(), step.trial.block
        if step.id not in progress.left:
            if ended(tracks, step.trial):  # not shown, as its track was over
                continue
            return finished
        finished.add(step.id)
    return set()


def remaining(plan: Plan, progress: Progress) -> Plan:
    """The plan without what is done: the same order, the interrupted trial again as its next attempt.

    A page welcomes the participant back and the instructions are shown again. Breaks before the first unfinished
    trial are not repeated.
    """
    left = {step for step in progress.left if not step.startswith("instructions-") or not progress.consented}
    left |= {"consent"} if progress.consented else set()
    tracks = _answered(plan, progress)
    steps: list[Step] = []
    for step in plan.steps:
        if isinstance(step, TrialStep) and ended(tracks, step.trial):
            continue
        if step.id in left or (isinstance(step, TextStep) and step.kind == "break" and not _trials(steps)):
            continue
        if isinstance(step, TrialStep):
            step = replace(step, attempt=progress.begun.get(step.id, 0) + 1)
        steps.append(step)
    if not _trials(steps):
        steps = [step for step in steps if not step.id.startswith("instructions-")]
    elif progress.consented:
        following = next((s.trial.number for s in _trials(steps) if not s.trial.practice), plan.total)
        words = plan.study.words
        text = words.welcome_back_text.replace("{next}", str(following)).replace("{total}", str(plan.total))
        steps.insert(0, TextStep("welcome-back", TextPage(title=words.welcome_back, text=text)))
    return replace(plan, steps=tuple(steps), tracks=tracks)


def _answered(plan: Plan, progress: Progress) -> Tracks:
    """The plan's tracks after the recorded answers, so that the levels go on where they were.

    Answers count in the order of the plan: of a block done again, an older answer may be left that its track, which
    ended sooner this time, no longer asks for.
    """
    track = {step.trial.number: step.trial.track for step in _trials(list(plan.steps)) if not step.trial.practice}
    tracks = plan.tracks
    for number, columns in sorted(progress.answers, key=lambda answer: answer[0]):
        if f"trial-{number}" not in progress.left:
            continue  # done again by the study's policy, so its first answer does not count
        tracks = after_response(plan.study, tracks, track.get(number, 0), columns)
    return tracks


def _trials(steps: list[Step]) -> list[TrialStep]:
    return [step for step in steps if isinstance(step, TrialStep)]

"""What becomes of an interrupted run: whether it may go on, and what of it is done again; no file, no clock."""

from __future__ import annotations

from dataclasses import replace

from protocols.plan import Plan, TextStep, TrialStep
from protocols.session import Progress
from protocols.study import Resume


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
            return finished
        finished.add(step.id)
    return set()

"""The whole order of a session: consent, questions, instructions, training, trials, breaks, debrief.

A plan follows from the study, the participant's number and the seed alone; it knows no time and no window.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from protocols.adjustment import AdjustmentTask
from protocols.design import Trial, make_trials, practice_trials
from protocols.study import Level, Question, Study, TextPage

QUESTIONS_PER_PAGE = 4


@dataclass(frozen=True)
class TextStep:
    """A page to read; kind decides what follows its button."""

    id: str
    page: TextPage
    kind: Literal["text", "consent", "break", "debrief", "declined"] = "text"


@dataclass(frozen=True)
class QuestionsStep:
    """Up to four questions on one page."""

    id: str
    questions: tuple[Question, ...]


@dataclass(frozen=True)
class TrialStep:
    """One trial of the task; attempt counts how often it has been begun, from 1."""

    trial: Trial
    attempt: int = 1

    @property
    def id(self) -> str:
        """As `trial-7` or `practice-1`."""
        return f"{'practice' if self.trial.practice else 'trial'}-{self.trial.number}"


Step = TextStep | QuestionsStep | TrialStep


@dataclass(frozen=True)
class Plan:
    """Everything one participant will go through, in order."""

    study: Study
    steps: tuple[Step, ...]
    task: AdjustmentTask
    total: int


def make_plan(study: Study, seed: int, participant_number: int) -> Plan:
    """The plan of one run; participant_number (from 1, order of arrival) decides counterbalanced keys."""
    trials = make_trials(study, seed)
    pages = study.pages
    steps: list[Step] = [TextStep("consent", pages.consent, "consent")]
    asked = study.participants.questions
    for i in range(0, len(asked), QUESTIONS_PER_PAGE):
        number = i // QUESTIONS_PER_PAGE + 1
        steps.append(QuestionsStep(f"questions-{number}", tuple(asked[i : i + QUESTIONS_PER_PAGE])))
    steps += [TextStep(f"instructions-{i}", page) for i, page in enumerate(pages.instructions, start=1)]
    practice = practice_trials(study)
    if practice and pages.before_practice is not None:
        steps.append(TextStep("before-practice", pages.before_practice))
    steps += [TrialStep(trial) for trial in practice]
    if pages.before_trials is not None:
        steps.append(TextStep("before-trials", pages.before_trials))
    for trial in trials:
        steps.append(TrialStep(trial))
        if study.breaks is not None and trial.number % study.breaks.every == 0 and trial.number < len(trials):
            steps.append(_break_step(study, trial.number, len(trials)))
    steps.append(TextStep("debrief", pages.debrief, "debrief"))
    return Plan(study, tuple(steps), _task(study, participant_number), len(trials))


def value_of(setting: str | float, trial: Trial) -> Level:
    """A stimulus or task setting in one trial: `$factor` becomes that factor's level."""
    return trial.levels[setting[1:]] if isinstance(setting, str) and setting.startswith("$") else setting


def _break_step(study: Study, done: int, total: int) -> TextStep:
    assert study.breaks is not None
    text = study.breaks.text.replace("{done}", str(done)).replace("{total}", str(total))
    return TextStep(f"break-{done}", TextPage(title=study.breaks.title, text=text), "break")


def _task(study: Study, participant_number: int) -> AdjustmentTask:
    task, keys = study.task, study.task.keys
    lower, raise_ = keys.lower, keys.raise_
    if keys.counterbalanced and participant_number % 2 == 0:
        lower, raise_ = raise_, lower
    return AdjustmentTask(
        minimum=task.range.minimum,
        maximum=task.range.maximum,
        rate=task.rate,
        minimum_looking_time=task.minimum_looking_time,
        lower_key=lower,
        raise_key=raise_,
        confirm_key=keys.confirm,
    )

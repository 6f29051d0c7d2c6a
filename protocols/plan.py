"""The whole order of a session: consent, questions, instructions, training, trials, breaks, debrief.

A plan follows from the study, the participant's number and the seed alone; it knows no time and no window.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from protocols.adaptive import Tracks, begin_tracks
from protocols.adjustment import AdjustmentTask
from protocols.design import Trial, make_trials, practice_trials
from protocols.study import Level, Pages, Question, Study, TextPage

QUESTIONS_PER_PAGE = 4


@dataclass(frozen=True)
class TextStep:
    """A page to read; kind decides what follows its button."""

    id: str
    page: TextPage
    kind: Literal["text", "consent", "break", "debrief", "farewell"] = "text"


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
    """Everything one participant will go through, in order.

    tracks: of an adaptive order, by number, after the answers of the trials that are no longer in the steps.
    """

    study: Study
    steps: tuple[Step, ...]
    task: AdjustmentTask
    total: int
    tracks: Tracks = field(default_factory=dict)


def make_plan(study: Study, seed: int, participant_number: int, group: Mapping[str, str] | None = None) -> Plan:
    """The plan of one run; participant_number (from 1) decides counterbalanced keys and the row of a square.

    group: levels of the between-participant factors that the program assigned.
    """
    trials = make_trials(study, seed, participant_number, group)
    pages = _with_keys(study, keys_of(study, participant_number))
    steps: list[Step] = [TextStep("consent", pages.consent, "consent")]
    asked = study.participants.questions
    for i in range(0, len(asked), QUESTIONS_PER_PAGE):
        number = i // QUESTIONS_PER_PAGE + 1
        steps.append(QuestionsStep(f"questions-{number}", tuple(asked[i : i + QUESTIONS_PER_PAGE])))
    steps += [TextStep(f"instructions-{i}", page) for i, page in enumerate(pages.instructions, start=1)]
    practice = practice_trials(study, group)
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
    return Plan(study, tuple(steps), _task(study, participant_number), len(trials), begin_tracks(study))


def value_of(setting: str | float, trial: Trial) -> Level:
    """A stimulus or task setting in one trial: `$factor` becomes that factor's level, or the assigned group's."""
    if isinstance(setting, str) and setting.startswith("$"):
        return {**trial.group, **trial.levels}[setting[1:]]
    return setting


KEY_LABELS = {"left": "←", "right": "→", "up": "↑", "down": "↓"}
"""How keys are called on a page, unless the study's words say otherwise; others by their name, as Enter or B."""


def keys_of(study: Study, participant_number: int) -> dict[str, str]:
    """What lower, raise, confirm and break are for a participant, whose number decides counterbalanced keys."""
    keys = study.task.keys
    lower, raise_ = keys.lower, keys.raise_
    if keys.counterbalanced and participant_number % 2 == 0:
        lower, raise_ = raise_, lower
    return {"lower": lower, "raise": raise_, "confirm": keys.confirm, "break": keys.take_break}


def _with_keys(study: Study, keys: Mapping[str, str]) -> Pages:
    """The study's pages with {lower}, {raise}, {confirm} and {break} replaced by this participant's keys."""
    labels: dict[str, str] = {**KEY_LABELS}
    labels.update(study.words.keys.items())

    def filled(text: str) -> str:
        for name, key in keys.items():
            text = text.replace(f"{{{name}}}", labels.get(key, key.capitalize()))
        return text

    def page(old: TextPage | None) -> TextPage | None:
        return None if old is None else TextPage(title=filled(old.title), text=filled(old.text))

    pages = study.pages
    return pages.model_copy(
        update={
            "instructions": [page(old) for old in pages.instructions],
            "before_practice": page(pages.before_practice),
            "before_trials": page(pages.before_trials),
        }
    )


def _break_step(study: Study, done: int, total: int) -> TextStep:
    assert study.breaks is not None
    text = study.breaks.text.replace("{done}", str(done)).replace("{total}", str(total))
    return TextStep(f"break-{done}", TextPage(title=study.breaks.title, text=text), "break")


def _task(study: Study, participant_number: int) -> AdjustmentTask:
    task, keys = study.task, keys_of(study, participant_number)
    return AdjustmentTask(
        minimum=task.range.minimum,
        maximum=task.range.maximum,
        rate=task.rate,
        minimum_looking_time=task.minimum_looking_time,
        lower_key=keys["lower"],
        raise_key=keys["raise"],
        confirm_key=keys["confirm"],
    )

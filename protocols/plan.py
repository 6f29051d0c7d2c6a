"""The whole order of a session: consent, questions, instructions, training, trials, breaks, debrief.

A plan follows from the study, the participant's number and the seed alone; it knows no time and no window.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

from protocols.orders.adaptive import Tracks, begin_tracks
from protocols.orders.design import Trial, make_trials, practice_trials
from protocols.stimulus import Walk
from protocols.study import Pages, Question, Study, TextPage
from protocols.tasks.sides import balanced_orders
from protocols.tasks.task import Setup, TaskTrial

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
    """One trial of the task.

    order: names of its alternatives from left to right or first to last, ("",) where there is only one walk.
    attempt: how often it has been begun, from 1.
    seed: the run's, for what of the stimulus is left to chance.
    """

    trial: Trial
    order: tuple[str, ...] = ("",)
    attempt: int = 1
    seed: int = 0

    @property
    def id(self) -> str:
        """As `trial-7` or `practice-1`."""
        return f"{'practice' if self.trial.practice else 'trial'}-{self.trial.number}"


Step = TextStep | QuestionsStep | TrialStep


@dataclass(frozen=True)
class Plan:
    """Everything one participant will go through, in order.

    keys: what each of the task's keys is for this participant; total: trials of the experiment.
    tracks: of an adaptive order, by number, after the answers of the trials that are no longer in the steps.
    """

    study: Study
    steps: tuple[Step, ...]
    keys: Mapping[str, str]
    total: int
    tracks: Tracks = field(default_factory=dict)

    def begin(self, step: TrialStep) -> TaskTrial:
        """The trial of a step, waiting for its first frame."""
        task = self.study.task
        question = with_keys(task.asked, self.keys, self.study)
        return task.begin(Setup(walks_of(self.study, step), step.trial.values, self.keys, question))


def walks_of(study: Study, step: TrialStep) -> dict[str, Walk]:
    """Name to walk of the alternatives of a trial, in the order they are shown."""
    walks = study.task.walks(study.stimulus, step.trial.values)
    return {name: _with_chance(walks[name], study, step) for name in step.order}


def _with_chance(walk: Walk, study: Study, step: TrialStep) -> Walk:
    """A crowd's paths are drawn for the trial, the same for all alternatives; a single walk has no chance in it."""
    return walk if walk.crowd is None else replace(walk, crowd=walk.crowd.drawn_by(study.study, step.seed, step.id))


def _with_orders(study: Study, trials: list[Trial], seed: int) -> list[TrialStep]:
    if not trials:
        return []
    task = study.task
    names = list(task.walks(study.stimulus, trials[0].values))
    kind = "practice" if trials[0].practice else "trials"
    orders = balanced_orders(trials, names, f"{study.study}/sides/{kind}/{seed}") if task.balanced else None
    return [TrialStep(trial, orders[i] if orders else tuple(names), seed=seed) for i, trial in enumerate(trials)]


def make_plan(study: Study, seed: int, participant_number: int, group: Mapping[str, str] | None = None) -> Plan:
    """The plan of one run; participant_number (from 1) decides counterbalanced keys and the row of a square.

    group: levels of the between-participant factors that the program assigned.
    """
    trials = _with_orders(study, make_trials(study, seed, participant_number, group), seed)
    practice = _with_orders(study, practice_trials(study, group), seed)
    keys = study.task.keys_for(participant_number)
    pages = _with_keys(study, keys)
    steps: list[Step] = [TextStep("consent", pages.consent, "consent")]
    asked = study.participants.questions
    for i in range(0, len(asked), QUESTIONS_PER_PAGE):
        number = i // QUESTIONS_PER_PAGE + 1
        steps.append(QuestionsStep(f"questions-{number}", tuple(asked[i : i + QUESTIONS_PER_PAGE])))
    steps += [TextStep(f"instructions-{i}", page) for i, page in enumerate(pages.instructions, start=1)]
    if practice and pages.before_practice is not None:
        steps.append(TextStep("before-practice", pages.before_practice))
    steps += practice
    if pages.before_trials is not None:
        steps.append(TextStep("before-trials", pages.before_trials))
    for step in trials:
        steps.append(step)
        done = step.trial.number
        if study.breaks is not None and done % study.breaks.every == 0 and done < len(trials):
            steps.append(_break_step(study, done, len(trials)))
    steps.append(TextStep("debrief", pages.debrief, "debrief"))
    return Plan(study, tuple(steps), keys, len(trials), begin_tracks(study))


KEY_LABELS = {"left": "←", "right": "→", "up": "↑", "down": "↓"}
"""How keys are called on a page, unless the study's words say otherwise; others by their name, as Enter or B."""


def with_keys(text: str, keys: Mapping[str, str], study: Study) -> str:
    """A text with {break} and the names of the task's keys, as {lower} or {first}, replaced by what they are called."""
    labels: dict[str, str] = {**KEY_LABELS}
    labels.update(study.words.keys.items())
    for name, key in keys.items():
        text = text.replace(f"{{{name}}}", labels.get(key, key.capitalize()))
    return text


def _with_keys(study: Study, keys: Mapping[str, str]) -> Pages:
    """The study's pages with this participant's keys."""

    def page(old: TextPage | None) -> TextPage | None:
        if old is None:
            return None
        return TextPage(title=with_keys(old.title, keys, study), text=with_keys(old.text, keys, study))

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

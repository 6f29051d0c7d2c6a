"""A simulated participant: reads pages, answers questions, and does in each trial what its behaviour says.

It sees only what a person sees (the page or the trial) and answers with the same events. Randomness comes from
the run's seed.
"""

from __future__ import annotations

import math
from random import Random

from experiment_app.simulated.behaviour import BEHAVIOURS, Observer
from protocols.events import Clicked, Event, KeyDown, Typed
from protocols.form import Form
from protocols.orders.assignment import place_in_group
from protocols.plan import QuestionsStep, Step, TextStep, TrialStep
from protocols.session import Session
from protocols.study import Question, Simulation, Study

READING = 1.0
"""s a simulated observer looks at a page."""


def draw_observer(study: Study, participant_number: int, seed: int) -> Observer:
    """An observer of the study's simulated population; the same seed gives the same observer.

    Preferences over actors are normal with the study's means and s.d. and correlate by `shared` within a
    participant. Between-participant factors are filled in turn by the participant's number.
    """
    rng, own = Random(f"{study.study}/observer/{seed}"), Random(f"{study.study}/person/{seed}")
    return Observer(
        simulation=study.simulation,
        preferred=_preferences(study.simulation, rng),
        leaning=own.gauss(0.0, 1.0),
        pace=own.gauss(0.0, 1.0),
        answers=_answers(study, participant_number, rng),
    )


def _preferences(simulation: Simulation, rng: Random) -> dict[str, float]:
    own = rng.gauss(0.0, 1.0)
    preferred = {}
    for actor, population in simulation.preferred_walk_ratio.items():
        z = math.sqrt(simulation.shared) * own + math.sqrt(1.0 - simulation.shared) * rng.gauss(0.0, 1.0)
        preferred[actor] = max(population.mean + population.sd * z, population.mean / 4.0)
    return preferred


def _answers(study: Study, number: int, rng: Random) -> dict[str, str]:
    """An answer to every question; those that are factors are filled in turn inside every assigned group."""
    turn = place_in_group(study, number)
    answers = {}
    for question in study.participants.questions:
        levels = study.participants.between.get(question.id)
        if levels:
            turn, place = divmod(turn, len(levels))
            answers[question.id] = levels[place]
        else:
            answers[question.id] = _answer(question, rng)
    return answers


def _answer(question: Question, rng: Random) -> str:
    if question.kind == "choice":
        return next(iter(question.options))
    if question.kind == "number":
        return str(rng.randint(question.minimum, min(question.maximum, question.minimum + 30)))
    return "simulated"


class SimulatedParticipant:
    """Plans the events of each page and trial when it appears, and hands them out as time goes by."""

    def __init__(self, study: Study, observer: Observer, seed: int) -> None:
        self._study = study
        self._observer = observer
        self._rng = Random(f"{study.study}/behaviour/{seed}")
        self._planned_for: tuple[Step, float] | None = None
        self._events: list[Event] = []

    def look(self, session: Session) -> None:
        """Takes notice of the session; plans what to do when a page or trial has newly appeared."""
        if session.shown is None or self._planned_for == (session.step, session.shown):
            return
        self._planned_for = (session.step, session.shown)
        if session.trial is not None and isinstance(session.step, TrialStep):
            behave = BEHAVIOURS[self._study.task.kind]
            self._events = behave(self._observer, session.trial, session.step.trial.levels, self._rng)
        elif isinstance(session.stage, Form):
            self._events = self._fill(session.step, session.shown + READING)

    def next_time(self) -> float | None:
        """The time (s) of the next event, None when nothing is planned."""
        return self._events[0].time if self._events else None

    def take(self, until: float) -> list[Event]:
        """The planned events up to `until` (s), oldest first; each is handed out once."""
        count = sum(event.time <= until for event in self._events)
        taken, self._events = self._events[:count], self._events[count:]
        return taken

    def _fill(self, step: Step, time: float) -> list[Event]:
        if isinstance(step, TextStep):
            return [Clicked(time, "agree") if step.kind == "consent" else KeyDown(time, "enter")]
        assert isinstance(step, QuestionsStep)
        events: list[Event] = []
        for question in step.questions:
            answer = self._observer.answers[question.id]
            if question.kind == "choice":
                events.append(Clicked(time, f"{question.id}:{answer}"))
            else:
                events += [Clicked(time, question.id), Typed(time, answer)]
        return [*events, Clicked(time, "next")]

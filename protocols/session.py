"""A participant's whole session as a value: which page or trial is on, what happens next, what to write down.

begin / handle(event) / advance(until) give the next session; no clock, window or file in here. Records to be
written collect in `emitted`, and the session waits for a Saved event before it goes on after a trial.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from protocols.events import Asked, Clicked, Closed, Event, FocusLost, KeyDown, KeyUp, Saved, Shown
from protocols.form import Choice, Entry, Form, handle_form
from protocols.orders.adaptive import Tracks, after_response, ended, placed, turns, why_over
from protocols.plan import Plan, QuestionsStep, Step, TextStep, TrialStep
from protocols.record import (
    Answered,
    Click,
    Consented,
    Ended,
    Key,
    PageShown,
    Paused,
    Record,
    Resumed,
    TrialBegun,
    TrialRecord,
)
from protocols.study import ChoiceQuestion, NumberQuestion, Question, TextPage
from protocols.tasks.task import TaskTrial

STOPPED_BY_EXPERIMENTER = "stopped by the experimenter"
"""Why a session ended that the experimenter stopped from the console."""

UNREAD = 0.25
"""s after a page appears in which keys do nothing, so that pressing Enter twice leaves no page unseen."""


@dataclass(frozen=True)
class Interval:
    """The empty screen after a trial: it lasts until `until` (s) and until everything is saved."""

    until: float
    saved: bool = False


@dataclass(frozen=True)
class Overlay:
    """A page over the session: the pause page, the question whether to stop, or a break the participant took."""

    why: str
    since: float
    form: Form


@dataclass(frozen=True)
class Session:
    """One participant's session at one moment.

    index:   step of the plan that is on; stage: its page, trial or the interval after it.
    shown:   flip time (s) of the stage's first frame, None until it has been seen.
    ended:   why the session is over, "" while it is not.
    tracks:  of an adaptive order, what the answers so far say about the next levels.
    """

    plan: Plan
    index: int
    stage: Form | TaskTrial | Interval
    shown: float | None = None
    overlay: Overlay | None = None
    pauses: int = 0
    ended: str = ""
    emitted: tuple[Record, ...] = field(default=())
    tracks: Tracks = field(default_factory=dict)

    @property
    def step(self) -> Step:
        """The step of the plan that is on."""
        return self.plan.steps[self.index]

    @property
    def done(self) -> bool:
        """True once the session is over."""
        return bool(self.ended)

    @property
    def trial(self) -> TaskTrial | None:
        """The trial that is on, or None."""
        return None if isinstance(self.stage, (Form, Interval)) else self.stage


def begin(plan: Plan) -> Session:
    """The session at its first step."""
    return _entered(Session(plan, 0, Form(), tracks=plan.tracks), 0, 0.0)


def drained(session: Session) -> tuple[Session, tuple[Record, ...]]:
    """The session with nothing left to write, and the records that were waiting."""
    return replace(session, emitted=()), session.emitted


def advance(session: Session, until: float) -> Session:
    """The session at time `until` (s) when no event has happened since."""
    if session.done or session.overlay is not None:
        return session
    if session.trial is not None:
        return replace(session, stage=session.trial.advance(until))
    if isinstance(session.stage, Interval) and session.stage.saved and until >= session.stage.until:
        return _entered(session, session.index + 1, until)
    return session


def handle(session: Session, event: Event) -> Session:
    """The session once `event` has happened."""
    if session.done:
        return session
    if isinstance(event, Closed):
        return _ended(session, event.time, event.reason)
    if isinstance(event, Saved):
        if not isinstance(session.stage, Interval):
            return session
        return replace(session, stage=replace(session.stage, saved=True))
    if isinstance(event, Shown):
        return _seen(session, event)
    session = advance(session, event.time)
    if isinstance(event, Asked):
        return _asked(session, event)
    if session.overlay is not None:
        return _overlaid(session, session.overlay, event)
    if isinstance(event, KeyDown) and event.key == "escape" and not _last_page(session):
        return _paused(session, event, "pause")
    in_trials = not isinstance(session.stage, Form)
    if isinstance(event, KeyDown) and event.key == session.plan.keys["break"] and in_trials:
        return _paused(session, event, "break")
    if session.trial is not None:
        return _in_trial(session, session.trial, event)
    if isinstance(session.stage, Form):
        return _on_page(session, session.stage, event)
    return session


# Entering and leaving steps


def _entered(session: Session, index: int, time: float) -> Session:
    index = _needed(session, index)
    if index == len(session.plan.steps):  # a plan of trials alone, as for a film, has no last page
        return replace(_emit(session, Ended(time, "finished")), ended="finished")
    session = _placed(session, index)
    session = replace(session, index=index, shown=None, pauses=0, stage=_stage(session.plan, index))
    step = session.step
    if isinstance(step, TextStep) and step.kind == "debrief":
        # all data are in; whoever closes the window on the last page has finished all the same
        session = _emit(session, Ended(time, "finished"))
    return session


def _needed(session: Session, index: int) -> int:
    """The first step from `index` on that is to be shown: no trial of a track that has ended, no break beside none."""
    steps = session.plan.steps
    before = steps[index - 1] if index else None  # the step shown last
    while index < len(steps):
        step = steps[index]
        over = isinstance(step, TrialStep) and ended(session.tracks, step.trial)
        idle = _is_break(step) and (_is_break(before) or not _trials_left(session, index))
        if not (over or idle):
            break
        index += 1
    return index


def _is_break(step: Step | None) -> bool:
    return isinstance(step, TextStep) and step.kind == "break"


def _trials_left(session: Session, index: int) -> bool:
    trials = (step.trial for step in session.plan.steps[index:] if isinstance(step, TrialStep))
    return any(not ended(session.tracks, trial) for trial in trials)


def _placed(session: Session, index: int) -> Session:
    """The session with the level that its track shows next filled into an adaptively placed trial."""
    steps = session.plan.steps
    step = steps[index]
    if not isinstance(step, TrialStep) or not step.trial.track:
        return session
    step = replace(step, trial=placed(session.plan.study, session.tracks, step.trial))
    return replace(session, plan=replace(session.plan, steps=(*steps[:index], step, *steps[index + 1 :])))


def _stage(plan: Plan, index: int) -> Form | TaskTrial:
    step, words = plan.steps[index], plan.study.words
    if isinstance(step, TrialStep):
        return plan.begin(step)
    if isinstance(step, QuestionsStep):
        return Form(
            fields=tuple(_field(question) for question in step.questions),
            buttons=(("next", words.next),),
            submit="next",
            missing=words.missing,
            not_a_number=words.not_a_number,
            focus=0,
        )
    if step.kind == "consent":
        return Form(buttons=(("agree", words.agree), ("decline", words.decline)))
    return Form()


def _field(question: Question) -> Choice | Entry:
    if isinstance(question, ChoiceQuestion):
        return Choice(question.id, question.prompt, tuple(question.options.items()))
    if isinstance(question, NumberQuestion):
        limits = (question.minimum, question.maximum)
        return Entry(question.id, question.prompt, True, *limits, max_length=9)
    return Entry(question.id, question.prompt, required=question.required, max_length=question.max_length)


def _emit(session: Session, *records: Record) -> Session:
    return replace(session, emitted=session.emitted + records)


def _ended(session: Session, time: float, reason: str) -> Session:
    if _last_page(session):  # the end is recorded already
        return replace(session, ended="finished" if session.step.id == "debrief" else session.step.id)
    return replace(_emit(session, Ended(time, reason)), ended=reason)


def _last_page(session: Session) -> bool:
    return isinstance(session.step, TextStep) and session.step.kind in ("debrief", "farewell")


def _seen(session: Session, event: Shown) -> Session:
    if session.shown is not None or session.overlay is not None or isinstance(session.stage, Interval):
        return session
    session = replace(session, shown=event.time)
    step = session.step
    if session.trial is not None and isinstance(step, TrialStep):
        trial = step.trial
        begun = TrialBegun(event.time, trial.number, trial.practice, step.attempt, trial.levels)
        session = _emit(replace(session, stage=session.trial.handle(event)), begun)
    return session


# Pages


def _on_page(session: Session, form: Form, event: Event) -> Session:
    if session.shown is None or (isinstance(event, KeyDown) and event.time < session.shown + UNREAD):
        return session  # a key meant for the page before must not turn this one
    form = handle_form(form, event)
    session = replace(session, stage=form)
    if not form.pressed:
        return session
    step, time = session.step, event.time
    left = PageShown(time, step.id, session.shown if session.shown is not None else time)
    if isinstance(step, QuestionsStep):
        session = _emit(session, *_answers(step, form.values, time), left)
    elif isinstance(step, TextStep) and step.kind == "consent":
        session = _emit(session, Consented(time, form.pressed == "agree"))
        if form.pressed != "agree":
            return _farewell(session, time, "declined", session.plan.study.pages.declined)
    elif isinstance(step, TextStep) and step.kind == "farewell":
        return replace(session, ended=step.id)
    elif isinstance(step, TextStep) and step.kind == "debrief":
        return replace(_emit(session, left), ended="finished")
    else:
        session = _emit(session, left)
        if isinstance(step, TextStep) and step.kind == "break":
            since = session.shown if session.shown is not None else time
            session = _emit(session, Paused(since, "set break"), Resumed(time, time - since))
    return _entered(session, session.index + 1, time)


def _answers(step: QuestionsStep, values: Mapping[str, str], time: float) -> list[Record]:
    answers: list[Record] = []
    for question in step.questions:
        value = values.get(question.id, "").strip()
        answers.append(Answered(time, question.id, int(value) if question.kind == "number" else value))
    return answers


def _farewell(session: Session, time: float, reason: str, page: TextPage) -> Session:
    """A polite last page; the end is recorded at once, so that closing the window adds nothing."""
    plan = replace(session.plan, steps=(TextStep(reason, page, "farewell"),))
    return replace(_emit(session, Ended(time, reason)), plan=plan, index=0, stage=Form(), shown=None)


# Trials


def _in_trial(session: Session, trial: TaskTrial, event: Event) -> Session:
    step = session.step
    assert isinstance(step, TrialStep)
    if trial.hears(event) and isinstance(event, (KeyDown, KeyUp)):
        session = _emit(session, _key_record(step, event, isinstance(event, KeyDown)))
    elif trial.hears(event) and isinstance(event, Clicked):
        session = _emit(session, Click(event.time, step.trial.number, step.trial.practice, event.target))
    if isinstance(event, FocusLost) and trial.held:
        session = _emit(session, Key(event.time, step.trial.number, step.trial.practice, "focus", False))
    trial = trial.handle(event)
    session = replace(session, stage=trial)
    if not trial.done:
        return session
    record = _trial_record(session, step, trial, event.time)
    study, track = session.plan.study, step.trial.track
    tracks = after_response(study, session.tracks, track, answer_columns(vars(record)))
    record = replace(record, track_reversals=turns(tracks, track), track_end=why_over(study, tracks, step.trial))
    session = replace(session, tracks=tracks)
    return replace(_emit(session, record), stage=Interval(event.time + session.plan.study.interval), shown=None)


def answer_columns(trial: Mapping[str, Any]) -> dict[str, object]:
    """What a condition on a trial's answer may name: its factors, the values of its response, and response_time.

    trial: the members of a TrialRecord, or of its line in a journal.
    """
    return {**trial["factors"], **trial["response"], "response_time": trial["response_time"]}


def _key_record(step: TrialStep, event: KeyDown | KeyUp, down: bool) -> Key:
    trial = step.trial
    return Key(event.time, trial.number, trial.practice, event.key, down, event.source, event.uncertainty_ms)


def _trial_record(session: Session, step: TrialStep, trial: TaskTrial, time: float) -> TrialRecord:
    return TrialRecord(
        time=time,
        number=step.trial.number,
        practice=step.trial.practice,
        attempt=step.attempt,
        block=step.trial.block,
        repetition=step.trial.repetition,
        factors=step.trial.levels,
        response=trial.response,
        onset=trial.onset,
        response_time=trial.looked,
        key_presses=trial.counts["key_presses"],
        reversals=trial.counts["reversals"],
        early_confirms=trial.counts["early_confirms"],
        pauses=session.pauses,
        track=step.trial.track,
    )


# Pauses


def _paused(session: Session, event: KeyDown | Asked, why: str) -> Session:
    words = session.plan.study.words
    resume, stop = ("resume", words.resume), ("stop", words.stop)
    buttons = {"pause": (resume, stop), "break": (resume,), "experimenter": ()}[why]
    stage = session.stage if session.trial is None else session.trial.advance(event.time).paused()
    overlay = Overlay(why, event.time, Form(buttons=buttons, focus=0))
    session = replace(session, stage=stage, overlay=overlay, pauses=session.pauses + 1)
    return _emit(session, Paused(event.time, why))


def _overlaid(session: Session, overlay: Overlay, event: Event) -> Session:
    words = session.plan.study.words
    if isinstance(event, KeyDown) and event.key == "escape":
        return _resumed(session, overlay, event.time)
    if not overlay.form.buttons:  # the experimenter's pause
        return session
    form = handle_form(overlay.form, event)
    if form.pressed == "resume":
        return _resumed(session, overlay, event.time)
    if form.pressed == "stop":
        really = Form(buttons=(("resume", words.resume), ("stop_really", words.stop_really)), focus=0)
        return replace(session, overlay=replace(overlay, why="stop", form=really))
    if form.pressed == "stop_really":
        page = TextPage(title=words.stopped, text=words.stopped_text)
        return _farewell(replace(session, overlay=None), event.time, "stopped", page)
    return replace(session, overlay=replace(overlay, form=form))


def _asked(session: Session, event: Asked) -> Session:
    """The session as the experimenter wants it; their pause has no button, so that only they, or Escape, end it."""
    if _last_page(session):
        return session
    if event.what == "stop":
        words = session.plan.study.words
        page = TextPage(title=words.stopped, text=words.stopped_text)
        return _farewell(replace(session, overlay=None), event.time, STOPPED_BY_EXPERIMENTER, page)
    if event.what == "resume" and session.overlay is not None:
        return _resumed(session, session.overlay, event.time)
    if event.what == "pause" and session.overlay is None:
        return _paused(session, event, "experimenter")
    return session


def _resumed(session: Session, overlay: Overlay, time: float) -> Session:
    stage = session.stage if session.trial is None else session.trial.resumed(time)
    if isinstance(stage, Interval):
        stage = replace(stage, until=max(stage.until, time))
    return _emit(replace(session, stage=stage, overlay=None), Resumed(time, time - overlay.since))

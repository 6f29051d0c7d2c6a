"""A session to a scene: what the participant sees now. Pure; knows no GPU."""

from __future__ import annotations

from dataclasses import replace

from experiment_app.scene import Box, Camera, Line, Marks, Page, Row, Scene, Walker
from protocols.adjustment import AdjustmentTrial
from protocols.form import Choice, Form
from protocols.plan import QuestionsStep, TextStep, TrialStep, value_of
from protocols.session import Interval, Overlay, Session
from protocols.study import Study
from protocols.viewing import field_of_view


def stage(session: Session) -> Scene:
    """The scene of a session at its present time."""
    if session.overlay is not None:
        scene = _trial_scene(session) if session.trial is not None else Scene(page=None)
        return replace(scene, page=_overlay_page(session, session.overlay), caption="")
    if isinstance(session.stage, AdjustmentTrial):
        return _trial_scene(session)
    if isinstance(session.stage, Interval):
        return Scene(page=Page())
    return Scene(page=_page(session, session.stage))


def staged(study: Study, walkers: tuple[Walker, ...]) -> Scene:
    """The walkers as the study wants them seen: its ground, camera, marks, level of detail and viewer's angle."""
    look = study.stimulus
    camera = Camera(
        view=look.camera.view,
        distance=look.camera.distance,
        height=look.camera.height,
        field_of_view=field_of_view(look.camera, study.display),
        heading=look.camera.heading,
        place=(look.camera.place[0], look.camera.place[1]) if look.camera.place else (0.0, 0.0),
    )
    return Scene(
        walkers,
        camera,
        look.ground,
        marks=Marks(**look.marks.model_dump()),
        screen_angle=study.display.angle if study.display is not None else 0.0,
        lod=look.level_of_detail,
    )


def _trial_scene(session: Session) -> Scene:
    step, trial, study = session.step, session.trial, session.plan.study
    assert isinstance(step, TrialStep)
    assert trial is not None
    body = value_of(study.stimulus.body, step.trial) if study.stimulus.body else ""
    walker = Walker(
        actor=str(value_of(study.stimulus.actor, step.trial)),
        body=str(body),
        speed=trial.speed,
        step_frequency=trial.setting,
        phase=trial.phase,
        distance=trial.distance,
    )
    return replace(staged(study, (walker,)), caption=study.words.trial_caption)


def paragraphs(text: str) -> tuple[Line, ...]:
    """Paragraphs are parted by empty lines; single line breaks inside one are only wrapping in the file."""
    parts = [" ".join(part.split()) for part in text.replace("\r\n", "\n").split("\n\n")]
    return tuple(Line(part) for part in parts if part)


def _page(session: Session, form: Form) -> Page:
    step, words = session.step, session.plan.study.words
    if isinstance(step, QuestionsStep):
        lines: tuple[Line, ...] = (Line(words.questions_title, "title"),)
        return Page(lines, _rows(form), hint=words.question_hint)
    assert isinstance(step, TextStep)
    lines = (Line(step.page.title, "title"), *paragraphs(step.page.text))
    if step.kind == "consent":
        return Page(lines, _rows(form), hint=words.choose_hint)
    last = step.kind in ("debrief", "farewell")
    progress = None
    if step.kind == "break" and session.plan.total:
        progress = int(step.id.removeprefix("break-")) / session.plan.total
    return Page(lines, hint=words.finished_hint if last else words.page_hint, progress=progress)


def _rows(form: Form) -> tuple[Row, ...]:
    rows: list[Row] = []
    for i, item in enumerate(form.fields):
        value, focused = form.values.get(item.id, ""), form.focus == i
        if isinstance(item, Choice):
            boxes = tuple(
                Box(f"{item.id}:{option}", label, "option", option == value, focused) for option, label in item.options
            )
        else:
            boxes = (Box(item.id, value, "field", focused=focused),)
        rows.append(Row(item.prompt, boxes, form.errors.get(item.id, "")))
    if form.buttons:
        first = len(form.fields)
        buttons = tuple(
            Box(name, label, "button", focused=form.focus == first + i) for i, (name, label) in enumerate(form.buttons)
        )
        rows.append(Row("", buttons))
    return tuple(rows)


def _overlay_page(session: Session, overlay: Overlay) -> Page:
    words = session.plan.study.words
    title, text = {
        "pause": (words.pause_title, words.pause_text),
        "break": (words.break_title, words.break_text),
        "stop": (words.stop_title, words.stop_text),
    }[overlay.why]
    lines = (Line(title, "title"), *paragraphs(text))
    return Page(lines, _rows(overlay.form), hint=words.choose_hint, over_scene=session.trial is not None)

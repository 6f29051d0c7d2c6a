"""A session to a scene: what the participant sees now. Pure; knows no GPU."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from functools import cache

from experiment_app.scene import Box, Camera, Crowd, Ground, Line, Marks, Page, Row, Scene, Slider, Walker
from experiment_app.walkers import own_step_frequency
from protocols.crowd_part import CrowdOf
from protocols.events import Shown
from protocols.form import Choice, Form
from protocols.mistakes.consistency import MOST_TRIALS
from protocols.parts import Level
from protocols.plan import Plan, QuestionsStep, TextStep, TrialStep
from protocols.session import Overlay, Session
from protocols.setting import value_of
from protocols.stimulus import Making as OwnMaking
from protocols.stimulus import Walk
from protocols.study import Study
from protocols.tasks.rating import CONFIRM, ON_SCALE
from protocols.tasks.task import Scale, Seen, View
from protocols.viewing import field_of_view
from stimuli.methods.recipe import Making

QUESTION_STRIP, SCALE_STRIP = 0.1, 0.22
"""Share of the picture's height, at its lower edge, that a question has for itself."""

OWN_WAY = OwnMaking()
"""How a walk is made when the study file says nothing: as the actor was captured."""


def stage(session: Session) -> Scene:
    """The scene of a session at its present time."""
    trial = session.trial
    if session.overlay is not None:
        scene = _trial_scene(session, trial.view) if trial is not None else Scene(page=None)
        return replace(scene, page=_overlay_page(session, session.overlay), caption="")
    if trial is not None:
        return _trial_scene(session, trial.view)
    if isinstance(session.stage, Form):
        return Scene(page=_page(session, session.stage))
    return Scene(page=Page())


def _trial_scene(session: Session, view: View) -> Scene:
    """What a trial shows; where the study wants it, a scrambled point light stands differently in every trial."""
    study, step = session.plan.study, session.step
    assert isinstance(step, TrialStep)
    scene = view_scene(study, view, step.trial.values)
    if not study.stimulus.marks.each_trial:
        return scene
    number = step.trial.number + (MOST_TRIALS if step.trial.practice else 0)
    marks = replace(scene.marks, seed=scene.marks.seed + number)
    beside = None if scene.beside is None else replace(scene.beside, marks=marks)
    return replace(scene, marks=marks, beside=beside)


def differing_scenes(plan: Plan) -> list[Scene]:
    """The first picture of a trial for every camera and ground; none where all trials of the plan share them.

    A window that has drawn them has built every ground, so that no trial's first frame waits for one.
    """
    trials: dict[tuple[Camera, Ground], TrialStep] = {}
    for step in plan.steps:
        if isinstance(step, TrialStep):
            empty = staged(plan.study, (), step.trial.values)
            trials.setdefault((empty.camera, empty.ground), step)
    if len(trials) < 2:
        return []
    return [
        view_scene(plan.study, plan.begin(step).handle(Shown(0.0)).view, step.trial.values) for step in trials.values()
    ]


def staged(study: Study, walkers: tuple[Walker, ...], levels: Mapping[str, Level]) -> Scene:
    """The walkers as the study wants them seen in a trial with these levels.

    That is: ground, camera, marks, level of detail and viewer's angle.
    """
    look = study.stimulus
    seen_from = look.camera.resolved(levels)
    camera = Camera(
        view=seen_from.view,
        distance=seen_from.distance,
        height=seen_from.height,
        field_of_view=field_of_view(seen_from, study.display),
        heading=seen_from.heading,
        place=seen_from.place or (0.0, 0.0),
    )
    return Scene(
        walkers,
        camera,
        value_of(look.ground, levels),
        marks=Marks(**look.marks.model_dump(exclude={"each_trial"})),
        screen_angle=study.display.angle if study.display is not None else 0.0,
        lod=look.level_of_detail,
    )


def view_scene(study: Study, view: View, levels: Mapping[str, Level]) -> Scene:
    """What a trial with these levels shows: one walk, or two beside each other, and in a strip what is asked."""
    scenes = [_seen_scene(study, seen, levels) for seen in view.walks]
    scene = Scene()
    if scenes:
        scene = scenes[0] if len(scenes) == 1 else replace(scenes[0], beside=scenes[1])
    if not view.question:
        return replace(scene, caption=study.words.trial_caption)
    page = _question_page(study, view)
    return replace(scene, page=replace(page, over_scene=bool(scenes)), strip=page.strip)


def _seen_scene(study: Study, seen: Seen, levels: Mapping[str, Level]) -> Scene:
    """One walk, or one crowd, as the study wants it seen in a trial with these levels."""
    if seen.walk.crowd is None:
        return staged(study, (_walker(seen),), levels)
    return replace(staged(study, (), levels), crowd=crowd_of(seen.walk.crowd, seen.time))


def crowd_of(crowd: CrowdOf, seconds: float = 0.0) -> Crowd:
    """A trial's crowd as a scene holds it, so many s after it began to walk."""
    return Crowd(crowd.size, crowd.variation, crowd.seed, crowd.pool, crowd.palette, seconds)


def _walker(seen: Seen) -> Walker:
    walk, making = seen.walk, making_of(seen.walk)
    frequency = walk.step_frequency
    if frequency is None:
        frequency = own_step_frequency(walk.actor, walk.body, making, walk.speed)
    strides = seen.time * frequency / 120.0 if seen.strides is None else seen.strides
    return Walker(
        actor=walk.actor,
        body=walk.body,
        speed=walk.speed,
        step_frequency=frequency,
        phase=strides % 1.0,
        distance=seen.distance,
        making=making,
    )


@cache
def making_of(walk: Walk) -> Making | None:
    """The way a walk is made as the stimuli know it; None for the actor's own, at any step frequency."""
    return None if walk.making == OWN_WAY else Making(**asdict(walk.making))


def _question_page(study: Study, view: View) -> Page:
    """The question, with the scale that answers it unless keys do, and a sentence when the answer is missing."""
    if view.scale is None:
        return Page((Line(view.question),), strip=QUESTION_STRIP)
    button = Box(CONFIRM, study.words.next, "button")
    missing = study.words.missing if view.unanswered else ""
    return Page((), (Row(view.question, (button,), missing, _slider(view.scale)),), strip=SCALE_STRIP)


def _slider(scale: Scale) -> Slider:
    return Slider(
        ON_SCALE.removesuffix(":"), scale.minimum, scale.maximum, scale.step, scale.low, scale.high, scale.mark
    )  # fmt: skip


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
        "experimenter": (words.pause_title, words.experimenter_pause_text),
        "stop": (words.stop_title, words.stop_text),
    }[overlay.why]
    lines = (Line(title, "title"), *paragraphs(text))
    hint = words.choose_hint if overlay.form.buttons else ""
    return Page(lines, _rows(overlay.form), hint=hint, over_scene=session.trial is not None)

"""`gaitlab check`: everything that can be wrong with a study before a participant sits down, and what it will be."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterator, Sequence

from experiment_app.checking.balance import balance, order_in_words
from experiment_app.checking.coverage import coverage_mistakes
from experiment_app.checking.slides import sliding_bodies
from protocols.mistakes.consistency import inconsistencies, referred_factors, settings_of
from protocols.mistakes.mistake import Mistake, Place
from protocols.mistakes.placeholders import unknown_placeholders
from protocols.mistakes.views import shown_views
from protocols.orders.design import conditions, make_trials, tracks
from protocols.orders.order import AdaptiveOrder
from protocols.resuming import in_words
from protocols.setting import leaves
from protocols.study import Study, Words
from protocols.study_file import StudyFile, read_study

SMALLEST_TEXT = 20
"""Pixels of a 1080p screen below which a page is too long: on 24 inches this is 5.5 mm with its leading."""

READING_SPEED = 200.0
"""Words read per minute on a screen, a cautious figure for the expected duration."""


def checked_study(study: str) -> StudyFile:
    """The study of a file or shipped name; raises StudyFileError with every mistake at once, also in names."""
    file = read_study(study)
    refuse_mistakes(file, [*_no_folder(file.study), *inconsistencies(file.study), *check_names(file)])
    refuse_mistakes(file, list(coverage_mistakes(file.study)))
    return file


def refuse_mistakes(file: StudyFile, mistakes: Sequence[Mistake]) -> None:
    """Raises StudyFileError when there are mistakes."""
    if mistakes:
        raise file.error(mistakes)


def _no_folder(study: Study) -> Iterator[Mistake]:
    """A name that the folder of the data cannot have."""
    from stimuli.file_names import why_no_file

    if why := why_no_file(study.study):
        yield Mistake(("study",), why)


def check_names(file: StudyFile) -> list[Mistake]:
    """Actors, bodies and styles that do not exist."""
    from stimuli.actors import actor_names
    from stimuli.bodies.known import body_names
    from stimuli.methods.styles import style_names

    known = {"actor": actor_names(), "body": body_names(), "style": style_names()}
    mistakes: dict[Place, Mistake] = {}
    for setting, place, _ in settings_of(file.study):
        what = str(place[-1])
        for mistake in _names(file.study, setting, place, what, known[what]) if what in known else ():
            mistakes.setdefault(mistake.where, mistake)
    return list(mistakes.values())


def _names(study: Study, setting: object, place: Place, what: str, known: Sequence[str]) -> Iterator[Mistake]:
    """Mistakes in the names that a setting gives, by itself, by a factor's levels and in training trials."""
    from difflib import get_close_matches

    named = list(leaves(setting, place, study.factors))
    if isinstance(setting, str) and setting.startswith("$"):
        factor = setting[1:]
        if factor in study.participants.assigned:
            levels = study.participants.between.get(factor, [])
            named = [(level, ("participants", "between", factor, i)) for i, level in enumerate(levels)]
        named += [
            (trial.levels[factor], ("practice", i, factor))
            for i, trial in enumerate(study.practice)
            if factor in trial.levels
        ]
    for name, where in named:
        if name not in known:
            same = [k for k in known if k.lower() == str(name).lower()]
            near = same or get_close_matches(str(name), known, n=1, cutoff=0.5)
            way = f"did you mean {near[0]}?" if near else f"there are: {', '.join(known)}{_kept_in(what)}"
            yield Mistake(where, f"there is no {what} {name}; {way}")


def _kept_in(what: str) -> str:
    """Where what was imported is kept, for a name that another computer may know."""
    from stimuli.user_folder import user_folder

    folder = user_folder("bodies" if what == "body" else "actors")
    place = folder / "styles" if what == "style" else folder
    return f"; one that was imported on another computer: copy its file from there to {place}"


def expected_minutes(study: Study) -> float:
    """How long a session takes, in minutes: reading every page, questions, trials, intervals and breaks."""
    words = sum(len(page.text.split()) for page in study.pages.in_order)
    trials = len(make_trials(study, seed=1))
    breaks = ((trials - 1) // study.breaks.every) * 60.0 if study.breaks else 0.0  # none follows the last trial
    answering = (trials + len(study.practice)) * (study.task.seconds(study.stimulus) + study.interval)
    return words / READING_SPEED + (len(study.participants.questions) * 8.0 + answering + breaks) / 60.0


def summary(file: StudyFile) -> list[str]:
    """What `gaitlab check` prints about a study without mistakes, with a picture of the design's balance in text."""
    study = file.study
    cells, trials = len(conditions(study)), len(make_trials(study, seed=1))
    levels = " x ".join(str(len(v)) for v in study.factors.values())
    lines = [
        f"{file.name}: {study.title}",
        f"  no mistakes; SHA-256 {file.hash[:16]}",
        f"  {levels} levels = {cells} conditions, {_counted(study, trials)}, "
        f"after {len(study.practice)} training trials",
        f"  {order_in_words(study)}",
        f"  {_most(study)}about {math.ceil(expected_minutes(study))} minutes; "
        f"{study.participants.planned} participants planned",
        f"  an interrupted run {in_words(study.resume)}",
        "",
        "Balance (one dot = one trial of participant 1, left to right in the order shown)",
    ]
    return [*lines, *_strip(study), "", *balance(study)]


def _counted(study: Study, trials: int) -> str:
    """How many trials there are, and why."""
    if study.order.placed_factor:
        most = _most(study)
        return f"{len(tracks(study))} tracks of {most}{study.repetitions} trials = {most}{trials} trials"
    return f"{_times(study.repetitions)} each = {trials} trials"


def _most(study: Study) -> str:
    """What stands before a number that tracks which end by their reversals need not reach."""
    return "at most " if isinstance(study.order, AdaptiveOrder) and study.order.stops_after is not None else ""


def notes_on(file: StudyFile) -> list[str]:
    """Sentences about what would not be shown as it should be; empty when all is well."""
    from experiment_app.render.fonts import can_shape, missing_glyphs, needs_shaping

    study = file.study
    texts = "".join(sorted(set("".join(_texts(study.model_dump())))))
    notes = [
        *_unused_factors(study),
        *_unknown_braces(file),
        *_wrong_arrows(study),
        *_small_pages(study),
        *_untrue_perspective(study),
        *sliding_bodies(study),
    ]
    if not study.language.startswith("en") and study.words == Words():
        notes.append(f"language is {study.language}, but the buttons and hints are English; translate them in words.")
    missing = sorted(missing_glyphs(texts))
    if missing:
        signs = " ".join(missing[:20])
        notes.append(f"no font on this computer has: {signs}; install one that does (on Debian, fonts-noto).")
    if needs_shaping(texts) and not can_shape():
        notes.append("a script in the texts needs FriBiDi to be shown right; install it (on Debian, libfribidi0).")
    return notes


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"


def _unused_factors(study: Study) -> Iterator[str]:
    for factor in study.factors:
        if factor not in referred_factors(study):
            yield f"factor {factor} changes nothing that is shown; refer to it as ${factor} in stimulus or task."


def _unknown_braces(file: StudyFile) -> Iterator[str]:
    """Names in braces that stand for nothing, with the line they stand in."""
    for mistake in file.error(unknown_placeholders(file.study)).mistakes:
        written = mistake.message.partition(" ")[0]
        lines = file.text.split("\n")
        places = (n for n, line in enumerate(lines, start=1) if n >= mistake.line and written in line)
        yield f"line {next(places, mistake.line)}: {mistake.message}."


def _wrong_arrows(study: Study) -> Iterator[str]:
    keys = study.task.keys_for(1)
    named = " and ".join(f"{{{name}}}" for name in keys if name != "break")
    for sign, key in (("←", "left"), ("→", "right")):
        if sign in study.pages.told and key not in keys.values():
            yield f"the instructions name {sign}, which is no key of the task; write {named} instead."


def _untrue_perspective(study: Study) -> Iterator[str]:
    fills = study.display.angle if study.display is not None else None
    for given in dict.fromkeys(camera.field_of_view for _, camera, _ in shown_views(study)):
        if fills is not None and given is not None and abs(given - fills) > 1.0:
            yield (
                f"the camera sees {given:g} degrees but the screen fills {fills:.1f} for the viewer, so the "
                "perspective is not true; leave field_of_view out to make it so."
            )


def _small_pages(study: Study) -> Iterator[str]:
    """Pages so long that their text would be hard to read on a 1080p screen."""
    from experiment_app.render.layout import layout_page
    from experiment_app.scene import Line, Page
    from experiment_app.staging import paragraphs

    for page in study.pages.in_order:
        lines = (Line(page.title, "title"), *paragraphs(page.text))
        placed = layout_page(Page(lines, hint=study.words.page_hint), 1920, 1080, 1.0)
        smallest = min(text.size for text in placed.texts if text.role == "text")
        if smallest < SMALLEST_TEXT:
            yield f"the page {page.title!r} is so long that its text gets very small; part it into two pages."


def _texts(part: object) -> Iterator[str]:
    """Every text in a part of a study, whatever it is for."""
    if isinstance(part, str):
        yield part
    elif isinstance(part, dict):
        for value in part.values():
            yield from _texts(value)
    elif isinstance(part, (list, tuple)):
        for value in part:
            yield from _texts(value)


def _strip(study: Study) -> list[str]:
    """For every level of every factor: in which of 48 equal parts of the session its trials fall."""
    trials = make_trials(study, seed=1)
    bins = min(48, len(trials))
    lines = []
    name = max(10, *map(len, study.factors))
    wide = max(8, *(len(str(level)) for levels in study.factors.values() for level in levels))
    placed = study.order.placed_factor
    for factor, levels in study.factors.items():
        for level in levels if factor != placed else ():
            at = Counter((t.number - 1) * bins // len(trials) for t in trials if t.levels[factor] == level)
            marks = "".join(" .:*#"[min(at[b], 4)] for b in range(bins))
            lines.append(f"  {factor:>{name}} {level!s:<{wide}}|{marks}| {sum(at.values())} trials")
    return lines


def schema_text() -> str:
    """The JSON Schema of study files."""
    schema = Study.model_json_schema(by_alias=True)
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema"
    schema["title"] = "gaitlab study"
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"

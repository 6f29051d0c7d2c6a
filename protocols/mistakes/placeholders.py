"""Names in braces, as {confirm}, that a participant's texts have filled in, and those that stand for nothing.

Nothing needs escaping: braces around anything but a name known there are shown as they are written, so a name that is
misspelt is shown, too.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator, Sequence

from protocols.mistakes.mistake import Mistake, Place
from protocols.study import Study, TextPage

FILLED = {("breaks", "text"): ("done", "total"), ("words", "welcome_back_text"): ("next", "total"),
          ("words", "not_a_number"): ("minimum", "maximum")}  # fmt: skip
"""Place of a text to the names it has filled in, beside the texts that have the task's keys."""

BRACES = re.compile(r"\{[^{}\n]*\}|\{\w+")
"""Something in braces, or a name whose closing brace is missing."""


def unknown_placeholders(study: Study) -> Iterator[Mistake]:
    """Every name in braces that stands for nothing where it is, each once a text, with those that would."""
    for where, text, known in _texts(study):
        for written in dict.fromkeys(BRACES.findall(text)):
            name = written.strip("{} ")
            if written != f"{{{name}}}" or name not in known:
                yield Mistake(where, f"{written} {_way_out(name, known)}")


def _way_out(name: str, known: Sequence[str]) -> str:
    shown = "is shown to participants as it is written"
    if not known:
        return f"{shown}; in this text nothing in braces is filled in"
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.6)
    meant = f"did you mean {{{near[0]}}}? This" if near else "this"
    listed = ", ".join(f"{{{one}}}" for one in known)
    return f"{shown}; {meant} text has {listed} filled in, and leaves other braces as they are"


def _texts(study: Study) -> Iterator[tuple[Place, str, Sequence[str]]]:
    """Every text that participants read: its place, itself, and the names it has filled in."""
    keys = list(study.task.keys_for(1))
    if study.task.asked:
        yield ("task", "question"), study.task.asked, keys
    pages = study.pages
    told = [(("pages", "instructions", i), page) for i, page in enumerate(pages.instructions)]
    for name in ("consent", "declined", "before_practice", "before_trials", "debrief"):
        yield from _page(("pages", name), getattr(pages, name), keys if name.startswith("before") else ())
    for place, page in told:
        yield from _page(place, page, keys)
    for i, question in enumerate(study.participants.questions):
        where: Place = ("participants", "questions", i)
        yield (*where, "prompt"), question.prompt, ()
        for value, label in getattr(question, "options", {}).items():
            yield (*where, "options", value), label, ()
    for part in ("breaks", "words"):
        for field, text in getattr(study, part) or ():
            if isinstance(text, str):
                yield (part, field), text, FILLED.get((part, field), ())


def _page(where: Place, page: TextPage | None, known: Sequence[str]) -> Iterator[tuple[Place, str, Sequence[str]]]:
    if page is not None:
        yield (*where, "title"), page.title, known
        yield (*where, "text"), page.text, known

"""A page to read or fill in as a value: choices, typed entries, buttons, keyboard focus and what is still missing.

Knows no layout and no window; a click arrives as the name of the box that was hit.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from protocols.events import Clicked, Event, KeyDown, Typed

JOINERS = "\u200c\u200d"
"""Zero-width non-joiner and joiner: invisible, but part of the spelling in Persian and Indic scripts."""


@dataclass(frozen=True)
class Choice:
    """A question with options: (value, label) pairs."""

    id: str
    prompt: str
    options: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Entry:
    """A typed answer; with digits, a whole number from minimum to maximum."""

    id: str
    prompt: str
    digits: bool = False
    minimum: int = 0
    maximum: int = 0
    required: bool = True
    max_length: int = 200


@dataclass(frozen=True)
class Form:
    """Fields, then buttons; focus counts through both, -1 is nothing.

    values:  what has been typed or chosen so far, by field id.
    errors:  what to tell beside a field, by field id.
    pressed: id of the button that ended the form, "" while it is open.
    """

    fields: tuple[Choice | Entry, ...] = ()
    buttons: tuple[tuple[str, str], ...] = ()
    submit: str = ""
    missing: str = "Please answer this question."
    not_a_number: str = "Please type a whole number from {minimum} to {maximum}."
    focus: int = -1
    values: Mapping[str, str] = field(default_factory=dict)
    errors: Mapping[str, str] = field(default_factory=dict)
    pressed: str = ""

    @property
    def focused_field(self) -> Choice | Entry | None:
        """The field that has the keyboard, or None when a button or nothing has."""
        return self.fields[self.focus] if 0 <= self.focus < len(self.fields) else None


def handle_form(form: Form, event: Event) -> Form:
    """The form once `event` has happened; events after a button was pressed change nothing."""
    if form.pressed:
        return form
    if isinstance(event, Typed):
        return _typed(form, event.text)
    if isinstance(event, Clicked):
        return _clicked(form, event.target)
    if isinstance(event, KeyDown):
        return _key(form, event.key)
    return form


def _with_value(form: Form, name: str, value: str) -> Form:
    errors = {k: v for k, v in form.errors.items() if k != name}
    return replace(form, values={**form.values, name: value}, errors=errors)


def _typed(form: Form, text: str) -> Form:
    entry = form.focused_field
    if not isinstance(entry, Entry):
        return form
    kept = "".join(c for c in text if unicodedata.category(c)[0] != "C" or c in JOINERS)
    if entry.digits:
        kept = "".join(str(unicodedata.digit(c)) for c in kept if unicodedata.digit(c, None) is not None)
    value = (form.values.get(entry.id, "") + kept)[: 9 if entry.digits else entry.max_length]
    return _with_value(form, entry.id, value)


def _clicked(form: Form, target: str) -> Form:
    for i, item in enumerate(form.fields):
        if target == item.id:
            return replace(form, focus=i)
        if isinstance(item, Choice) and target in {f"{item.id}:{value}" for value, _ in item.options}:
            return replace(_with_value(form, item.id, target.removeprefix(f"{item.id}:")), focus=i)
    if target in {name for name, _ in form.buttons}:
        return _press(form, target)
    return form


def _key(form: Form, key: str) -> Form:
    stops = len(form.fields) + len(form.buttons)
    on = form.focused_field
    if key in ("tab", "down") and stops:
        return replace(_judged(form, on), focus=(form.focus + 1) % stops)
    if key in ("up", "backtab") and stops:
        return replace(_judged(form, on), focus=(max(form.focus, 0) - 1) % stops)
    if key == "backspace" and isinstance(on, Entry):
        return _with_value(form, on.id, form.values.get(on.id, "")[:-1])
    if key in ("left", "right"):
        step = 1 if key == "right" else -1
        if isinstance(on, Choice):
            return _with_value(form, on.id, _neighbour(on, form.values.get(on.id), step))
        if on is None and len(form.buttons) > 1:
            button = form.focus - len(form.fields) + step if form.focus >= 0 else 0
            return replace(form, focus=len(form.fields) + button % len(form.buttons))
    if key == "enter" or (key == "space" and not isinstance(on, Entry) and form.focus >= 0):
        return _enter(form, key)
    return form


def _neighbour(choice: Choice, value: str | None, step: int) -> str:
    """The option beside the chosen one, staying at the ends; the first press chooses an end."""
    options = [option for option, _ in choice.options]
    if value not in options:
        return options[0] if step > 0 else options[-1]
    return options[min(max(options.index(value) + step, 0), len(options) - 1)]


def _enter(form: Form, key: str) -> Form:
    on = form.focused_field
    if isinstance(on, Choice) and key == "space":
        return _with_value(form, on.id, _neighbour(on, form.values.get(on.id), 1))
    if on is not None:
        return replace(_judged(form, on), focus=form.focus + 1)
    if form.focus >= len(form.fields):
        return _press(form, form.buttons[form.focus - len(form.fields)][0])
    if not form.fields and len(form.buttons) <= 1:
        return _press(form, form.buttons[0][0] if form.buttons else "next")
    return form


def _judged(form: Form, left: Choice | Entry | None) -> Form:
    """The form with what is wrong about a field that is being left; an empty field may still be filled."""
    problem = _problem(form, left) if left is not None and form.values.get(left.id, "").strip() else ""
    return replace(form, errors={**form.errors, left.id: problem}) if left is not None and problem else form


def _press(form: Form, button: str) -> Form:
    if button != form.submit:
        return replace(form, pressed=button)
    errors = {item.id: problem for item in form.fields if (problem := _problem(form, item))}
    if errors:
        first = next(i for i, item in enumerate(form.fields) if item.id in errors)
        return replace(form, errors=errors, focus=first)
    return replace(form, errors={}, pressed=button)


def _problem(form: Form, item: Choice | Entry) -> str:
    value = form.values.get(item.id, "").strip()
    if not value:
        return form.missing if isinstance(item, Choice) or item.required else ""
    if isinstance(item, Entry) and item.digits and not item.minimum <= int(value) <= item.maximum:
        limits = {"{minimum}": str(item.minimum), "{maximum}": str(item.maximum)}
        return _filled(form.not_a_number, limits)
    return ""


def _filled(text: str, values: Mapping[str, str]) -> str:
    for name, value in values.items():
        text = text.replace(name, value)
    return text

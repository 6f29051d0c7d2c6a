"""Reads a study file: YAML 1.2 to a Study, or every mistake at once with its line and column.

Knows YAML and the study's types; it knows no actor, body or window, so names of those are checked elsewhere.
"""

from __future__ import annotations

import difflib
import hashlib
import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from importlib.resources import files
from io import StringIO
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError

from protocols.mistakes.mistake import Mistake, Place
from protocols.mistakes.wrong_types import shortened, wrong_type
from protocols.setting import CONSTANT, FACTOR, LIMITS, TABLE, SettingsPart
from protocols.study import Study

MISSING = "this key is missing"

MOST_VALUES = 100_000
"""Values a study file may hold once its aliases are written out; the longest studies have some thousands."""


class StudyFileError(ValueError):
    """A study file that cannot be used; str() gives one line per mistake, `file:line:column: where: message`."""

    def __init__(self, name: str, mistakes: Sequence[Mistake]) -> None:
        self.name = name
        self.mistakes = tuple(sorted(mistakes, key=lambda m: (m.line, m.column)))
        super().__init__("\n".join(_sentence(name, m) for m in self.mistakes))


@dataclass(frozen=True)
class StudyFile:
    """A study with the text it was read from.

    hash: SHA-256 of the text, hexadecimal; document: the YAML tree, kept for the positions of later mistakes.
    """

    name: str
    text: str
    study: Study
    document: Any

    @property
    def hash(self) -> str:
        """SHA-256 of the file's UTF-8 text, as hexadecimal."""
        return hashlib.sha256(self.text.encode("utf-8")).hexdigest()

    def error(self, mistakes: Iterable[Mistake]) -> StudyFileError:
        """The mistakes, found by a later check, as an error with positions in this file."""
        return StudyFileError(self.name, [_placed(self.document, m) for m in mistakes])


def shipped_studies() -> tuple[str, ...]:
    """Names of the studies that come with gaitlab, in alphabetical order."""
    folder = files("protocols") / "studies"
    return tuple(sorted(p.name.removesuffix(".yaml") for p in folder.iterdir() if p.name.endswith(".yaml")))


def find_study(study: str) -> tuple[str, bytes]:
    """The display name and the bytes of a study file: a path, or the name of a shipped study.

    Raises FileNotFoundError with a sentence when neither exists.
    """
    path = Path(study)
    if path.is_file():
        return str(path), path.read_bytes()
    if study in shipped_studies():
        return f"{study}.yaml", (files("protocols") / "studies" / f"{study}.yaml").read_bytes()
    if path.is_dir():
        raise FileNotFoundError(f"{study} is a folder; name a study file in it, as {path / 'my_study.yaml'}.")
    beside = {p.stem: str(p) for p in path.parent.glob("*.y*ml")} if path.parent.is_dir() else {}
    known = {**{name: name for name in shipped_studies()}, **beside}  # compared without .yaml, which all have
    near = difflib.get_close_matches(path.name if path.name in known else path.stem, known, n=1)
    hint = f" Did you mean {known[near[0]]}?" if near else ""
    raise FileNotFoundError(
        f"{study}: there is no such file and no shipped study of that name "
        f"(shipped: {', '.join(shipped_studies())}).{hint}"
    )


def read_study(study: str) -> StudyFile:
    """The study of a file or of a shipped name; raises FileNotFoundError or StudyFileError."""
    name, raw = find_study(study)
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        column = error.start - (raw.rfind(b"\n", 0, error.start) + 1) + 1
        message = f"byte 0x{raw[error.start]:02x} is not UTF-8; save the file with the encoding UTF-8"
        raise StudyFileError(name, [Mistake((), message, line=line, column=column)]) from None
    return parse_study(name, text)


def parse_study(name: str, text: str) -> StudyFile:
    """The study of a text; `name` is used in messages only. Raises StudyFileError."""
    document = _load_yaml(name, text)
    if not isinstance(document, dict):
        found = "empty" if document is None else "a list" if isinstance(document, list) else "one value without keys"
        message = f"the file is {found}; a study file holds keys such as study, participants, factors, task"
        raise StudyFileError(name, [Mistake((), message)])
    try:
        plain = _plain(document, itertools.count(1))
    except (OverflowError, RecursionError):
        message = f"aliases (*) make the file larger than {MOST_VALUES} values, or endless; write out what is meant"
        raise StudyFileError(name, [Mistake((), message)]) from None
    try:
        study = Study.model_validate(plain)
    except ValidationError as error:
        mistakes = _without_echoes([_explain(e, document) for e in error.errors(include_url=False)])
        raise StudyFileError(name, [_placed(document, m) for m in mistakes]) from None
    return StudyFile(name, text, study, document)


def _load_yaml(name: str, text: str) -> Any:
    from ruamel.yaml import YAML
    from ruamel.yaml.error import MarkedYAMLError, YAMLError

    try:
        return YAML(typ="rt").load(StringIO(text))
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
        problem = _yaml_problem(error)
        raise StudyFileError(name, [Mistake((), problem, line=line, column=column)]) from None
    except (YAMLError, ValueError, TypeError, RecursionError) as error:  # TypeError: a mapping as a key
        reason = str(error).split("\n")[0] or type(error).__name__
        raise StudyFileError(name, [Mistake((), f"not valid YAML: {reason}")]) from None


def _yaml_problem(error: Any) -> str:
    """What is wrong with the YAML, in the words of somebody who types it; error: ruamel's MarkedYAMLError."""
    problem = (error.problem or "not valid YAML").split("\n")[0]
    opened = f"at {error.context_mark.line + 1}:{error.context_mark.column + 1}" if error.context_mark else "above"
    if "\\t" in problem:
        return "a tab cannot indent or begin a value in YAML; use spaces"
    if problem.startswith("found duplicate key"):
        return problem.split(" with value")[0] + "; keep one of the two"
    if problem.startswith("mapping values are not allowed"):
        return 'a text with a colon in it needs quotes, as "Sex: which?"; or a quote in a line above is not closed'
    if problem.startswith("could not find expected ':'"):
        return "a colon and a space are missing here or in the line above, as in rate: 10"
    if problem.startswith(("expected ',' or", "did not find expected ',' or")):
        return f"the bracket opened {opened} is not closed before this"
    if problem.startswith("found undefined alias"):
        return 'a text that begins with * needs quotes, as "*"'
    if problem.startswith("found character") and "cannot start" in problem:
        return f"a text that begins with {problem.split(chr(39))[1]} needs quotes"
    if problem.startswith("but found another document"):
        return "--- begins a second study here; a file holds one"
    if "end of stream" in problem and "quoted" in (error.context or ""):
        return f"the quote opened {opened} is not closed"
    if problem.startswith("expected <block end>"):
        return "this line is indented differently from its neighbours, or a quote ends too early in it"
    return problem


def _plain(node: Any, count: Iterator[int]) -> Any:
    """The YAML tree as plain dict, list and scalars: ruamel's scalar subclasses would fail strict numbers.

    count: of values so far. Raises OverflowError beyond MOST_VALUES: a few lines of aliases can mean billions.
    """
    if next(count) > MOST_VALUES:
        raise OverflowError
    if isinstance(node, dict):
        return {_plain(key, count): _plain(value, count) for key, value in node.items()}
    if isinstance(node, list):
        return [_plain(value, count) for value in node]
    for kind in (bool, int, float, str):
        if isinstance(node, kind):
            return kind(node)
    return node


def _explain(error: Any, document: Any) -> Mistake:
    """One of pydantic's errors in the words of an experimenter."""
    where = _place(document, error["loc"])
    kind, limits = error["type"], error.get("ctx") or {}
    value = limits.get("tag", error["input"])
    shown = shortened(value)
    if wrong := wrong_type(kind, value):
        return Mistake(where, wrong)
    if kind == "extra_forbidden":
        allowed = _allowed_keys(document, where[:-1])
        near = difflib.get_close_matches(str(where[-1]), allowed, n=1, cutoff=0.6)
        way = f"did you mean {near[0]}?" if near else f"allowed here: {', '.join(allowed)}"
        if value is None and " " in str(where[-1]):
            way = "between { and } a text with a comma stands in quotes"
        elif str(where[-1]).startswith("$") and _has_settings(document, where[:-1]):
            way = f"a table belongs to a single key, as {allowed[0]}: {{{where[-1]}: ...}}; {way}"
        elif str(where[-1]).startswith("$"):
            way = f"what stands here is the same in all trials, no table by a factor; {way}"
        return Mistake(where, f"unknown key; {way}", on_key=True)
    if kind == "union_tag_not_found":
        return Mistake(where, "the key kind is missing; it says which of several parts this is")
    if kind == "missing":
        return Mistake(where, MISSING, on_key=True)
    if kind in ("greater_than_equal", "greater_than", "less_than_equal", "less_than"):
        limit = " and ".join(f"{LIMITS[k]} {v:g}" for k, v in limits.items() if k in LIMITS)
        return Mistake(where, f"{shown} is out of range; it must be {limit}")
    if kind in ("literal_error", "union_tag_invalid"):
        expected = str(limits.get("expected") or limits.get("expected_tags")).replace("'", "")
        words = [w.strip() for w in expected.replace(" or ", ",").split(",")]
        near = difflib.get_close_matches(str(value).lower(), words)
        hint = f"; did you mean {near[0]}?" if near else ""
        if not isinstance(value, str) and str(value) in words:
            return Mistake(where, f'{shown} needs quotes here, as "{value}"')
        if isinstance(value, str) and value.startswith("$"):
            hint = "; it is the same in all trials, no factor's level"
        if len(expected) > 160:
            expected = "the names of keys, as left, right, enter, space, a, 1"
        return Mistake(where, f"{shown} is not allowed; allowed: {expected}{hint}")
    if kind == "string_pattern_mismatch" and where[-1:] == ("variation",):
        return Mistake(where, f"{shown} does not fit; write 1:1 to 1:1000 (walkers per motion), or 1")
    if kind == "string_pattern_mismatch" and where == ("language",):
        return Mistake(where, f"{shown} is no language; write its code, as en, de or pt-BR")
    if kind == "string_pattern_mismatch" and shown[1:2] == "$":
        return Mistake(where, f"{shown} does not fit; write the factor's name after the $, as $speed")
    if kind == "string_too_short":
        return Mistake(where, "there is nothing between the quotes; write a text")
    if kind == "invalid_key":
        return Mistake(
            where, "a key is a name in letters, as speed; quotes make one of a number or of yes and no", True
        )
    if kind == "string_pattern_mismatch":
        return Mistake(where, f"{shown} does not fit; letters, digits and _ only, starting with a letter")
    if kind in ("too_short", "too_long"):
        return Mistake(where, f"needs {error['msg'].split('should have ')[-1].replace(' after validation', '')}")
    said = error["msg"].removeprefix("Value error, ")
    message = said[0].lower() + said[1:]
    return Mistake(where, f"{shown}: {message.replace('input should be', 'must be')}")


def _without_echoes(mistakes: Sequence[Mistake]) -> list[Mistake]:
    """The mistakes without "missing" where a misspelt key was found for it: one typo, one sentence."""
    mistakes = _one_of_each_union(mistakes)
    meant = {(m.where[:-1], m.message.partition("did you mean ")[2].rstrip("?")) for m in mistakes if m.on_key}
    return [m for m in mistakes if m.message != MISSING or (m.where[:-1], m.where[-1]) not in meant]


def _one_of_each_union(mistakes: Sequence[Mistake]) -> list[Mistake]:
    """The mistakes with one where a value fits no type of several: "must be text, or a number"."""
    kept: dict[Place, Mistake] = {}
    others = []
    for mistake in mistakes:
        value, must, wanted = mistake.message.partition(" must be ")
        first = kept.get(mistake.where)
        if not must or mistake.on_key:
            others.append(mistake)
        elif first is None:
            kept[mistake.where] = mistake
        elif wanted not in first.message and first.message.startswith(value):
            kept[mistake.where] = replace(first, message=f"{first.message}, or {wanted}")
    return [*kept.values(), *others]


TYPE_TAGS = {"str", "float", "int", "[key]", FACTOR, TABLE, CONSTANT}


def _place(document: Any, location: Iterable[str | int]) -> Place:
    """Pydantic's location without the branches of unions, which are no keys of the file."""
    where: list[str | int] = []
    node = document
    for part in location:
        if isinstance(node, dict) and "kind" in node and node["kind"] == part:
            continue
        if isinstance(part, str) and (part in TYPE_TAGS or part.startswith(("constrained-", "function-", "dict["))):
            continue
        where.append(part)
        node = _at(node, part)
    return tuple(where)


def _at(node: Any, part: str | int) -> Any:
    try:
        return node[part]
    except (KeyError, IndexError, TypeError):
        return None


def _allowed_keys(document: Any, where: Place) -> list[str]:
    """Keys that may stand at a place of the study file; where its kind of part is not known, those of all."""
    models = _models_at(document, where)
    return list(dict.fromkeys(f.alias or n for model in models for n, f in model.model_fields.items()))


def _has_settings(document: Any, where: Place) -> bool:
    """Whether values of the part at a place of the study file can be tables by a factor."""
    return any(issubclass(model, SettingsPart) and model.takes() for model in _models_at(document, where))


def _models_at(document: Any, where: Place) -> list[type[BaseModel]]:
    """The study parts that may stand at a place of the study file."""
    annotation, node = Study, document
    for part in where:
        annotation, node = _inside(annotation, part, node), _at(node, part)
    return _models(annotation, node)


def _inside(annotation: Any, part: str | int, node: Any) -> Any:
    """The type of what stands under a key or at a position of a value of a type; None where nothing is known."""
    for model in _models(annotation, node):
        for name, field in model.model_fields.items():
            if part in (name, field.alias):
                return field.annotation
    for choice in _choices(annotation):
        if get_origin(choice) in (dict, list):
            return get_args(choice)[-1]
    return None


def _models(annotation: Any, node: Any) -> list[type[BaseModel]]:
    """The study parts that a type stands for; of several, the one of the node's kind."""
    models = [choice for choice in _choices(annotation) if isinstance(choice, type) and issubclass(choice, BaseModel)]
    kind = _at(node, "kind") if isinstance(node, dict) else None
    return [
        m for m in models if "kind" in m.model_fields and kind in get_args(m.model_fields["kind"].annotation)
    ] or models


def _choices(annotation: Any) -> list[Any]:
    """The types of a union, Annotated unwrapped; the type itself where it is none."""
    if get_origin(annotation) is Annotated:
        return _choices(get_args(annotation)[0])
    if get_origin(annotation) in (Union, UnionType):
        return [choice for argument in get_args(annotation) for choice in _choices(argument)]
    return [annotation]


def _placed(document: Any, mistake: Mistake) -> Mistake:
    """The mistake with the line and column of its place in the file (both from 1)."""
    if not mistake.where:
        return mistake
    node, line, column = document, 0, 0
    for depth, part in enumerate(mistake.where):
        last = depth == len(mistake.where) - 1
        try:
            if isinstance(node, list):
                line, column = node.lc.item(part)  # type: ignore[attr-defined]
            elif last and mistake.on_key:
                line, column = node.lc.key(part)
            else:
                line, column = node.lc.value(part)
            node = node[part]
        except (AttributeError, KeyError, IndexError, TypeError):
            break
    return Mistake(mistake.where, mistake.message, mistake.on_key, line + 1, column + 1)


def _sentence(name: str, mistake: Mistake) -> str:
    where = "".join(f"[{p}]" if isinstance(p, int) else f".{p}" for p in mistake.where).lstrip(".")
    return f"{name}:{mistake.line}:{mistake.column}: {where + ': ' if where else ''}{mistake.message}"

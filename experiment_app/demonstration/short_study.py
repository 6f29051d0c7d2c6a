"""A study short enough for a demo: few levels, every condition once, no breaks. Knows no window."""

from __future__ import annotations

import re
from collections.abc import Iterator
from io import StringIO
from typing import Any

from protocols.study_file import StudyFile, parse_study, read_study

LONGEST = 4.0
"""s that walks are shown where the study sets a limit."""

TOO_LONG = ("order", "regression")
"""Figures that need more: the course of a session 24 trials, a regression three levels."""

SHORT_PAGES: dict[str, Any] = {
    "instructions": [
        {
            "title": "Your task",
            "text": "Hold {lower} for fewer, longer steps and {raise} for more, shorter steps. When the walk looks "
            "most natural to you, press {confirm}.\n\nPress Escape to pause or to stop.",
        }
    ],
    "before_practice": {"title": "One trial to practise", "text": "Then eight trials follow."},
}
"""What the short version says instead, so that it is true of it."""


SAID_INSTEAD = (
    (r"It takes about [^.]*\.", "This is a short version of it, which takes about {minutes}."),
    (r"The data may be published[^.]*\.", "In this demonstration they stay on this computer."),
    (r"(walk|can be seen) for \w+ seconds", r"\1 for {seconds} seconds"),
    (r"\s*If anything is unclear, please ask the experimenter now\.", ""),
    (r"Please tell the experimenter that you are done\.", "The demonstration goes on in the terminal."),
)
"""Sentences of the shipped studies' pages that are not true of a demonstration, and what is."""

IN_WORDS = ("", "a minute", "two minutes", "three minutes", "four minutes", "five minutes")


def short_study(name: str) -> StudyFile:
    """A study with two levels of every factor, each condition once, after one training trial at most.

    Raises FileNotFoundError or StudyFileError where there is no such study.
    """
    from ruamel.yaml import YAML

    yaml = YAML(typ="rt")
    document = yaml.load(read_study(name).text)
    if document["study"] == "walk_ratio":
        _shorten_walk_ratio(document)
    else:
        _shorten(document)
    for analysis in (document["analysis"], *document["analysis"].get("also", ())):
        analysis["figures"] = [figure for figure in analysis.get("figures", ()) if figure["kind"] not in TOO_LONG]
    document["study"] = f"{document['study']}_demo"
    document["repetitions"] = 1
    document.pop("breaks", None)
    short = _parsed(yaml, document)
    _tell_the_truth(document, short)
    return _parsed(yaml, document)


def _parsed(yaml: Any, document: Any) -> StudyFile:
    text = StringIO()
    yaml.dump(document, text)
    return parse_study(f"{document['study']}.yaml", text.getvalue())


def _tell_the_truth(document: Any, short: StudyFile) -> None:
    """Puts how long the short version takes, and what becomes of its data, into its pages."""
    from experiment_app.checking.check import expected_minutes

    minutes = min(max(round(expected_minutes(short.study)), 1), len(IN_WORDS) - 1)
    values = {"{minutes}": IN_WORDS[minutes], "{seconds}": f"{getattr(short.study.task, 'time_limit', None) or 0:g}"}
    for page in _pages(document["pages"]):
        text = page["text"]
        for pattern, instead in SAID_INSTEAD:
            for mark, value in values.items():
                instead = instead.replace(mark, value)
            text = re.sub(pattern.replace(" ", r"\s+"), instead, text)
        page["text"] = type(page["text"])(text)


def _pages(pages: Any) -> Iterator[Any]:
    for page in pages.values():
        yield from page if isinstance(page, list) else [page]


def _shorten_walk_ratio(document: Any) -> None:
    """Two actors, two speeds, two starts: 8 trials, with words that are true of them."""
    document["factors"]["actor"] = ["F1", "M1"]
    document["factors"]["speed"] = [0.8, 1.2]
    document["practice"] = document["practice"][:1]
    for page in ("before_practice", "instructions"):
        document["pages"][page] = SHORT_PAGES[page]
    for test in document["analysis"]["t_tests"]:
        test["against"] = {actor: test["against"][actor] for actor in ("F1", "M1")}


def _shorten(document: Any) -> None:
    """The first and the last level of every factor, and of groups of levels what is left of them."""
    for factor, levels in document["factors"].items():
        document["factors"][factor] = levels if len(levels) < 3 else [levels[0], levels[-1]]
    document["practice"] = []
    for page in ("before_practice", "before_trials"):
        document["pages"].pop(page, None)
    if document["task"].get("time_limit"):
        document["task"]["time_limit"] = min(document["task"]["time_limit"], LONGEST)
    for analysis in (document["analysis"], *document["analysis"].get("also", ())):
        analysis.pop("regression", None)  # two levels are too few cases
    for groups in (document["analysis"].get("groups") or {}).values():
        left = document["factors"][groups["of"]]
        kept = {name: [level for level in levels if level in left] for name, levels in groups["levels"].items()}
        groups["levels"] = {name: levels for name, levels in kept.items() if levels}

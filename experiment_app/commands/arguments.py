"""Arguments that several commands have in common, and how they are read."""

from __future__ import annotations

from fractions import Fraction
from importlib.resources import files
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from experiment_app.errors import UsageError

SHIPPED = sorted(p.name.removesuffix(".yaml") for p in (files("protocols") / "studies").iterdir() if ".yaml" in p.name)
StudyArgument = Annotated[
    str, Parameter(help=f"A study file (YAML), or the name of a shipped study: {', '.join(SHIPPED)}.")
]


def require_ending(option: str, path: Path | None, what: str, example: str) -> None:
    """Raises UsageError when a file to be written has not the example's ending, so that it never replaces another kind.

    A journal or a study file named by a slip of the keyboard stays as it is.
    """
    ending = Path(example).suffix
    if path is not None and path.suffix.lower() != ending:
        raise UsageError(f"{option} {path}: {what}; let its name end in {ending}, as {example}.")


def picture_size(text: str) -> tuple[int, int]:
    """Width and height from a text such as 1280x720; raises UsageError."""
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal() and 320 <= int(width) <= 16384 and 200 <= int(height) <= 16384):
        raise UsageError(f"--size {text}: write width x height in pixels, at least 320x200, as 1280x720.")
    return int(width), int(height)


def frame_rate(text: str) -> Fraction:
    """Frames per second from a text such as 60, 59.94 or 60000/1001; raises UsageError."""
    try:
        rate = Fraction(text)
    except (ValueError, ZeroDivisionError):
        raise UsageError(f"--rate {text}: write a number, as 60, 59.94 or 60000/1001.") from None
    if not 1 <= rate <= 1000:
        raise UsageError(f"--rate {text}: a film has 1 to 1000 frames per second.")
    return rate

"""What the commands say in a terminal: results, problems apart from them, and a progress bar with the time left."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Protocol, TypeVar

from rich.console import Console

if TYPE_CHECKING:
    from rich.progress import Progress

T = TypeVar("T")

out = Console(highlight=False, emoji=False, soft_wrap=True)
"""Results, on standard output."""

problems = Console(stderr=True, highlight=False, emoji=False, soft_wrap=True)
"""Notes, errors and progress, on standard error."""


class ShowProgress(Protocol):
    """Hands items on and shows how many of `count` there were and how long the others will take; what: a title."""

    def __call__(self, items: Iterable[T], count: int, what: str, /) -> Iterable[T]:
        """The items, as they are."""


def typed(path: object) -> str:
    """A path as it is typed in a command: so that no blank parts it and no shell takes a sign of it, as $, for its own.

    With ./ before a dash, which would make it an option. On Windows in double quotes, which all its shells know.
    """
    text = f"./{path}" if str(path).startswith("-") else str(path)
    if sys.platform != "win32":
        return shlex.quote(text)
    plain = all(sign.isalnum() or sign in "-_./\\:+,@%=~" for sign in text)
    return text if plain else f'"{text}"'


def say(sentence: str) -> None:
    """Prints a sentence as it is: square brackets in it are no markup."""
    out.print(sentence, markup=False)


def progress_bar() -> Progress:
    """A bar with its title, counts and the time left, which vanishes when it is done."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    return Progress(*columns, console=problems, transient=True)


def with_progress(items: Iterable[T], count: int, what: str, /) -> Iterator[T]:
    """The items, with a progress bar while they are being made."""
    with progress_bar() as bar:
        yield from bar.track(items, total=count, description=what)


def unseen(items: Iterable[T], count: int, what: str, /) -> Iterable[T]:
    """The items, without a progress bar."""
    return items

"""Journals for tests: lines put in, left out or changed, and joined again as if they had been written so."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from protocols.record import checksum_of, decode_line, sealed


def rechained(lines: Iterable[str]) -> list[str]:
    """The lines with each naming the one before it, as a run that went that way would have written them."""
    return resealed(map(decode_line, lines))


def resealed(records: Iterable[dict[str, Any]]) -> list[str]:
    """Members of lines, in order, as lines."""
    made: list[str] = []
    for values in records:
        made.append(sealed(values, checksum_of(made[-1]) if made else ""))
    return made


def rewrite(path: Path, change: Callable[[list[dict[str, Any]]], list[dict[str, Any]]]) -> None:
    """A journal with its records changed, otherwise as it was."""
    records = [decode_line(line) for line in path.read_text(encoding="utf-8").splitlines()]
    path.write_text("".join(f"{line}\n" for line in resealed(change(records))), encoding="utf-8")

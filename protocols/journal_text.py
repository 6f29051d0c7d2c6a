"""The text of a whole journal: its lines in the order they were written, and the torn end that a kill leaves.

A line by itself shows by its checksum that it was not altered. That none was removed, doubled or moved is shown by
each line naming the checksum of the line before. Lines cut off the end are followed by nothing that could tell; a run
that was finished says so in its last line, so it is unfinished without it. Knows no file.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from protocols.record import DamagedLineError, Line, read_line


class DamagedJournalError(ValueError):
    """A line before the last that is not what was written, or not where it was written."""

    def __init__(self, line: int, lines: int, why: str) -> None:
        super().__init__(why)
        self.line = line  # its number, from 1
        self.lines = lines  # how many there are


@dataclass(frozen=True)
class JournalText:
    """What a journal says.

    records: the members of every whole line. last: the checksum of the last one, "" when there is none.
    torn:    bytes after them: a line that was still being written, 0 when there is none.
    chained: every line but the first names the one before; not so in format 1, nor in a file without a header.
    """

    records: tuple[dict[str, Any], ...]
    last: str
    torn: int
    chained: bool


def read_text(content: bytes) -> JournalText:
    """The lines of a journal; raises DamagedJournalError when one before a torn end is damaged or out of its place.

    A line and its newline are written together, so a last line without one was still being written.
    """
    *parts, rest = content.split(b"\n")
    while parts and not rest and not parts[-1].strip():
        parts.pop()
    lines: list[Line] = []
    whole = 0  # bytes of the lines that count
    for number, part in enumerate(parts, start=1):
        try:
            line = read_line(part.decode("utf-8"))
        except (DamagedLineError, UnicodeDecodeError) as error:
            if number == len(parts) and not rest:
                break
            why = "the line is not UTF-8; it was altered" if isinstance(error, UnicodeDecodeError) else str(error)
            raise DamagedJournalError(number, len(parts), why) from None
        lines.append(line)
        whole += len(part) + 1
    chained = bool(lines) and lines[0].values["kind"] == "header" and lines[0].values.get("format", 1) > 1
    for place in range(1, len(lines)):
        if not _follows(lines[place], lines[place - 1], chained):
            raise DamagedJournalError(place + 1, len(parts), _what_happened(lines, place))
    last = lines[-1].checksum if lines else ""
    return JournalText(tuple(line.values for line in lines), last, len(content) - whole, chained)


def _follows(line: Line, before: Line, chained: bool) -> bool:
    """Whether a line stands after the one it was written after; a line of format 1 names none."""
    return line.after == before.checksum or (line.after is None and not chained)


def _what_happened(lines: Sequence[Line], place: int) -> str:
    """Why a whole line does not follow the one before it, as half a sentence; places count from 0."""
    line = lines[place]
    places = {other.checksum: number for number, other in reversed(list(enumerate(lines, start=1)))}
    if line.after is None:
        return "the line does not name the line before it, so it was put in later"
    if places[line.checksum] <= place:
        return f"the line is line {places[line.checksum]} once more; it was doubled"
    if line.after in places:
        return f"the line was written after what is now line {places[line.after]}; lines were moved"
    return "the line before it is missing; a whole line was removed"

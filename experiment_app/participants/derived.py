"""What was made from a study's journals and where, so that a withdrawal reaches it: lines of `derived.jsonl`."""

from __future__ import annotations

import json
import os
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path

DERIVED = "derived.jsonl"


@dataclass(frozen=True)
class Derived:
    """One export or report.

    what: "export" or "report"; to: the export's format, "" for a report; out: its folder, an absolute path, which
    keeps a list of the files; near: the same folder as seen from the study's, which holds when both are moved together.
    """

    what: str
    to: str
    out: str
    near: str = ""

    @property
    def sentence(self) -> str:
        """As `bids export in /home/lab/bids`."""
        return f"{self.to} {self.what} in {self.out}".lstrip()


def note_derived(folder: Path, what: str, to: str, out: Path) -> None:
    """Notes what was made from a study's folder, once; data that cannot be written to (an archive) are no error."""
    made = Derived(what, to, str(out.resolve()), _seen_from(folder, out))
    if made in _noted(folder):
        return
    with suppress(OSError), open(folder / DERIVED, "a", encoding="utf-8") as file:
        file.write(json.dumps(asdict(made), ensure_ascii=False) + "\n")


def derived(folder: Path) -> tuple[list[Derived], list[Derived]]:
    """Everything noted that is there, oldest first, with the place it is at now; and what is no longer there."""
    found: dict[tuple[str, str, str], Derived] = {}
    gone: dict[tuple[str, str, str], Derived] = {}
    for made in _noted(folder):
        place = _place(folder, made)
        there = made if place is None else replace(made, out=str(place))
        (gone if place is None else found).setdefault((made.what, made.to, there.out), there)
    return list(found.values()), list(gone.values())


def _noted(folder: Path) -> list[Derived]:
    """The lines of the file; those that cannot be read are passed over (splitlines would cut names at U+2028)."""
    try:
        lines = (folder / DERIVED).read_text(encoding="utf-8").split("\n")
    except OSError:
        return []
    noted: list[Derived] = []
    for line in lines:
        with suppress(ValueError, TypeError):
            noted.append(Derived(**json.loads(line)))
    return noted


def _seen_from(folder: Path, out: Path) -> str:
    try:
        return Path(os.path.relpath(out.resolve(), folder.resolve())).as_posix()
    except ValueError:  # another drive, on Windows
        return ""


def _place(folder: Path, made: Derived) -> Path | None:
    """Where it is now: seen from the study's folder as it was, or at its old place; one that keeps its list first."""
    moved = [(folder.resolve() / made.near).resolve()] if made.near else []
    places = [place for place in (*moved, Path(made.out)) if place.is_dir()]
    listed = [place for place in places if (place / f".gaitlab-{made.what}.json").is_file()]
    return next(iter((*listed, *places)), None)

"""What was made from a study's journals and where, so that a withdrawal reaches it: lines of `derived.jsonl`."""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

DERIVED = "derived.jsonl"


@dataclass(frozen=True)
class Derived:
    """One export or report.

    what: "export" or "report"; to: the export's format, "" for a report; out: its folder, an absolute path, which
    keeps a list of the files.
    """

    what: str
    to: str
    out: str

    @property
    def sentence(self) -> str:
        """As `bids export in /home/lab/bids`."""
        return f"{self.to} {self.what} in {self.out}".lstrip()


def note_derived(folder: Path, made: Derived) -> None:
    """Notes what was made from a study's folder, once; data that cannot be written to (an archive) are no error."""
    if made in derived(folder):
        return
    with suppress(OSError), open(folder / DERIVED, "a", encoding="utf-8") as file:
        file.write(json.dumps(asdict(made), ensure_ascii=False) + "\n")


def derived(folder: Path) -> list[Derived]:
    """Everything noted whose folder still exists, oldest first; lines that cannot be read are passed over."""
    try:
        lines = (folder / DERIVED).read_text(encoding="utf-8").splitlines()
    except OSError:
        return []
    found: list[Derived] = []
    for line in lines:
        with suppress(ValueError, TypeError):
            found.append(Derived(**json.loads(line)))
    return [made for made in dict.fromkeys(found) if Path(made.out).is_dir()]

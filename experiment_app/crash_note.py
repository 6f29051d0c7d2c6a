"""What a run leaves behind when the process dies of a native fault (a driver, say): the signal and where it struck.

Python's own fault handler writes the note from inside the signal; the journal itself needs nothing, since each of its
lines was handed to the system when it was written.
"""

from __future__ import annotations

import faulthandler
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def crash_note(folder: Path, sitting: int) -> Iterator[None]:
    """While open, a native fault (SIGSEGV, SIGABRT, SIGBUS, ...) leaves `crash-<sitting>.txt` in `folder`."""
    for old in folder.glob("crash-*.txt"):
        if not old.stat().st_size:  # a sitting that was killed, which no fault handler sees
            old.unlink(missing_ok=True)
    path, before = _path(folder, sitting), faulthandler.is_enabled()
    with open(path, "w", encoding="utf-8") as note:
        faulthandler.enable(note, all_threads=True)
        try:
            yield
        finally:
            faulthandler.disable()
            if before and sys.__stderr__ is not None:
                faulthandler.enable(sys.__stderr__)
    path.unlink(missing_ok=True)


def leave_note(folder: Path, sitting: int, reason: str) -> None:
    """Writes what the process is about to die of, where no native fault says it."""
    _path(folder, sitting).write_text(f"{reason}\n", encoding="utf-8")


def crash_reason(folder: Path, sitting: int) -> str:
    """What a sitting died of, as "Segmentation fault"; "" when there is no note of a native fault."""
    try:
        first = _path(folder, sitting).read_text(encoding="utf-8", errors="replace").split("\n")[0]
    except OSError:
        return ""
    return first.removeprefix("Fatal Python error: ").strip()


def _path(folder: Path, sitting: int) -> Path:
    return folder / f"crash-{sitting}.txt"

"""A folder of exported files: each whole or not there, and only files that an export wrote are ever replaced."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from analysis.errors import AnalysisError, listed
from analysis.writing import write_bytes

MANIFEST = ".gaitlab-export.json"
"""Names and SHA-256 of the files an export wrote, so that the next one knows what it may replace or remove."""


def write_tree(out: Path, files: Iterable[tuple[str, bytes]], over_edits: bool = False) -> list[Path]:
    """Writes the files into `out`, removes what an earlier export wrote and this one does not, and returns the paths.

    Raises AnalysisError when `out` holds files but no export, or, unless `over_edits`, when a person has changed an
    exported file since.
    """
    before = _manifest(out)
    if before is None and out.is_dir() and any(out.iterdir()):
        raise AnalysisError(f"{out} holds files that no export wrote; name an empty or a new folder with --out.")
    before = before or {}
    if not over_edits:
        _refuse_edited(out, before)
    written: dict[str, str] = {}
    for name, content in files:
        written[name] = hashlib.sha256(content).hexdigest()
        if name not in before:  # noted first, so that what a killed export wrote is known to be its own
            _note(out, {**before, **written})
        write_bytes(out / name, content)
    for name in before.keys() - written.keys():
        _remove(out, name)
    _note(out, written)
    return [out / name for name in written]


def remove_tree(out: Path) -> None:
    """Removes everything that exports wrote into `out`, and the folder itself when nothing else is in it."""
    for name in [*(_manifest(out) or {}), MANIFEST]:
        _remove(out, name)
    with suppress(OSError):
        out.rmdir()


def _manifest(out: Path) -> dict[str, str] | None:
    try:
        return dict(json.loads((out / MANIFEST).read_text(encoding="utf-8"))["files"])
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _note(out: Path, files: dict[str, str]) -> None:
    content = json.dumps({"files": dict(sorted(files.items()))}, ensure_ascii=False, indent=1) + "\n"
    write_bytes(out / MANIFEST, content.encode("utf-8"))


def _refuse_edited(out: Path, before: dict[str, str]) -> None:
    edited = []
    for name, known in before.items():
        with suppress(OSError):
            if hashlib.sha256((out / name).read_bytes()).hexdigest() != known:
                edited.append(name)
    if edited:
        raise AnalysisError(
            f"{out}: {listed(sorted(edited))} was changed since it was exported; move it away, or choose another --out."
        )


def _remove(out: Path, name: str) -> None:
    path = out / name
    if not path.resolve().is_relative_to(out.resolve()):
        return
    path.unlink(missing_ok=True)
    for folder in path.parents:
        if folder == out:
            break
        with suppress(OSError):
            folder.rmdir()

"""A folder of derived files: each whole or not there, and only files that gaitlab wrote are ever replaced."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.errors import AnalysisError, listed
from analysis.writing import write_bytes


@dataclass(frozen=True)
class Derivation:
    """What is made of recorded runs and written into a folder.

    noun: "export", "report" or "comparison"; source: the data it is made of, as a sentence names them; alone: it
    shares its folder with no other files.
    """

    noun: str
    source: str
    alone: bool

    @property
    def manifest(self) -> str:
        """Name of the file that holds source, names and SHA-256 of the files, so that the next one knows its own."""
        return f".gaitlab-{self.noun}.json"


def export_of(header: Mapping[str, Any]) -> Derivation:
    """A data set in a folder of its own, of a study's runs of which one has this header."""
    return Derivation("export", _source(header), alone=True)


def report_of(header: Mapping[str, Any]) -> Derivation:
    """Tables, figures and a page, beside whatever the analyst keeps there, of runs of which one has this header."""
    return Derivation("report", _source(header), alone=False)


def _source(header: Mapping[str, Any]) -> str:
    who = "simulated participants" if header.get("simulated") else "pilot runs" if header.get("pilot") else ""
    study = str(header.get("study", ""))
    return f"{who} of {study}" if who else study


def write_derived(
    out: Path, made: Derivation, files: Iterable[tuple[str, bytes]], over_edits: bool = False
) -> list[Path]:
    """Writes the files into `out`, removes what an earlier one wrote and this one does not, and returns the paths.

    Raises AnalysisError when `out` holds one made of other data, when a file is in the way that gaitlab did not
    write, or, unless `over_edits`, when a person has changed one that it did.
    """
    known = _manifest(out, made)
    if known is None and made.alone and out.is_dir() and any(out.iterdir()):
        raise AnalysisError(f"{out} holds files that no {made.noun} wrote; name an empty or a new folder with --out.")
    source, before = known or (made.source, {})
    if source != made.source:
        raise AnalysisError(
            f"{out} holds the {made.noun} of {source}, this one is of {made.source}; name another folder with --out."
        )
    if not over_edits:
        _refuse_edited(out, made, before)
    written: dict[str, str] = {}
    for name, content in files:
        written[name] = hashlib.sha256(content).hexdigest()
        if name not in before:  # noted first, so that what was written before a kill is known to be its own
            _refuse_foreign(out, made, name)
            _note(out, made, {**before, **written})
        write_bytes(out / name, content)
    for name in before.keys() - written.keys():
        _remove(out, name)
    _note(out, made, written)
    return [out / name for name in written]


def names_written(out: Path, made: Derivation) -> frozenset[str]:
    """The names of the files of the kind that gaitlab wrote into `out`."""
    return frozenset((_manifest(out, made) or ("", {}))[1])


def remove_derived(out: Path, made: Derivation) -> None:
    """Removes everything of the kind that gaitlab wrote into `out`, and the folder when nothing else is in it."""
    _, files = _manifest(out, made) or ("", {})
    for name in [*files, made.manifest]:
        _remove(out, name)
    with suppress(OSError):
        out.rmdir()


def _manifest(out: Path, made: Derivation) -> tuple[str, dict[str, str]] | None:
    """Of what data the one in `out` was made, and the SHA-256 of its files by name; None where there is none."""
    try:
        held = json.loads((out / made.manifest).read_text(encoding="utf-8"))
        return str(held["source"]), dict(held["files"])
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _note(out: Path, made: Derivation, files: Mapping[str, str]) -> None:
    held = {"source": made.source, "files": dict(sorted(files.items()))}
    content = json.dumps(held, ensure_ascii=False, indent=1) + "\n"
    write_bytes(out / made.manifest, content.encode("utf-8"))


def _refuse_foreign(out: Path, made: Derivation, name: str) -> None:
    if (out / name).exists():
        raise AnalysisError(
            f"{out / name} was not written by gaitlab and is in the way of the {made.noun}; move it away, or choose "
            "another --out."
        )


def _refuse_edited(out: Path, made: Derivation, before: Mapping[str, str]) -> None:
    edited = []
    for name, known in before.items():
        with suppress(OSError):
            if hashlib.sha256((out / name).read_bytes()).hexdigest() != known:
                edited.append(name)
    if edited:
        raise AnalysisError(
            f"{out}: {listed(sorted(edited))} was changed since the {made.noun} was made; move it away, or choose "
            "another --out."
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

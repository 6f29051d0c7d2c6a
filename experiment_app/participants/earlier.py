"""How a study's earlier runs differ from the one that is to begin: another version of the file, other imports.

Told or refused before the window opens, from the headers of the runs alone.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from experiment_app.errors import UsageError
from experiment_app.imports import imported
from experiment_app.run_folder import study_folder
from experiment_app.terminal import typed
from protocols.study_file import StudyFile
from protocols.versions import another_study, what_differs

Header = Mapping[str, Any]
"""The first line of a journal."""


def _other_versions(headers: Sequence[Header], file: StudyFile) -> dict[str, list[Header]]:
    """The text of every other version of a study file to the headers of who took part with it."""
    versions: dict[str, list[Header]] = {}
    for header in headers:
        if header["study_hash"] != file.hash:
            versions.setdefault(header["study_text"], []).append(header)
    return versions


def refuse_another_study(headers: Sequence[Header], file: StudyFile, data: Path) -> None:
    """Raises UsageError where the folder holds runs of a study that has no more than its name in common."""
    for text, same in _other_versions(headers, file).items():
        if why := another_study(text, file.text):
            raise UsageError(
                f"{data / file.study.study} holds another study of that name ({same[0]['participant']}: {why}), and "
                "they would stand in one table. Give this one a name of its own under `study:`, or choose another "
                "folder with --data."
            )


def default_data(study: str, name: str, pilot: bool) -> Path:
    """The folder of data where none is named: here. study: the study file as it was named; name: of the study.

    Raises UsageError when this study has none here but one beside its file, as after a change of the working folder:
    who came back would begin anew, and the order of arrival too.
    """
    here = Path("pilot" if pilot else "data")
    beside = Path(study).parent / here
    if study_folder(beside, name).is_dir() and not study_folder(here, name).is_dir():
        raise UsageError(
            f"there are no data of {name} in this working folder, but in {study_folder(beside, name)}. Say --data "
            f"{typed(beside)} to go on there, or --data {here} to begin a new folder here."
        )
    return here


def refuse_lookalike(headers: Sequence[Header], participant: str) -> None:
    """Raises UsageError for a new ID that is an earlier one in other letters or zeros, as p1 for P01.

    Who came back would begin anew under it, and on computers where p01 and P01 are one name, folders would mix.
    """
    known = {str(header["participant"]) for header in headers}
    for other in sorted(known - {participant}) if participant not in known else ():
        if _sound(other) == _sound(participant):
            raise UsageError(
                f"--participant {participant}: there is a participant {other} already. For the same person say "
                f"--participant {other}; for somebody else choose an ID that cannot be mistaken for it."
            )


def _sound(participant: str) -> str:
    return re.sub(r"0+(?=\d)", "", participant.lower())


def tell_changes(headers: Sequence[Header], file: StudyFile, say: Callable[[str], None]) -> None:
    """Says who took part with another version of the study file, and with other imported actors, bodies or styles."""
    for text, same in _other_versions(headers, file).items():
        who = ", ".join([header["participant"] for header in same[:5]])
        say(f"Note: {who} took part with another version of this study file, which differs in "
            f"{what_differs(text, file.text)}.")  # fmt: skip
    here = imported(file.study)
    for name, sha256 in here.items():
        others = [h["participant"] for h in headers if h.get("imported", {}).get(name, sha256) != sha256]
        if others:
            say(f"Note: {', '.join(others[:5])} saw another {name} than this computer has; copy its file from there.")

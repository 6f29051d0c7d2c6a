"""Imported bodies: where they are kept, one GLB file each. The folder is that of the user's data, or GAITLAB_BODIES."""

from __future__ import annotations

import re
from pathlib import Path

from stimuli.bodies.point_light import FIGURES
from stimuli.body_files.errors import BodyError
from stimuli.file_names import same_file, why_no_file
from stimuli.user_folder import make_user_folder, user_folder
from stimuli.whole_file import whole_file

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,39}")
MATCHED, MISMATCHED = "matched", "mismatched"
"""Stand in a study for the shipped body of the actor's sex, and for that of the other sex, at the actor's height."""

OWN_BUILD = "own_build"
"""Stands in a study for the shipped body of the actor's sex, as stout or slim as the actor's weight and height say."""

TAKEN = ("woman", "man", MATCHED, MISMATCHED, OWN_BUILD, *FIGURES)


def library_folder() -> Path:
    """Where imported bodies are kept: GAITLAB_BODIES, or the folder of this user's data."""
    return user_folder("bodies")


def imported_names() -> tuple[str, ...]:
    """Names of imported bodies, in order; none where there is no library."""
    try:
        found = sorted(path.stem for path in library_folder().glob("*.glb"))
    except OSError:
        return ()
    return tuple(name for name in found if NAME.fullmatch(name) and name not in TAKEN)


def path_of(name: str) -> Path:
    """The file of an imported body."""
    return library_folder() / f"{name}.glb"


def stored(data: bytes, name: str, replace: bool = False) -> Path:
    """Writes the bytes of a GLB file into the library, whole or not at all, and returns the file."""
    if not NAME.fullmatch(name):
        raise BodyError(f"{name!r} is no name for a body; use letters, digits, - and _, as lab7_anna")
    if why := why_no_file(name):
        raise BodyError(why)
    if name in TAKEN:
        raise BodyError(f"{name} comes with gaitlab; choose another name")
    if not replace and (taken := same_file(name, imported_names())):
        raise BodyError(f"there is a body {taken} already; choose another name, or say --replace")
    path = path_of(name)
    make_user_folder(path.parent, "bodies")
    with whole_file(path) as stream:
        stream.write(data)
    return path

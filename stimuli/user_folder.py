"""Where what a user imported is kept: the folder of that user's data, or one that an environment variable names."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def user_folder(kind: str) -> Path:
    """The folder of a kind of imported things ("actors", "bodies"): GAITLAB_ACTORS, ..., or in this user's data."""
    given = os.environ.get(f"GAITLAB_{kind.upper()}")
    if given:
        return Path(given)
    if sys.platform == "win32":
        data = Path(os.environ.get("APPDATA", Path.home()))
    elif sys.platform == "darwin":
        data = Path.home() / "Library" / "Application Support"
    else:
        data = Path(os.environ.get("XDG_DATA_HOME", Path.home() / ".local" / "share"))
    return data / "gaitlab" / kind


def make_user_folder(folder: Path, kind: str) -> None:
    """Makes a folder for imported things of a kind; raises OSError with the way out where nothing can be kept in it."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        why = "" if os.access(folder, os.W_OK) else "Permission denied"
    except OSError as error:
        why = str(error.strerror)
    if why:
        raise OSError(f"{folder} cannot be written ({why}); name another folder with GAITLAB_{kind.upper()}.")

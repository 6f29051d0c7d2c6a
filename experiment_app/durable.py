"""Forces what was written onto the disk itself, so that it is there after a power cut."""

from __future__ import annotations

import errno
import importlib
import os
import sys
from pathlib import Path


def force_file(descriptor: int) -> None:
    """Returns when an open file is on the disk.

    On macOS fsync leaves it in the drive's own cache; there F_FULLFSYNC is asked first, which some network disks lack.
    """
    if sys.platform == "darwin":  # pragma: no cover - exercised on macOS only
        fcntl = importlib.import_module("fcntl")
        try:
            fcntl.fcntl(descriptor, fcntl.F_FULLFSYNC)
            return
        except OSError:
            pass
    os.fsync(descriptor)


def force_folder(folder: Path) -> None:
    """Makes the names in a folder survive a power cut, too (POSIX; Windows needs and allows no such thing).

    Many network and FUSE disks refuse it for folders as invalid (EINVAL); their servers see to names themselves.
    """
    if os.name == "nt":  # pragma: no cover - exercised on Windows only
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno != errno.EINVAL:
            raise
    finally:
        os.close(descriptor)

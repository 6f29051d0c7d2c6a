"""Forces the names in a folder onto the disk itself, so that its files are found after a power cut."""

from __future__ import annotations

import errno
import os
from pathlib import Path


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

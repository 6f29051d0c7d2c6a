"""Writes files that are there whole or not at all, even if the power fails."""

from __future__ import annotations

import importlib
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO


@contextmanager
def whole_file(path: Path) -> Iterator[IO[bytes]]:
    """A file to write, which takes its place at `path` when all of it is on the disk, and leaves nothing otherwise."""
    handle, temporary = tempfile.mkstemp(prefix=".", suffix=".part", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as stream:
            yield stream
            stream.flush()
            force_file(stream.fileno())
        os.replace(temporary, path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise


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

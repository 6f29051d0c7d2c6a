"""Results on disk: written beside the target, then renamed, so that nobody reads half a file."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

import pandas as pd

from analysis.errors import AnalysisError


def write_bytes(path: Path, content: bytes) -> Path:
    """Write `content` to `path`, whole or not at all."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary.write_bytes(content)
        os.replace(temporary, path)
    except OSError as error:
        with suppress(OSError):
            temporary.unlink()
        if path.parent.is_file():
            raise AnalysisError(f"{path.parent} is a file; name a folder with --out, or one that is new.") from None
        raise AnalysisError(f"{path} cannot be written: {error.strerror or error}.") from None
    return path


def table_bytes(table: pd.DataFrame) -> bytes:
    """A CSV table (RFC 4180: CRLF, quoted where needed, UTF-8); numbers at full precision, nan empty."""
    return table.to_csv(index=False, lineterminator="\r\n").encode("utf-8")

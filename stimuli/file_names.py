"""Names that become those of files and folders, and are carried from one computer to another."""

from __future__ import annotations

from collections.abc import Iterable

DEVICES = frozenset({"con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in range(1, 10))})
"""What Windows takes for a device, in any case and with any ending, as con.npz (Microsoft, Naming Files)."""


def why_no_file(name: str) -> str:
    """Why no file or folder should have this name, as a sentence; "" where nothing speaks against it."""
    if name.lower() in DEVICES:
        return f"{name} is what Windows calls a device, so no file there can have this name; choose another"
    return ""


def same_file(name: str, names: Iterable[str]) -> str:
    """Which of the names would be the same file, as Anna and anna are on Windows and macOS; "" if none."""
    return next((other for other in names if other.lower() == name.lower()), "")

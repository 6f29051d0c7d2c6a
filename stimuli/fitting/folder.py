"""The folder of captures that the programs of this package are given with --mocap."""

from __future__ import annotations

from argparse import ArgumentTypeError
from importlib.util import find_spec
from pathlib import Path

NEEDED = ("mocap/REFERENCE_C3D_EVENTS.csv", "mocap/c3d", "mocap/bvh/cmu", "gait-tables")


def captures_folder(text: str) -> Path:
    """The folder named on the command line; ArgumentTypeError when it, or the library that reads it, is missing."""
    missing = [name for name in NEEDED if not (Path(text) / name).exists()]
    if missing:
        raise ArgumentTypeError(f"{text} has no {', '.join(missing)}; name the folder that has mocap/ and gait-tables/")
    if find_spec("ezc3d") is None:
        raise ArgumentTypeError("reading C3D files needs ezc3d; install it with: pip install 'gaitlab[mocap]'")
    return Path(text)

"""Where the tests find R's results: the shared folder beside the repository, else the copies kept here."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

SHARED = Path(__file__).parents[2].parent / "shared" / "stats-reference"
COPIES = Path(__file__).parent / "data"


def path(name: str) -> Path:
    """The shared file, or our copy of it; skips the test when there is neither."""
    for folder in (SHARED, COPIES):
        if (folder / name).is_file():
            return folder / name
    pytest.skip(f"reference file {name} is not in ../shared/stats-reference and no copy is kept in tests/analysis/data")


def expected(name: str) -> dict[str, Any]:
    return json.loads(path(f"{name}.json").read_text(encoding="utf-8"))


def table(name: str, design: dict[str, Any], text: bool = True) -> pd.DataFrame:
    """The CSV with labels read as text."""
    labels = [design["id"], *design.get("within", {}), *design.get("between", {})]
    if "item" in design:
        labels.append(design["item"])
    return pd.read_csv(path(f"{name}.csv"), dtype=dict.fromkeys(labels, str) if text else None)


def arguments(design: dict[str, Any]) -> dict[str, Any]:
    """A reference design as arguments of `anova`."""
    return {
        "dv": design["dv"],
        "subject": design["id"],
        "within": list(design["within"]),
        "between": list(design["between"]),
        "levels": {**design["within"], **design["between"]},
    }

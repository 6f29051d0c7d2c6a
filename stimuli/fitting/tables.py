"""The Schreiber & Moissenet (2019) tables of sagittal angles, to hold the model against. Knows CSV files only."""

from __future__ import annotations

import csv
from collections import defaultdict
from pathlib import Path

import numpy as np

from stimuli.skeleton import Floats


def mean_curves(folder: Path, condition: str) -> dict[str, Floats]:
    """quantity -> (101, 2) mean and between-subject SD over the cycle, deg; condition C4 (comfort) or C5 (fast)."""
    curves: dict[str, list[tuple[float, float]]] = defaultdict(list)
    for row in _rows(folder / "schreiber_moissenet_mean_sd.csv"):
        if row["condition"] == condition:
            curves[row["quantity"]].append((float(row["mean"]), float(row["sd"])))
    return {quantity: np.array(values) for quantity, values in curves.items()}


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))

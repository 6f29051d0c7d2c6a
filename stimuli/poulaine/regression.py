"""Where the points of a poulaine are expected for a person and a speed: Niay (2022) tables 5.2 and 5.3, and a refit.

Coefficients stand in regression_tables.csv, with their sources. A coefficient that was not significant is 0. Only
differences are used for editing: how far a point moves when a predictor changes.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np

from stimuli.poulaine.curve import FIVE, PoulaineError
from stimuli.skeleton import Floats

GRAVITY = 9.81  # m/s²

PREDICTORS: tuple[str, ...] = ("age", "height", "weight", "gender", "speed")

TABLES: tuple[str, ...] = ("raw", "normalised", "refitted")
"""Table 5.2 (m), table 5.3 (leg lengths; speed over sqrt(g l0)) and our refit (as table 5.3)."""


@dataclass(frozen=True)
class Change:
    """What is to be changed about a walk; differences from the walk as captured.

    gender: 1 for man to woman, -1 for woman to man (the sources do not print their coding; see docs/methods.md)
    """

    speed: float = 0.0  # m/s
    height: float = 0.0  # m
    gender: float = 0.0
    age: float = 0.0  # years
    weight: float = 0.0  # kg


@dataclass(frozen=True, eq=False)
class RegressionTable:
    """name: one of TABLES; coefficients: (5, 2, 5) of FIVE points, x and z, PREDICTORS; intercepts: (5, 2)."""

    name: str
    intercepts: Floats
    coefficients: Floats

    @property
    def normalised(self) -> bool:
        """Whether places are in leg lengths and speed over sqrt(g l0)."""
        return self.name != "raw"

    def moved(self, change: Change, leg_length: float) -> Floats:
        """(5, 2) m that the FIVE points move in x and z. leg_length: m, l0 of the normalised tables.

        In a normalised table height acts through the leg length alone, which the caller scales.
        """
        if not self.normalised:
            values = [change.age, change.height, change.weight, change.gender, change.speed]
            return self.coefficients @ np.array(values)
        speed = change.speed / np.sqrt(GRAVITY * leg_length)
        return self.coefficients @ np.array([change.age, 0.0, change.weight, change.gender, speed]) * leg_length

    def expected(self, leg_length: float, speed: float, age: float, height: float, weight: float) -> Floats:
        """(5, 2) m: places of the FIVE points of a person with gender coded 0 (equation 5.1)."""
        if not self.normalised:
            return self.intercepts + self.coefficients @ np.array([age, height, weight, 0.0, speed])
        scaled = np.array([age, 0.0, weight, 0.0, speed / np.sqrt(GRAVITY * leg_length)])
        return (self.intercepts + self.coefficients @ scaled) * leg_length


@cache
def regression_table(name: str) -> RegressionTable:
    """One of TABLES. Raises PoulaineError for another name."""
    if name not in TABLES:
        raise PoulaineError(f"there is no regression table {name!r}; there are {', '.join(TABLES)}")
    text = (files("stimuli.poulaine") / "regression_tables.csv").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    intercepts, coefficients = np.zeros((5, 2)), np.zeros((5, 2, 5))
    for row in csv.DictReader(lines):
        if row["table"] == name:
            place = FIVE.index(row["point"]), "xz".index(row["axis"])
            intercepts[place] = float(row["intercept"])
            coefficients[place] = [float(row[predictor] or 0.0) for predictor in PREDICTORS]
    return RegressionTable(name, intercepts, coefficients)

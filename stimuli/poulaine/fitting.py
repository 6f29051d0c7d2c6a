"""The regression of the points refitted on the Schreiber & Moissenet (2019) adults: 28 walks of 14 people.

Run as `python -m stimuli.poulaine.fitting FOLDER`, with the folder of gait tables; prints the rows of
regression_tables.csv. Predictors that are not significant are dropped one at a time, the least significant first.
"""

from __future__ import annotations

import csv
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import stats

from stimuli.poulaine.curve import FIVE, Poulaine, PoulaineError, characteristic_points
from stimuli.poulaine.regression import GRAVITY, PREDICTORS
from stimuli.skeleton import Floats

SIGNIFICANT = 0.05
NORMALISED_PREDICTORS = ("age", "weight", "gender", "speed")


@dataclass(frozen=True)
class FittedRow:
    """The regression of one coordinate of one point; coefficient 0.0 where not significant."""

    point: str
    axis: str
    intercept: float
    coefficients: dict[str, float]
    adjusted_r2: float
    rmse: float


def fitted_rows(folder: Path) -> list[FittedRow]:
    """The ten regressions of normalised places (over l0) on age, weight, gender (woman 1) and speed over sqrt(g l0)."""
    people = _rows(folder / "schreiber_moissenet_spatiotemporal.csv")
    curves = _curves(folder / "schreiber_moissenet_cycles.csv")
    places, predictors = [], []
    for person in people:
        both = [curves[person["trial"], side] for side in "LR" if (person["trial"], side) in curves]
        places.append(np.mean([characteristic_points(curve).places for curve in both], axis=0))
        legs = 0.5 * (float(person["right_leg_m"]) + float(person["left_leg_m"]))
        speed = float(person["speed_m_s"]) / np.sqrt(GRAVITY * legs)
        predictors.append([float(person["age"]), float(person["mass_kg"]), float(person["gender"] == "W"), speed])
    observed, known = np.array(places), np.array(predictors)
    return [
        _fit(point, axis, known, observed[:, row, column])
        for row, point in enumerate(FIVE)
        for column, axis in enumerate("xz")
    ]


def _fit(point: str, axis: str, predictors: Floats, values: Floats) -> FittedRow:
    kept = list(range(predictors.shape[1]))
    while True:
        design = np.column_stack([np.ones(len(values)), predictors[:, kept]])
        b, *_ = np.linalg.lstsq(design, values, rcond=None)
        df = len(values) - design.shape[1]
        residual = float(np.sum((values - design @ b) ** 2))
        errors = np.sqrt(residual / df * np.diag(np.linalg.inv(design.T @ design)))
        p = 2 * stats.t.sf(np.abs(b / errors), df)[1:]
        if not kept or p.max() < SIGNIFICANT:
            break
        kept.pop(int(np.argmax(p)))
    total = float(np.sum((values - values.mean()) ** 2))
    names = [NORMALISED_PREDICTORS[index] for index in kept]
    return FittedRow(
        point,
        axis,
        float(b[0]),
        {name: float(value) for name, value in zip(names, b[1:], strict=True)},
        1.0 - (residual / df) / (total / (len(values) - 1)),
        float(np.sqrt(residual / len(values))),
    )


def _curves(path: Path) -> dict[tuple[str, str], Poulaine]:
    """(trial, side) -> normalised poulaine, closed by spreading the gap between 0 and 100 % over the cycle."""
    rows: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for row in _rows(path):
        place = float(row["poulaine_x_leg"]), float(row["poulaine_z_leg"])
        rows.setdefault((row["trial"], row["side"]), []).append(place)
    curves = {}
    for key, places in rows.items():
        values = np.array(places)
        share = np.linspace(-0.5, 0.5, len(values))[:, None]
        curves[key] = Poulaine((values - share * (values[-1] - values[0]))[:-1], " ".join(key))
    return curves


def _rows(path: Path) -> list[dict[str, str]]:
    if not path.is_file():
        raise PoulaineError(f"{path} is missing; give the folder of the gait tables")
    return list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))


def printed(row: FittedRow) -> str:
    """The row as it stands in regression_tables.csv."""
    cells = [f"{row.coefficients[name]:.6g}" if name in row.coefficients else "" for name in PREDICTORS]
    return ",".join(
        ["refitted", row.point, row.axis, f"{row.intercept:.6g}", *cells, f"{row.adjusted_r2:.2f}", f"{row.rmse:.3f}"]
    )


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("give the folder of the gait tables: python -m stimuli.poulaine.fitting ../shared/gait-tables")
    try:
        print("\n".join(printed(row) for row in fitted_rows(Path(sys.argv[1]))))
    except PoulaineError as error:
        sys.exit(str(error))

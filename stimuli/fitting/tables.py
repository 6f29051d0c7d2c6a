"""Schreiber & Moissenet (2019) walks as Fourier coefficients of the sagittal leg signals. Knows CSV files only."""

from __future__ import annotations

import csv
from collections import defaultdict
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

from stimuli.fitting.captures import Walk, close_cycle, fourier
from stimuli.gait_model import COEFFICIENTS, SIGNALS
from stimuli.skeleton import Floats

LEG_SHARE = 0.461
"""Hip-to-ankle length over stature: what `standing_posture` finds for the fourteen adults (0.234 + 0.227)."""


def read_walks(folder: Path, events: Path) -> list[Walk]:
    """The 28 walks of the tables; both sides averaged.

    folder: with schreiber_moissenet_cycles.csv and schreiber_moissenet_spatiotemporal.csv
    events: CSV of foot strikes and foot offs per C3D file (file, context, label, time_s)
    """
    cycles: dict[tuple[str, str], list[list[float]]] = defaultdict(list)
    for row in _rows(folder / "schreiber_moissenet_cycles.csv"):
        thigh, knee = float(row["thigh_incl_deg"]), float(row["knee_flex_deg"])
        cycles[row["trial"], row["side"]].append([thigh, thigh - knee, float(row["foot_pitch_deg"])])
    stance = stance_shares(events)
    walks = []
    standing = standing_posture(folder)
    for row in _rows(folder / "schreiber_moissenet_spatiotemporal.csv"):
        sides = [np.radians(np.array(cycles[row["trial"], side])) for side in "LR"]
        coefficients = np.full((len(SIGNALS), COEFFICIENTS), np.nan)
        fitted = fourier(np.mean([close_cycle(side) for side in sides], axis=0))
        fitted[:2, 0] += standing
        for name, values in zip(("thigh", "shank", "foot"), fitted, strict=True):
            coefficients[SIGNALS.index(name)] = values
        walks.append(
            Walk(
                name=row["trial"],
                person="SM-" + row["subject"],
                laboratory="SM",
                sex=0.5 if row["gender"] == "W" else -0.5,
                leg_length=LEG_SHARE * float(row["height_m"]),
                speed=float(row["speed_m_s"]),
                step_frequency=float(row["step_freq_steps_min"]),
                stance_share=stance.get(row["trial"], float("nan")),
                coefficients=coefficients,
            )
        )
    return walks


def standing_posture(folder: Path) -> Floats:
    """(2,) rad: inclination of thigh and shank in the standing trial, to which the tables' angles refer.

    The tables give angles minus those of standing, but also the path of the ankle below the hip in metres. For each
    person two inclinations and two bone lengths are fitted so that the bones, turned by the tables' angles, put the
    ankle on that path (9 mm RMS); the mean over people is returned. People stand with the hips ahead of the ankles.
    """
    rows: dict[str, list[list[float]]] = defaultdict(list)
    for row in _rows(folder / "schreiber_moissenet_cycles.csv"):
        rows[row["trial"][:7]].append(
            [float(row[name]) for name in ("thigh_incl_deg", "knee_flex_deg", "poulaine_x_m", "poulaine_z_m")]
        )
    found = []
    for person in sorted(rows):
        thigh, knee, forward, up = np.array(rows[person]).T
        upper, lower = np.radians(thigh), np.radians(thigh - knee)

        def misses(
            guess: Floats, upper: Floats = upper, lower: Floats = lower, forward: Floats = forward, up: Floats = up
        ) -> Floats:
            above, below = upper + guess[0], lower + guess[1]
            return np.concatenate([
                guess[2] * np.sin(above) + guess[3] * np.sin(below) - forward,
                -guess[2] * np.cos(above) - guess[3] * np.cos(below) - up,
            ])

        found.append(least_squares(misses, [0.0, 0.0, 0.4, 0.4]).x)
    return np.asarray(np.mean(found, axis=0)[:2])


def stance_shares(events: Path) -> dict[str, float]:
    """Trial -> share of the cycle from foot strike to the same side's foot off, averaged over sides."""
    times: dict[str, dict[str, dict[str, list[float]]]] = defaultdict(lambda: defaultdict(lambda: defaultdict(list)))
    for row in _rows(events):
        if "schreiber" in row["file"]:
            kind = "strike" if "Strike" in row["label"] else "off"
            times[Path(row["file"]).stem][row["context"]][kind].append(float(row["time_s"]))
    shares: dict[str, float] = {}
    for trial, sides in times.items():
        found = []
        for side in sides.values():
            strikes = sorted(side["strike"])
            offs = [off for off in side["off"] if len(strikes) > 1 and strikes[0] < off < strikes[1]]
            found += [(off - strikes[0]) / (strikes[1] - strikes[0]) for off in offs[:1]]
        if found:
            shares[trial] = float(np.mean(found))
    return shares


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

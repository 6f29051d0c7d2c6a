"""How well the gait model foretells people it has not seen: leave one person out, fit, predict, compare.

`python -m stimuli.fitting.validation --mocap SHARED` prints the error of every signal.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import numpy as np

from stimuli.fitting.captures import Walk
from stimuli.fitting.folder import captures_folder
from stimuli.fitting.gait_model import fit, read_all
from stimuli.gait_model import SIGNALS, Step, basis
from stimuli.skeleton import Floats

ANGLES = {"hip": ("thigh", ""), "knee": ("thigh", "shank"), "ankle": ("foot", "shank")}
"""Sagittal joint angles as the difference of two signals (quality.angles)."""


def left_out_errors(walks: Sequence[Walk], standing: Floats, laboratory: str = "SM") -> dict[str, tuple[float, float]]:
    """Sagittal joint or signal -> (RMS error over the cycle, the same without its mean), for people not fitted to.

    Angles in degrees, shifts in hundredths of the leg length; averaged over the people of one laboratory, whose
    manner is unknown to the model: this is the error of the average walker as a stranger's portrait.
    """
    phases = basis(np.arange(100) / 100)
    totals, changes = [], []
    for person in sorted({walk.person for walk in walks if walk.laboratory == laboratory}):
        model = fit([walk for walk in walks if walk.person != person], standing)
        for walk in (walk for walk in walks if walk.person == person):
            step = Step.of(walk.speed, walk.step_frequency, walk.leg_length)
            missed = walk.coefficients - model.coefficients(step, walk.sex)
            misses = phases @ np.concatenate([[_angle(missed, *pair) for pair in ANGLES.values()], missed]).T
            totals.append(np.sqrt(np.mean(misses**2, axis=0)))
            changes.append(np.std(misses, axis=0))
    names = (*ANGLES, *SIGNALS)
    unit = np.array([100.0 if name.endswith("_shift") else np.degrees(1.0) for name in names])
    found: dict[str, tuple[float, float]] = {}
    for index, name in enumerate(names):
        known = [(total[index], change[index]) for total, change in zip(totals, changes, strict=True)]
        known = [pair for pair in known if np.isfinite(pair[0])]
        if known:
            total, change = np.mean(known, axis=0) * unit[index]
            found[name] = (float(total), float(change))
    return found


def _angle(coefficients: Floats, upper: str, lower: str) -> Floats:
    """(C,) coefficients of one signal, or of what it has more than another."""
    other = coefficients[SIGNALS.index(lower)] if lower else 0.0
    return np.asarray(coefficients[SIGNALS.index(upper)] - other)


def error_lines(errors: dict[str, tuple[float, float]]) -> list[str]:
    """The errors of joints and signals as lines of text."""
    unit = {name: "% of leg length" if name.endswith("_shift") else "degrees" for name in errors}
    return [f"{name:12s} {total:5.1f} {unit[name]}, {c:5.1f} without the mean" for name, (total, c) in errors.items()]


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the errors of every joint and signal."""
    parser = argparse.ArgumentParser(description="Leave-one-person-out errors of the gait model.")
    parser.add_argument("--mocap", type=captures_folder, required=True, help="has mocap/ and gait-tables/")
    walks, standing = read_all(parser.parse_args(arguments).mocap)
    print("\n".join(error_lines(left_out_errors(walks, standing))))


if __name__ == "__main__":
    main()

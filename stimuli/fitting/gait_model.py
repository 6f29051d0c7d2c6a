"""Fits the gait model: `python -m stimuli.fitting.gait_model --mocap SHARED` writes stimuli/data/gait_model.npz.

SHARED holds mocap/bvh/cmu, mocap/c3d/schreiber-moissenet, mocap/REFERENCE_C3D_EVENTS.csv and gait-tables.
The same files give the same coefficients: nothing is drawn at random.

Every Fourier coefficient of every signal is a mixed linear model
    value = b0 + b1 length + b2 cadence + b3 sex + laboratory + person + error
with a random intercept per person (variance ratio PERSON_RATIO) and a small ridge on the slopes. The laboratory term
takes up where the two sources put their zero (the CMU skeletons' rest pose is not a standing pose). Predictions are
those of the gait laboratory, which knows standing, foot strikes and sex; CMU adds slopes, people, neck and head.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from stimuli.fitting import captures, laboratory
from stimuli.fitting.captures import Walk
from stimuli.fitting.folder import captures_folder
from stimuli.gait_model import SIGNALS, GaitModel, Step, basis, shifted
from stimuli.skeleton import Floats

PERSON_RATIO = 3.0  # variance between people over variance between walks of one person
RIDGE = np.array([0.0, 0.02, 0.01, 0.3, 0.0])  # on intercept, length, cadence, sex, laboratory
CAPTURED_MEAN = {"neck_x": 2.2, "head_x": 0.0}
"""deg. Only CMU has neck and head, and its rest pose is no standing pose: the mean neck follows the thorax of Schreiber
& Moissenet (2.2 degrees over the cycle) and the mean head is level. The changes over the cycle are captured."""
KNEE_YAW_SHARE = 0.6
"""Skin movement makes the thigh's captured rotation about its own axis too large (Cappozzo et al. 1996)."""
CALIBRATION_SHARE = 0.4
"""Share of a CMU person's own mean offset that is believed in signals whose zero depends on the rest pose."""
POSED = ("hips_x", "spine_x", "chest_x", "neck_x", "head_x", "thigh", "shank", "foot", "foot_yaw", "knee_yaw")


def read_all(shared: Path) -> tuple[list[Walk], Floats]:
    """Every walk the model is fitted to, CMU brought to the laboratory's heel strike; and the standing posture."""
    measured, standing = laboratory.read_walks(shared)
    cmu = [_registered(walk, measured) for walk in captures.read_walks(shared / "mocap" / "bvh" / "cmu")]
    return cmu + measured, standing


def fit(walks: Sequence[Walk], standing: Floats) -> GaitModel:
    """The model of a set of walks of both laboratories; standing: see laboratory.read_walks."""
    steps = [Step.of(walk.speed, walk.step_frequency, walk.leg_length) for walk in walks]
    lengths = np.array([step.length for step in steps])
    frequencies = np.array([step.frequency for step in steps])
    slope, _ = np.polyfit(lengths, frequencies, 1)
    residuals = frequencies - np.mean(frequencies) - slope * (lengths - np.mean(lengths))
    frame = GaitModel(
        effects=np.zeros((4, 0, 0)),
        offsets=np.zeros((0, 0, 0)),
        people=(),
        stance=np.zeros(4),
        centre=np.array([np.mean(lengths), np.mean(frequencies)]),
        cadence_slope=float(slope),
        cadence_limit=2.0 * float(np.std(residuals)),
        length_range=np.array([lengths.min(), lengths.max()]),
        standing=standing,
    )
    design = np.array(
        [
            [*frame.predictors(step, walk.sex), float(walk.laboratory == "CMU")]
            for step, walk in zip(steps, walks, strict=True)
        ]
    )
    people = tuple(sorted({walk.person for walk in walks}))
    coefficients = np.array([walk.coefficients for walk in walks])
    effects = np.zeros((4, *coefficients.shape[1:]))
    offsets = np.zeros((len(people), *coefficients.shape[1:]))
    for index, name in enumerate(SIGNALS):
        use = [n for n in range(len(walks)) if not np.isnan(coefficients[n, index]).any()]
        both = len({walks[n].laboratory for n in use}) > 1
        columns = [0, 1, 2, 3, 4] if both else [0, 1, 2]
        fixed, own = _mixed_fit(
            design[np.ix_(use, columns)], coefficients[use, index], [walks[n].person for n in use], RIDGE[columns]
        )
        share = KNEE_YAW_SHARE if name == "knee_yaw" else 1.0
        effects[: min(len(columns), 4), index] = share * fixed[:4]
        for row, person in enumerate(people):
            if person in own:
                offsets[row, index] = share * own[person]
                if person.startswith("CMU") and name in POSED:
                    offsets[row, index, 0] *= CALIBRATION_SHARE
        if name in CAPTURED_MEAN:
            effects[0, index, 0] = np.radians(CAPTURED_MEAN[name])
    measured = [n for n, walk in enumerate(walks) if not np.isnan(walk.stance_share)]
    stance, _ = _mixed_fit(
        design[np.ix_(measured, [0, 1, 2, 3])],
        np.array([[walks[n].stance_share] for n in measured]),
        [walks[n].person for n in measured],
        RIDGE[:4],
    )
    return GaitModel(
        effects,
        offsets,
        people,
        stance[:, 0],
        frame.centre,
        frame.cadence_slope,
        frame.cadence_limit,
        frame.length_range,
        standing,
    )


def save(model: GaitModel, path: Path) -> None:
    """Writes the coefficients in single precision, without a time stamp."""
    np.savez_compressed(
        path,
        effects=model.effects.astype(np.float32),
        offsets=model.offsets.astype(np.float32),
        people=np.array(model.people),
        stance=model.stance,
        centre=model.centre,
        cadence_slope=model.cadence_slope,
        cadence_limit=model.cadence_limit,
        length_range=model.length_range,
        standing=model.standing,
    )


def _mixed_fit(design: Floats, values: Floats, people: list[str], ridge: Floats) -> tuple[Floats, dict[str, Floats]]:
    """Generalised least squares with a random intercept per person, and the shrunk intercepts (BLUP).

    design (N, K), values (N, C), ridge (K,) -> effects (K, C), person -> (C,)
    """
    names = sorted(set(people))
    member = np.array([[float(person == name) for name in names] for person in people])
    inverse = np.linalg.inv(np.eye(len(people)) + PERSON_RATIO * member @ member.T)
    effects = np.linalg.solve(design.T @ inverse @ design + np.diag(ridge), design.T @ inverse @ values)
    own = PERSON_RATIO * member.T @ inverse @ (values - design @ effects)
    return effects, dict(zip(names, own, strict=True))


def _registered(walk: Walk, measured: Sequence[Walk]) -> Walk:
    """A CMU walk shifted in phase so that its knee bends when the laboratory's knees do.

    The laboratory's cycles start at the force plate's foot strike; CMU has no plates, and the ankle's furthest
    reach comes some per cent earlier.
    """
    thigh, shank = SIGNALS.index("thigh"), SIGNALS.index("shank")
    phases = np.arange(200) / 200
    reference = np.mean([w.coefficients[thigh] - w.coefficients[shank] for w in measured], axis=0)
    target = basis(phases) @ reference
    candidates = np.arange(-0.06, 0.0601, 0.0025)
    knee = walk.coefficients[thigh] - walk.coefficients[shank]
    errors = [np.std(basis(phases) @ shifted(knee, shift) - target) for shift in candidates]
    best = float(candidates[int(np.argmin(errors))])
    values = {**walk.__dict__, "coefficients": shifted(walk.coefficients, best)}
    return Walk(**values)


def main(arguments: Sequence[str] | None = None) -> None:
    """Fit and write; prints what was used and the leave-one-subject-out errors."""
    parser = argparse.ArgumentParser(description="Fit the gait model to the captures and tables in a folder.")
    parser.add_argument("--mocap", type=captures_folder, required=True, help="has mocap/ and gait-tables/")
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[1] / "data" / "gait_model.npz")
    chosen = parser.parse_args(arguments)
    walks, standing = read_all(chosen.mocap)
    save(fit(walks, standing), chosen.out)
    print(f"{len(walks)} walks of {len({walk.person for walk in walks})} people -> {chosen.out.name}")


if __name__ == "__main__":
    main()

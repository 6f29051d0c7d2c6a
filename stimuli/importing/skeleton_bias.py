"""What the skeletons of one source show differently from markers on the same kind of walk, to be taken off captures.

CMU's skeletons bend the knee by up to 20 degrees where marker-based captures have it nearly straight. The difference
between CMU's walks (28 of 12 people) and those of Schreiber & Moissenet (26 of 13) is the laboratory term of the
gait model's regression (stimuli/fitting/gait_model.py), which holds speed, step frequency and person apart. For a
source of unknown bias nothing is taken off.
"""

from __future__ import annotations

import csv
from functools import cache
from importlib.resources import files

import numpy as np

from stimuli.gait_model import COEFFICIENTS, SIGNALS
from stimuli.skeleton import Floats


@cache
def skeleton_bias(names: str) -> Floats:
    """(S, C) to be subtracted from the coefficients of a capture; names: table of joint names that fitted it."""
    bias = np.zeros((len(SIGNALS), COEFFICIENTS))
    if names == "CMU":
        text = (files("stimuli") / "importing" / "cmu_skeleton.csv").read_text(encoding="utf-8")
        for row in csv.DictReader(text.splitlines()):
            bias[SIGNALS.index(row["signal"])] = [float(row[f"c{index}"]) for index in range(COEFFICIENTS)]
    return bias

"""Walking past somebody whose speed and sway vary (Niay 2022, section 6.2).

    python -m analysis.examples.avoidance trials.csv

Columns: participant, condition, time_to_contact (s), clearance (m), avoidance_rate (m/s).
"""

from __future__ import annotations

import sys

import pandas as pd

from analysis import anova, normality, pairwise
from analysis.apa import anova_sentence

MEASURES = ("time_to_contact", "clearance", "avoidance_rate")


def main(path: str) -> None:
    trials = pd.read_csv(path)
    for measure in MEASURES:
        row = anova(trials, measure, "participant", "condition").iloc[0]
        print(f"{measure}: {anova_sentence(row)}; epsilon {row['epsilon_gg']:.2f}, Mauchly p {row['mauchly_p']:.3f}")
        residuals = normality(trials, measure, "participant", "condition").iloc[0]
        print(f"  residuals: W = {residuals['w']:.3f}, p = {residuals['p']:.3f}")
        pairs = pairwise(trials, measure, "participant", "condition", factors="condition", adjust="holm")
        print(pairs[["a", "b", "estimate", "t", "p"]].to_string(index=False))


if __name__ == "__main__":
    main(sys.argv[1])

"""Walk ratio adjusted for four actors, three speeds and two starts (Niay 2022, chapter 3).

    python -m analysis.examples.walk_ratio trials.csv

trials.csv is what `gaitlab analyse` writes: participant, sex, actor, speed, start, trial, walk_ratio.
"""

from __future__ import annotations

import sys

import pandas as pd

from analysis import anova, assumptions, equivalence, pairwise, t_tests
from analysis.apa import anova_sentence, t_sentence

CAPTURED = {"F1": 0.00690, "F2": 0.00560, "M1": 0.00700, "M2": 0.00700}  # m·min, table 3.4
DESIGN = {"dv": "walk_ratio", "subject": "participant", "within": ["actor", "speed", "start"], "between": "sex"}


def main(path: str) -> None:
    trials = pd.read_csv(path)
    for row in anova(trials, **DESIGN).to_dict("records"):
        print(f"{row['effect']:24} {anova_sentence(row)}")

    print("\nWhich actors differ (Tukey)?")
    print(
        pairwise(trials, **DESIGN, factors="actor")[["a", "b", "estimate", "t", "df", "p", "d_z"]].to_string(
            index=False
        )
    )

    print("\nIs the walk ratio the same at every speed, within 0.0003 m·min?")
    same = equivalence(trials, **DESIGN, factors="speed", bound=0.0003)
    print(same[["a", "b", "estimate", "ci_low", "ci_high", "p", "equivalent"]].to_string(index=False))

    print("\nDo participants recover the captured walk ratio?")
    for row in t_tests(trials, "walk_ratio", "participant", each="actor", against=CAPTURED).to_dict("records"):
        print(f"{row['level']}: mean {row['mean']:.5f}, captured {row['against']:.5f}, {t_sentence(row)}")

    checks = assumptions(trials, **DESIGN, trial="trial", start="start")
    print("\n" + checks[checks["check"].isin(["learning", "anchoring", "outlier"])].to_string(index=False))


if __name__ == "__main__":
    main(sys.argv[1])

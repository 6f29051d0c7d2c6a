"""Which crowd has more unique motions? Percent correct, aligned rank transform (Niay 2022, section 6.1).

    python -m analysis.examples.crowd_variety trials.csv

trials.csv is what `gaitlab analyse` writes for this study: participant, variation (1:2, 1:5, ...), size (250 to 1000),
correct (0 or 1).
"""

from __future__ import annotations

import sys

import pandas as pd

from analysis import art_anova, art_contrasts, proportions, t_tests
from analysis.apa import p_value, t_sentence


def main(path: str) -> None:
    trials = pd.read_csv(path, dtype={"variation": str})
    percent = trials.groupby(["participant", "variation", "size"])["correct"].mean().mul(100).reset_index()
    for row in art_anova(percent, "correct", "participant", ["variation", "size"]).to_dict("records"):
        print(f"{row['effect']:12} F({row['df1']}, {row['df2']}) = {row['F']:.2f}, {p_value(row['p'])}")
    pairs = art_contrasts(
        percent, "correct", "participant", ["variation", "size"], factors="variation", adjust="bonferroni"
    )
    print(pairs[["a", "b", "estimate", "t", "df", "p"]].to_string(index=False))
    for row in t_tests(percent, "correct", "participant", each="variation", against=50).to_dict("records"):
        print(f"{row['level']:5} against chance: {row['mean']:.1f} %, {t_sentence(row)}")
    print(proportions(trials, "correct", by="variation").to_string(index=False))


if __name__ == "__main__":
    main(sys.argv[1])

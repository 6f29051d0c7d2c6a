"""Rebuilt leg movements against captured ones: confusion rate and response time (Niay 2022, chapter 5).

    python -m analysis.examples.poulaine_reconstruction trials.csv

trials.csv is what `gaitlab analyse` writes for this study: participant, sex, points (4, 5), interpolation, actor,
speed, chosen, original, response_time (s).
"""

from __future__ import annotations

import sys

import pandas as pd

from analysis import anova, confusion_rate, pairwise, t_tests
from analysis.apa import anova_sentence, t_sentence

WITHIN = ["points", "interpolation", "actor", "speed"]


def main(path: str) -> None:
    trials = pd.read_csv(path)
    rates = confusion_rate(trials, "chosen", "original", ["participant", "sex", *WITHIN])
    for measure, data in (("confusion_rate", rates), ("response_time", trials)):
        print(f"\n{measure}")
        table = anova(data, measure, "participant", WITHIN, "sex")
        for row in table[~table["effect"].str.contains(":")].to_dict("records"):
            print(f"  {row['effect']:16} {anova_sentence(row)}")
    pairs = pairwise(rates, "confusion_rate", "participant", WITHIN, "sex", factors="interpolation")
    print(pairs[["a", "b", "estimate", "t", "p"]].to_string(index=False))
    for row in t_tests(rates, "confusion_rate", "participant", each="points", against=50).to_dict("records"):
        print(f"{row['level']} points against 50 %: mean {row['mean']:.1f} %, {t_sentence(row)}")


if __name__ == "__main__":
    main(sys.argv[1])

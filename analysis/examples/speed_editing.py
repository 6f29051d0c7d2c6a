"""Walks edited to another speed against captured ones: confusion rate and response time (Niay 2022, section 5.3).

    python -m analysis.examples.speed_editing trials.csv

Columns: participant, gender, method (poulaine, blending, warping), direction (slowed, sped_up), actor, speed, side,
chosen, original, response_time (s).
"""

from __future__ import annotations

import sys

import pandas as pd

from analysis import anova, confusion_rate, equivalence, pairwise, proportions, t_tests
from analysis.apa import anova_sentence, t_sentence

WITHIN = ["method", "direction", "actor", "speed"]


def main(path: str) -> None:
    trials = pd.read_csv(path)
    rates = confusion_rate(trials, "chosen", "original", ["participant", "gender", *WITHIN])
    for measure, data in (("confusion_rate", rates), ("response_time", trials)):
        print(f"\n{measure}")
        table = anova(data, measure, "participant", WITHIN, "gender")
        for row in table[~table["effect"].str.contains(":")].to_dict("records"):
            print(f"  {row['effect']:16} {anova_sentence(row)}")
    pairs = pairwise(rates, "confusion_rate", "participant", WITHIN, "gender", factors="method")
    print(pairs[["a", "b", "estimate", "t", "p"]].to_string(index=False))
    same = equivalence(rates, "confusion_rate", "participant", WITHIN, "gender", factors="method", bound=10)
    print("Within 10 points of each other:", ", ".join(same.loc[same["equivalent"], "a"] + "/" + same["b"]) or "none")
    for row in t_tests(rates, "confusion_rate", "participant", each="method", against=50).to_dict("records"):
        print(f"{row['level']} against 50 %: mean {row['mean']:.1f} %, {t_sentence(row)}")
    confused = trials.assign(confused=(trials["chosen"] != trials["original"]).astype(int))
    print(proportions(confused, "confused", by="side", chance=0.5).to_string(index=False))


if __name__ == "__main__":
    main(sys.argv[1])

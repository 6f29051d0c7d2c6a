"""Walks edited to another speed against captured ones: confusion rate and response time (Niay 2022, section 5.3).

    python -m analysis.examples.speed_editing trials.csv

trials.csv is what `gaitlab analyse` writes for this study: participant, sex, method (poulaine, blend, timewarp),
direction (slowed_down, sped_up), actor, speed, side (of what was chosen), chosen, original, response_time (s).
"""

from __future__ import annotations

import sys

import pandas as pd

from analysis import anova, confusion_rate, equivalence, pairwise, proportions, t_tests
from analysis.apa import anova_sentence, t_sentence

WITHIN = ["method", "direction", "actor", "speed"]


def main(path: str) -> None:
    trials = pd.read_csv(path)
    rates = confusion_rate(trials, "chosen", "original", ["participant", "sex", *WITHIN])
    for measure, data in (("confusion_rate", rates), ("response_time", trials)):
        print(f"\n{measure}")
        table = anova(data, measure, "participant", WITHIN, "sex")
        for row in table[~table["effect"].str.contains(":")].to_dict("records"):
            print(f"  {row['effect']:16} {anova_sentence(row)}")
    pairs = pairwise(rates, "confusion_rate", "participant", WITHIN, "sex", factors="method")
    print(pairs[["a", "b", "estimate", "t", "p"]].to_string(index=False))
    same = equivalence(rates, "confusion_rate", "participant", WITHIN, "sex", factors="method", bound=10)
    near = same[same["equivalent"]]
    print("Within 10 points of each other:", ", ".join(near["a"] + "/" + near["b"]) or "none")
    for row in t_tests(rates, "confusion_rate", "participant", each="method", against=50).to_dict("records"):
        print(f"{row['level']} against 50 %: mean {row['mean']:.1f} %, {t_sentence(row)}")
    confused = trials.assign(confused=(trials["chosen"] != trials["original"]).astype(int))
    print(proportions(confused, "confused", by="side", chance=0.5).to_string(index=False))


if __name__ == "__main__":
    main(sys.argv[1])

"""Sixteen actors on matched and mismatched bodies, absolute and normalised walk ratio (Niay 2022, chapter 4).

    python -m analysis.examples.walk_ratio_actors trials.csv

Columns: participant, participant_gender, viewing, actor, actor_sex, character (matched, mismatched),
height (m), weight (kg), speed (m/s), step_length (m), step_frequency (steps/min).
"""

from __future__ import annotations

import sys

import pandas as pd

from analysis import anova, mixed_model, normalised_gait, pairwise, regression
from analysis.apa import anova_sentence

WITHIN, BETWEEN = ["actor_sex", "character"], ["viewing", "participant_gender"]


def main(path: str) -> None:
    trials = pd.read_csv(path)
    trials["walk_ratio"] = trials["step_length"] / trials["step_frequency"]
    trials["walk_ratio_n"] = normalised_gait(trials, "height")["walk_ratio_n"]
    for measure in ("walk_ratio", "walk_ratio_n"):
        print(f"\n{measure}")
        for row in anova(trials, measure, "participant", WITHIN, BETWEEN).to_dict("records"):
            print(f"  {row['effect']:40} {anova_sentence(row)}")
        pairs = pairwise(trials, measure, "participant", WITHIN, BETWEEN, factors=WITHIN)
        print(pairs[["a", "b", "estimate", "t", "df", "p"]].to_string(index=False))

    actors = trials.groupby("actor")[["walk_ratio", "height", "weight", "speed"]].mean()
    table = regression(actors, "walk_ratio", ["height", "weight", "speed"])
    fit = table.attrs["fit"]
    print(f"\nR² = {fit['r2']:.3f}, adjusted {fit['r2_adjusted']:.3f}, F({fit['df1']}, {fit['df2']}) = {fit['F']:.1f}")
    print(table[["term", "beta", "t", "p", "vif"]].to_string(index=False))

    print("\nActors as a sample of all actors:")
    model = mixed_model(trials, "walk_ratio", "participant", "actor", ["actor_sex", "character"])
    print(model[model["part"] == "effect"][["term", "df1", "df2", "statistic", "p"]].to_string(index=False))


if __name__ == "__main__":
    main(sys.argv[1])

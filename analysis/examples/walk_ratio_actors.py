"""Sixteen actors on matched and mismatched bodies, absolute and normalised walk ratio (Niay 2022, chapter 4).

    python -m analysis.examples.walk_ratio_actors trials.csv

trials.csv is what `gaitlab analyse` writes for this study: participant, participant_gender, viewing, actor, actor_sex,
character (matched, mismatched), step_length (m), step_frequency (steps/min). Height (m), weight (kg) and comfortable
speed (m/s) of the actors are in the study file.
"""

from __future__ import annotations

import sys

import pandas as pd

from analysis import anova, mixed_model, normalised_gait, pairwise, regression
from analysis.apa import anova_sentence
from analysis.planned.plan import read_plan
from protocols.study_file import read_study

WITHIN, BETWEEN = ["actor_sex", "character"], ["viewing", "participant_gender"]


def main(path: str) -> None:
    known = read_plan(read_study("walk_ratio_actors").text, "walk_ratio_actors.yaml").regression
    assert known is not None
    trials = pd.read_csv(path)
    for name, by_actor in known.on.items():
        trials[name] = trials["actor"].map(by_actor)
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

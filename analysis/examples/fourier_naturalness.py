"""Naturalness of Fourier walks, rated 0 to 4: mean with limits per style (Tilmanne & Dutoit).

    python -m analysis.examples.fourier_naturalness trials.csv

trials.csv is what `gaitlab analyse` writes for this study: participant, style, rating. Raters who saw different pairs
are welcome: nobody is left out.
"""

from __future__ import annotations

import sys

import pandas as pd

from analysis import mixed_model
from analysis.statistics.intervals import ordinary


def main(path: str) -> None:
    ratings = pd.read_csv(path)
    for style, part in ratings.groupby("style"):
        raters = part.groupby("participant")["rating"].mean().to_numpy()
        half = ordinary(raters[:, None])[0]
        print(
            f"{style:12} {raters.mean():.2f} [{raters.mean() - half:.2f}, "
            f"{raters.mean() + half:.2f}], n = {len(raters)}"
        )
    model = mixed_model(ratings, "rating", "participant", "style")
    print(model[model["part"] == "deviation"][["term", "estimate", "share"]].to_string(index=False))


if __name__ == "__main__":
    main(sys.argv[1])

"""Assumption checks agree with R; measures follow their definitions."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from analysis import AnalysisError, assumptions, confusion_rate, gaze_shares, normalised_gait, quantiles, walk_ratio
from tests.analysis.reference import arguments, expected, table


@pytest.mark.parametrize("name", ["01_mixed_4x3x2_sex", "06_unbalanced_3x2_between_3x2", "02_mixed_2x2_2x2"])
def test_levene_in_every_within_cell_is_rs(name: str) -> None:
    reference = expected(name)
    mine = assumptions(table(name, reference["design"]), **arguments(reference["design"]))
    rows = {(row["check"], row["where"]): row for row in mine.to_dict("records")}
    for wanted in reference["levene_per_within_cell"]:
        where = " × ".join(wanted["levels"][f] for f in reference["design"]["within"])
        for centre in ("mean", "median"):
            row = rows[f"Levene ({centre})", where]
            assert (row["df1"], row["df2"]) == (wanted["df1"], wanted["df2"])
            assert row["statistic"] == pytest.approx(wanted[f"F_{centre}"], rel=1e-8)
            assert row["p"] == pytest.approx(wanted[f"p_{centre}"], rel=1e-8)


def adjustments(anchoring: float, learning: float) -> pd.DataFrame:
    rng = np.random.default_rng(11)
    rows = []
    for person in range(14):
        conditions = [(a, s) for a in ("F1", "M1") for s in (80, 120)] * 6
        for trial, index in enumerate(rng.permutation(len(conditions)), start=1):
            actor, start = conditions[index]
            y = 100 + anchoring * (start - 100) + learning * trial + rng.normal(0, 1)
            rows.append((person, actor, start, trial, y))
    return pd.DataFrame(rows, columns=["who", "actor", "start", "trial", "y"])


def test_anchoring_and_learning_are_found_when_there_and_not_otherwise() -> None:
    def checks(data: pd.DataFrame) -> pd.DataFrame:
        found = assumptions(data, "y", "who", ["actor", "start"], trial="trial", start="start")
        return found.set_index("check").loc[["learning", "anchoring"]]

    there = checks(adjustments(0.1, 0.1))
    assert (there["p"] < 0.001).all()
    assert "4" in there.loc["anchoring", "note"]
    assert (checks(adjustments(0.0, 0.0))["p"] > 0.01).all()


def test_an_outlying_cell_is_named() -> None:
    data = adjustments(0.0, 0.0)
    data.loc[(data["who"] == 3) & (data["actor"] == "M1") & (data["start"] == 80), "y"] += 50
    found = assumptions(data, "y", "who", ["actor", "start"])
    assert found.loc[found["check"] == "outlier", "where"].to_list() == ["3 × M1 × 80"]


def test_quantiles_of_a_normal_sample_lie_on_the_diagonal() -> None:
    pairs = quantiles(np.random.default_rng(0).normal(3, 2, 4000))
    assert np.corrcoef(pairs["theoretical"], pairs["ordered"])[0, 1] > 0.999


def test_walk_ratios_absolute_and_normalised() -> None:
    data = pd.DataFrame({"step_length": [0.6], "step_frequency": [100.0], "height": [1.8]})
    assert walk_ratio(data)[0] == pytest.approx(0.006)
    mine = normalised_gait(data, "height").iloc[0]
    assert mine["step_length_n"] == pytest.approx(0.6 / 1.8)
    assert mine["step_frequency_n"] == pytest.approx((100 / 60) / np.sqrt(9.81 / 1.8))
    assert mine["speed_n"] == pytest.approx((0.6 * 100 / 60) / np.sqrt(9.81 * 1.8))
    with pytest.raises(AnalysisError, match="in metres"):
        normalised_gait(data.assign(height=180.0), "height")


def test_confusion_and_gaze() -> None:
    choices = pd.DataFrame({"who": ["a"] * 4, "chosen": ["copy", "real", "real", "copy"], "original": ["real"] * 4})
    assert confusion_rate(choices, "chosen", "original", "who")["confusion_rate"][0] == 50
    frames = pd.DataFrame({"who": ["a", "a", "a", "b"], "part": ["legs", "legs", "head", "legs"]})
    shares = gaze_shares(frames, "who", "part").set_index(["who", "part"])["share"]
    assert shares["a", "legs"] == pytest.approx(200 / 3)
    assert shares["b", "head"] == 0
    assert shares.groupby("who").sum().to_list() == pytest.approx([100, 100])

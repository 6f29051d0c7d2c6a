"""Crossed random effects agree with R's lme4 and lmerTest."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from analysis import mixed_model
from tests.analysis.reference import expected, table


@pytest.fixture(scope="module")
def fitted() -> tuple[dict, pd.DataFrame]:
    reference = expected("16_crossed_lmm")
    design = reference["design"]
    data = table("16_crossed_lmm", design)
    levels = {**design["within"], **design["between"]}
    return reference, mixed_model(data, "ratio", "id", "actor", ["speed", "sex"], levels=levels)


def test_fixed_effects_and_their_satterthwaite_df(fitted: tuple[dict, pd.DataFrame]) -> None:
    reference, mine = fitted
    rows = mine[mine["part"] == "coefficient"].to_dict("records")
    for row, wanted in zip(rows, reference["fixed"], strict=True):
        assert row["estimate"] == pytest.approx(wanted["estimate"], rel=1e-4), wanted["term"]
        assert row["se"] == pytest.approx(wanted["se"], rel=1e-3)
        assert row["df2"] == pytest.approx(wanted["df_satterthwaite"], rel=1e-3)
        assert row["p"] == pytest.approx(wanted["p"], rel=5e-3)


def test_type_three_tests(fitted: tuple[dict, pd.DataFrame]) -> None:
    reference, mine = fitted
    rows = mine[mine["part"] == "effect"].to_dict("records")
    for row, wanted in zip(rows, reference["anova_type3"], strict=True):
        assert (row["term"], row["df1"]) == (wanted["effect"], wanted["df_num"])
        assert row["df2"] == pytest.approx(wanted["df_den_satterthwaite"], rel=1e-3)
        assert row["statistic"] == pytest.approx(wanted["F"], rel=1e-4)


def test_variances_and_the_reml_criterion(fitted: tuple[dict, pd.DataFrame]) -> None:
    reference, mine = fitted
    rows = mine[mine["part"] == "deviation"].to_dict("records")
    for row, wanted in zip(rows, reference["variance_components"], strict=True):
        assert row["estimate"] == pytest.approx(wanted["sd"], rel=1e-3)
    assert mine.attrs["reml"] == pytest.approx(reference["reml_criterion"], abs=1e-4)
    assert sum(row["share"] for row in rows) == pytest.approx(1)


def test_few_stimuli_are_mentioned_and_a_zero_variance_is_held_there() -> None:
    rng = np.random.default_rng(4)
    rows = [(p, a, s) for p in range(8) for a in "ABCD" for s in ("slow", "fast")]
    data = pd.DataFrame(rows, columns=["who", "actor", "speed"])
    data["y"] = rng.normal(size=len(data)) + data["who"] * 0.8 - 0.2 * data.groupby(["actor"])["who"].transform("mean")
    result = mixed_model(data, "y", "who", "actor", "speed")
    assert any("only 4 levels of 'actor'" in note for note in result.attrs["notes"])
    assert np.isfinite(result.loc[result["part"] == "effect", "p"]).all()

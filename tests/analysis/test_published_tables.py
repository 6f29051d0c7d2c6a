"""The published tables, recomputed from what they print; disagreements are listed in docs/published.md."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest
from scipy import stats

from analysis import partial_eta_squared, t_tests_from_summary

PUBLISHED = Path(__file__).parents[2].parent / "shared" / "studies" / "published"


def published(name: str) -> pd.DataFrame:
    path = PUBLISHED / f"{name}.csv"
    if not path.is_file():
        pytest.skip(f"{name}.csv is not in ../shared/studies/published")
    return pd.read_csv(path, comment="#", dtype={"p": str})


def rounding(printed: str) -> float:
    """Half a unit of the last printed digit."""
    return 0.5 * 10.0 ** -len(printed.partition(".")[2])


@pytest.mark.parametrize("name", ["walk_ratio_anova", "walk_ratio_actors_anova", "poulaine_anova"])
def test_every_partial_eta_squared_follows_from_f_and_df(name: str) -> None:
    table = published(name).dropna(subset=["df1"])
    assert len(table) >= 9
    for row in table.itertuples():
        assert partial_eta_squared(row.F, row.df1, row.df2) == pytest.approx(row.eta_p2, abs=6e-4), row.effect


@pytest.mark.parametrize("name", ["walk_ratio_anova", "walk_ratio_actors_anova", "poulaine_anova"])
def test_every_p_follows_from_f_and_the_uncorrected_df(name: str) -> None:
    for row in published(name).dropna(subset=["df1"]).itertuples():
        p = stats.f.sf(row.F, row.df1, row.df2)
        if row.p.startswith("<"):
            assert p < float(row.p[1:]), row.effect
            continue
        slack = 0.5 * 10.0 ** -len(str(row.F).partition(".")[2])
        possible = [stats.f.sf(max(row.F + d, 0), row.df1, row.df2) for d in (slack, -slack)]
        off = rounding(row.p)
        assert possible[0] - off <= float(row.p) <= possible[1] + off, (row.effect, p)


def test_the_p_values_of_table_3_3_are_not_greenhouse_geisser_corrected() -> None:
    # With epsilon = .9 the printed p of actor x sex and of speed x start x sex would already be another.
    table = published("walk_ratio_anova").set_index("effect")
    for effect in ("actor:sex", "speed:start:sex"):
        row = table.loc[effect]
        corrected = stats.f.sf(row["F"], 0.9 * row["df1"], 0.9 * row["df2"])
        assert abs(corrected - float(row["p"])) > rounding(row["p"])


def test_table_3_4_follows_from_means_standard_deviations_and_n() -> None:
    table = published("walk_ratio_ttests").rename(columns={"captured": "against", "estimated": "mean"})
    result = t_tests_from_summary(table.drop(columns="p").assign(n=22))
    for row, printed in zip(result.itertuples(), table["p"], strict=True):
        if printed.startswith("<"):
            assert row.p < float(printed[1:])
        else:
            assert row.p == pytest.approx(float(printed), abs=rounding(printed))
    assert result["t"].to_list() == pytest.approx([-8.44, 2.65, -3.86, -3.96], abs=0.005)


def test_table_5_4_prints_effect_sizes_of_twelve_error_df() -> None:
    # "averaged over 20 motion clips" would give 19 and 38 error df; the printed numbers do not.
    table = published("poulaine_anova").query("measure == 'rmse'").set_index("effect")
    for effect, df1 in (("points", 1), ("interpolation", 2), ("points:interpolation", 2)):
        row = table.loc[effect]
        assert partial_eta_squared(row["F"], df1, 12) == pytest.approx(row["eta_p2"], abs=7e-4)
        p = stats.f.sf(row["F"], df1, 12)
        assert p < 0.001 if row["p"].startswith("<") else p == pytest.approx(float(row["p"]), abs=6e-4)
        repeated = partial_eta_squared(row["F"], df1, 19 * df1)
        assert abs(repeated - row["eta_p2"]) > 0.01


def test_the_crowd_study_pooled_its_error_as_artools_mixed_model_does() -> None:
    table = published("crowd_variety").set_index("statistic")
    row = table.loc["variation_ratio_F(4;266)"]
    assert stats.f.sf(float(row["value"]), 4, 266) == pytest.approx(float(row["p"]), abs=5e-5)
    assert (20 - 1) * (5 * 3 - 1) == 266
    t = table.loc["ratio_1_vs_chance_t"]
    assert 2 * stats.t.sf(float(t["value"]), 19) == pytest.approx(float(t["p"]), abs=1e-4)  # .03927, printed .0392


def test_the_regression_of_chapter_4_hangs_together() -> None:
    r2, n, k = 0.725, 16, 3
    assert 1 - (1 - r2) * (n - 1) / (n - k - 1) == pytest.approx(0.656, abs=5e-4)
    assert r2 / k / ((1 - r2) / (n - k - 1)) == pytest.approx(10.6, abs=0.06)
    for t, p in ((1.269, 0.228), (-0.441, 0.667)):
        assert 2 * stats.t.sf(abs(t), 12) == pytest.approx(p, abs=6e-4)
    assert 2 * stats.t.sf(5.542, 12) < 0.001
    assert stats.f.sf(10.6, 3, 12) > 0.001  # printed p < .001


def test_gaze_shares_add_up_to_all_of_the_time() -> None:
    assert published("gaze_shares")["percent"].sum() == pytest.approx(100.0)


@pytest.mark.parametrize(
    ("name", "predictors"), [("poulaine_regression_raw", 5), ("poulaine_regression_normalised", 4)]
)
def test_the_p_values_of_the_poulaine_regressions_fit_their_adjusted_r2(name: str, predictors: int) -> None:
    n = 135
    for row in published(name).query("adj_r2 != 'NS'").dropna(subset=["adj_r2"]).itertuples():
        low, high = float(row.adj_r2) - 0.005, float(row.adj_r2) + 0.005

        def p(adjusted: float) -> float:
            r2 = 1 - (1 - adjusted) * (n - predictors - 1) / (n - 1)
            return float(
                stats.f.sf(r2 / predictors / ((1 - r2) / (n - predictors - 1)), predictors, n - predictors - 1)
            )

        if row.p.startswith("<"):
            assert p(low) < float(row.p[1:])
        else:
            assert p(high) - 5e-4 <= float(row.p) <= p(low) + 5e-4

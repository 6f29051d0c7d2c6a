"""Regression, power, equivalence, psychometric functions and proportions agree with R and with print."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from analysis import (
    AnalysisError,
    anova,
    d_prime,
    d_prime_forced_choice,
    equivalence,
    equivalence_of_effects,
    power_regression,
    power_rm_anova,
    power_t_test,
    proportions,
    psychometric,
    regression,
    regression_diagnostics,
)
from tests.analysis.reference import expected, path


def test_regression_gives_rs_coefficients_and_fit() -> None:
    reference = expected("14_regression_16")
    data = pd.read_csv(path("14_regression_16.csv"))
    mine = regression(data, reference["y"], reference["x"])
    for row, wanted in zip(mine.to_dict("records"), reference["coefficients"], strict=True):
        keys = {"estimate": "estimate", "se": "se", "t": "t", "p": "p"}
        if wanted["term"] != "(Intercept)":
            keys |= {"beta": "std_estimate", "vif": "vif", "ss": "ss_type3"}
        for column, key in keys.items():
            assert row[column] == pytest.approx(wanted[key], rel=1e-8), (wanted["term"], column)
        assert (row["ci_low"], row["ci_high"]) == pytest.approx(wanted["ci95"], rel=1e-8)
    fit = mine.attrs["fit"]
    for key, name in {
        "r2": "r2", "r2_adjusted": "r2_adj", "rmse": "rmse_jamovi", "residual_se": "residual_standard_error",
        "F": "F", "p": "p", "aic": "aic", "bic": "bic", "log_likelihood": "loglik",
        "durbin_watson": "durbin_watson", "loo_rmse": "loo_rmse",
    }.items():  # fmt: skip
        assert fit[key] == pytest.approx(reference[name], rel=1e-8), key
    assert fit["shapiro_w"] == pytest.approx(reference["shapiro_W"], abs=1e-6)


def test_regression_diagnostics_are_those_of_r() -> None:
    reference = expected("14_regression_16")
    mine = regression_diagnostics(pd.read_csv(path("14_regression_16.csv")), reference["y"], reference["x"])
    for column, key in {
        "leverage": "leverage",
        "cooks_distance": "cooks_distance",
        "fitted": "fitted",
    }.items():
        assert mine[column].to_list() == pytest.approx(reference[key], rel=1e-8)


def test_standardised_limits_are_those_of_the_standardised_fit() -> None:
    reference = expected("14_regression_16")
    mine = regression(pd.read_csv(path("14_regression_16.csv")), reference["y"], reference["x"])
    wanted = reference["coefficients"][1]["std_ci95"]
    assert (mine["beta_low"][1], mine["beta_high"][1]) == pytest.approx(wanted, rel=1e-8)


def test_a_predictor_that_follows_from_others_is_named() -> None:
    data = pd.DataFrame({"y": [1.0, 2, 4, 3, 6], "a": [1.0, 2, 3, 4, 5], "b": [2.0, 4, 6, 8, 10]})
    with pytest.raises(AnalysisError, match="a and b are linearly dependent"):
        regression(data, "y", ["a", "b"])
    with pytest.raises(AnalysisError, match="too few"):
        regression(data[:2], "y", "a")


def test_labels_become_columns_of_zero_and_one() -> None:
    rng = np.random.default_rng(1)
    data = pd.DataFrame({"y": rng.normal(size=20), "sex": ["f", "m"] * 10})
    mine = regression(data, "y", "sex")
    t = stats.ttest_ind(data.loc[data["sex"] == "m", "y"], data.loc[data["sex"] == "f", "y"])
    assert mine["term"].to_list() == ["(intercept)", "sex[m]"]
    assert (mine["t"][1], mine["p"][1]) == pytest.approx((t.statistic, t.pvalue), rel=1e-9)


POWER = list(expected("15_power")["cases"])


@pytest.mark.parametrize("case", POWER, ids=lambda c: f"{c['type']}-{c.get('convention', '')}-{c['power']:.3f}")
def test_power_in_every_convention(case: dict[str, Any]) -> None:
    if case["type"] in ("within", "between", "interaction"):
        row = power_rm_anova(
            effect=case["type"], measures=case["measures"], n=case["n_total"], f=case["f"],
            groups=case["groups"], rho=case["rho"], epsilon=case["epsilon"],
            alpha=case["alpha"], convention=case["convention"],
        ).iloc[0]  # fmt: skip
        assert row["lambda_"] == pytest.approx(case["lambda"], abs=1e-7)
    elif case["type"] == "regression_r2_increase":
        row = power_regression(case["f2"], case["n_total"], case["predictors"], case["tested"]).iloc[0]
    else:
        row = power_t_test(case["d"], case["n"], case["n2"], case["alpha"], case["tails"]).iloc[0]
    assert row["power"] == pytest.approx(case["power"], abs=1e-7)


def test_published_power_listings_to_their_printed_digits() -> None:
    for case in expected("15_power")["published"]:
        row = power_rm_anova(
            effect=case["type"], measures=case["measures"], n=case["n_total"], f=case["f"],
            groups=case["groups"], rho=case["rho"], epsilon=case["epsilon"], convention=case["convention"],
        ).iloc[0]  # fmt: skip
        assert row["power"] == pytest.approx(case["computed"]["power"], abs=1e-7)
        if "power" in case["published"]:
            digits = len(str(case["published"]["power"])) - 2
            assert row["power"] == pytest.approx(case["published"]["power"], abs=0.51 * 10**-digits)


def test_the_three_conventions_need_33_95_and_185_participants() -> None:
    wanted = expected("15_power")["min_n"]["published_min_n"]
    for convention, n in wanted.items():
        row = power_rm_anova(effect="within", measures=3, eta_p2=0.05, power=0.8, convention=convention).iloc[0]
        assert row["n"] == n


def test_counting_the_correlation_twice_is_warned_of() -> None:
    options: dict[str, Any] = {"effect": "within", "measures": 3, "n": 22, "eta_p2": 0.14, "groups": 2}
    inflated = power_rm_anova(**options, convention="gpower_default")
    assert inflated["power"][0] == pytest.approx(0.98, abs=0.005)
    assert any("counted twice" in note for note in inflated.attrs["notes"])
    honest = power_rm_anova(**options)
    assert honest["power"][0] == pytest.approx(0.59, abs=0.005)
    assert any("p value" in note for note in honest.attrs["notes"])


def test_the_smallest_effect_a_study_could_find() -> None:
    row = power_rm_anova(effect="within", measures=3, n=22, groups=2, power=0.8).iloc[0]
    again = power_rm_anova(effect="within", measures=3, n=22, groups=2, f=row["f"]).iloc[0]
    assert again["power"] == pytest.approx(0.8, abs=1e-6)


def test_equivalence_of_pairs_is_rs_tost() -> None:
    reference = expected("13_accuracy_chance")
    wide = pd.read_csv(path("13_accuracy_chance.csv"))
    data = wide.melt(["id", "sex"], ["cond1", "cond2", "cond3", "cond4"], "condition", "accuracy")
    mine = equivalence(data, "accuracy", "id", "condition", factors="condition", bound=reference["tost_bound"])
    for row, paired in zip(mine.to_dict("records"), reference["paired"], strict=True):
        wanted = paired["tost"]
        for column, key in {
            "t_lower": "t_lower",
            "p_lower": "p_lower",
            "p_upper": "p_upper",
            "p": "p_tost",
        }.items():
            assert row[column] == pytest.approx(wanted[key], rel=1e-8)
        assert (row["ci_low"], row["ci_high"]) == pytest.approx(wanted["ci90"], rel=1e-8)
        assert row["equivalent"] == (wanted["p_tost"] < 0.05)
        assert row["equivalent"] == (row["ci_low"] > -5 and row["ci_high"] < 5)


def test_a_negligible_effect_by_the_noncentral_f() -> None:
    rng = np.random.default_rng(2)
    rows = [(p, s, rng.normal()) for p in range(200) for s in "abc"]
    table = anova(pd.DataFrame(rows, columns=["who", "s", "y"]), "y", "who", "s")
    assert equivalence_of_effects(table, 0.10)["equivalent"][0]
    assert not equivalence_of_effects(table, 0.0005)["equivalent"][0]


@pytest.mark.parametrize(("shape", "link", "tolerance"), [("logistic", "logit", 1e-8), ("normal", "probit", 1e-6)])
def test_psychometric_functions_are_rs_binomial_models(shape: str, link: str, tolerance: float) -> None:
    reference = expected("17_psychometric")
    data = pd.read_csv(path("17_psychometric.csv"))
    pooled = psychometric(data, "level", "k", "n", shape=shape)
    each = psychometric(data, "level", "k", "n", by="id", shape=shape)
    wanted = [reference["pooled"][link], *(p[link] for p in reference["per_participant"])]
    for row, one in zip([pooled.iloc[0], *(r for _, r in each.iterrows())], wanted, strict=True):
        for column, key in {"intercept": "intercept", "slope": "slope", "threshold": "pse",
                                "jnd": "jnd_75",
                            "threshold_se": "pse_se_delta"}.items():  # fmt: skip
            # R's standard errors come from the weights one step before convergence: equal to 2e-5 only.
            assert row[column] == pytest.approx(one[key], rel=5e-5 if "se" in key else tolerance)


def test_lapses_and_guesses_are_recovered_and_limits_repeat() -> None:
    rng = np.random.default_rng(8)
    x = np.linspace(-2, 2, 9)
    p = 0.5 + (0.5 - 0.04) * stats.norm.cdf((x - 0.3) / 0.5)
    data = pd.DataFrame({"x": x, "k": rng.binomial(400, p), "n": 400})
    options: dict[str, Any] = {"shape": "normal", "guess": 0.5, "lapse": None, "bootstrap": 60}
    row = psychometric(data, "x", "k", "n", **options).iloc[0]
    assert row["threshold"] == pytest.approx(0.3, abs=0.08)
    assert row["lapse"] == pytest.approx(0.04, abs=0.02)
    assert row["threshold_low"] < row["threshold"] < row["threshold_high"]
    again = psychometric(data, "x", "k", "n", **options).iloc[0]
    assert row["threshold_low"] == again["threshold_low"]


def test_a_perfect_step_has_no_function() -> None:
    data = pd.DataFrame({"x": [1, 2, 3, 4], "k": [0, 0, 5, 5], "n": 5})
    mine = psychometric(data, "x", "k", "n")
    assert math.isnan(mine["threshold"][0])
    assert "no gradual rise" in mine.attrs["notes"][0] or "form no gradual" in mine.attrs["notes"][0]


@pytest.mark.parametrize("yes", [4, 5])
def test_somebody_who_says_yes_as_often_at_every_level_has_no_threshold(yes: int) -> None:
    data = pd.DataFrame({"x": [1, 2, 3], "k": [yes] * 3, "n": [10] * 3})
    table = psychometric(data, "x", "k", "n")
    assert table["threshold"].isna().all()
    assert "no gradual rise or fall" in table.attrs["notes"][0]


def test_samples_without_a_slope_do_not_stop_the_limits_of_somebody_who_nearly_guesses() -> None:
    data = pd.DataFrame({"x": [1, 2, 3], "k": [5, 5, 6], "n": [10] * 3})
    row = psychometric(data, "x", "k", "n", bootstrap=500).iloc[0]
    assert row["slope_low"] < row["slope"] < row["slope_high"]


@pytest.mark.parametrize(
    ("effect", "measures", "groups", "needs"),
    [("between", 1, 1, "groups"), ("within", 1, 2, "measures"), ("interaction", 3, 1, "groups")],
)
def test_what_an_effect_lacks_is_named(effect: str, measures: int, groups: int, needs: str) -> None:
    with pytest.raises(AnalysisError, match=f"A {effect} effect needs two or more {needs}"):
        power_rm_anova(effect=effect, measures=measures, groups=groups, f=0.25, n=20)


def test_wilson_limits_of_newcombe_1998() -> None:
    # Newcombe 1998, table I: 81/263 Wilson .2553-.3662, exact .2527-.3676; 0/20 Wilson 0-.1611.
    data = pd.DataFrame({"k": [81, 0], "n": [263, 20], "case": ["a", "b"]})
    mine = proportions(data, "k", "n", by="case")
    assert (mine["wilson_low"][0], mine["wilson_high"][0]) == pytest.approx((0.2553, 0.3662), abs=5e-5)
    assert (mine["exact_low"][0], mine["exact_high"][0]) == pytest.approx((0.2527, 0.3676), abs=5e-5)
    assert mine["wilson_high"][1] == pytest.approx(0.1611, abs=5e-5)


def test_d_prime_of_counts_and_of_forced_choice() -> None:
    counts = {(1, 1): 80, (1, 0): 20, (0, 1): 30, (0, 0): 70}
    rows = [pair for pair, times in counts.items() for _ in range(times)]
    row = d_prime(pd.DataFrame(rows, columns=["signal", "yes"]), "signal", "yes").iloc[0]
    h, f = 80.5 / 101, 30.5 / 101
    assert row["d_prime"] == pytest.approx(stats.norm.ppf(h) - stats.norm.ppf(f), rel=1e-12)
    assert row["criterion"] < 0
    # Macmillan & Creelman, table A5.7 (m-AFC): p = .80 gives d' = 1.19 for 2 and 1.65 for 3 alternatives.
    assert d_prime_forced_choice(0.8, 2)[0] == pytest.approx(1.19, abs=0.005)
    assert d_prime_forced_choice(0.8, 3)[0] == pytest.approx(1.65, abs=0.01)
    assert d_prime_forced_choice(0.25, 4)[0] == pytest.approx(0.0, abs=1e-6)

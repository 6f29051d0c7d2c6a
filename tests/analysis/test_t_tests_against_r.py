"""t tests, effect sizes, Bayes factors and normality agree with R; published tests are recomputed."""

from __future__ import annotations

from typing import Any

import pandas as pd
import pytest

from analysis import normality, t_tests, t_tests_from_summary
from analysis.statistics.bayes_factor import jzs
from analysis.statistics.effect_size import HUGE, t_noncentrality_limits
from tests.analysis.reference import arguments, expected, path, table

CONDITIONS = ["cond1", "cond2", "cond3", "cond4"]


@pytest.fixture(scope="module")
def chance() -> tuple[dict[str, Any], pd.DataFrame]:
    reference = expected("13_accuracy_chance")
    wide = pd.read_csv(path("13_accuracy_chance.csv"))
    return reference, wide.melt(["id", "sex"], CONDITIONS, "condition", "accuracy")


def agree(row: Any, wanted: dict[str, Any], effect: str) -> None:
    assert row["t"] == pytest.approx(wanted["t"], rel=1e-8)
    assert row["p"] == pytest.approx(wanted["p"], rel=1e-8)
    assert row["d"] == pytest.approx(wanted[effect]["d"], rel=1e-8)
    assert (row["d_low"], row["d_high"]) == pytest.approx(wanted[effect]["ci95"], abs=1e-6)


def test_one_sample_against_chance(chance: Any) -> None:
    reference, data = chance
    result = t_tests(data, "accuracy", "id", each="condition", against=50)
    for row, wanted in zip(result.to_dict("records"), reference["one_sample"], strict=True):
        agree(row, wanted, "cohens_d")
        assert row["g"] == pytest.approx(wanted["hedges_g"]["d"], rel=1e-8)
        assert row["bf10"] == pytest.approx(wanted["bf10_jzs_0707"], rel=1e-5)
        assert (row["shapiro_w"], row["shapiro_p"]) == pytest.approx(
            (wanted["shapiro_W"], wanted["shapiro_p"]), abs=1e-6
        )
        assert row["rank_statistic"] == wanted["wilcoxon_V"]
        assert row["rank_p"] == pytest.approx(wanted["wilcoxon_p_normal_approx"], rel=1e-8)
        assert row["ci_low"] + 50 == pytest.approx(wanted["ci95"][0], rel=1e-8)


def test_paired_in_every_pair_of_conditions(chance: Any) -> None:
    reference, data = chance
    result = t_tests(data, "accuracy", "id", paired="condition")
    for row, wanted in zip(result.to_dict("records"), reference["paired"], strict=True):
        assert (row["a"], row["b"]) == (wanted["a"], wanted["b"])
        agree(row, wanted, "dz")
        assert row["bf10"] == pytest.approx(wanted["bf10_jzs_0707"], rel=1e-5)
        assert row["rank_p"] == pytest.approx(wanted["wilcoxon_p_normal_approx"], rel=1e-8)


def test_independent_groups_by_student_and_by_welch(chance: Any) -> None:
    reference, data = chance
    result = t_tests(data, "accuracy", "id", independent="sex", each="condition")
    student = result[result["test"] == "independent"].to_dict("records")
    welch = result[result["test"] == "Welch"].to_dict("records")
    for one, other, wanted in zip(student, welch, reference["independent"], strict=True):
        agree(one, {**wanted["student"], "d": wanted["cohens_d_pooled"]}, "d")
        assert one["bf10"] == pytest.approx(wanted["bf10_jzs_0707"], rel=1e-5)
        assert one["rank_p"] == pytest.approx(wanted["mannwhitney_p_normal_approx"], rel=1e-8)
        assert (other["t"], other["df"], other["p"]) == pytest.approx(
            [wanted["welch"][k] for k in ("t", "df", "p")], rel=1e-8
        )


def test_niays_table_3_4_from_means_and_standard_deviations() -> None:
    published = pd.DataFrame(
        {
            "actor": ["F1", "F2", "M1", "M2"],
            "against": [0.00690, 0.00560, 0.00700, 0.00700],
            "mean": [0.00573, 0.00595, 0.00658, 0.00651],
            "sd": [0.00065, 0.00062, 0.00051, 0.00058],
            "n": 22,
        }
    )
    result = t_tests_from_summary(published)
    assert list(result["actor"]) == ["F1", "F2", "M1", "M2"]
    assert result["p"][1] == pytest.approx(0.015, abs=0.0015)
    assert (result["p"][[0, 2, 3]] < 0.001).all()


def test_a_bayes_factor_of_rouder_2009() -> None:
    # Rouder et al. 2009, p. 232: t = 2.03, n = 80, r = 1 favours the null 1.56 to 1.
    assert 1 / jzs(2.03, 79, 80, scale=1.0) == pytest.approx(1.56, abs=0.01)


@pytest.mark.parametrize("df", [2, 5, 21, 100])
def test_effect_sizes_have_limits_however_large_t_is(df: int) -> None:
    """Values that hardly differ between people, as thresholds that all went to one end, give t of a billion."""
    edge = HUGE * df**0.5
    exact, limiting = t_noncentrality_limits(edge * 0.999, df), t_noncentrality_limits(edge * 1.001, df)
    assert [low / 0.999 for low in exact] == pytest.approx([low / 1.001 for low in limiting], rel=3e-6)
    low, high = t_noncentrality_limits(4.7e9, df)
    assert 0 < low < 4.7e9 < high
    assert t_noncentrality_limits(-4.7e9, df) == pytest.approx((-high, -low))


@pytest.mark.parametrize("name", ["01_mixed_4x3x2_sex", "06_unbalanced_3x2_between_3x2", "05_within_4x3"])
def test_shapiro_wilk_on_residuals_and_in_every_cell(name: str) -> None:
    reference = expected(name)
    factors = [*reference["design"]["within"], *reference["design"]["between"]]
    result = normality(table(name, reference["design"]), **arguments(reference["design"]))
    first = result.iloc[0]
    assert first["scope"] == "residuals"
    assert first["w"] == pytest.approx(reference["residual_normality"]["shapiro_W"], abs=1e-6)
    assert first["p"] == pytest.approx(reference["residual_normality"]["shapiro_p"], abs=1e-6)
    rows = {tuple(row[f] for f in factors): row for row in result.iloc[1:].to_dict("records")}
    for wanted in reference["cells"]:
        row = rows[tuple(wanted["levels"][f] for f in factors)]
        assert row["n"] == wanted["n"]
        assert row["mean"] == pytest.approx(wanted["mean"], rel=1e-8)
        if wanted["shapiro_p"] is not None:
            assert (row["w"], row["p"]) == pytest.approx((wanted["shapiro_W"], wanted["shapiro_p"]), abs=1e-6)


def test_a_group_of_one_is_compared_by_the_variance_of_the_other() -> None:
    """R: t.test(c(3, 5, 4, 8), 10, var.equal = TRUE) is t(3) = (5 - 10) / (sd sqrt(1 + 1/4)); sd² = 14 / 3."""
    data = pd.DataFrame({"who": list("abcde"), "group": ["many"] * 4 + ["one"], "y": [3.0, 5, 4, 8, 10]})
    result = t_tests(data, "y", "who", independent="group")
    assert result["test"].to_list() == ["independent"]  # Welch's needs a variance of each group
    row = result.iloc[0]
    assert (row["t"], row["df"]) == (pytest.approx(-5 / (14 / 3 * 1.25) ** 0.5, rel=1e-12), 3)
    assert result.attrs["notes"] == []

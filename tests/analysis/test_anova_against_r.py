"""The analysis of variance agrees with R (afex, car) to the tolerances of the reference data."""

from __future__ import annotations

import math
import warnings
from typing import Any

import pytest

from analysis import anova
from tests.analysis.reference import arguments, expected, table

SETS = [
    "01_mixed_4x3x2_sex", "02_mixed_2x2_2x2", "03_mixed_2x3x4x3_gender", "04_within_5", "05_within_4x3",
    "06_unbalanced_3x2_between_3x2", "07_few_subjects_within_8", "08_within_2x2x2", "09_trials_missing",
    "10_between_3x2",
]  # fmt: skip

COLUMN = {
    "df1": "df_num", "df2": "df_den", "ss": "ss", "ss_error": "ss_error", "F": "F", "p": "p", "eta_p2": "pes",
    "eta_g2": "ges", "epsilon_gg": "gg_eps_definition", "p_gg": "p_gg_definition", "epsilon_hf": "hf_eps",
    "p_hf": "p_hf", "mauchly_w": "mauchly_W", "mauchly_p": "mauchly_p",
}  # fmt: skip


def close(value: float, wanted: float | None, relative: float = 1e-8) -> bool:
    if wanted is None:
        return math.isnan(value)
    return value == pytest.approx(wanted, rel=relative, abs=1e-13)


def run(name: str, **options: Any) -> tuple[dict[str, Any], dict[frozenset[str], dict[str, Any]], Any]:
    reference = expected(name)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = anova(table(name, reference["design"]), **arguments(reference["design"]), **options)
    rows = {frozenset(row["effect"].split(":")): row for row in result.to_dict("records")}
    return reference, rows, result


@pytest.mark.parametrize("name", SETS)
def test_every_number_of_the_table_is_that_of_r(name: str) -> None:
    reference, rows, _ = run(name)
    effects = [row for row in reference["anova_type3"] if row["factors"]]
    assert len(rows) == len(effects)
    for wanted in effects:
        mine = rows[frozenset(wanted["factors"])]
        for column, key in COLUMN.items():
            if key in wanted:
                assert close(mine[column], wanted[key]), (wanted["effect"], column, mine[column], wanted[key])


@pytest.mark.parametrize("name", SETS)
def test_limits_of_partial_eta_squared_invert_the_noncentral_f(name: str) -> None:
    reference, rows, _ = run(name)
    for wanted in reference["anova_type3"]:
        if wanted["factors"]:
            mine = rows[frozenset(wanted["factors"])]
            assert (mine["eta_p2_low"], mine["eta_p2_high"]) == pytest.approx(wanted["pes_ci90"], abs=1e-6)


@pytest.mark.parametrize("name", [n for n in SETS if n[:2] in ("01", "02", "03", "06")])
def test_generalized_eta_squared_with_measured_groups(name: str) -> None:
    reference = expected(name)
    _, rows, _ = run(name, measured=list(reference["design"]["between"]))
    for wanted in reference["anova_type3"]:
        if wanted["factors"]:
            assert close(rows[frozenset(wanted["factors"])]["eta_g2"], wanted["ges_observed_between"])


@pytest.mark.parametrize("name", [n for n in SETS if not n.startswith("10")])
def test_mauchlys_textbook_p_is_offered_beside_rs(name: str) -> None:
    reference, rows, result = run(name)
    for wanted in reference["anova_type3"]:
        if wanted["factors"]:
            effect = rows[frozenset(wanted["factors"])]["effect"]
            assert close(result.attrs["mauchly_p_textbook"][effect], wanted["mauchly_p_textbook"])


def test_effects_are_in_the_order_of_the_arguments_as_in_the_thesis() -> None:
    reference = expected("01_mixed_4x3x2_sex")
    data = table("01_mixed_4x3x2_sex", reference["design"])
    result = anova(data, reference["design"]["dv"], "id", ["actor", "speed", "init"], "sex")
    assert list(result["effect"][:8]) == [
        "actor", "speed", "init", "sex", "actor:speed", "actor:init", "actor:sex", "speed:init",
    ]  # fmt: skip


def test_participants_with_missing_cells_are_left_out_and_named() -> None:
    reference = expected("09_trials_missing")
    data = table("09_trials_missing", reference["design"])
    with pytest.warns(UserWarning, match="P07") as caught:
        result = anova(data, **arguments(reference["design"]))
    assert list(result.attrs["left_out"]) == reference["subjects_removed_incomplete"]
    assert result.attrs["n"] == reference["n_subjects"]
    assert "mixed model" in str(caught[0].message)
    assert any("averaged" in note for note in result.attrs["notes"])


def test_a_singular_error_matrix_gives_greenhouse_geisser_and_no_mauchly() -> None:
    _, _, result = run("07_few_subjects_within_8")
    assert math.isnan(result["mauchly_p"][0])
    assert math.isfinite(result["p_gg"][0])
    assert any("fewer participants than contrasts" in note for note in result.attrs["notes"])

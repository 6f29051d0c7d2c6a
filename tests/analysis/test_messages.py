"""What goes wrong is said in a sentence that names participants, cells or levels, and what to do."""

from __future__ import annotations

import math
import warnings
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis import (
    AnalysisError,
    AnalysisWarning,
    anova,
    art_anova,
    emmeans,
    equivalence,
    mixed_model,
    normality,
    pairwise,
    power_rm_anova,
    proportions,
    psychometric,
    regression,
    t_tests,
)
from tests.analysis.reference import expected, table


def small(people: int = 6) -> pd.DataFrame:
    """People x 2 speeds x 2 cues, and a group."""
    rng = np.random.default_rng(1)
    rows = [
        (f"P{p}", speed, cue, ("young", "old")[p % 2], rng.normal())
        for p, speed, cue in product(range(people), ("slow", "fast"), ("valid", "invalid"))
    ]
    return pd.DataFrame(rows, columns=["id", "speed", "cue", "group", "score"])


def run(data: pd.DataFrame, **options: Any) -> pd.DataFrame:
    return anova(data, "score", "id", ["speed", "cue"], "group", **options)


def edge_cases() -> list[str]:
    return ["two_groups", "empty_between_cell", "constant_dv", "decimal_comma", "one_level"]


@pytest.mark.parametrize("key", edge_cases())
def test_the_awkward_files_of_the_reference(key: str) -> None:
    case = next(c for c in expected("edge_cases")["cases"] if c["key"] == key)
    design = case["design"]
    data = table(case["csv"][:-4], design)
    try:
        result = anova(data, design["dv"], design["id"], list(design["within"]), list(design["between"]))
    except AnalysisError as error:
        said = str(error)
    else:
        assert result["p"].isna().all()
        assert result["F"].isna().all()
        said = " ".join(result.attrs["notes"])
    for word in case["must_mention"]:
        assert word in said


def test_someone_in_two_groups() -> None:
    data = small()
    data.loc[0, "group"] = "old"
    with pytest.raises(AnalysisError, match=r"P0 \(old and young\).*numbering restart in each group"):
        run(data)


def test_an_empty_cell_leaves_a_participant_out_with_a_warning() -> None:
    data = small(8)
    with pytest.warns(AnalysisWarning, match=r"1 participant.*P3 \(no data in fast × invalid\).*n = 7"):
        result = run(data[~((data["id"] == "P3") & (data["speed"] == "fast") & (data["cue"] == "invalid"))])
    assert result.attrs["n"] == 7


def test_a_level_nobody_has() -> None:
    with pytest.raises(AnalysisError, match="No row has the level 'medium' of 'speed'"):
        run(small(), levels={"speed": ["slow", "medium", "fast"]})


def test_a_level_that_is_not_in_the_design() -> None:
    data = small()
    data.loc[3, "speed"] = "fats"
    with pytest.raises(AnalysisError, match=r"'speed' has the level 'fats' in 1 row"):
        run(data, levels={"speed": ["slow", "fast"]})


def test_a_level_with_other_capitals() -> None:
    data = small()
    data.loc[:1, "speed"] = "Slow"
    with pytest.raises(AnalysisError, match=r"odd level 'Slow' \(2 row"):
        run(data)


def test_trailing_blanks_are_removed_and_noted() -> None:
    data = small()
    data.loc[:1, "speed"] = "slow "
    result = run(data)
    assert any("'slow ' was read as 'slow'" in note for note in result.attrs["notes"])
    assert result["F"].to_list() == run(small())["F"].to_list()


@pytest.mark.parametrize(
    ("value", "said"),
    [("fast", "row 6 holds 'fast'"), ("1,5", "decimals with a point"), (math.inf, "infinite")],
)
def test_what_is_no_number(value: object, said: str) -> None:
    data = small().astype({"score": object})
    data.loc[5, "score"] = value
    with pytest.raises(AnalysisError, match=f"'score'.*{said}|{said}"):
        run(data)


def test_too_few_participants_for_the_groups() -> None:
    with pytest.raises(AnalysisError, match=r"2 participant.*too few for 2 group.*at least 3"):
        run(small(2))


def test_an_unknown_column_and_a_name_given_twice() -> None:
    with pytest.raises(AnalysisError, match="no column 'spede'; the columns are"):
        anova(small(), "score", "id", "spede")
    with pytest.raises(AnalysisError, match="'speed' is named twice"):
        anova(small(), "score", "id", ["speed", "speed"])
    with pytest.raises(AnalysisError, match="at least one within or between factor"):
        anova(small(), "score", "id")


def test_a_pair_without_variance_has_no_p() -> None:
    data = small()
    shift = data.loc[data["speed"] == "slow", "score"].to_numpy() + 3.0
    data.loc[data["speed"] == "fast", "score"] = shift
    result = pairwise(data, "score", "id", ["speed", "cue"], "group", factors="speed")
    assert result["estimate"][0] == pytest.approx(3.0) or result["estimate"][0] == pytest.approx(-3.0)
    assert result["se"][0] == 0
    assert math.isnan(result["p"][0])
    assert any("no variance" in note for note in result.attrs["notes"])
    table_of_effects = run(data)
    assert math.isnan(table_of_effects.set_index("effect").loc["speed", "p"])


def test_columns_called_id_and_side_lose_no_effect() -> None:
    # statsmodels' AnovaRM tests the participant column as a substring of effects and drops `side`.
    data = small().rename(columns={"speed": "side", "cue": "id_cue"})
    result = anova(data, "score", "id", ["side", "id_cue"], "group")
    assert len(result) == 7


def test_empty_cells_of_one_person_do_not_stop_the_normality_test() -> None:
    result = normality(small(5), "score", "id", ["speed", "cue"], "group")
    assert any("fewer than 3" in note for note in result.attrs["notes"])


def test_t_tests_want_exactly_one_question() -> None:
    with pytest.raises(AnalysisError, match="exactly one of against, paired and independent"):
        t_tests(small(), "score", "id")
    with pytest.raises(AnalysisError, match=r"'walk'.*has only the levels 'fast' and 'slow'"):
        t_tests(small(), "score", "id", each="speed", against={"walk": 1.0})


def test_a_complete_table_warns_of_nothing() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        run(small())


def test_ranks_of_equal_values_have_no_p_and_the_table_says_why() -> None:
    result = art_anova(small().assign(score=1.0), "score", "id", ["speed", "cue"])
    assert result["p"].isna().all()
    assert any("score has no variance left to test speed, cue, speed:cue" in note for note in result.attrs["notes"])


@pytest.mark.parametrize("size", [{"eta_p2": 1.2}, {"eta_p2": -0.1}, {"f": -0.2}, {"f": math.nan}])
def test_an_effect_size_that_cannot_be_is_refused(size: dict[str, float]) -> None:
    with pytest.raises(AnalysisError, match="eta_p2 one from 0"):
        power_rm_anova(effect="within", measures=3, n=20, **size)


def test_participant_and_stimulus_of_a_mixed_model_are_two_columns() -> None:
    with pytest.raises(AnalysisError, match="'id' is named as participant and as stimulus"):
        mixed_model(small(), "score", "id", "id", "speed")


@pytest.mark.parametrize("level", [95, 1.0, 0.0, -0.1, math.nan])
def test_a_confidence_level_outside_0_to_1_is_refused_instead_of_giving_no_limits(level: float) -> None:
    data = small().assign(right=1)
    for computed in (
        lambda: regression(data, "score", ["speed"], level=level),
        lambda: emmeans(data, "score", "id", "speed", factors="speed", level=level),
        lambda: pairwise(data, "score", "id", "speed", factors="speed", level=level),
        lambda: mixed_model(data, "score", "id", "cue", "speed", level=level),
        lambda: proportions(data, "right", level=level),
    ):
        with pytest.raises(AnalysisError, match=f"level is a share between 0 and 1, as 0.95, not {level}"):
            computed()


@pytest.mark.parametrize("bound", [-1, 0, math.nan, math.inf])
def test_a_bound_of_equivalence_that_is_no_distance_is_refused(bound: float) -> None:
    with pytest.raises(AnalysisError, match=f"a number above 0, not {bound}; give"):
        equivalence(small(), "score", "id", "speed", factors="speed", bound=bound)


def test_bounds_in_the_wrong_order_and_an_alpha_in_per_cent_are_refused() -> None:
    with pytest.raises(AnalysisError, match="1 is not below -1"):
        equivalence(small(), "score", "id", "speed", factors="speed", bound=(1, -1))
    with pytest.raises(AnalysisError, match=r"alpha is a share between 0 and 1, as 0\.05, not 5"):
        equivalence(small(), "score", "id", "speed", factors="speed", bound=1, alpha=5)
    with pytest.raises(AnalysisError, match="alpha is a share"):
        power_rm_anova(effect="within", measures=3, n=20, f=0.25, alpha=5)


def test_a_power_no_better_than_chance_is_refused() -> None:
    with pytest.raises(AnalysisError, match=r"power must lie between alpha \(0.05\) and 1, not 0.01"):
        power_rm_anova(effect="within", measures=3, n=20, power=0.01)


@pytest.mark.parametrize("wrong", [{"guess": 1.0}, {"guess": -0.1}, {"lapse": 1.0}, {"guess": 0.5, "lapse": 0.5}])
def test_guesses_and_lapses_that_leave_no_room_for_a_function_are_refused(wrong: dict[str, float]) -> None:
    data = pd.DataFrame({"x": [1, 2, 3, 4], "k": [1, 4, 5, 9], "n": 10})
    with pytest.raises(AnalysisError, match="guess and lapse are shares"):
        psychometric(data, "x", "k", "n", **wrong)


def test_levels_without_a_value_to_test_against_are_named_and_not_tested() -> None:
    with pytest.warns(AnalysisWarning, match="'fast' against was given; not tested"):
        result = t_tests(small(), "score", "id", each="speed", against={"slow": 0.0})
    assert result["level"].to_list() == ["slow"]
    assert any("'fast'" in note for note in result.attrs["notes"])


def test_a_value_to_test_against_that_is_no_number_is_refused() -> None:
    with pytest.raises(AnalysisError, match="finite numbers"):
        t_tests(small(), "score", "id", each="speed", against={"slow": 0.0, "fast": math.nan})

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
    confusion_rate,
    d_prime,
    emmeans,
    equivalence,
    mixed_model,
    normality,
    pairwise,
    power_regression,
    power_rm_anova,
    power_t_test,
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


def test_a_factor_called_as_a_column_of_the_result_is_refused_instead_of_overwritten() -> None:
    data = small().assign(right=1, was=[0, 1] * 12)
    named = {name: data.rename(columns={"speed": name}) for name in ("df", "p", "mean", "n", "hits", "upper_bound")}
    for name, computed in {
        "df": lambda d: emmeans(d, "score", "id", ["df", "cue"], factors="df"),
        "p": lambda d: pairwise(d, "score", "id", ["p", "cue"], factors="cue", by="p"),
        "upper_bound": lambda d: equivalence(
            d, "score", "id", ["upper_bound", "cue"], factors="cue", by="upper_bound", bound=1
        ),
        "mean": lambda d: normality(d, "score", "id", "mean"),
        "n": lambda d: proportions(d, "right", by="n"),
        "hits": lambda d: d_prime(d, "was", "right", by="hits"),
    }.items():
        with pytest.raises(AnalysisError, match=f"The result has a column '{name}' of its own; rename the factor"):
            computed(named[name])


@pytest.mark.parametrize("name", ["x", "k", "n_"])
def test_any_other_name_of_a_column_keeps_its_levels(name: str) -> None:
    data = pd.DataFrame({"level": [1, 2, 3, 4] * 2, "yes": [1, 3, 6, 9] * 2, "of": 10, name: ["a"] * 4 + ["b"] * 4})
    assert psychometric(data, "level", "yes", "of", by=name)[name].to_list() == ["a", "b"]


@pytest.mark.parametrize("test", [anova, art_anova])
def test_a_factor_with_a_colon_would_be_taken_for_an_interaction(test: Any) -> None:
    with pytest.raises(AnalysisError, match="'speed:1': a colon joins the factors"):
        test(small().rename(columns={"speed": "speed:1"}), "score", "id", ["speed:1", "cue"])


def test_columns_without_names_and_names_without_one_column() -> None:
    data = small()
    numbered = data.set_axis(range(len(data.columns)), axis=1)
    with pytest.raises(AnalysisError, match=r"named by text.*data\.columns\.map\(str\)"):
        anova(numbered, 4, 0, 1)  # type: ignore[arg-type]
    with pytest.raises(AnalysisError, match="several columns called 'cue'"):
        anova(pd.concat([data, data[["cue"]]], axis=1), "score", "id", ["speed", "cue"])


def test_times_are_not_taken_for_numbers() -> None:
    data = small()
    times = data.assign(score=pd.to_timedelta(data["score"].abs(), unit="s"))
    with pytest.raises(AnalysisError, match=r"'score' must hold numbers.*total_seconds"):
        run(times)
    seconds = times.assign(score=times["score"].dt.total_seconds())
    np.testing.assert_allclose(run(seconds)["F"], run(data.assign(score=data["score"].abs()))["F"], rtol=1e-6)


def test_a_blank_label_is_a_missing_one() -> None:
    data = small()
    data.loc[[2, 5], "speed"] = "  "
    with pytest.raises(AnalysisError, match=r"'speed' is empty in row 3 \(2 such"):
        run(data)


def test_long_numbers_of_participants_read_as_floats_stay_apart() -> None:
    data = small()
    known = run(data)
    numbered = data.assign(id=data["id"].str[1:].astype(int) + 20261124123456.0)
    pd.testing.assert_frame_equal(run(numbered), known)
    assert run(numbered).attrs["n"] == 6


def test_a_mixed_model_without_a_remainder_is_refused() -> None:
    data = small()
    exact = data.assign(score=data["id"].str[1:].astype(int) * 0.3 + (data["cue"] == "valid") * 0.7 + 5)
    with pytest.raises(AnalysisError, match="explain 'score' without a remainder"):
        mixed_model(exact, "score", "id", "cue", "speed")


@pytest.mark.parametrize(
    ("impossible", "said"),
    [
        (lambda: power_t_test(0.5, 1), "needs 2 participants"),
        (lambda: power_t_test(0.5, 1, 1), "3 in two groups"),
        (lambda: power_t_test(math.nan, 20), "d is a finite number"),
        (lambda: power_t_test(0.5, 20, tails=3), "tails 1 or 2"),
        (lambda: power_regression(0.15, 6, 5), "6 cases are too few for 5 predictor"),
        (lambda: power_regression(-0.1, 30, 2), "f2 is a number from 0 up"),
        (lambda: power_regression(0.1, 30, 2, 3), "tested is from 1 up to all"),
        (lambda: power_rm_anova(effect="within", measures=3, n=1, power=0.8), "1 participant.*at least 2"),
        (lambda: power_rm_anova(effect="within", measures=3, n=20, f=0.2, groups=0), "groups is 1 or more"),
    ],
)
def test_power_of_designs_that_cannot_be_is_a_sentence_instead_of_nothing(impossible: Any, said: str) -> None:
    with pytest.raises(AnalysisError, match=said):
        impossible()


def test_rows_without_a_label_are_named_instead_of_dropped() -> None:
    data = small().assign(right=1, was=[0, 1] * 12, level=[1, 2, 3, 4] * 6)
    gap = data.assign(cue=data["cue"].where(data.index != 4))
    for computed in (
        lambda: proportions(gap, "right", by="cue"),
        lambda: d_prime(gap, "was", "right", by="cue"),
        lambda: psychometric(gap, "level", "right", by="cue"),
        lambda: t_tests(gap, "score", "id", against=0, each="cue"),
        lambda: confusion_rate(gap, "speed", "speed", "cue"),
    ):
        with pytest.raises(AnalysisError, match=r"'cue' is empty in row 5 \(1 such"):
            computed()


def test_levels_that_were_never_shown_tell_nothing_and_shares_of_nothing_are_refused() -> None:
    shown = pd.DataFrame({"x": [1, 2, 3, 4], "k": [1, 3, 6, 9], "n": 10})
    never = pd.concat([shown, pd.DataFrame({"x": [9], "k": [0], "n": [0]})])
    pd.testing.assert_frame_equal(psychometric(shown, "x", "k", "n"), psychometric(never, "x", "k", "n"))
    pd.testing.assert_frame_equal(proportions(shown, "k", "n"), proportions(never, "k", "n"))
    for computed in (proportions, lambda *a: psychometric(a[0], "x", *a[1:])):
        with pytest.raises(AnalysisError, match="'k' has no trials"):
            computed(shown.assign(k=0, n=0), "k", "n")
    with pytest.raises(AnalysisError, match="whole counts"):
        proportions(shown.assign(n=10.5), "k", "n")


def test_what_explains_itself_is_no_model() -> None:
    data = small().assign(double=lambda d: 2 * d["score"] + 1)
    with pytest.raises(AnalysisError, match="'score' cannot be explained by itself"):
        regression(data, "score", ["score"])
    with pytest.raises(AnalysisError, match="double explain 'score' without a remainder"):
        regression(data, "score", ["double"])
    with pytest.raises(AnalysisError, match="'cue' is named twice"):
        mixed_model(data, "score", "id", "cue", ["speed", "cue"])
    with pytest.raises(AnalysisError, match="'score' is named twice"):
        t_tests(data, "score", "score", against=0)


def test_a_trial_without_an_answer_is_no_confusion() -> None:
    data = pd.DataFrame({"chosen": [1, 2, None], "original": [1.0, 1.0, 1.0], "who": "P1"})
    row = confusion_rate(data, "chosen", "original", "who").iloc[0]
    assert (row["trials"], row["confusion_rate"]) == (2, 50.0)

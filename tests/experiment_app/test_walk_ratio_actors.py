"""The study of Niay (2022), chapter 4, from simulated participants to its tables and figures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analysis.planned_analysis import analyse
from experiment_app.checking.check import checked_study
from experiment_app.simulated.simulate import simulate
from experiment_app.staging import staged
from protocols.orders.design import make_trials
from protocols.setting import value_of
from stimuli.actors import load_actor

PARTICIPANTS = 12
STUDY = checked_study("walk_ratio_actors")
ACTORS = [f"{sex}{i}" for sex in "FM" for i in range(1, 9)]


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("actors")
    runs = list(simulate(STUDY, PARTICIPANTS, folder / "data", seed=4))
    assert len(runs) == PARTICIPANTS
    outcome = analyse(folder / "data" / "walk_ratio_actors", folder / "report")
    assert not outcome.warnings
    return outcome.report.parent


def table(report: Path, name: str) -> pd.DataFrame:
    return pd.read_csv(report / name)


def test_every_actor_walks_at_the_comfort_speed_of_table_4_1() -> None:
    """And the heights and weights of the regression are those of the actors."""
    study = STUDY.study
    on = study.analysis.regression
    assert on is not None
    for name in ACTORS:
        actor = load_actor(name)
        assert value_of(study.stimulus.speed, {"actor": name}) == pytest.approx(actor.comfort_speed)
        assert on.on["height"][name] == pytest.approx(actor.height)
        assert on.on["weight"][name] == pytest.approx(actor.weight)


def test_a_participant_sees_128_trials_each_actor_on_both_bodies_from_both_starts_twice() -> None:
    trials = make_trials(STUDY.study, 7)
    cells = {tuple(trial.levels.values()) for trial in trials}
    assert (len(trials), len(cells)) == (128, 64)
    assert {cell[1] for cell in cells} == {"matched", "mismatched"}


def test_it_is_shown_on_a_treadmill_from_the_side() -> None:
    scene = staged(STUDY.study, (), {})
    assert (scene.ground, scene.camera.view) == ("treadmill", "side")


def test_the_simulated_preferences_give_the_published_regression() -> None:
    """Section 4.3.1 of the thesis: t = 1.269 for height, -0.441 for weight, 5.542 for speed; R² = 0.725."""
    on = STUDY.study.analysis.regression
    assert on is not None
    population = STUDY.study.simulation.preferred_walk_ratio
    y = np.array([population[name].mean for name in ACTORS])
    X = np.column_stack([np.ones(16), *([on.on[p][name] for name in ACTORS] for p in ("height", "weight", "speed"))])
    b, (rest,), *_ = np.linalg.lstsq(X, y, rcond=None)
    se = np.sqrt(rest / 12 * np.diag(np.linalg.inv(X.T @ X)))
    assert (b / se)[1:] == pytest.approx([1.269, -0.441, 5.542], abs=0.03)
    assert 1 - rest / np.sum((y - y.mean()) ** 2) == pytest.approx(0.725, abs=0.006)


@pytest.mark.parametrize("folder", ["", "normalised_walk_ratio/"])
def test_both_four_way_anovas_have_the_effects_of_tables_4_2_and_4_4(report: Path, folder: str) -> None:
    anova = table(report, f"{folder}anova.csv").set_index("effect")
    assert len(anova) == 15
    assert set(anova["df1"]) == {1}
    assert set(anova["df2"]) == {PARTICIPANTS - 4}
    for effect in ("actor_sex", "character", "viewing", "participant_gender", "actor_sex:character"):
        assert np.isfinite(anova.loc[effect, "F"])
    assert anova.loc["actor_sex", "p"] < 0.01


@pytest.mark.parametrize("folder", ["", "normalised_walk_ratio/"])
def test_the_six_pairs_of_table_4_3_are_compared_whatever_the_interaction(report: Path, folder: str) -> None:
    pairs = table(report, f"{folder}pairs.csv")
    cells = {"female × matched", "female × mismatched", "male × matched", "male × mismatched"}
    assert len(pairs) == 6
    assert {*pairs["a"], *pairs["b"]} == cells
    assert (pairs["p"] >= pairs["p_unadjusted"]).all()


def test_the_effect_of_the_actors_sex_is_that_of_a_paired_t_test(report: Path) -> None:
    """F of a factor of two levels is the square of t, with the participants' group means taken out."""
    trials = table(report, "trials.csv")
    means = trials.groupby(["participant", "viewing", "participant_gender", "actor_sex"])["walk_ratio"].mean().unstack()
    difference = (means["male"] - means["female"]).reset_index(name="d")
    within = difference["d"] - difference.groupby(["viewing", "participant_gender"])["d"].transform("mean")
    variance = np.sum(within**2) / (PARTICIPANTS - 4)
    F = difference["d"].mean() ** 2 / (variance / PARTICIPANTS)
    anova = table(report, "anova.csv").set_index("effect")
    assert anova.loc["actor_sex", "F"] == pytest.approx(F, rel=1e-9)


def test_normalisation_turns_the_effect_of_sex_round_as_in_the_thesis(report: Path) -> None:
    """Men above women in m·min, below them when normalised by height (Hof 1996)."""
    trials = table(report, "trials.csv")
    heights = trials["actor"].map({name: load_actor(name).height for name in ACTORS})
    expected = (trials["step_length"] / heights) / (trials["step_frequency"] / 60.0 / np.sqrt(9.81 / heights))
    assert trials["normalised_walk_ratio"].to_numpy() == pytest.approx(expected.to_numpy())
    by_sex = trials.groupby("actor_sex")[["walk_ratio", "normalised_walk_ratio"]].mean()
    assert by_sex.loc["male", "walk_ratio"] > by_sex.loc["female", "walk_ratio"]
    assert by_sex.loc["male", "normalised_walk_ratio"] < by_sex.loc["female", "normalised_walk_ratio"]


def test_every_actor_on_the_matched_body_is_tested_against_the_captured_walk_ratio(report: Path) -> None:
    tests = table(report, "ttests.csv").set_index("level")
    assert list(tests.index) == ACTORS
    trials = table(report, "trials.csv")
    matched = trials[trials["character"] == "matched"].groupby("actor")["walk_ratio"].mean()
    for name in ACTORS:
        assert tests.loc[name, "mean"] == pytest.approx(matched[name])
        assert tests.loc[name, "against"] == pytest.approx(load_actor(name).captured_walk_ratio, abs=1e-5)
        assert tests.loc[name, "df"] == PARTICIPANTS - 1


def test_the_regression_is_of_sixteen_actors_on_height_weight_and_speed(report: Path) -> None:
    cases, terms = table(report, "regression_cases.csv"), table(report, "regression.csv").set_index("term")
    assert len(cases) == 16
    X = np.column_stack([np.ones(16), cases[["height", "weight", "speed"]]])
    b, *_ = np.linalg.lstsq(X, cases["walk_ratio"].to_numpy(), rcond=None)
    assert terms["estimate"].to_numpy() == pytest.approx(b)
    assert terms.loc["speed", "p"] < 0.01


def test_the_figures_of_the_thesis_are_drawn_and_in_the_report(report: Path) -> None:
    page = (report / "report.html").read_text(encoding="utf-8")
    for name in ("t_tests_actor", "regression", "interaction_actor_sex_character"):
        assert (report / f"{name}.svg").stat().st_size > 10_000
    assert "A star: the t test found no difference from it." in page
    assert "the multiple regression with the other predictors at their means" in page
    assert "in trials with character == matched" in page

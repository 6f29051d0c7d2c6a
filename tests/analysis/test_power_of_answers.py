"""Power of choice and rating studies: the same observers as those of `gaitlab simulate`, without sessions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from analysis import AnalysisError, power_by_simulation
from analysis.power.simulated_answers import Choosers, Raters
from analysis.power.simulated_experiments import cell_means_of, experiment_model
from analysis.power.simulation import as_dict
from analysis.power.study import power_notes
from experiment_app.simulated.behaviour import _shifted
from protocols.study_file import read_study

SHARES = np.array([0.1, 0.5, 0.9, 0.0, 1.0])


def loaded(name):
    return as_dict(read_study(name).text)


def test_choices_are_confused_as_often_as_the_study_says():
    chosen = Choosers("confusion_rate", SHARES, np.full(5, 3.0), 0.0, 0.2, 0.4)
    values = chosen.values(np.random.default_rng(1), 20_000)
    assert set(np.unique(values)) == {0.0, 100.0}
    # s.d. of a mean of 20 000 choices: 0.35 % at most, so 1.5 is more than four of them
    assert values.mean(axis=0) == pytest.approx(100.0 * SHARES, abs=1.5)
    assert Choosers("correct", SHARES, np.full(5, 3.0), 0.0, 0.2, 0.4).values(np.random.default_rng(1), 20_000).mean(
        axis=0
    ) == pytest.approx(1.0 - SHARES, abs=0.015)


def test_a_person_leans_as_the_simulated_observer_of_a_session_does():
    chosen = Choosers("confusion_rate", np.full(40_000, 0.3), np.full(40_000, 3.0), 0.8, 0.2, 0.4)
    leaning = np.random.default_rng(7).standard_normal((1, 1))[0, 0]
    share = chosen.values(np.random.default_rng(7), 1).mean() / 100.0
    assert share == pytest.approx(_shifted(0.3, 0.8 * leaning), abs=0.012)


def test_response_times_have_the_median_and_the_spread_of_the_study():
    chosen = Choosers("response_time", np.full(50, 0.5), np.full(50, 3.0), 0.3, 0.2, 0.4)
    log = np.log(chosen.values(np.random.default_rng(2), 4000))
    assert np.median(log) == pytest.approx(math.log(3.0), abs=0.02)
    assert log.mean(axis=1).std() == pytest.approx(math.sqrt(0.2**2 + 0.4**2 / 50), rel=0.05)


def test_ratings_stay_on_the_points_of_their_scale():
    rated = Raters(np.array([0.2, 2.0, 3.9]), 0.4, 0.8, 0.0, 4.0, 1.0)
    values = rated.values(np.random.default_rng(3), 5000)
    assert set(np.unique(values)) == {0.0, 1.0, 2.0, 3.0, 4.0}
    assert values[:, 1].mean() == pytest.approx(2.0, abs=0.06)
    free = Raters(np.array([2.0]), 0.4, 0.3, 0.0, 4.0, None).values(np.random.default_rng(3), 5000)
    assert free.std() == pytest.approx(0.5, rel=0.05)  # sqrt(0.4^2 + 0.3^2)


def test_ratings_have_the_means_of_the_study_though_the_scale_cuts_them_off():
    study = loaded("fourier_naturalness")
    wanted = list(study["simulation"]["rating"]["rating"]["$pair"].values())
    model = experiment_model(study, 37)
    found = model.observers.values(np.random.default_rng(5), 20_000).mean(axis=0).reshape(-1, len(wanted)).mean(axis=0)
    # s.d. of a mean of 20 000 people: below 0.008; rounding to whole points moves a mean by 0.02 at most
    assert found == pytest.approx(wanted, abs=0.04)


def test_a_rating_that_the_study_does_not_say_is_the_middle_of_the_scale():
    study = loaded("fourier_naturalness")
    rating = {name: value for name, value in study["simulation"]["rating"].items() if name != "rating"}
    model = experiment_model({**study, "simulation": {"rating": rating}}, 37)
    assert set(model.observers.rating) == {2.0}


@pytest.mark.parametrize(
    ("study", "effects"),
    [("speed_editing", {"method", "direction"}), ("fourier_naturalness", {"style"}), ("crowd_variety", set())],
)
def test_effects_of_the_simulated_observers_are_found_and_others_at_chance(study, effects):
    table = power_by_simulation(loaded(study), experiments=400, seed=3).set_index(["test", "name"])
    for (test, name), row in table.iterrows():
        if test == "anova" and name in effects:
            assert row["power"] > 0.8, name
    for name in ("actor", "speed", "size"):
        if ("anova", name) in table.index:
            k = int(table.loc[("anova", name), "significant"])
            # Greenhouse-Geisser is a little conservative: never more than 5 % of 400 allows with p > .0001
            assert stats.binomtest(k, 400, 0.05, alternative="greater").pvalue > 1e-4, name


def test_a_split_gives_the_same_counts_as_the_whole():
    study = loaded("crowd_variety")
    whole = power_by_simulation(study, experiments=60)["significant"]
    parts = [power_by_simulation(study, experiments=60, shard=(i, 3))["significant"] for i in (1, 2, 3)]
    assert list(sum(parts)) == list(whole)


def test_cells_are_means_of_the_trials_in_them():
    model = experiment_model(loaded("speed_editing"), 8)
    values = model.observers.values(np.random.default_rng([4, 2]), 8)
    assert cell_means_of(model, 4, range(2, 3))[0] == pytest.approx(values @ model.cell)
    assert model.cell.sum(axis=0) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"measure": "gaze_share"}, "choice trials can be simulated for confusion_rate, correct, response_time"),
        ({}, "adaptive order"),
    ],
)
def test_what_cannot_be_simulated_is_a_sentence(change, says):
    study = {**loaded("speed_editing")}
    if change:
        study["analysis"] = {**study["analysis"], **change, "anova": {"within": []}}
    else:
        study["order"] = {"kind": "adaptive", "of": "speed", "yes": "correct == 1", "rule": {"kind": "staircase"}}
    with pytest.raises(AnalysisError, match=says):
        experiment_model(study)


@pytest.mark.filterwarnings("error")
def test_answers_without_variance_are_no_power():
    """Everybody answers at the end of the scale: `gaitlab analyse` gives neither F nor t of such values."""
    study = loaded("fourier_naturalness")
    rating = {**study["simulation"]["rating"], "rating": -9, "spread": 0.1, "noise": 0.1}
    tested = {**study["analysis"], "t_tests": [{"each": "style", "against": 2, "label": "middle of the scale"}]}
    study = {**study, "analysis": tested, "simulation": {"rating": rating}}
    table = power_by_simulation(study, experiments=20, participants=6)
    assert set(table["test"]) == {"anova", "t"}
    assert table["significant"].to_list() == [0] * len(table)


def test_planned_tests_that_are_not_simulated_are_named():
    study = loaded("crowd_variety")
    assert any(
        "not post hoc tests, aligned rank transform and the tests of response_time" in n for n in power_notes(study)
    )

"""The shipped studies that compare ways of making walks, from simulated participants to the tables of their sources.

Degrees of freedom and published means: Niay (2022), tables 5.5 and 5.6 and section 5.2.2; Tilmanne & Dutoit, section 3.
"""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from analysis.planned_analysis import analyse
from experiment_app.checking.check import checked_study
from experiment_app.simulated.simulate import simulate
from protocols.limited_scale import latent_mean
from protocols.study_file import read_study


def analysed(study: str, participants: int, folder: Path) -> Path:
    """The folder with the results of so many simulated participants."""
    for _ in simulate(read_study(study), participants, folder / "data", seed=5):
        pass
    analyse(folder / "data" / study, folder / "results")
    return folder / "results"


@pytest.fixture(scope="module")
def reconstruction(tmp_path_factory):
    return analysed("poulaine_reconstruction", 21, tmp_path_factory.mktemp("reconstruction"))


@pytest.fixture(scope="module")
def editing(tmp_path_factory):
    return analysed("speed_editing", 12, tmp_path_factory.mktemp("editing"))


@pytest.fixture(scope="module")
def naturalness(tmp_path_factory):
    return analysed("fourier_naturalness", 37, tmp_path_factory.mktemp("naturalness"))


@pytest.mark.parametrize("study", ["poulaine_reconstruction", "speed_editing", "fourier_naturalness"])
def test_the_study_has_no_mistakes_and_every_walk_of_it_can_be_made(study):
    assert checked_study(study).study.study == study


@pytest.mark.parametrize("measure", ["", "response_time"])
def test_the_analyses_of_variance_have_the_rows_of_tables_5_5_and_5_6(reconstruction, measure):
    table = pd.read_csv(reconstruction / measure / "anova.csv").set_index("effect")
    published = {"points": (1, 19), "interpolation": (2, 38), "actor": (3, 57), "speed": (2, 38), "sex": (1, 19)}
    assert {effect: tuple(table.loc[effect, ["df1", "df2"]].astype(int)) for effect in published} == published
    assert len(table) == 2**5 - 1  # a five-way design has 31 effects
    assert table.loc["points", "p"] < 0.001


def test_response_times_differ_between_interpolations_and_confusion_rates_do_not_as_published(reconstruction):
    confusion = pd.read_csv(reconstruction / "anova.csv").set_index("effect")
    time = pd.read_csv(reconstruction / "response_time" / "anova.csv").set_index("effect")
    assert time.loc["interpolation", "p"] < 0.001 < 0.05 < confusion.loc["interpolation", "p"]


def test_five_points_with_hermite_are_confused_in_close_to_35_percent(reconstruction):
    trials = pd.read_csv(reconstruction / "trials.csv")
    rates = trials.groupby(["points", "interpolation"])["confusion_rate"].mean()
    # 252 trials: a standard error of 3 percentage points, and the spread of 21 people
    assert rates[5, "hermite"] == pytest.approx(35.0, abs=9.0)
    assert rates[4].max() < rates[5].min()


def test_the_captured_walk_is_left_as_often_as_right_for_every_participant(reconstruction):
    trials = pd.read_csv(reconstruction / "trials.csv")
    left = trials.groupby("participant")["left"].value_counts().unstack()
    assert (left["captured"] == 36).all()
    assert (left["rebuilt"] == 36).all()
    assert ((trials["chosen"] == trials["original"]) == (trials["correct"] == 1)).all()


def test_every_edited_walk_stands_once_on_either_side(editing):
    trials = pd.read_csv(editing / "trials.csv")
    sides = trials.groupby(["participant", "method", "actor", "speed", "direction"])["left"].agg(["nunique", "count"])
    assert (sides == 2).all(axis=None)
    assert len(sides) == 12 * 72


def test_speeding_up_by_time_warping_is_noticed_more_often_than_slowing_down(editing):
    rates = pd.read_csv(editing / "trials.csv").groupby(["method", "direction"])["confusion_rate"].mean()
    assert rates["timewarp", "sped_up"] < rates["timewarp", "slowed_down"]
    assert rates["timewarp"].mean() < rates["blend"].mean()
    table = pd.read_csv(editing / "anova.csv").set_index("effect")
    assert tuple(table.loc["method:direction", ["df1", "df2"]].astype(int)) == (2, 20)


def test_styles_have_means_with_confidence_intervals_and_the_published_extremes(naturalness):
    table = pd.read_csv(naturalness / "descriptives.csv").set_index("style")
    assert len(table) == 11
    assert ((table["ci_low"] < table["mean"]) & (table["mean"] < table["ci_high"])).all()
    assert table["mean"].idxmin() == "drunken"
    assert table.loc["drunken", "mean"] == pytest.approx(1.60, abs=0.2)
    assert table.loc["manly", "mean"] == pytest.approx(3.45, abs=0.2)
    trials = pd.read_csv(naturalness / "trials.csv")
    assert trials["rating"].mean() == pytest.approx(2.91, abs=0.1)
    assert set(trials["rating"]) == {0.0, 1.0, 2.0, 3.0, 4.0}


def test_every_pair_comes_once_in_each_of_three_series(naturalness):
    trials = pd.read_csv(naturalness / "trials.csv")
    assert (trials.groupby(["participant", "block"])["pair"].nunique() == 15).all()
    assert (trials.groupby("participant").size() == 45).all()


@pytest.mark.parametrize(("mean", "sd"), [(3.45, 0.83), (1.6, 0.83), (0.2, 1.5), (2.0, 0.5)])
def test_values_kept_between_the_ends_of_a_scale_have_the_mean_that_was_asked_for(mean, sd):
    from random import Random

    rng, latent = Random(1), latent_mean(mean, sd, 0.0, 4.0)
    kept = [min(max(rng.gauss(latent, sd), 0.0), 4.0) for _ in range(40_000)]
    assert sum(kept) / len(kept) == pytest.approx(mean, abs=0.02)

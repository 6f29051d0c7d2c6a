"""Power by simulation uses the study's own design and analysis, and does not depend on how it is split."""

from __future__ import annotations

from io import StringIO
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis import AnalysisError, anova, combine_power, power_by_simulation, t_tests
from analysis.power.simulated_experiments import cell_means_of, experiment_model
from analysis.statistics.many_anovas import many_anovas
from tests.analysis.recorded import study_text


@pytest.fixture(scope="module")
def study() -> dict[str, Any]:
    from ruamel.yaml import YAML

    return YAML(typ="safe", pure=True).load(StringIO(study_text()))


def test_each_simulated_experiment_gets_the_p_values_of_anova(study: dict[str, Any]) -> None:
    model = experiment_model(study, 13)
    values = cell_means_of(model, 5, range(3))
    found = many_anovas(values, model.design)
    cells = list(product(*model.design.within.values()))
    for number in range(3):
        rows = [
            (who, *cell, model.design.between["sex"][model.design.groups[who, 0]], values[number, who, place])
            for who in range(13)
            for place, cell in enumerate(cells)
        ]
        data = pd.DataFrame(rows, columns=["who", "actor", "speed", "start", "sex", "y"])
        table = anova(data, "y", "who", ["actor", "speed", "start"], "sex").set_index("effect")
        for effect, p in found.items():
            assert p[number] == pytest.approx(table.loc[effect, "p_gg"], rel=1e-8), effect


def test_any_split_gives_the_same_counts(study: dict[str, Any]) -> None:
    whole = power_by_simulation(study, experiments=60, seed=3)
    parts = [power_by_simulation(study, experiments=60, seed=3, shard=(i, 3)) for i in (2, 3, 1)]
    pd.testing.assert_frame_equal(combine_power(parts), whole)
    again = power_by_simulation(study_text(), experiments=60, seed=3)
    pd.testing.assert_frame_equal(again, whole)


def test_a_client_that_maps_and_gathers_gets_the_work(study: dict[str, Any]) -> None:
    class Client:
        def map(self, function: Any, jobs: Any) -> list[Any]:
            return [function(job) for job in jobs]

        def gather(self, results: Any) -> Any:
            return results

    one = power_by_simulation(study, experiments=20, client=Client())
    pd.testing.assert_frame_equal(one, power_by_simulation(study, experiments=20))


def test_the_published_means_make_the_actor_effect_certain(study: dict[str, Any]) -> None:
    table = power_by_simulation(study, experiments=200).set_index("name")
    assert table.loc["actor", "power"] > 0.95
    assert table.loc["actor F1", "power"] > 0.95
    assert (table["ci_low"] <= table["power"]).all()
    assert (table["power"] <= table["ci_high"]).all()


def test_without_an_effect_five_percent_are_significant(study: dict[str, Any]) -> None:
    same = {actor: {"mean": 0.0064, "sd": 0.0003} for actor in ("F1", "F2", "M1", "M2")}
    wide = {**study["task"], "range": {"minimum": 20, "maximum": 400}}
    null = {**study, "task": wide, "simulation": {**study["simulation"], "preferred_walk_ratio": same}}
    table = power_by_simulation(null, experiments=600, participants=12).set_index("name")
    for effect in ("actor", "start", "sex", "actor:sex"):
        assert 0.015 < table.loc[effect, "power"] < 0.1, effect


def test_t_tests_of_simulated_experiments_are_t_tests(study: dict[str, Any]) -> None:
    model = experiment_model(study, 8)
    values = cell_means_of(model, 1, range(1))
    rows = [
        (w, cell[0], values[0, w, i]) for w in range(8) for i, cell in enumerate(product(*model.design.within.values()))
    ]
    data = pd.DataFrame(rows, columns=["who", "actor", "y"])
    table = t_tests(data, "y", "who", each="actor", against=0.0069).set_index("level")
    from analysis.power.simulation import _t_p

    assert _t_p(values, model, "actor", "F1", 0.0069)[0] == pytest.approx(table.loc["F1", "p"], rel=1e-8)


def test_without_a_simulation_section_the_published_observers_are_simulated(study: dict[str, Any]) -> None:
    bare = {k: v for k, v in study.items() if k != "simulation"}
    preferences = {"preferred_walk_ratio": study["simulation"]["preferred_walk_ratio"]}
    same = power_by_simulation({**study, "simulation": preferences}, experiments=20)
    pd.testing.assert_frame_equal(power_by_simulation(bare, experiments=20), same)


def test_what_cannot_be_simulated_is_said(study: dict[str, Any]) -> None:
    factors = {**study["factors"], "actor": ["F1", "F7"]}
    with pytest.raises(AnalysisError, match="no preferred walk ratio for F7"):
        power_by_simulation({**study, "factors": factors}, experiments=5)
    with pytest.raises(AnalysisError, match="i/n"):
        power_by_simulation(study, experiments=5, shard=(3, 2))
    with pytest.raises(AnalysisError, match="no study file"):
        power_by_simulation("nowhere.yaml", experiments=5)
    assert np.isfinite(power_by_simulation(study, experiments=5)["power"]).all()


def test_levels_may_be_written_as_1_where_others_have_decimals(study: dict[str, Any]) -> None:
    against = {"0.8": 0.006, "1": 0.006, "1.2": 0.006}
    tests = [{"each": "speed", "against": against, "label": "a guess"}]
    written = {**study, "factors": {**study["factors"], "speed": [0.8, 1, 1.2]}}
    table = power_by_simulation({**written, "analysis": {**study["analysis"], "t_tests": tests}}, experiments=20)
    assert list(table.loc[table["test"] == "t", "name"]) == ["speed 0.8", "speed 1", "speed 1.2"]


def test_no_participants_are_not_the_planned_ones(study: dict[str, Any]) -> None:
    with pytest.raises(AnalysisError, match="0 participants are too few"):
        power_by_simulation(study, experiments=5, participants=0)


@pytest.mark.slow
def test_p_values_are_uniform_when_every_observer_has_one_walk_ratio(study: dict[str, Any]) -> None:
    from scipy import stats

    same = {actor: {"mean": 0.0064, "sd": 0.0003} for actor in ("F1", "F2", "M1", "M2")}
    wide = {**study["task"], "range": {"minimum": 20, "maximum": 400}}
    alike = {**study["simulation"], "preferred_walk_ratio": same, "shared": 1.0}
    model = experiment_model({**study, "task": wide, "simulation": alike})
    found = many_anovas(cell_means_of(model, 9, range(1500)), model.design)
    for effect in ("start", "sex", "start:sex"):  # one df: exact
        assert stats.kstest(found[effect], "uniform").pvalue > 0.005, effect
    for effect in ("actor", "speed", "actor:speed"):  # Greenhouse-Geisser: conservative by a little
        assert 0.025 < np.mean(found[effect] < 0.05) < 0.065, effect

"""From the study file to the statistics: simulated observers' preferences are found again, and nothing else is."""

from __future__ import annotations

import csv

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from analysis import analyse, anova
from experiment_app.loop import run_session
from experiment_app.simulated.observer import SimulatedParticipant, draw_observer
from experiment_app.simulated.simulate import simulate
from experiment_app.windows.undrawn import UndrawnWindow
from protocols.orders.design import default_seed
from protocols.plan import make_plan
from protocols.record import Record, TrialRecord
from protocols.session import begin
from protocols.study_file import parse_study, read_study
from tests.protocols.studies import shipped_text

PUBLISHED = {"F1": 0.00573, "F2": 0.00595, "M1": 0.00658, "M2": 0.00651}
"""Means of Niay (2022), table 3.4, m·min."""


@pytest.fixture(scope="module")
def analysed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recovery")
    for _ in simulate(read_study("walk_ratio"), 22, folder / "data", seed=1):
        pass
    analyse(folder / "data" / "walk_ratio", folder / "a")
    analyse(folder / "data" / "walk_ratio", folder / "b")
    return folder


def rows(path) -> list[dict[str, str]]:
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_the_same_journals_analysed_twice_give_the_same_bytes(analysed):
    first = {p.name: p.read_bytes() for p in sorted((analysed / "a").iterdir())}
    second = {p.name: p.read_bytes() for p in sorted((analysed / "b").iterdir())}
    assert first == second


def test_the_effect_of_actor_is_found(analysed):
    effects = {row["effect"]: row for row in rows(analysed / "a" / "anova.csv")}
    assert len(effects) == 15
    assert float(effects["actor"]["p_gg"]) < 0.001


def inside(trials: pd.DataFrame, actor: str) -> bool:
    """Whether the published mean lies in the 95 % confidence interval of the participants' means."""
    means = trials[trials.actor == actor].groupby("participant").walk_ratio.mean()
    half = stats.t.ppf(0.975, len(means) - 1) * means.std() / np.sqrt(len(means))
    return bool(abs(means.mean() - PUBLISHED[actor]) < half)


@pytest.mark.parametrize("actor", PUBLISHED)
def test_each_actors_published_mean_lies_in_the_95_percent_interval(analysed, actor):
    assert inside(pd.read_csv(analysed / "a" / "trials.csv"), actor)


@pytest.mark.slow
def test_the_95_percent_intervals_hold_the_published_means_in_about_95_of_100_experiments():
    study = parse_study("s.yaml", shipped_text().replace("repetitions: 4 ", "repetitions: 1 ")).study
    data = [experiment(study, seed) for seed in range(60)]
    for actor in PUBLISHED:
        # the ends of the range, 80 and 120 steps/min, cut off the most extreme answers and shift the means a
        # little; 60 experiments at 95 % give 57, s.d. 1.7
        assert sum(inside(trials, actor) for trials in data) >= 51, actor


class Memory:
    """A recorder that keeps the trials."""

    saved = True

    def __init__(self) -> None:
        self.trials: list[TrialRecord] = []

    def write(self, records: list[Record]) -> None:
        self.trials += [r for r in records if isinstance(r, TrialRecord) and not r.practice]


def indifferent():
    """The study with observers who have one walk ratio of their own for every actor, well inside the range."""
    text = shipped_text()
    text = text.replace("repetitions: 4 ", "repetitions: 1 ").replace("shared: 0.75", "shared: 1.0")
    for actor, mean in PUBLISHED.items():
        start = text.index(f"{actor}: {{mean: {mean:.5f}")
        text = text[:start] + f"{actor}: {{mean: 0.00630, sd: 0.00020}}" + text[text.index("\n", start) :]
    return parse_study("indifferent.yaml", text.replace("trial_noise: 0.0004", "trial_noise: 0.0003")).study


def experiment(study, seed: int, participants: int = 22) -> pd.DataFrame:
    """One simulated experiment, in memory."""
    found = []
    for number in range(1, participants + 1):
        own = default_seed(f"{study.study}/{seed}", f"S{number}", 1)
        memory = Memory()
        person = SimulatedParticipant(study, draw_observer(study, number, own), own)
        run_session(begin(make_plan(study, own, number)), UndrawnWindow(person, lambda: None), memory)
        for trial in memory.trials:
            sex = "female" if number % 2 else "male"
            found.append({"participant": number, "sex": sex, **trial.factors, **trial.response})
    return pd.DataFrame(found)


@pytest.mark.slow
def test_without_an_effect_the_p_values_of_the_main_effects_are_uniform_over_200_seeds():
    study = indifferent()
    found: dict[str, list[float]] = {"actor": [], "speed": [], "start": [], "sex": []}
    for seed in range(200):
        data = experiment(study, seed)
        table = anova(data, "walk_ratio", "participant", within=("actor", "speed", "start"), between=("sex",))
        p = table.set_index("effect")["p"]
        for effect, values in found.items():
            values.append(float(p[effect]))
    for effect, values in found.items():
        # Kolmogorov-Smirnov against the uniform distribution; four tests at 0.001 fail a sound program once in 250
        assert stats.kstest(values, "uniform").pvalue > 0.001, (effect, np.mean(np.array(values) < 0.05))

"""Every example script runs on the trials of its study: simulated by the real study file, where there is one."""

from __future__ import annotations

from importlib import import_module
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import analysis.examples
from analysis.planned.plan import read_plan
from analysis.recorded import journal
from analysis.recorded.trials import trials_table
from experiment_app.simulated.simulate import simulate
from protocols.study_file import read_study, shipped_studies

RNG = np.random.default_rng(17)
PARTICIPANTS = {"walk_ratio_actors": 8}  # two in each of its four groups; of the other studies six are enough


def simulated(name: str, data: Path) -> pd.DataFrame:
    """The table of trials as `gaitlab analyse` writes it, of simulated participants."""
    file = read_study(name)
    for _ in simulate(file, PARTICIPANTS.get(name, 6), data):
        pass
    return trials_table(journal.read_study(data / name), read_plan(file.text, name))


def rows(people: int, *levels: tuple[Any, ...]) -> list[tuple[Any, ...]]:
    return [(f"P{p:02d}", *cell) for p in range(people) for cell in product(*levels)]


def avoidance() -> pd.DataFrame:
    data = pd.DataFrame(
        rows(9, ("slow", "normal", "fast", "still", "sway"), (1, 2, 3)), columns=["participant", "condition", "rep"]
    )
    for name in ("time_to_contact", "clearance", "avoidance_rate"):
        data[name] = RNG.normal(1, 0.2, len(data))
    return data


WITHOUT_STUDY_FILE = {"avoidance": avoidance}
"""Made-up tables of the columns the script names, until the study can be simulated."""

SCRIPTS = sorted(p.stem for p in Path(analysis.examples.__file__).parent.glob("[!_]*.py"))


def printed_by(name: str, trials: pd.DataFrame, folder: Path, capsys: pytest.CaptureFixture[str]) -> str:
    path = folder / "trials.csv"
    trials.to_csv(path, index=False)
    import_module(f"analysis.examples.{name}").main(str(path))
    return capsys.readouterr().out


@pytest.mark.parametrize("name", SCRIPTS)
def test_the_example_runs_on_the_trials_of_its_study(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    trials = simulated(name, tmp_path) if name in shipped_studies() else WITHOUT_STUDY_FILE[name]()
    printed = printed_by(name, trials, tmp_path, capsys)
    assert len(printed.splitlines()) >= 5
    assert "nan" not in printed


def test_every_shipped_study_has_an_example() -> None:
    assert set(shipped_studies()) <= set(SCRIPTS)

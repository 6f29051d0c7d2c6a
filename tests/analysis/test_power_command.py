"""`gaitlab power`: one table, whatever machines its parts were made on, and a warning where the range lies."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis import AnalysisError
from analysis.power.simulated_experiments import cell_means_of, experiment_model
from analysis.power.simulation import as_dict
from analysis.power.study import join_parts, power_notes, read_part, simulate_power
from analysis.statistics.many_anovas import many_anovas
from experiment_app.command import run
from tests.analysis.recorded import study_text

HEIGHTS = {"F1": 1.72, "F2": 1.60, "M1": 1.80, "M2": 1.83}


def test_parts_joined_in_any_order_are_the_whole(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    asked = ["power", "walk_ratio", "--participants", "12", "22", "--experiments", "40", "--workers", "1"]
    assert run([*asked, "--plot", "power.png"]) == 0
    whole = capsys.readouterr().out
    assert "12 participants  actor x speed" in whole
    assert "22 participants  t test of actor F1" in whole
    assert (tmp_path / "power.png").read_bytes()[:4] == b"\x89PNG"
    for i in (1, 2, 3):
        assert run([*asked, "--shard", f"{i}/3", "--out", f"{i}.json"]) == 0
    capsys.readouterr()
    assert run(["power", "walk_ratio", "--combine", "3.json", "1.json", "2.json"]) == 0
    joined = capsys.readouterr()
    assert [line for line in joined.out.splitlines() if "part" in line] == [
        line for line in whole.splitlines() if "part" in line
    ]
    assert "missing" not in joined.err
    assert run(["power", "walk_ratio", "--combine", "1.json", "2.json"]) == 0
    assert "Part 3 of 3 is missing" in capsys.readouterr().err


def test_parts_that_do_not_belong_together_are_refused(tmp_path: Path) -> None:
    part = simulate_power(study_text(), [12], experiments=4, shard=(1, 2))
    with pytest.raises(AnalysisError, match="part 1 is there twice"):
        join_parts([part, part])
    with pytest.raises(AnalysisError, match="different seeds"):
        join_parts([part, simulate_power(study_text(), [12], experiments=4, shard=(2, 2), seed=2)])
    with pytest.raises(AnalysisError, match="different study files"):
        join_parts([part, simulate_power(study_text().replace("sd: 0.00065", "sd: 0.001"), [12], experiments=4)])
    (tmp_path / "x.json").write_text(json.dumps({"kind": "other"}))
    with pytest.raises(AnalysisError, match="no part of a power simulation"):
        read_part(tmp_path / "x.json")
    with pytest.raises(AnalysisError, match="cannot be read"):
        read_part(tmp_path / "nowhere.json")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--shard", "3/2"], "write i/n"),
        (["--shard", "x"], "write i/n"),
        (["--experiments", "0"], "at least 1 is needed"),
        (["--participants", "2"], "too few for 2 group"),
    ],
)
def test_wrong_arguments_are_one_sentence(arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["power", "walk_ratio", *arguments]) in (1, 2)
    assert said in capsys.readouterr().err


def test_without_dask_the_way_out_is_said(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def missing(name: str) -> Any:
        raise ImportError(name)

    monkeypatch.setattr("analysis.power.study.import_module", missing)
    assert run(["power", "walk_ratio", "--dask", "tcp://scheduler:8786"]) == 1
    assert "dask is not installed" in capsys.readouterr().err


def test_the_range_cuts_answers_off_where_walkers_are_slow_or_fast() -> None:
    assert "F1 at 1.2 m/s" in power_notes(study_text())[0]
    study = dict(as_dict(study_text()))
    study["task"] = {**study["task"], "range": {"minimum": 30, "maximum": 240}}
    assert experiment_model(study).observers.clipped_shares(22)["share"].max() < 0.001
    assert not any("cuts off" in note for note in power_notes(study))


def test_the_normalised_walk_ratio_can_be_simulated_too() -> None:
    study = dict(as_dict(study_text()))
    plain = cell_means_of(experiment_model(study, 8), 1, range(2))
    study["analysis"] = {**study["analysis"], "measure": "normalised_walk_ratio", "heights": HEIGHTS}
    model = experiment_model(study, 8)
    scale = np.repeat([60 * (9.81 / h**3) ** 0.5 for h in HEIGHTS.values()], 6)
    scaled = cell_means_of(model, 1, range(2))
    assert scaled == pytest.approx(plain * scale, rel=1e-10)
    assert isinstance(pd.DataFrame(many_anovas(scaled, model.design)), pd.DataFrame)


def test_a_study_whose_levels_are_words_and_numbers_can_be_simulated() -> None:
    study = {**as_dict(study_text()), "paces": {"slow": 1.0, 2: 1.2, 1: 0.8}}
    hashes = {simulate_power(one, [8], experiments=2).study_hash for one in (study, dict(reversed(study.items())))}
    assert len(hashes) == 1

"""Every example script runs on a table of the columns it names."""

from __future__ import annotations

from importlib import import_module
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import analysis.examples

ACTORS = ("F1", "F2", "M1", "M2")
RNG = np.random.default_rng(17)


def rows(people: int, *levels: tuple[Any, ...]) -> list[tuple[Any, ...]]:
    return [(f"P{p:02d}", *cell) for p in range(people) for cell in product(*levels)]


def walk_ratio() -> pd.DataFrame:
    data = pd.DataFrame(
        rows(10, ACTORS, (0.8, 1.0, 1.2), (80, 120), (1, 2)), columns=["participant", "actor", "speed", "start", "rep"]
    )
    data["sex"] = np.where(data["participant"].str[-1].astype(int) % 2, "female", "male")
    data["trial"] = data.groupby("participant").cumcount() + 1
    return data.assign(walk_ratio=0.006 + 0.0006 * RNG.normal(size=len(data)))


def walk_ratio_actors() -> pd.DataFrame:
    actors = [
        (f"{sex}{i}", sex, h, w, v)
        for sex in "FM"
        for i, (h, w, v) in enumerate(RNG.uniform((1.6, 50, 1), (1.9, 90, 1.4), (8, 3)))
    ]
    data = pd.DataFrame(
        rows(8, tuple(range(16)), ("matched", "mismatched")), columns=["participant", "which", "character"]
    )
    for place, name in enumerate(("actor", "actor_sex", "height", "weight", "speed")):
        data[name] = [actors[i][place] for i in data["which"]]
    number = data["participant"].str[-1].astype(int)
    data["viewing"], data["participant_gender"] = (
        np.where(number < 4, "screen", "headset"),
        np.where(number % 2, "f", "m"),
    )
    data["step_frequency"] = RNG.normal(105, 5, len(data))
    return data.assign(step_length=60 * data["speed"] / data["step_frequency"])


def poulaine_reconstruction() -> pd.DataFrame:
    data = pd.DataFrame(
        rows(8, (4, 5), ("cubic", "pchip", "hermite"), ACTORS, ("slow", "comfort", "fast"), (1, 2)),
        columns=["participant", "points", "interpolation", "actor", "speed", "rep"],
    )
    data["gender"] = np.where(data["participant"].str[-1].astype(int) % 2, "f", "m")
    data["original"] = "captured"
    data["chosen"] = np.where(RNG.random(len(data)) < 0.4, "rebuilt", "captured")
    return data.assign(response_time=RNG.gamma(4, 1, len(data)))


def speed_editing() -> pd.DataFrame:
    methods = ("poulaine", "blending", "warping")
    data = pd.DataFrame(
        rows(8, methods, ("slowed", "sped_up"), ACTORS, (0.8, 1.0, 1.2), ("left", "right")),
        columns=["participant", "method", "direction", "actor", "speed", "side"],
    )
    data["gender"] = np.where(data["participant"].str[-1].astype(int) % 2, "f", "m")
    data["original"] = "captured"
    data["chosen"] = np.where(RNG.random(len(data)) < 0.4, "edited", "captured")
    return data.assign(response_time=RNG.gamma(4, 1, len(data)))


def crowd_variety() -> pd.DataFrame:
    data = pd.DataFrame(
        rows(9, ("1:2", "1:5", "1:10", "1:25", "1"), (250, 500, 1000), (1, 2, 3)),
        columns=["participant", "ratio", "size", "rep"],
    )
    return data.assign(correct=(RNG.random(len(data)) < 0.55).astype(int))


def avoidance() -> pd.DataFrame:
    data = pd.DataFrame(
        rows(9, ("slow", "normal", "fast", "still", "sway"), (1, 2, 3)), columns=["participant", "condition", "rep"]
    )
    for name in ("time_to_contact", "clearance", "avoidance_rate"):
        data[name] = RNG.normal(1, 0.2, len(data))
    return data


def fourier_naturalness() -> pd.DataFrame:
    styles = ("drunken", "manly", "proud", "sad", "tired", "cool", "afraid", "heavy", "hurried")
    data = pd.DataFrame(rows(12, styles), columns=["participant", "style"]).sample(frac=0.7, random_state=1)
    return data.assign(rating=RNG.integers(0, 5, len(data)))


SCRIPTS = sorted(p.stem for p in Path(analysis.examples.__file__).parent.glob("[!_]*.py"))


@pytest.mark.parametrize("name", SCRIPTS)
def test_the_example_runs(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "trials.csv"
    globals()[name]().to_csv(path, index=False)
    import_module(f"analysis.examples.{name}").main(str(path))
    printed = capsys.readouterr().out
    assert len(printed.splitlines()) >= 5
    assert "nan" not in printed

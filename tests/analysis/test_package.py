"""The room as a whole: what it exports, what it costs to import, how fast it is."""

from __future__ import annotations

import subprocess
import sys
import time
from importlib.util import find_spec
from itertools import product

import numpy as np
import pandas as pd
import pytest

import analysis


@pytest.mark.parametrize("name", sorted(analysis.__all__))
def test_every_exported_name_exists_has_a_docstring_and_is_no_module(name: str) -> None:
    assert getattr(analysis, name).__doc__
    assert find_spec(f"analysis.{name}") is None


def test_importing_the_room_loads_nothing_heavy() -> None:
    code = (
        "import sys, analysis; print(*(m for m in ('pandas', 'scipy', 'matplotlib', 'pydantic') if m in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == ""


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="anovas"):
        _ = analysis.anovas


def thesis_sized() -> pd.DataFrame:
    cells = product(range(22), ("F1", "F2", "M1", "M2"), (0.8, 1.0, 1.2), (80, 120), range(4))
    data = pd.DataFrame(cells, columns=["participant", "actor", "speed", "start", "repetition"])
    data["sex"] = np.where(data["participant"] < 10, "f", "m")
    return data.assign(walk_ratio=np.random.default_rng(1).normal(0.006, 0.0005, len(data)))


def fastest(function, times: int) -> float:  # type: ignore[no-untyped-def]
    found = []
    for _ in range(times):
        begun = time.perf_counter()
        function()
        found.append(time.perf_counter() - begun)
    return min(found)


def test_the_anova_of_22_participants_and_96_trials_takes_15_milliseconds() -> None:
    data = thesis_sized()
    seconds = fastest(lambda: analysis.anova(data, "walk_ratio", "participant", ["actor", "speed", "start"], "sex"), 15)
    assert seconds < 0.015


def test_918_tukey_contrasts_take_a_second() -> None:
    from analysis.studentized_range import survival

    q, df = np.linspace(0.1, 9, 918), np.linspace(20, 200, 918)
    assert fastest(lambda: survival(q, 24, df), 3) < 1.0

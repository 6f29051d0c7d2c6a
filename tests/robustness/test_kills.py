"""A session killed at any moment loses no acknowledged trial, doubles no cell, and marks what it repeats."""

from __future__ import annotations

import pytest

from tests.robustness.killing import kill_sessions


@pytest.mark.parametrize(
    ("kills", "seed"), [pytest.param(3, 1, id="3"), pytest.param(20, 2, id="20", marks=pytest.mark.slow)]
)
def test_kills_at_random_moments_lose_no_acknowledged_trial_and_double_none(tmp_path, kills, seed):
    """`python -m tests.benchmarks.kills 200` kills as often as one likes."""
    toll = kill_sessions(tmp_path, kills, seed)
    assert toll.good, toll
    assert toll.kills == kills
    assert toll.finished >= 1
    assert set(toll.reasons) <= {
        "no end was recorded: killed, or the power failed", "crashed: Segmentation fault", "crashed: Aborted",
    }  # fmt: skip

"""Many sessions through the off-screen window with the real renderer leave nothing behind in the process."""

from __future__ import annotations

import sys

import pytest

from tests.robustness.soaking import growth, soak


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="memory and handles are read from /proc")
def test_memory_and_file_handles_stay_flat_over_sessions(tmp_path):
    """`python -m tests.benchmarks.soak 10000` soaks for as long as one likes."""
    uses = list(soak(tmp_path, 24 * 8, 24))
    assert uses[-1].handles == uses[1].handles
    # allocators settle over the first sessions; what a session keeps would be some MiB each
    assert uses[-1].memory - uses[2].memory < 12.0, uses
    assert growth(uses) < 100.0, uses

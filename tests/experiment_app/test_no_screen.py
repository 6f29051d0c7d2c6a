"""A computer without a screen is told so by an answer, and not by a warning of the window library."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

ASKS = "from experiment_app.windows.screen import has_screen; print(has_screen())"


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere a screen is not named by the environment")
def test_where_there_is_no_screen_nothing_but_the_answer_is_printed() -> None:
    without = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    asked = subprocess.run([sys.executable, "-c", ASKS], env=without, capture_output=True, text=True, check=True)
    assert (asked.stdout, asked.stderr) == ("False\n", "")

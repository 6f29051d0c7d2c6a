"""The room as a whole: what it exports, what it costs to import."""

from __future__ import annotations

import subprocess
import sys
from importlib.util import find_spec

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

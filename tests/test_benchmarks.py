"""The benchmarks are run by hand, so this alone tells when what they import has moved."""

import ast
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parent / "benchmarks"
OWN = ("analysis", "experiment_app", "protocols", "stimuli", "tests")


@pytest.mark.parametrize("file", sorted(BENCHMARKS.rglob("*.py")), ids=lambda f: str(f.relative_to(BENCHMARKS)))
def test_a_benchmark_imports_only_what_there_is(file):
    """Imports inside functions, too."""
    for statement in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(statement, ast.ImportFrom) and (statement.module or "").split(".")[0] in OWN:
            module = import_module(statement.module)
            for name in statement.names:
                assert hasattr(module, name.name) or find_spec(f"{statement.module}.{name.name}"), name.name

"""The whole check of the project: format, lint, types, import contracts, tests with coverage under a virtual display.

`python -m tests.run` runs all of it; further arguments go to pytest, as `-m "not slow"`.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CHECKS = (
    ("format", [sys.executable, "-m", "ruff", "format", "--check", "."]),
    ("lint", [sys.executable, "-m", "ruff", "check", "."]),
    ("types", [sys.executable, "-m", "mypy"]),
    ("import contracts", [str(Path(sys.executable).with_name("lint-imports"))]),
)


def main() -> int:
    """Runs every check to the end and returns 1 when one failed."""
    failed = []
    for name, command in CHECKS:
        print(f"== {name}", flush=True)
        if subprocess.run(command, cwd=ROOT).returncode:
            failed.append(name)
    print("== tests", flush=True)
    pytest = [sys.executable, "-m", "pytest", "--cov", "--cov-report=term:skip-covered", *sys.argv[1:]]
    with virtual_display() as environment:
        if status := subprocess.run(pytest, cwd=ROOT, env=environment).returncode:
            failed.append("tests" if status == 1 else f"tests (pytest ended with {status})")
    if failed:
        print(f"failed: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


@contextmanager
def virtual_display() -> Iterator[dict[str, str]]:
    """The environment with a virtual display where Xvfb is installed, so that no test opens a window on yours."""
    environment = {**os.environ, "MPLBACKEND": "Agg", "MPLCONFIGDIR": tempfile.mkdtemp(prefix="gaitlab-mpl-")}
    if shutil.which("Xvfb") is None:
        yield environment
        return
    reader, writer = os.pipe()
    # without -noreset the server begins anew whenever its last window closes, and refuses whoever comes just then
    command = ["Xvfb", "-displayfd", str(writer), "-screen", "0", "1920x1080x24", "-nolisten", "tcp", "-noreset"]
    server = subprocess.Popen(command, pass_fds=[writer], stderr=subprocess.DEVNULL)
    os.close(writer)
    with os.fdopen(reader) as numbers:
        environment["DISPLAY"] = f":{numbers.readline().strip()}"
    environment.pop("WAYLAND_DISPLAY", None)
    try:
        yield environment
    finally:
        server.terminate()
        server.wait()


if __name__ == "__main__":
    sys.exit(main())

"""What setup.sh installs is what the lock files say, whatever has been released since they were written."""

import re
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parents[1]
LOCKS = ("requirements.lock", "requirements-dev.lock")


def pinned(lock: str) -> dict[str, str]:
    """The version of each library a lock file names, by canonical name."""
    lines = (ROOT / lock).read_text(encoding="utf-8").splitlines()
    pins = [re.match(r"([A-Za-z0-9._-]+)==([^\s;]+)", line) for line in lines if line[:1].isalnum()]
    assert all(pins), "every line of a lock pins one version"
    return {str(canonicalize_name(pin[1])): pin[2] for pin in pins if pin}


def needed_here(name: str) -> set[str]:
    """The libraries that an installed one cannot do without on this system; none where it is not installed here."""
    try:
        requirements = [Requirement(text) for text in distribution(name).requires or ()]
    except PackageNotFoundError:
        return set()
    here = [one for one in requirements if one.marker is None or one.marker.evaluate({"extra": ""})]
    return {str(canonicalize_name(one.name)) for one in here}


@pytest.mark.parametrize("lock", LOCKS)
def test_a_lock_names_every_library_that_its_libraries_and_gaitlab_need(lock):
    pins = pinned(lock)
    for name in ("gaitlab", *pins):
        assert needed_here(name) <= pins.keys(), f"{lock} misses what {name} needs"


@pytest.mark.parametrize("page", ["setup.sh", "README.md"])
def test_a_release_newer_than_the_lock_is_never_looked_at(page):
    """pip refused the locked libraries on the day one of them had a newer release, until told not to resolve."""
    text = (ROOT / page).read_text(encoding="utf-8")
    installs = [line for line in text.splitlines() if re.search(r"pip install\b", line)]
    assert installs
    assert all("--no-deps" in line for line in installs)

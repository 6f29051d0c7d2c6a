"""What is written must be there after a power cut, on every system and on disks that cannot promise all of it."""

from __future__ import annotations

import errno
import os
import stat
import sys

import pytest

from experiment_app.run_folder import participant_runs
from stimuli.whole_file import force_file
from tests.experiment_app.sessions import opened, play


def refusing_folders(number: int):
    real = os.fsync

    def fsync(descriptor: int) -> None:
        if stat.S_ISDIR(os.fstat(descriptor).st_mode):
            raise OSError(number, os.strerror(number))
        real(descriptor)

    return fsync


@pytest.mark.skipif(os.name == "nt", reason="Windows forces no folders")
def test_a_run_is_made_on_a_network_disk_that_cannot_force_folders(tmp_path, monkeypatch):
    """As SMB and FUSE disks answer: EINVAL."""
    monkeypatch.setattr(os, "fsync", refusing_folders(errno.EINVAL))
    play(opened(tmp_path))
    assert participant_runs(tmp_path, "walk_ratio", "P01")[-1].end == "finished"


@pytest.mark.skipif(os.name == "nt", reason="Windows forces no folders")
def test_a_folder_that_a_broken_disk_cannot_force_is_an_error(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "fsync", refusing_folders(errno.EIO))
    with pytest.raises(OSError, match="Input/output error"):
        opened(tmp_path)


@pytest.mark.parametrize("lacking", [False, True])
@pytest.mark.skipif(os.name == "nt", reason="Windows has no fcntl")
def test_on_macos_the_drives_own_cache_is_emptied_too(tmp_path, monkeypatch, lacking):
    import fcntl

    asked = []

    def full(descriptor: int, what: int) -> None:
        asked.append(what)
        if lacking:
            raise OSError(errno.ENOTSUP, "Operation not supported")

    monkeypatch.setattr(sys, "platform", "darwin")
    monkeypatch.setattr(fcntl, "F_FULLFSYNC", 51, raising=False)
    monkeypatch.setattr(fcntl, "fcntl", full)
    monkeypatch.setattr(os, "fsync", asked.append)
    with open(tmp_path / "journal", "wb") as file:
        force_file(file.fileno())
        assert asked == [51, *([file.fileno()] if lacking else [])]

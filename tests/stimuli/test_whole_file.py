"""What is imported is kept whole or not at all."""

from __future__ import annotations

import os
import sys

import pytest

from stimuli.bodies.imported_bodies import path_of, stored
from stimuli.whole_file import whole_file


def test_a_file_whose_writing_fails_half_way_leaves_the_old_one_and_nothing_else(tmp_path):
    path = tmp_path / "anna.npz"
    path.write_bytes(b"old")

    def write() -> None:
        with whole_file(path) as stream:
            stream.write(b"half")
            raise OSError("No space left on device")

    with pytest.raises(OSError, match="No space left"):
        write()
    assert [(one.name, one.read_bytes()) for one in tmp_path.iterdir()] == [("anna.npz", b"old")]


@pytest.mark.skipif(os.name == "nt", reason="Windows has no fcntl")
def test_on_macos_an_imported_body_is_out_of_the_drives_cache_before_it_takes_its_name(tmp_path, monkeypatch):
    import fcntl

    there = []
    monkeypatch.setenv("GAITLAB_BODIES", str(tmp_path))
    monkeypatch.setattr(sys, "platform", "darwin")
    monkeypatch.setattr(fcntl, "F_FULLFSYNC", 51, raising=False)
    monkeypatch.setattr(fcntl, "fcntl", lambda _, what: there.append((what, path_of("anna").exists())))
    assert stored(b"glb", "anna").read_bytes() == b"glb"
    assert there == [(51, False)]

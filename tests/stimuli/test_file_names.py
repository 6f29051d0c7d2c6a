"""Names of devices on Windows, which no file there can have, are refused for everything that is kept in files."""

from __future__ import annotations

import pytest

from stimuli.actor_library import check_name
from stimuli.actors import ActorError
from stimuli.bodies.imported_bodies import stored
from stimuli.body_files.errors import BodyError
from stimuli.file_names import why_no_file


@pytest.mark.parametrize("name", ["con", "PRN", "Aux", "nul", "com1", "COM9", "lpt1", "Lpt9"])
def test_what_windows_calls_a_device_is_no_name_in_any_case(name):
    assert why_no_file(name).startswith(f"{name} is what Windows calls a device")


@pytest.mark.parametrize("name", ["console", "con_1", "com", "com0", "com10", "lpt", "null", "anna"])
def test_names_that_only_look_like_one_are_left_alone(name):
    assert why_no_file(name) == ""


def test_no_actor_or_body_is_called_as_a_device(tmp_path, monkeypatch):
    monkeypatch.setenv("GAITLAB_BODIES", str(tmp_path))
    with pytest.raises(ActorError, match="Aux is what Windows calls a device"):
        check_name("Aux", tmp_path)
    with pytest.raises(BodyError, match="nul is what Windows calls a device"):
        stored(b"", "nul")
    assert not list(tmp_path.iterdir())

"""Imported actors on disk: whole or not at all, read back as they were written, damaged files one sentence."""

from random import Random

import numpy as np
import pytest

from stimuli.actor_library import (
    StoredActor,
    StoredCycle,
    actor_of,
    check_name,
    imported_names,
    library_folder,
    read_stored,
    stored,
)
from stimuli.actors import ActorError, Person
from stimuli.bodies import imported_bodies
from stimuli.gait import Gait
from stimuli.gait_model import Step, WalkCurves, load_gait_model
from stimuli.measure import delivered_gait


def actor(name: str = "anna", speeds: tuple[float, ...] = (1.0, 1.2)) -> StoredActor:
    """An actor whose two cycles are the gait model's own, one of them said to be captured."""
    model = load_gait_model()
    cycles = tuple(
        StoredCycle(
            speed,
            100.0 + 20.0 * (speed - 1.0),
            WalkCurves.symmetric(model.coefficients(Step.of(speed, 100.0, 0.8), 0.5), 0.62),
            ("a.bvh",) if speed == 1.0 else (),
            (Gait.at_speed(speed, 100.0),) if speed == 1.0 else (),
        )
        for speed in speeds
    )
    person = Person(name, "F", 30.0, 1.7, 60.0, 1.1, 0.006, "captured", ())
    return StoredActor(person, "CC BY 4.0", "our laboratory", ((0.0, cycles),), True, ("a note",))


def test_what_is_stored_is_read_back(tmp_path):
    written = actor()
    stored(written, tmp_path)
    read = read_stored("anna", tmp_path)
    assert read.person == written.person
    assert (read.licence, read.source, read.follows, read.notes) == ("CC BY 4.0", "our laboratory", True, ("a note",))
    assert read.cycles[0].captured == written.cycles[0].captured
    np.testing.assert_allclose(read.cycles[1].walk.sides, written.cycles[1].walk.sides, atol=1e-6)
    assert read.provenance == "1 cycle captured, 1 modelled; licence: CC BY 4.0; source: our laboratory"


def test_a_stored_actor_walks_at_what_is_asked(tmp_path):
    stored(actor(), tmp_path)
    delivered = delivered_gait(actor_of(read_stored("anna", tmp_path)), 1.1, 102.0)
    assert delivered.speed == pytest.approx(1.1, rel=1e-3)
    assert delivered.step_frequency == pytest.approx(102.0, rel=1e-3)
    assert delivered.slide_mean < 5.0


def test_a_write_that_fails_leaves_nothing_and_keeps_the_old_actor(tmp_path, monkeypatch):
    stored(actor(), tmp_path)
    before = (tmp_path / "anna.npz").read_bytes()

    def full(*_: object, **__: object) -> None:
        raise OSError("no space left on device")

    monkeypatch.setattr(np, "savez_compressed", full)
    with pytest.raises(OSError, match="no space"):
        stored(actor(speeds=(1.0, 1.3)), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["anna.npz"]
    assert (tmp_path / "anna.npz").read_bytes() == before


def test_an_actor_of_which_a_few_bytes_have_changed_is_read_or_refused_in_a_sentence(tmp_path):
    path, rng, refused = stored(actor(), tmp_path), Random(1), 0
    whole = path.read_bytes()
    for _ in range(300):
        spoiled = bytearray(whole)
        spoiled[rng.randrange(len(whole))] ^= 1 << rng.randrange(8)
        path.write_bytes(spoiled)
        try:
            read_stored("anna", tmp_path)
        except ActorError:
            refused += 1
    assert refused > 200


@pytest.mark.parametrize("size", [0, 10, 200, 1000])
def test_a_damaged_file_is_one_sentence(tmp_path, size):
    path = stored(actor(), tmp_path)
    path.write_bytes(path.read_bytes()[:size])
    with pytest.raises(ActorError, match="import the actor again") as error:
        read_stored("anna", tmp_path)
    assert "\n" not in str(error.value)


def test_a_name_that_differs_in_case_only_is_taken_because_it_is_the_same_file_on_windows_and_macos(tmp_path):
    stored(actor(), tmp_path)
    with pytest.raises(ActorError, match="there is an actor anna already; choose another name, or say --replace"):
        check_name("Anna", tmp_path)
    check_name("Anna", tmp_path, replace=True)


def test_an_actor_that_is_not_there_is_named(tmp_path):
    with pytest.raises(ActorError, match="nobody"):
        read_stored("nobody", tmp_path)


def test_the_library_is_where_the_environment_says(tmp_path, monkeypatch):
    monkeypatch.setenv("GAITLAB_ACTORS", str(tmp_path / "mine"))
    assert library_folder() == tmp_path / "mine"
    assert imported_names() == ()
    monkeypatch.delenv("GAITLAB_ACTORS")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    assert library_folder().name == "actors"


def test_an_imported_actor_is_known_wherever_default_ones_are(tmp_path, monkeypatch):
    from stimuli.actors import actor_names, load_actor

    monkeypatch.setenv("GAITLAB_ACTORS", str(tmp_path))
    assert "anna" not in actor_names()
    stored(actor(), tmp_path)
    assert actor_names()[-1] == "anna"
    assert load_actor("anna").height == 1.7


def test_what_an_imported_actor_covers_and_comes_from_is_known_without_making_its_walks(tmp_path, monkeypatch):
    from stimuli.actors import load_actor, provenance_of, tree_of

    monkeypatch.setenv("GAITLAB_ACTORS", str(tmp_path))
    stored(actor(), tmp_path)
    walking = load_actor("anna")
    monkeypatch.setattr("stimuli.actor_library.walk_cycle", lambda *_, **__: pytest.fail("a walk was made"))
    assert tree_of("anna") == walking.tree
    assert provenance_of("anna") == walking.provenance
    with pytest.raises(ActorError, match="no actor 'annna'"):
        provenance_of("annna")


def test_a_library_that_cannot_be_written_is_named_with_the_way_out(tmp_path, monkeypatch):
    (tmp_path / "home").write_text("a file where a folder should be")
    monkeypatch.setenv("GAITLAB_ACTORS", str(tmp_path / "home" / "actors"))
    with pytest.raises(OSError, match=r"actors cannot be written \(Not a directory\); .* with GAITLAB_ACTORS\."):
        stored(actor())
    monkeypatch.setenv("GAITLAB_BODIES", str(tmp_path / "home" / "bodies"))
    with pytest.raises(OSError, match=r"bodies cannot be written \(Not a directory\); .* with GAITLAB_BODIES\."):
        imported_bodies.stored(b"glb", "anna")

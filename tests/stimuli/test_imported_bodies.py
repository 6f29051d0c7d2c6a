"""Imported bodies: the library, pictures and alpha of materials, and soles that stay on the ground."""

import json
from functools import cache
from importlib.resources import files
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from stimuli.actors import load_actor, people
from stimuli.bodies.imported_bodies import imported_names, stored
from stimuli.bodies.known import body_names, haircut_names, load_body, scaled, variant_names
from stimuli.bodies.retarget import longest_step, on_its_own_soles, sole_gaps
from stimuli.body_files.container import Container, open_container, read_container, write_container
from stimuli.body_files.errors import BodyError
from stimuli.body_files.imported import import_and_explain, import_body
from stimuli.body_files.packing import packed
from stimuli.measure import delivered_gait
from tests.stimuli.short_legs import short_legged

MAN = files("stimuli").joinpath("data", "bodies", "man.glb").read_bytes()
MODELS = Path(__file__).parents[2].parent / "shared" / "gltf"


@pytest.fixture
def library(tmp_path, monkeypatch):
    monkeypatch.setenv("GAITLAB_BODIES", str(tmp_path / "bodies"))
    return tmp_path / "bodies"


def with_picture(mode: str, image: dict | None = None) -> bytes:
    """The man with a 4 x 2 picture, half of it transparent, on his first material."""
    container = read_container(MAN, "man")
    stream = BytesIO()
    pixels = np.full((2, 4, 4), 255, np.uint8)
    pixels[:, :2, 3] = 0
    Image.fromarray(pixels).save(stream, "PNG")
    block = container.buffers[0] + b"\0" * (-len(container.buffers[0]) % 4)
    document = container.document
    document["bufferViews"].append({"buffer": 0, "byteOffset": len(block), "byteLength": len(stream.getvalue())})
    document["images"] = [image or {"bufferView": len(document["bufferViews"]) - 1, "mimeType": "image/png"}]
    document["textures"] = [{"source": 0}]
    for material in document["materials"]:
        material["alphaMode"], material["alphaCutoff"] = mode, 0.3
        material["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    for mesh in document["meshes"]:
        for primitive in mesh["primitives"]:
            count = document["accessors"][primitive["attributes"]["POSITION"]]["count"]
            document["accessors"].append({"componentType": 5126, "count": count, "type": "VEC2"})
            primitive["attributes"]["TEXCOORD_0"] = len(document["accessors"]) - 1
    whole = block + stream.getvalue()
    document["buffers"][0]["byteLength"] = len(whole)
    return write_container(Container(document, (whole,)))


@pytest.mark.parametrize("mode", ["OPAQUE", "MASK", "BLEND"])
def test_pictures_and_alpha_modes_are_read(tmp_path, mode):
    (tmp_path / "a.glb").write_bytes(with_picture(mode))
    surface = import_body(tmp_path / "a.glb").levels[0][0]
    assert surface.alpha == mode.lower()
    assert surface.alpha_cutoff == pytest.approx(0.3)
    assert surface.picture is not None
    assert surface.picture.shape == (2, 4, 4)
    assert surface.picture_at is not None


def test_a_missing_picture_is_a_note_and_a_picture_elsewhere_is_refused(tmp_path):
    (tmp_path / "a.glb").write_bytes(with_picture("OPAQUE", {"uri": "nowhere.png"}))
    body, explained = import_and_explain(tmp_path / "a.glb")
    assert body.levels[0][0].picture is None
    assert any("nowhere.png" in sentence for sentence in explained.problems)
    (tmp_path / "b.glb").write_bytes(with_picture("OPAQUE", {"uri": "../../secret.png"}))
    with pytest.raises(BodyError, match="outside"):
        import_body(tmp_path / "b.glb")


def test_a_picture_without_places_on_it_is_a_note(tmp_path):
    container = read_container(with_picture("OPAQUE"), "a")
    for mesh in container.document["meshes"]:
        for primitive in mesh["primitives"]:
            del primitive["attributes"]["TEXCOORD_0"]
    (tmp_path / "a.glb").write_bytes(write_container(container))
    body, explained = import_and_explain(tmp_path / "a.glb")
    assert body.levels[0][0].picture is None
    assert any("has a picture, but a mesh that wears it does not say where" in said for said in explained.problems)


def test_a_picture_that_only_glows_is_a_note(tmp_path):
    container = read_container(with_picture("OPAQUE"), "a")
    for material in container.document["materials"]:
        material["emissiveTexture"] = material["pbrMetallicRoughness"].pop("baseColorTexture")
    (tmp_path / "a.glb").write_bytes(write_container(container))
    _, explained = import_and_explain(tmp_path / "a.glb")
    assert any("glows (emissive), which is not drawn" in said for said in explained.problems)


def test_an_imported_body_is_known_by_its_name(library):
    stored(MAN, "lab7_anna")
    assert imported_names() == ("lab7_anna",)
    assert "lab7_anna" in body_names()
    assert load_body("lab7_anna").name == "lab7_anna"
    assert load_body("lab7_anna") is load_body("lab7_anna")
    with pytest.raises(BodyError, match="--replace"):
        stored(MAN, "lab7_anna")
    stored(MAN, "lab7_anna", replace=True)


def test_a_name_that_differs_in_case_only_is_taken_because_it_is_the_same_file_on_windows_and_macos(library):
    stored(MAN, "lab7_anna")
    with pytest.raises(BodyError, match="there is a body lab7_anna already"):
        stored(MAN, "LAB7_Anna")


@pytest.mark.parametrize("name", ["woman", "point_light", "../x", "", "1a", "a b"])
def test_names_that_a_body_cannot_have(library, name):
    with pytest.raises(BodyError):
        stored(MAN, name)


def test_a_figure_without_a_body_cannot_be_loaded():
    with pytest.raises(BodyError, match="without a body"):
        load_body("stick_figure")


def test_a_gltf_with_other_files_becomes_one_file(tmp_path):
    container = read_container(MAN, "man")
    document = json.loads(json.dumps(container.document))
    document["buffers"][0]["uri"] = "man.bin"
    (tmp_path / "man.bin").write_bytes(container.buffers[0])
    (tmp_path / "man.gltf").write_text(json.dumps(document))
    (tmp_path / "one.glb").write_bytes(packed(open_container(tmp_path / "man.gltf"), tmp_path / "man.gltf"))
    one, many = import_body(tmp_path / "one.glb"), import_body(tmp_path / "man.gltf")
    assert np.array_equal(one.levels[0][0].positions, many.levels[0][0].positions)


GAITS = ((0.7, 80.0), (0.7, 120.0), (1.06, 100.0), (1.42, 80.0), (1.42, 120.0), (1.2, 80.0), None)
"""Corners, middle and a long slow step of what actors walk (speed in m/s, step frequency in steps/min); comfort."""


@cache
def imported(model: str):
    """A test model's body, read once."""
    return import_body(MODELS / model)


def worst_gaps(actor, body) -> tuple[float, float]:
    """mm: how deep a sole of the body sinks and how high one stands over all GAITS, at 24 phases."""
    found = [sole_gaps(actor, body, gait, phases=24) for gait in GAITS]
    return min(low for low, _ in found), max(high for _, high in found)


@pytest.mark.parametrize("name", people())
@pytest.mark.parametrize("model", ["CesiumMan.glb", "RiggedFigure.glb", "KayKit_Knight.glb"])
def test_imported_soles_stay_within_five_millimetres_of_the_ground(model, name):
    if not (MODELS / model).exists():
        pytest.skip("the Khronos sample models are not here")
    body = imported(model)
    actor = load_actor(name, body)
    grown = scaled(body, actor.height)
    lowest, highest = worst_gaps(on_its_own_soles(actor, grown), grown)
    assert -5.0 < lowest <= highest < 5.0


@pytest.mark.parametrize("name", ["F2", "M1", "M3"])
def test_legs_much_too_short_for_the_step_keep_their_soles_on_the_ground(name):
    body = short_legged(load_body("man"))
    actor = load_actor(name, body)
    grown = scaled(body, actor.height)
    actor = on_its_own_soles(actor, grown)
    lowest, highest = worst_gaps(actor, grown)
    assert -5.0 < lowest <= highest < 5.0
    made, asked = longest_step(actor)
    assert 0.7 < made < asked


@pytest.mark.parametrize("name", ["F2", "M1", "M3"])
def test_a_foot_without_toes_rolls_over_its_tip_and_delivers_what_is_asked(tmp_path, name):
    """VRM asks for no toes, and many rigs have none."""
    container = read_container(MAN, "man")
    for node in container.document["nodes"]:
        node["name"] = node.get("name", "").replace("Toes", "-")
    (tmp_path / "a.glb").write_bytes(write_container(container))
    body = import_body(tmp_path / "a.glb")
    actor = load_actor(name, body)
    grown = scaled(body, actor.height)
    actor = on_its_own_soles(actor, grown)
    lowest, highest = worst_gaps(actor, grown)
    assert -5.0 < lowest <= highest < 5.0
    for speed, step_frequency in GAITS[:-1]:
        gait = delivered_gait(actor, speed, step_frequency)
        assert gait.slide_peak < 5.0
        assert gait.speed == pytest.approx(speed, rel=0.002)
        assert gait.step_frequency == pytest.approx(step_frequency, rel=0.002)


@pytest.mark.parametrize("worn", ["woman", "man"])
@pytest.mark.parametrize("name", people())
def test_shipped_soles_stay_within_five_millimetres_of_the_ground(name, worn):
    """Matched and mismatched."""
    body = load_body(worn)
    actor = load_actor(name, body)
    lowest, highest = worst_gaps(actor, scaled(body, actor.height))
    assert -5.0 < lowest <= highest < 5.0


@pytest.mark.parametrize("worn", [*haircut_names(), *variant_names()])
def test_haircuts_and_builds_stand_on_the_same_feet(worn):
    body = load_body(worn)
    actor = load_actor("T1", body)
    lowest, highest = worst_gaps(actor, scaled(body, actor.height))
    assert -5.0 < lowest <= highest < 5.0


@pytest.mark.parametrize("worn", ["woman", "man"])
def test_legs_of_people_make_every_step_without_a_slide(worn):
    made, asked = longest_step(load_actor("M1", load_body(worn)))
    assert made == asked

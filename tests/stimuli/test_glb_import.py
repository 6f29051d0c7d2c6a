"""Characters from other programs: joints by name or by shape, any axes and units, and the reference bounding boxes."""

import csv
import json
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stimuli.bodies.known import load_body
from stimuli.body_files.animation import Channel, moved_nodes, read_animations, value_at
from stimuli.body_files.container import Container, open_container, read_container, write_container
from stimuli.body_files.errors import BodyError
from stimuli.body_files.imported import bounding_box, import_and_explain, import_body
from stimuli.body_files.scene import placed_vertices, read_scene
from stimuli.skeleton import JOINTS

MAN = files("stimuli").joinpath("data", "bodies", "man.glb").read_bytes()
MODELS = Path(__file__).parents[2].parent / "shared" / "gltf"
"""Folder with the Khronos sample models and REFERENCE_SKINNED_BBOX.csv; the comparison is skipped without it."""


def changed(change) -> bytes:
    container = read_container(MAN, "man")
    change(container.document)
    return write_container(container)


def saved(folder: Path, data: bytes, name: str = "person.glb") -> Path:
    (folder / name).write_bytes(data)
    return folder / name


def test_our_own_man_is_understood_like_any_other_character(tmp_path):
    imported, own = import_body(saved(tmp_path, MAN)), load_body("man")
    assert np.allclose(imported.skeleton.positions, own.skeleton.positions, atol=0.002)
    skin = next(s for s in imported.levels[0] if s.name == "skin")
    assert np.allclose(skin.positions, next(s for s in own.levels[0] if s.name == "skin").positions, atol=0.002)
    assert np.allclose(skin.weights.sum(axis=1), 1)


def test_joints_without_names_are_told_by_the_skeletons_shape(tmp_path):
    def nameless(document):
        for node in document["nodes"]:
            node.pop("name", None)

    imported = import_body(saved(tmp_path, changed(nameless)))
    legs = [j for j, name in enumerate(JOINTS) if "Leg" in name or "Foot" in name or "Arm" in name or "Hand" in name]
    assert np.allclose(imported.skeleton.positions[legs], load_body("man").skeleton.positions[legs], atol=0.003)


MIXAMO = {
    "hips": "Hips", "spine": "Spine", "chest": "Spine2", "neck": "Neck", "head": "Head", "Shoulder": "{}Shoulder",
    "UpperArm": "{}Arm", "LowerArm": "{}ForeArm", "Hand": "{}Hand", "UpperLeg": "{}UpLeg", "LowerLeg": "{}Leg",
    "Foot": "{}Foot", "Toes": "{}ToeBase",
}  # fmt: skip
BIPED = {
    "hips": "Pelvis", "spine": "Spine", "chest": "Spine2", "neck": "Neck", "head": "Head", "Shoulder": "{} Clavicle",
    "UpperArm": "{} UpperArm", "LowerArm": "{} Forearm", "Hand": "{} Hand", "UpperLeg": "{} Thigh",
    "LowerLeg": "{} Calf", "Foot": "{} Foot", "Toes": "{} Toe0",
}  # fmt: skip


def named(prefix: str, words: dict[str, str], left: str, right: str):
    """A change of every joint's name to that of another program."""

    def change(document):
        for node in document["nodes"]:
            role = node.get("name", "")
            part = role.removeprefix("left").removeprefix("right")
            if part in words:
                node["name"] = prefix + words[part].format(left if role.startswith("left") else right)

    return change


def vrm(version: int):
    """A change to a VRM file: joints with names that say nothing, told by the list of the extension."""

    def change(document):
        bones = [(node["name"], i) for i, node in enumerate(document["nodes"]) if node.get("name") in JOINTS]
        for node in document["nodes"]:
            node["name"] = "x"
        extension = (
            {"VRM": {"humanoid": {"humanBones": [{"bone": role, "node": i} for role, i in bones]}}}
            if version == 0
            else {"VRMC_vrm": {"humanoid": {"humanBones": {role: {"node": i} for role, i in bones}}}}
        )
        document.setdefault("extensions", {}).update(extension)

    return change


@pytest.mark.parametrize(
    ("change", "told_by"),
    [
        (vrm(0), "VRM"),
        (vrm(1), "VRM"),
        (named("mixamorig:", MIXAMO, "Left", "Right"), "Mixamo"),
        (named("", MIXAMO, "Left", "Right"), "Mixamo|Vicon/MotionBuilder"),  # Ready Player Me
        (named("Bip01 ", BIPED, "L", "R"), "3ds Max Biped"),  # Rocketbox
    ],
)
def test_joints_are_told_by_the_words_of_the_program_they_come_from(tmp_path, change, told_by):
    body, explained = import_and_explain(saved(tmp_path, changed(change)))
    assert explained.source in told_by.split("|")
    assert all(explained.joints[role] is not None for role in JOINTS)
    assert np.allclose(body.skeleton.positions, load_body("man").skeleton.positions, atol=0.002)


@pytest.mark.parametrize("factor", [1.0, 100.0, 0.01, 1000.0])
def test_a_character_in_other_units_with_z_up_stands_upright_in_metres(tmp_path, factor):
    def turned(document):
        nodes = document["nodes"]
        quarter = [0.7071067811865476, 0, 0, 0.7071067811865476]
        nodes.append({"children": [0], "rotation": quarter, "scale": [factor] * 3, "name": "armature"})
        document["scenes"][0]["nodes"][0] = len(nodes) - 1

    imported = import_body(saved(tmp_path, changed(turned)))
    assert imported.stature == pytest.approx(load_body("man").stature, abs=0.05)  # the haircut may top the crown
    assert np.allclose(imported.skeleton.positions, load_body("man").skeleton.positions, atol=0.005)


def test_a_text_file_with_its_data_beside_it_reads_the_same(tmp_path):
    container = read_container(MAN, "man")
    container.document["buffers"][0]["uri"] = "body%20data.bin"
    (tmp_path / "body data.bin").write_bytes(container.buffers[0])
    path = saved(tmp_path, json.dumps(container.document).encode(), "person.gltf")
    assert np.allclose(bounding_box(path), bounding_box(saved(tmp_path, MAN)))


@pytest.mark.parametrize("uri", ["../secret.bin", "/etc/hostname", "%2e%2e/secret.bin"])
def test_data_outside_the_files_own_folder_is_refused(tmp_path, uri):
    text = json.dumps({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 4, "uri": uri}]})
    with pytest.raises(BodyError, match="outside the file's own folder"):
        open_container(saved(tmp_path, text.encode(), "person.gltf"))


def test_fbx_is_refused_with_the_command_that_converts_it(tmp_path):
    with pytest.raises(BodyError, match=r"FBX2glTF --binary walker\.fbx"):
        import_body(saved(tmp_path, b"Kaydara FBX Binary  \x00", "walker.fbx"))


def _only_five_joints(skin):
    """A skin cut short, as a garbled file once had: meshes name joints beyond its end."""
    skin.pop("inverseBindMatrices", None)
    skin.update(joints=skin["joints"][:5])


def _weights(document, change):
    for mesh in document["meshes"]:
        for primitive in mesh["primitives"]:
            change(primitive["attributes"])


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda d: d.update(extensionsRequired=["KHR_draco_mesh_compression"]), "needs KHR_draco_mesh_compression"),
        (lambda d: [n.pop("skin", None) for n in d["nodes"]], "no mesh hangs on a skeleton"),
        (lambda d: d["skins"][0].update(joints=[0] * 300), "300 joints, more than 256"),
        (
            lambda d: d["meshes"][0].update(primitives=d["meshes"][0]["primitives"] * 60),
            "triangles, more than 500000; simplify it first",
        ),
        (lambda d: d["skins"][0].update(joints=[999]), "joints that do not exist"),
        (lambda d: _only_five_joints(d["skins"][0]), "but its skin has 5; export the file again"),
        (lambda d: d["nodes"][3].update(children=[0]), "each other's parents"),
        (lambda d: _weights(d, lambda attributes: attributes.pop("WEIGHTS_0")), "say not which joints move them"),
        (
            lambda d: _weights(d, lambda a: d["accessors"][a["WEIGHTS_0"]].pop("bufferView", None)),
            "weights of a mesh are 0",
        ),
        (lambda d: [n.update(scale=[0, 0, 0]) for n in d["nodes"]], "is scaled to 0"),
        (lambda d: d["meshes"][0].pop("primitives"), "breaks glTF's own rules"),
    ],
)
def test_a_file_that_cant_be_shown_is_refused_with_a_reason(tmp_path, change, sentence):
    with pytest.raises(BodyError, match=sentence):
        import_body(saved(tmp_path, changed(change)))


@settings(max_examples=120, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 60_000), st.integers(0, 255)), min_size=1, max_size=8))
def test_garbled_characters_give_vertices_or_a_sentence_but_never_a_crash(changes):
    data = bytearray(MAN)
    for place, value in changes:
        data[place] = value
    try:
        scene = read_scene(read_container(bytes(data), "garbled"), "garbled")
    except BodyError as error:
        assert str(error).startswith("garbled: ")  # noqa: PT017
    else:
        assert placed_vertices(scene).shape[1] == 3


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.integers(20, 40_000), st.integers(0, 255)), min_size=1, max_size=6))
def test_garbled_characters_are_imported_or_refused_in_one_sentence(tmp_path_factory, changes):
    data = bytearray(MAN)
    for place, value in changes:
        data[place] = value
    path = saved(tmp_path_factory.mktemp("garbled"), bytes(data))
    try:
        import_body(path)
    except BodyError as error:
        assert "\n" not in str(error)  # noqa: PT017


def test_a_cubic_spline_passes_through_its_keys_and_has_its_tangents():
    """glTF 2.0 appendix C.5: Hermite spline, tangents times the key distance."""
    values = np.array([[0], [1], [2], [3], [5], [0]], dtype=float) * np.ones((1, 3))
    channel = Channel(0, "translation", "CUBICSPLINE", np.array([1.0, 3.0]), values)
    assert np.allclose(value_at(channel, 0.0), 1)
    assert np.allclose(value_at(channel, 3.0), 5)
    slope = (value_at(channel, 1.001) - value_at(channel, 1.0)) / 0.001
    assert np.allclose(slope, 2, atol=0.01)


def test_an_animation_of_an_empty_file_is_no_animation():
    assert read_animations(Container({}, ()), "empty") == ()


@pytest.mark.skipif(not MODELS.exists(), reason="the shared reference models are not here")
def test_skinned_bounding_boxes_match_the_reference_to_a_millimetre():
    with (MODELS / "REFERENCE_SKINNED_BBOX.csv").open() as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        container = open_container(MODELS / row["file"])
        scene = read_scene(container, row["file"])
        if row["time_s"] != "rest":
            animations = read_animations(container, row["file"])
            chosen = next(a for i, a in enumerate(animations) if row["animation"] in (a.name, str(i)))
            time = float(row["time_s"]) + 5e-6  # the table's times are rounded to 5 places
            scene = replace(scene, nodes=moved_nodes(scene.nodes, chosen, time))
        points = placed_vertices(scene)
        wanted = [[float(row[f"{end}_{axis}"]) for axis in "xyz"] for end in ("min", "max")]
        assert np.allclose([points.min(axis=0), points.max(axis=0)], wanted, atol=0.001), row

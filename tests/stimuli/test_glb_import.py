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
from stimuli.body_files.placing import placed_vertices
from stimuli.body_files.scene import read_scene
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


def _accessors(document, name, change):
    for mesh in document["meshes"]:
        for primitive in mesh["primitives"]:
            accessor = document["accessors"][primitive["attributes"][name]]
            if "seen" not in accessor:
                change(accessor)
                accessor["seen"] = True


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
        (lambda d: d["skins"][0].pop("inverseBindMatrices"), "lie in one place in the bind pose"),
        (lambda d: _accessors(d, "POSITION", lambda a: a.pop("bufferView")), "all its vertices lie in one place"),
        (lambda d: _accessors(d, "JOINTS_0", lambda a: a.update(componentType=5120)), "a type of number"),
    ],
)
def test_a_file_that_cant_be_shown_is_refused_with_a_reason(tmp_path, change, sentence):
    with pytest.raises(BodyError, match=sentence):
        import_body(saved(tmp_path, changed(change)))


@pytest.mark.parametrize(
    ("asset", "sentence"),
    [
        (
            {"version": "1.0"},
            r"glTF 1\.0 can't be read, only glTF 2\.0; convert it first: gltf-pipeline -i person\.glb",
        ),
        ({"version": "2.1", "minVersion": "2.1"}, r"glTF 2\.1 can't be read"),
        ({"version": "3.0"}, r"glTF 3\.0 can't be read"),
        ({}, "does not say which glTF it is"),
    ],
)
def test_another_gltf_than_2_0_is_refused_with_the_way_out(tmp_path, asset, sentence):
    with pytest.raises(BodyError, match=sentence):
        import_body(saved(tmp_path, changed(lambda document: document.update(asset=asset))))


def test_a_text_file_of_gltf_1_0_is_refused_for_its_version_not_for_how_it_is_written(tmp_path):
    text = json.dumps({"asset": {"version": "1.0"}, "buffers": {"body": {"uri": "body.bin"}}})
    with pytest.raises(BodyError, match=r"glTF 1\.0 can't be read"):
        import_body(saved(tmp_path, text.encode(), "person.gltf"))


def test_a_later_minor_version_that_asks_for_2_0_only_is_read(tmp_path):
    later = changed(lambda document: document.update(asset={"version": "2.1", "minVersion": "2.0"}))
    assert import_body(saved(tmp_path, later)).stature > 1.7


def test_vertices_without_weights_walk_with_their_neighbours_and_are_counted(tmp_path):
    """Every third vertex has lost its weights; the nearest one that has some is millimetres away."""
    container = read_container(MAN, "man")
    block = bytearray(container.buffers[0])
    for mesh in container.document["meshes"]:
        for primitive in mesh["primitives"]:
            accessor = container.document["accessors"][primitive["attributes"]["WEIGHTS_0"]]
            view = container.document["bufferViews"][accessor["bufferView"]]
            start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
            for row in range(0, accessor["count"], 3):
                block[start + 4 * row : start + 4 * row + 4] = bytes(4)
    spoiled = write_container(Container(container.document, (bytes(block),)))
    body, explained = import_and_explain(saved(tmp_path, spoiled))
    whole = import_body(saved(tmp_path, MAN, "whole.glb"))
    count = sum(len(s.positions) for s in body.levels[0])
    lost = sum(-(-len(s.positions) // 3) for s in body.levels[0])
    assert any(f"{lost} of {count} vertices have no joint weights" in sentence for sentence in explained.problems)
    for ours, theirs in zip(body.levels[0], whole.levels[0], strict=True):
        dense = [np.zeros((len(s.positions), len(JOINTS))) for s in (ours, theirs)]
        for s, matrix in zip((ours, theirs), dense, strict=True):
            np.add.at(matrix, (np.arange(len(matrix))[:, None], s.joints), s.weights)
        apart = np.abs(dense[0] - dense[1]).sum(axis=1)
        assert np.median(apart) < 0.05
        assert np.mean(apart) < 0.12


def armature(**transform):
    """A change that hangs the whole person on a node with this transform."""

    def change(document):
        document["nodes"].append({"children": [0], "name": "armature", **transform})
        document["scenes"][0]["nodes"][0] = len(document["nodes"]) - 1

    return change


def other_names(document):
    for node in document["nodes"]:
        role = node.get("name", "")
        if role.startswith(("left", "right")):
            node["name"] = role.replace("left", "?").replace("right", "left").replace("?", "right")


def _outwards(surface) -> float:
    """Six times the volume inside a surface: negative when its inside is seen."""
    a, b, c = (surface.positions[surface.triangles[:, i]] for i in range(3))
    return float(np.sum(a * np.cross(b, c)))


@pytest.mark.parametrize("change", [armature(scale=[-1, 1, 1]), armature(scale=[1, 1, -1]), other_names])
def test_a_mirrored_character_looks_ahead_and_is_seen_from_outside(tmp_path, change):
    body, explained = import_and_explain(saved(tmp_path, changed(change)))
    joints = dict(zip(JOINTS, body.skeleton.positions, strict=True))
    assert joints["leftToes"][2] > joints["leftFoot"][2] + 0.08
    assert joints["leftUpperArm"][0] > 0.1
    assert all(_outwards(s) > 0 for s in body.levels[0] if s.name in ("skin", "shirt", "trousers", "shoes"))
    assert any("left and right" in sentence for sentence in explained.problems)


@pytest.mark.parametrize("angle", [15.0, 30.0, 75.0])
def test_a_character_that_leans_in_its_scene_walks_upright(tmp_path, angle):
    turn = [0, 0, np.sin(np.radians(angle) / 2), np.cos(np.radians(angle) / 2)]
    body = import_body(saved(tmp_path, changed(armature(rotation=turn))))
    assert np.allclose(body.skeleton.positions, load_body("man").skeleton.positions, atol=0.005)


def test_of_two_people_in_a_file_one_walks_and_the_other_is_left_out_with_a_sentence(tmp_path):
    def twice(document):
        count = len(document["nodes"])
        second = json.loads(json.dumps(document["nodes"]))
        for node in second:
            node["children"] = [child + count for child in node.get("children", [])] or [count - 1 + count]
            if node["children"] == [2 * count - 1]:
                del node["children"]
            if "skin" in node:
                node["skin"] = 1
        document["nodes"] += second
        document["scenes"][0]["nodes"] += [root + count for root in document["scenes"][0]["nodes"]]
        document["skins"].append(
            {**document["skins"][0], "joints": [j + count for j in document["skins"][0]["joints"]]}
        )

    body, explained = import_and_explain(saved(tmp_path, changed(twice)))
    alone = import_body(saved(tmp_path, MAN, "alone.glb"))
    assert sum(len(s.positions) for s in body.levels[0]) == sum(len(s.positions) for s in alone.levels[0])
    assert any("one person per file" in sentence for sentence in explained.problems)


@pytest.mark.parametrize("mode", [5, 6])
def test_strips_and_fans_are_drawn_as_triangles_that_keep_their_side(mode):
    """A square as a strip 0 1 2 3 and as a fan 0 1 3 2, both counter-clockwise (glTF 2.0, section 3.7.2.1)."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], np.float32)
    order = np.array([0, 1, 2, 3] if mode == 5 else [0, 1, 3, 2], np.uint8)
    document = {
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 4}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5121, "count": 4, "type": "SCALAR"},
        ],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": mode}]}],
    }
    (primitive,) = read_scene(Container(document, (corners.tobytes() + order.tobytes(),)), "square").primitives
    a, b, c = (primitive.positions[primitive.triangles[:, i]] for i in range(3))
    areas = 0.5 * np.cross(b - a, c - a)[:, 2]
    assert np.allclose(areas, [0.5, 0.5])


def test_what_is_not_drawn_is_said(tmp_path):
    def more(document):
        document["meshes"][0]["weights"] = [0.5]
        document["meshes"][0]["primitives"].append({**document["meshes"][0]["primitives"][0], "mode": 1})

    _, explained = import_and_explain(saved(tmp_path, changed(more)))
    said = " ".join(explained.problems)
    for part in ("painted vertex by vertex", "points or lines", "morph targets"):
        assert part in said


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

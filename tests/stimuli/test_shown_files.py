"""Any glTF file as it shows itself: in place, in size, at rest and in its animations, also when it cannot walk."""

import csv
import json
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stimuli.bodies.known import load_body
from stimuli.body_files.container import Container, read_container, write_container
from stimuli.body_files.errors import BodyError
from stimuli.body_files.shown import TALLEST, WIDEST, fitted, looked_at, read_shown
from stimuli.body_files.surfaces import MOST_MATERIALS

MAN = files("stimuli").joinpath("data", "bodies", "man.glb").read_bytes()
MODELS = Path(__file__).parents[2].parent / "shared" / "gltf"


def box_in_file(model):
    """(2, 3) lowest and highest corner of what is drawn, in the file's units."""
    points = np.concatenate([s.positions for s in model.body.levels[0]])
    return (np.array([points.min(axis=0), points.max(axis=0)]) - model.shift) / model.scale


@pytest.mark.skipif(not MODELS.exists(), reason="the shared reference models are not here")
def test_every_model_is_drawn_in_the_reference_box_at_rest_and_in_every_animation():
    with (MODELS / "REFERENCE_SKINNED_BBOX.csv").open() as file:
        rows = list(csv.DictReader(file))
    shown = {name: read_shown(MODELS / name) for name in {row["file"] for row in rows}}
    assert len(shown) == 7
    for row in rows:
        at = None
        if row["time_s"] != "rest":
            animations = shown[row["file"]].animations
            chosen = next(a for i, a in enumerate(animations) if row["animation"] in (a.name, str(i)))
            at = (chosen, float(row["time_s"]) + 5e-6)  # the table's times are rounded to 5 places
        wanted = [[float(row[f"{end}_{axis}"]) for axis in "xyz"] for end in ("min", "max")]
        assert np.allclose(box_in_file(fitted(shown[row["file"]], at)), wanted, atol=0.001), row


@pytest.mark.skipif(not MODELS.exists(), reason="the shared reference models are not here")
def test_a_walking_animation_is_looked_at_before_others():
    animation, time = looked_at(read_shown(MODELS / "KayKit_Knight.glb"))
    assert animation.name == "Walking_A"
    assert time == pytest.approx(0.39467, abs=1e-5)  # as in the reference table


def square(**changes) -> Container:
    """A square of 2 x 2 units that faces +Z, its normals as stored, on one node."""
    corners = np.array([[-1, 0, 0], [1, 0, 0], [1, 2, 0], [-1, 2, 0]], np.float32)
    ahead = np.tile([0, 0, 1], (4, 1)).astype(np.float32)
    triangles = np.array([0, 1, 2, 0, 2, 3], np.uint8)
    data = corners.tobytes() + ahead.tobytes() + triangles.tobytes()
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": len(data)}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 48},
            {"buffer": 0, "byteOffset": 96, "byteLength": 6},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5121, "count": 6, "type": "SCALAR"},
        ],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}]}],
    }
    return Container(document | changes, (data,))


def shown_of(folder, container):
    path = folder / "model.glb"
    path.write_bytes(write_container(container))
    return read_shown(path)


@pytest.mark.parametrize("node", [{"scale": [-1, 1, 1]}, {"scale": [3, 3, -3]}, {"rotation": [0, 1, 0, 0]}])
def test_a_mirrored_mesh_is_seen_from_the_side_its_normals_say(tmp_path, node):
    """Triangles go round counter-clockwise about the drawn normal (glTF 2.0, section 3.7.4)."""
    (surface,) = fitted(shown_of(tmp_path, square(nodes=[{"mesh": 0, **node}]))).body.levels[0]
    a, b, c = (surface.positions[surface.triangles[:, i]] for i in range(3))
    round_about = np.cross(b - a, c - a)
    assert np.all(np.einsum("ti,ti->t", round_about, surface.normals[surface.triangles[:, 0]]) > 0)
    behind = node.get("rotation") is not None or node["scale"][2] < 0
    assert surface.normals[0, 2] == pytest.approx(-1.0 if behind else 1.0)


def test_normals_stay_upright_on_a_mesh_that_is_stretched(tmp_path):
    """A slope of 45 degrees stretched threefold in height rises 3 on 1: its normal leans 1 on 3."""
    slope = {"mesh": 0, "rotation": [-np.sin(np.pi / 8), 0, 0, np.cos(np.pi / 8)]}
    nodes = [{"children": [1], "scale": [1, 3, 1]}, slope]
    (surface,) = fitted(shown_of(tmp_path, square(nodes=nodes))).body.levels[0]
    assert np.allclose(surface.normals, np.array([0.0, 1.0, 3.0]) / np.sqrt(10.0), atol=1e-6)


@pytest.mark.parametrize(("scene", "seen"), [(None, 1), (0, 1), (1, 2)])
def test_only_the_scene_that_a_file_shows_is_shown(tmp_path, scene, seen):
    changes = {"scenes": [{"nodes": [0]}, {"nodes": [0, 1]}, {}]} | ({} if scene is None else {"scene": scene})
    nodes = [{"mesh": 0}, {"children": [2]}, {"mesh": 0}]
    surfaces = fitted(shown_of(tmp_path, square(nodes=nodes, **changes))).body.levels[0]
    assert sum(len(s.triangles) for s in surfaces) == 2 * seen


@pytest.mark.parametrize("scale", [1e-3, 1.0, 500.0])
def test_a_model_of_any_unit_stands_in_the_picture(tmp_path, scale):
    model = fitted(shown_of(tmp_path, square(nodes=[{"mesh": 0, "scale": [scale] * 3, "translation": [9, 9, 9]}])))
    points = model.body.levels[0][0].positions
    assert np.allclose(points.min(axis=0), [-WIDEST / 2, 0.0, 0.0], atol=1e-9)
    assert points[:, 1].max() == pytest.approx(min(WIDEST, TALLEST))


def test_a_model_of_more_materials_than_can_be_drawn_has_the_rest_in_one(tmp_path):
    count = MOST_MATERIALS + 9
    container = square(
        materials=[{"pbrMetallicRoughness": {"baseColorFactor": [i / count, 0, 0, 1]}} for i in range(count)]
    )
    primitive = container.document["meshes"][0]["primitives"][0]
    container.document["meshes"][0]["primitives"] = [{**primitive, "material": i} for i in range(count)]
    surfaces = fitted(shown_of(tmp_path, container)).body.levels[0]
    assert len(surfaces) == MOST_MATERIALS
    assert sum(len(s.triangles) for s in surfaces) == 2 * count


@pytest.mark.parametrize(
    "changes", [{"meshes": []}, {"nodes": []}, {"nodes": [{"mesh": 0, "scale": [0, 0, 0]}]}, {"accessors": []}]
)
def test_a_file_that_shows_nothing_is_refused(tmp_path, changes):
    with pytest.raises(BodyError, match=r"^model\.glb: "):
        fitted(shown_of(tmp_path, square(**changes)))


def test_a_person_is_shown_by_all_joints_of_the_file(tmp_path):
    """The man as a walker and as his file shows him, all levels of detail at once, have the same height."""
    container = read_container(MAN, "man")
    document = json.loads(json.dumps(container.document))
    model = fitted(shown_of(tmp_path, Container(document, container.buffers)))
    low, high = box_in_file(model)
    heights = np.concatenate([surface.positions[:, 1] for level in load_body("man").levels for surface in level])
    assert high[1] - low[1] == pytest.approx(np.ptp(heights), abs=1e-4)
    assert looked_at(shown_of(tmp_path, container)) is None


@pytest.mark.parametrize("animations", [[{"channels": [{"sampler": 0, "target": {"node": 0, "path": "scale"}}]}], [7]])
def test_a_file_whose_animations_are_broken_is_shown_at_rest(tmp_path, animations):
    shown = shown_of(tmp_path, square(animations=animations))
    assert looked_at(shown) is None
    assert "its animations can't be read" in shown.problems[0]
    assert fitted(shown).body.stature == pytest.approx(WIDEST)


@settings(max_examples=100, deadline=None)
@given(st.lists(st.tuples(st.integers(20, 60_000), st.integers(0, 255)), min_size=1, max_size=8))
def test_garbled_files_are_shown_or_refused_in_one_sentence(tmp_path_factory, changes):
    data = bytearray(MAN)
    for place, value in changes:
        data[place] = value
    path = tmp_path_factory.mktemp("garbled") / "man.glb"
    path.write_bytes(data)
    try:
        model = fitted(read_shown(path))
    except BodyError as error:
        assert "\n" not in str(error)  # noqa: PT017
    else:
        assert 0.0 < model.scale < np.inf

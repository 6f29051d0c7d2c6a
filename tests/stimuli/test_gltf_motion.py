"""glTF animations: the joints of Khronos' and KayKit's samples, and the three interpolations on a written file."""

import base64
import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stimuli.clip import world_pose, world_positions
from stimuli.motion_files.errors import MotionFileError
from stimuli.motion_files.gltf_motion import animation_names, read_gltf_motion
from stimuli.motion_files.rest_pose import rest_pose
from stimuli.rotations import about_axis, angle_between

GLTF = Path(__file__).parents[2].parent / "shared" / "gltf"
needs_samples = pytest.mark.skipif(not GLTF.is_dir(), reason="the shared glTF samples are not beside the checkout")

TURN = about_axis([0.0, 0.0, 1.0], np.array([0.0, 1.0]))


def document(interpolation="LINEAR", values=TURN, times=(0.0, 1.0)):
    """Two nodes, the child 1 m above its parent, the parent's rotation animated."""
    numbers = np.concatenate([np.ravel(times), np.ravel(values)]).astype("<f4")
    data = numbers.tobytes()
    split = 4 * len(times)
    return {
        "asset": {"version": "2.0"},
        "nodes": [{"name": "root", "children": [1]}, {"name": "tip", "translation": [0, 1, 0]}],
        "buffers": [{"byteLength": len(data), "uri": "data:;base64," + base64.b64encode(data).decode()}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": split},
            {"buffer": 0, "byteOffset": split, "byteLength": len(data) - split},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "SCALAR", "count": len(times)},
            {"bufferView": 1, "componentType": 5126, "type": "VEC4", "count": np.size(values) // 4},
        ],
        "animations": [
            {
                "name": "wave",
                "samplers": [{"input": 0, "output": 1, "interpolation": interpolation}],
                "channels": [
                    {"sampler": 0, "target": {"node": 0, "path": "rotation"}},
                    {"sampler": 0, "target": {"path": "rotation"}},
                ],
            }
        ],
    }


def written(folder, content):
    path = folder / "wave.gltf"
    path.write_text(json.dumps(content))
    return path


@pytest.mark.parametrize(("interpolation", "halfway"), [("LINEAR", 0.5), ("STEP", 0.0)])
def test_linear_turns_at_constant_speed_and_step_stays(tmp_path, interpolation, halfway):
    clip = read_gltf_motion(written(tmp_path, document(interpolation)), rate=10)
    angles = angle_between(world_pose(clip)[0][:, 0], [0.0, 0.0, 0.0, 1.0])
    assert (clip.frame_count, clip.rate) == (11, 10)
    assert angles[5] == pytest.approx(halfway, abs=1e-6)
    assert angles[-1] == pytest.approx(1.0, abs=1e-6)


def test_linear_takes_the_shorter_way(tmp_path):
    clip = read_gltf_motion(written(tmp_path, document(values=TURN * [[1], [-1]])), rate=10)
    assert angle_between(world_pose(clip)[0][5, 0], [0.0, 0.0, 0.0, 1.0]) == pytest.approx(0.5, abs=1e-6)


def test_a_cubic_spline_with_flat_tangents_eases_in_and_out(tmp_path):
    """Hermite with tangents 0: 3 s² - 2 s³ is 0.028 at a tenth, taken of the quaternions and normalised."""
    zero = np.zeros(4)
    values = np.stack([zero, TURN[0], zero, zero, TURN[1], zero])
    clip = read_gltf_motion(written(tmp_path, document("CUBICSPLINE", values)), rate=10)
    blend = TURN[0] + 0.028 * (TURN[1] - TURN[0])
    assert angle_between(world_pose(clip)[0][1, 0], blend / np.linalg.norm(blend)) == pytest.approx(0, abs=1e-6)


def test_a_child_is_carried_by_its_parent(tmp_path):
    clip = read_gltf_motion(written(tmp_path, document()), rate=10)
    tip = world_positions(clip)[-1, clip.joints.index("root")]
    np.testing.assert_allclose(tip, 0, atol=1e-9)


def test_several_animations_want_a_name(tmp_path):
    content = document()
    content["animations"] += [{**content["animations"][0], "name": "walk"}]
    path = written(tmp_path, content)
    assert animation_names(path) == ("wave", "walk")
    with pytest.raises(MotionFileError, match="2 animations; give animation, one of wave, walk"):
        read_gltf_motion(path)
    assert read_gltf_motion(path, animation="walk").frame_count > 1
    with pytest.raises(MotionFileError, match="has no animation 'run'"):
        read_gltf_motion(path, animation="run")


@needs_samples
@pytest.mark.parametrize("file", ["CesiumMan.glb", "cesium_man_embedded.gltf"])
def test_joints_without_names_are_told_by_the_skeletons_shape(file):
    """CesiumMan walks towards +X with a Z-up root matrix: left is -Z; knees bend forward, 24 keys a second."""
    clip = read_gltf_motion(GLTF / file)
    positions = world_positions(clip)
    assert (clip.source.names, clip.source.forward, clip.rate) == ("topology", "+X", 24)
    assert len(clip.roles) == 19
    assert np.all(positions[:, clip.roles["leftUpperLeg"], 2] < positions[:, clip.roles["rightUpperLeg"], 2])
    assert np.all(positions[:, clip.roles["head"], 1] > 1.0)
    assert rest_pose(clip).standing_zero


@needs_samples
def test_one_of_76_animations_is_picked_by_name():
    assert len(animation_names(GLTF / "KayKit_Knight.glb")) == 76
    clip = read_gltf_motion(GLTF / "KayKit_Knight.glb", animation="Walking_A")
    assert clip.joints[clip.roles["leftUpperLeg"]] == "upperleg.l"
    assert 0.5 < clip.duration < 2


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda d: d.update(animations=[]), "no animation"),
        (lambda d: d["accessors"][1].update(count=99), "cut off"),
        (lambda d: d["accessors"][0].update(componentType=1), "type or count"),
        (lambda d: d["nodes"][1].update(children=[0]), "tree"),
        (lambda d: d["nodes"][0].update(children=[7]), "not in the file"),
        (lambda d: d["buffers"][0].update(uri="none.bin"), "beside the file"),
        (lambda d: d["buffers"][0].update(uri="../../secret.bin"), "outside"),
        (lambda d: d["bufferViews"][0].update(buffer=3), r"buffers\[3\]"),
        (lambda d: d["animations"][0]["channels"].clear(), "moves no node"),
    ],
)
def test_bad_files_end_in_one_sentence_naming_the_file(tmp_path, change, words):
    content = document()
    change(content)
    path = written(tmp_path, content)
    with pytest.raises(MotionFileError, match=words) as error:
        read_gltf_motion(path)
    assert str(path) in str(error.value)


anything = st.recursive(
    st.none() | st.booleans() | st.integers(-3, 300) | st.floats() | st.text(max_size=3),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner, max_size=2),
    max_leaves=4,
)


def places(content, path=()):
    yield path
    items = content.items() if isinstance(content, dict) else enumerate(content) if isinstance(content, list) else ()
    for key, value in items:
        yield from places(value, (*path, key))


@given(st.data())
@settings(max_examples=300, deadline=None)
def test_no_value_anywhere_in_the_file_escapes_as_another_error(tmp_path_factory, data):
    content = document()
    path = data.draw(st.sampled_from([p for p in places(content) if p]))
    inside = content
    for key in path[:-1]:
        inside = inside[key]
    inside[path[-1]] = data.draw(anything)
    try:
        clip = read_gltf_motion(written(tmp_path_factory.mktemp("bad"), content))
    except MotionFileError:
        return
    assert np.all(np.isfinite(world_positions(clip)))


def test_keys_a_tenth_of_a_millisecond_apart_and_one_after_an_hour_are_refused_before_they_fill_the_memory(tmp_path):
    times = (0.0, 0.0001, 0.0002, 0.0003, 3500.0)
    path = written(tmp_path, document(values=np.tile([0.0, 0.0, 0.0, 1.0], (5, 1)), times=times))
    with pytest.raises(MotionFileError, match="3500 s at 10000 Hz are 35000001 frames, too many for 2 nodes; give a"):
        read_gltf_motion(path)


def test_a_motion_in_gltf_1_0_is_refused(tmp_path):
    with pytest.raises(MotionFileError, match=r"is glTF 1\.0; only glTF 2\.0 can be read"):
        read_gltf_motion(written(tmp_path, document() | {"asset": {"version": "1.0"}}))

"""The GLB reader and writer: what goes in comes out, and what is broken is refused in one sentence."""

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stimuli.bodies.body import Body, Surface
from stimuli.bodies.known import load_body
from stimuli.body_files.accessors import read_accessor
from stimuli.body_files.baked import read_baked
from stimuli.body_files.baking import bake
from stimuli.body_files.container import Container, read_container, write_container
from stimuli.body_files.errors import BodyError


def small_surface(name: str, seed: int) -> Surface:
    rng = np.random.default_rng(seed)
    normals = rng.normal(size=(40, 3))
    weights = rng.random((40, 4)) ** 3
    return Surface(
        name=name,
        colour=np.array([0.2, 0.3, 0.4]),
        roughness=0.7,
        positions=rng.uniform((-0.6, 0, -0.3), (0.6, 1.7, 0.3), (40, 3)),
        normals=normals / np.linalg.norm(normals, axis=1, keepdims=True),
        occlusion=rng.random(40),
        joints=rng.integers(0, 21, (40, 4)),
        weights=weights / weights.sum(axis=1, keepdims=True),
        triangles=rng.integers(0, 40, (30, 3)),
        blush=rng.uniform(0, 0.4, 40) if name == "skin" else None,
    )


def small_body() -> Body:
    level = (small_surface("skin", 1), small_surface("hair:short", 2), small_surface("hair:long", 3))
    return Body("someone", load_body("man").skeleton, 1.7, (level, level))


SMALL = bake(small_body())


def _is_one_sentence(error: BodyError) -> None:
    assert "\n" not in str(error)
    assert str(error).startswith("garbled: ")


def test_a_body_survives_baking_within_the_quantisation():
    before, after = small_body(), read_baked(SMALL, "small")
    assert (after.name, after.stature, len(after.levels)) == ("someone", 1.7, 2)
    assert np.allclose(after.skeleton.positions, before.skeleton.positions, atol=1e-6)
    for old, new in zip(before.levels[0][:2], after.levels[0], strict=True):
        assert new.name == old.name.split(":")[0]
        assert np.allclose(new.positions, old.positions, atol=2e-5)
        assert np.allclose(new.normals, old.normals, atol=0.01)
        assert np.allclose(new.occlusion, old.occlusion, atol=0.003)
        assert np.allclose(new.weights, old.weights, atol=0.01)
        if old.blush is None:
            assert new.blush is None
        else:
            assert np.allclose(new.occlusion * new.blush, old.occlusion * old.blush, atol=0.005)
        assert np.array_equal(np.where(old.weights > 0, old.joints, 0), new.joints)
        assert np.array_equal(new.triangles, old.triangles)
        assert np.allclose(new.colour, old.colour, atol=1e-4)


def test_baking_twice_gives_the_same_bytes():
    assert bake(small_body()) == SMALL


def test_a_haircut_can_be_chosen():
    cuts = [read_baked(SMALL, "small", cut).levels[0][1] for cut in ("short", "long")]
    assert not np.allclose(cuts[0].positions, cuts[1].positions)


def test_the_file_is_valid_enough_for_other_viewers():
    document = read_container(SMALL, "small").document
    assert document["asset"]["version"] == "2.0"
    for accessor in document["accessors"]:
        view = document["bufferViews"][accessor["bufferView"]]
        assert view["byteOffset"] % 4 == 0
        assert view.get("byteStride", 4) % 4 == 0
    for mesh in document["meshes"]:
        for primitive in mesh["primitives"]:
            position = document["accessors"][primitive["attributes"]["POSITION"]]
            assert len(position["min"]) == len(position["max"]) == 3
    assert {n["name"] for n in document["nodes"] if "mesh" in n} >= {"lod0", "lod1", "lod0 hair:short"}


@pytest.mark.parametrize("kept", [0, 3, 11, 19, 20, 200, 2000, len(SMALL) - 1])
def test_a_truncated_file_is_refused(kept):
    with pytest.raises(BodyError, match="small: "):
        read_baked(SMALL[:kept], "small")


@pytest.mark.parametrize("data", [b"", b"hello", b"glTF" + bytes(40), bytes(1000), b"PK\x03\x04" * 50])
def test_a_file_of_another_kind_is_refused(data):
    with pytest.raises(BodyError):
        read_baked(data, "other")


def test_an_older_gltf_version_is_named():
    with pytest.raises(
        BodyError, match=r"glTF 1 can't be read, only glTF 2\.0; convert it first: gltf-pipeline -i old"
    ):
        read_baked(SMALL[:4] + struct.pack("<I", 1) + SMALL[8:], "old")


@settings(max_examples=250, deadline=None)
@given(st.lists(st.tuples(st.integers(0, len(SMALL) - 1), st.integers(0, 255)), min_size=1, max_size=12))
def test_garbled_bytes_give_a_body_or_a_sentence_but_never_a_crash(changes):
    data = bytearray(SMALL)
    for place, value in changes:
        data[place] = value
    try:
        body = read_baked(bytes(data), "garbled")
    except BodyError as error:
        _is_one_sentence(error)
    else:
        assert all(np.all(np.isfinite(s.positions)) for level in body.levels for s in level)


@settings(max_examples=250, deadline=None)
@given(st.data())
def test_garbled_json_values_give_a_body_or_a_sentence_but_never_a_crash(data):
    container = read_container(SMALL, "small")
    document = container.document
    keys = data.draw(st.sampled_from(sorted(document)))
    node, path = document, keys
    while isinstance(node[path], dict | list) and node[path] and data.draw(st.booleans()):
        node = node[path]
        path = data.draw(st.sampled_from(sorted(node) if isinstance(node, dict) else range(len(node))))
    node[path] = data.draw(
        st.one_of(
            st.none(),
            st.booleans(),
            st.integers(-5, 10**12),
            st.floats(),
            st.text(max_size=3),
            st.just([]),
            st.just({}),
        )
    )
    try:
        read_baked(write_container(Container(document, container.buffers)), "garbled")
    except BodyError as error:
        _is_one_sentence(error)


def test_sparse_accessors_without_a_view_begin_as_zeros():
    """glTF 2.0 section 3.6.2.3: elements named by the indices take new values, the others stay."""
    block = struct.pack("<2H", 1, 3) + struct.pack("<6f", 1, 2, 3, 4, 5, 6)
    document = {
        "bufferViews": [{"buffer": 0, "byteLength": 4}, {"buffer": 0, "byteOffset": 4, "byteLength": 24}],
        "accessors": [
            {
                "componentType": 5126,
                "count": 5,
                "type": "VEC3",
                "sparse": {
                    "count": 2,
                    "indices": {"bufferView": 0, "componentType": 5123},
                    "values": {"bufferView": 1},
                },
            }
        ],
    }
    values = read_accessor(Container(document, (block,)), 0, "sparse")
    assert np.array_equal(values, [[0, 0, 0], [1, 2, 3], [0, 0, 0], [4, 5, 6], [0, 0, 0]])


def test_normalised_integers_become_fractions_between_minus_one_and_one():
    document = {
        "bufferViews": [{"buffer": 0, "byteLength": 3}],
        "accessors": [{"bufferView": 0, "componentType": 5120, "normalized": True, "count": 3, "type": "SCALAR"}],
    }
    values = read_accessor(Container(document, (struct.pack("3b", -128, 0, 127),)), 0, "bytes")
    assert np.array_equal(values.ravel(), [-1, 0, 1])

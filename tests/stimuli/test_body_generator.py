"""The generator of the default bodies, on coarse grids: the shipped files are made the same way, only finer."""

import numpy as np
import pytest

pytest.importorskip("skimage")
pytest.importorskip("fast_simplification")

from stimuli.body_files.baking import bake
from stimuli.body_generator.__main__ import FIGURES
from stimuli.body_generator.assemble import body_heat, build, hair_pieces
from stimuli.body_generator.fields import ellipsoid, smooth_min
from stimuli.body_generator.hair import style, style_names
from stimuli.body_generator.head import head_frame
from stimuli.body_generator.heat import MIRROR_JOINT, weights_at
from stimuli.body_generator.parts import parts_of
from stimuli.body_generator.polygons import polished, polygonise, volume
from stimuli.skeleton import JOINTS

COARSE = 2.6


@pytest.fixture(scope="module")
def coarse():
    return build(FIGURES["woman"], COARSE)


@pytest.mark.slow
def test_the_same_figure_gives_the_same_bytes(coarse):
    assert bake(coarse) == bake(build(FIGURES["woman"], COARSE))


def test_a_coarse_woman_is_as_tall_and_as_stout_as_she_should_be(coarse):
    assert coarse.stature == pytest.approx(1.63, abs=0.02)
    litres = 1000 * sum(
        np.sum(
            np.cross(s.positions[s.triangles[:, 1]], s.positions[s.triangles[:, 2]]) * s.positions[s.triangles[:, 0]]
        )
        / 6
        for s in coarse.levels[1]
        if s.name in ("shirt", "trousers")
    )
    assert 45 < litres < 75  # clothed trunk and legs, the trousers' top counted twice


def test_the_left_and_right_weights_of_any_point_are_mirrored():
    figure = FIGURES["man"]
    _, everything = parts_of(figure)
    heat = body_heat(figure, everything, 2.0)
    points = heat.positions[::37]
    dense = []
    for p in (points, points * (-1, 1, 1)):
        joints, weights = weights_at(heat, p)
        full = np.zeros((len(p), len(JOINTS)))
        np.put_along_axis(full, joints, weights, axis=1)
        dense.append(full)
    assert np.allclose(dense[0][:, MIRROR_JOINT], dense[1], atol=1e-9)


def test_a_polygonised_ball_has_a_balls_volume():
    ball = ellipsoid((1, 2, 3), (5, 5, 5))
    mesh = polished(polygonise(ball, np.array([-6.0, -5, -4]), np.array([8.0, 9, 10]), 0.7), ball, 0.7)
    assert volume(mesh) == pytest.approx(4 / 3 * np.pi * 125, rel=0.01)


def test_a_smooth_union_is_never_outside_the_plain_one():
    a, b = np.random.default_rng(1).normal(size=(2, 500))
    joined = smooth_min(a, b, 0.8)
    assert np.all(joined <= np.minimum(a, b) + 1e-12)
    assert np.all(joined >= np.minimum(a, b) - 0.2 - 1e-12)


@pytest.mark.parametrize("level", [0, 1])
def test_no_lock_of_hair_floats_beside_the_head(level):
    for name in ("woman", "man"):
        figure = FIGURES[name]
        _, everything = parts_of(figure)
        for cut in style_names(figure):
            worn = style(cut, figure.female)
            for piece in hair_pieces(cut, figure, everything, COARSE)[level]:
                off = worn.volume(head_frame(figure).to_head(piece.mesh.positions))
                assert off.max() < 1.2  # cm above the surface that locks lie on

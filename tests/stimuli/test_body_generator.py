"""The generator of the default bodies, on coarse grids: the shipped files are made the same way, only finer."""

import numpy as np
import pytest

pytest.importorskip("skimage")
pytest.importorskip("fast_simplification")

from stimuli.body_files.baking import bake
from stimuli.body_generator.__main__ import FIGURES
from stimuli.body_generator.assemble import body_heat, build, hair_pieces
from stimuli.body_generator.fields import ellipsoid, half_space, smooth_max, smooth_min
from stimuli.body_generator.hair import style, style_names
from stimuli.body_generator.head import head_frame
from stimuli.body_generator.heat import MIRROR_JOINT, weights_at
from stimuli.body_generator.parts import parts_of
from stimuli.body_generator.polygons import edged, polished, polygonise, simplified, volume
from stimuli.body_generator.seams import DARK, LIFT, sewn
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


def test_a_seam_lies_closely_on_its_cloth_and_has_a_back():
    ball = ellipsoid((0, 0, 0), (8, 8, 8))
    mesh = polished(polygonise(ball, np.array([-9.0, -9, -9]), np.array([9.0, 9, 9]), 1.0), ball, 1.0)
    turn = np.linspace(0, 2 * np.pi, 90)
    equator = np.column_stack([8 * np.cos(turn), np.zeros(90), 8 * np.sin(turn)])
    normals = mesh.positions / np.linalg.norm(mesh.positions, axis=1, keepdims=True)
    ribbon, _, shade = sewn(mesh, normals, np.full(len(mesh.positions), 0.8), [equator])
    assert np.all(np.abs(np.linalg.norm(ribbon.positions, axis=1) - 8 - LIFT) < 0.1)
    assert np.all(np.abs(ribbon.positions[:, 1]) < 0.2)
    assert shade == pytest.approx(np.full(len(shade), 0.8 * DARK))
    edges = np.sort(np.concatenate([ribbon.triangles[:, [i, (i + 1) % 3]] for i in range(3)]), axis=1)
    assert np.all(np.unique(edges, axis=0, return_counts=True)[1] % 2 == 0)


def test_cloth_cut_by_a_plane_gets_a_sharp_edge():
    ball, plane = ellipsoid((0, 0, 0), (8, 8, 8)), half_space((0, -1, 0), (0, -3.0, 0))
    cloth = lambda p: smooth_max(ball(p), plane(p), 0.2)  # noqa: E731
    mesh = polished(polygonise(cloth, np.array([-9.0, -5, -9]), np.array([9.0, 9, 9]), 0.8), cloth, 0.8)
    sharp = edged(simplified(mesh, 900), ball, plane, 0.35, 1.0)
    on_ball = np.abs(ball(sharp.positions)) < 0.02
    low = sharp.positions[on_ball & (sharp.positions[:, 1] < -2.2), 1]
    assert len(low) > 20
    assert np.mean(np.abs(low + 3.0) < 0.02) > 0.9
    assert volume(sharp) == pytest.approx(volume(mesh), rel=0.02)


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

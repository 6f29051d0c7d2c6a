"""The generator of the default bodies, on coarse grids: the shipped files are made the same way, only finer."""

from functools import cache

import numpy as np
import pytest

pytest.importorskip("skimage")
pytest.importorskip("fast_simplification")

from stimuli.bodies.known import scaled
from stimuli.body_files.baked import read_baked
from stimuli.body_files.baking import bake
from stimuli.body_generator.__main__ import FIGURES
from stimuli.body_generator.assemble import body_heat, build
from stimuli.body_generator.eyes import EYE, INNER, OUTER, eyes
from stimuli.body_generator.fields import ellipsoid, half_space, smooth_max, smooth_min
from stimuli.body_generator.hair import style, style_names
from stimuli.body_generator.haircuts import hair_pieces
from stimuli.body_generator.head import head_frame
from stimuli.body_generator.heat import MIRROR_JOINT, weights_at
from stimuli.body_generator.limbs import hand
from stimuli.body_generator.parts import parts_of
from stimuli.body_generator.patches import Canvas
from stimuli.body_generator.polygons import edged, polished, polygonise, simplified, volume
from stimuli.body_generator.seams import DARK, LIFT, sewn
from stimuli.skeleton import JOINTS

COARSE = 2.6


@cache
def solids(name):
    """Parts of a figure, and the field of everything."""
    return parts_of(FIGURES[name])


@cache
def combed(name, cut):
    """A coarse haircut at its levels."""
    return hair_pieces(cut, FIGURES[name], solids(name)[1], COARSE)


@cache
def worn(name, cut):
    return style(cut, FIGURES[name])


def skin_of(name):
    """The field of head and neck."""
    return next(part.field for part in solids(name)[0] if part.name == "head")


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
    _, everything = solids("man")
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
        for cut in style_names(figure):
            for piece in combed(name, cut)[level]:
                off = worn(name, cut).volume(head_frame(figure).to_head(piece.mesh.positions))
                assert off.max() < 1.2  # cm above the surface that locks lie on


@pytest.mark.parametrize("name", ["woman", "man"])
def test_no_skin_shows_through_hair_that_grows_on_it(name):
    """From a centimetre inside the hairline on, every vertex of a cap lies outside the skin."""
    figure = FIGURES[name]
    skin = skin_of(name)
    frame = head_frame(figure)
    for cut in style_names(figure):
        line = worn(name, cut).line
        if line is None:
            continue
        for level, pieces in enumerate(combed(name, cut)[:2]):
            cap = pieces[0].mesh.positions
            place = frame.to_head(cap)
            inside = (line.above(place) > 1.0) & (place[:, 2] > -8.0)  # before the knot
            assert inside.sum() > 30
            assert skin(cap[inside]).min() > 0.0, (cut, level)


@pytest.mark.parametrize("name", ["woman", "man"])
def test_the_ears_are_free_of_hair_that_is_cut_short_or_tied(name):
    """At the height of an ear's middle no cap reaches as far to the side as the ear does."""
    figure = FIGURES[name]
    skin = skin_of(name)
    frame = head_frame(figure)
    across = np.column_stack([np.linspace(6, 10, 400), np.full(400, 162.0), np.full(400, -1.2)])
    ear = frame.to_head(frame.to_figure(across))[skin(frame.to_figure(across)) < 0, 0].max()
    for cut in style_names(figure):
        if worn(name, cut).line is not None:
            cap = frame.to_head(combed(name, cut)[0][0].mesh.positions)
            beside = (np.abs(cap[:, 1] - 162.0) < 1.5) & (np.abs(cap[:, 2] + 1.2) < 1.5)
            assert np.all(np.abs(cap[beside, 0]) < ear - 0.5)


@pytest.mark.parametrize("name", ["woman", "man"])
def test_an_eye_bulges_before_its_corners_and_behind_its_lids(name):
    """The outer corner lies 1 to 2 cm behind the cornea ; no eyeball sinks into the face."""
    figure = FIGURES[name]
    skin = skin_of(name)
    frame = head_frame(figure)
    patches = eyes(Canvas(skin, frame, 1.0), figure.female)
    white = next(p.mesh.positions for p in patches if p.material == "eye")
    assert skin(white).min() > 0.0
    place = frame.to_head(white)
    front = place[np.argmax(place[:, 2])]
    assert abs(front[0] - EYE[0]) < 0.3
    outer, inner = place[np.argmax(place[:, 0])], place[np.argmin(place[:, 0])]
    assert (outer[0], inner[0]) == pytest.approx((OUTER, INNER), abs=0.05)
    assert 0.6 < front[2] - outer[2] < 2.0
    assert 0.4 < front[2] - inner[2] < front[2] - outer[2] + 0.2
    lids = np.concatenate([frame.to_head(p.mesh.positions) for p in patches if p.material == "skin"])
    over_the_cornea = lids[np.abs(lids[:, 0] - EYE[0]) < 0.4]
    assert over_the_cornea[:, 2].max() > front[2]


def test_a_hand_is_as_long_as_its_phalanges_bent_at_rest_and_narrower_at_the_wrist():
    """Buryanov & Kotiuk 2010, middle finger: 4.46, 2.63 and 1.74 cm; bent by 21, 51 and 67 degrees along the hand."""
    figure = FIGURES["man"]
    solid, along = hand(figure), figure.arm_direction
    wrist = np.array(figure.shoulder) + (figure.upper_arm + figure.forearm) * along
    inwards = np.array([-np.cos(np.radians(30)), -np.sin(np.radians(30)), 0.0])
    grid = np.stack(
        np.meshgrid(np.arange(0, 20, 0.2), np.arange(-6, 8, 0.2), np.arange(-3, 9, 0.2), indexing="ij"), -1
    ).reshape(-1, 3)
    inside = grid[solid(wrist + grid @ np.stack([along, [0.0, 0, 1], inwards])) < 0]
    bent = np.radians([21, 51, 67])
    tip = 9.2 + (np.array([4.46, 2.63, 1.74]) * np.cos(bent)).sum()
    assert tip < inside[:, 0].max() < tip + 1.0  # the pulp beyond the bone
    breadth = [np.ptp(inside[np.abs(inside[:, 0] - s) < 0.15, 1]) for s in (0.0, 8.6)]
    assert breadth[0] < 0.75 * breadth[1]


def test_where_hair_is_tied_is_kept_in_the_file_and_grows_with_the_body(coarse):
    data = bake(coarse)
    loose, tied = (
        next(s for s in read_baked(data, "woman", cut).levels[0] if s.name == "hair") for cut in ("bob", "ponytail")
    )
    assert loose.knot is None
    assert tied.knot == pytest.approx(1.537, abs=0.01)  # m, 10 cm below the crown
    tall = scaled(read_baked(data, "woman", "ponytail"), 1.8)
    grown = next(s for s in tall.levels[0] if s.name == "hair")
    assert grown.knot == pytest.approx(tied.knot * tall.stature / coarse.stature, rel=1e-4)

"""The people of crowds: walks like people's, looks that can be told apart, bodies that stay bodies when coarse."""

from dataclasses import replace

import numpy as np
import pytest

from stimuli.actors import load_actor
from stimuli.blend_tree import Leaf
from stimuli.bodies.builds import GIRTHS
from stimuli.bodies.known import hair_names, load_body
from stimuli.body_generator.crowd_levels import SMALL, coarse_levels
from stimuli.crowds.bodies import KEPT, crowd_body
from stimuli.crowds.looks import LOOKS, difference, farthest, linear_rgb, looks
from stimuli.crowds.motions import Style, drawn_manner, figure_of, least_distinctive, motion_of
from stimuli.gait_model import load_gait_model
from stimuli.measure import delivered_gait


@pytest.mark.parametrize(
    "style", [Style("F", 0), Style("F", 41), Style("M", 7), Style("M", 300), Style("M", -2), Style("F", -1)]
)
def test_a_made_walk_delivers_its_step_and_its_feet_stand_still(style):
    motion = motion_of(style)
    walker = replace(load_actor("F1"), figure=figure_of(style.sex), table=motion.table, tree=Leaf(0))
    gait = delivered_gait(walker, motion.speed, motion.step_frequency)
    assert gait.step_length == pytest.approx(motion.step_length, rel=1e-3)
    assert gait.slide_mean < 5.0
    assert gait.slide_peak < 10.0


def test_made_people_differ_from_the_average_as_captured_ones_do():
    model = load_gait_model()
    rng = np.random.default_rng(1)
    made = np.std([drawn_manner(model, rng) for _ in range(600)], axis=0)
    captured = model.offsets.std(axis=0)
    marked = captured > np.quantile(captured, 0.9)
    np.testing.assert_allclose(made[marked], captured[marked], rtol=0.12)


def test_the_same_style_is_the_same_walk_and_others_are_others():
    motion_of.cache_clear()
    first = motion_of(Style("M", 3)).table
    motion_of.cache_clear()
    np.testing.assert_array_equal(motion_of(Style("M", 3)).table.body, first.body)
    assert np.abs(motion_of(Style("M", 4)).table.body - first.body).max() > 0.01
    assert np.abs(motion_of(Style("M", 3, pool=1)).table.body - first.body).max() > 0.01


def test_the_least_distinctive_person_is_the_nearest_to_the_average():
    model = load_gait_model()
    order = least_distinctive(model)
    spread = model.offsets.std(axis=0)
    from_average = [np.sqrt(np.mean((model.offsets[p] / np.maximum(spread, 1e-9)) ** 2)) for p in order]
    assert from_average == sorted(from_average)


@pytest.mark.parametrize(("palette", "apart"), [("varied", 20.0), ("equal_luminance", 9.0)])
def test_240_looks_can_be_told_apart(palette, apart):
    for sex in "FM":
        chosen = looks(sex, palette)
        assert len(set(chosen)) == LOOKS
        nearest = min(difference(a, b) for i, a in enumerate(chosen) for b in chosen[:i])
        assert nearest > apart


def test_with_equal_luminance_every_garment_has_one_luminance():
    seen = {}
    for sex in "FM":
        for look in looks(sex, "equal_luminance"):
            for name, lab in look.colours:
                rgb = linear_rgb(np.array(lab))
                assert 0.0 <= rgb.min() <= rgb.max() <= 1.0, (name, lab)
                seen.setdefault(name, []).append(float(rgb @ [0.2126729, 0.7151522, 0.0721750]))
    assert set(seen) == {"shirt", "trousers", "shoes"}
    for values in seen.values():
        assert np.ptp(values) < 1e-3


@pytest.mark.parametrize(
    ("lab", "srgb"),
    [
        ((100.0, 0.0, 0.0), (1.0, 1.0, 1.0)),
        ((53.2408, 80.0925, 67.2032), (1.0, 0.0, 0.0)),  # B. Lindbloom's calculator, D65
        ((87.7347, -86.1827, 83.1793), (0.0, 1.0, 0.0)),
        ((32.2970, 79.1875, -107.8602), (0.0, 0.0, 1.0)),
    ],
)
def test_colours_are_those_of_the_srgb_primaries(lab, srgb):
    np.testing.assert_allclose(linear_rgb(np.array(lab)), srgb, atol=2e-3)


def test_farthest_points_of_a_line_are_its_middle_and_its_ends():
    line = np.linspace(0.0, 1.0, 101)[:, None]
    assert farthest(line, 3) in ([50, 0, 100], [50, 100, 0])


@pytest.mark.parametrize("kind", [("woman", "ponytail", "slim"), ("man", "short", "stout")])
def test_coarse_bodies_are_as_large_as_fine_ones_and_move_like_them(kind):
    body = crowd_body(*kind)
    counts = [sum(len(surface.triangles) for surface in level) for level in body.levels]
    assert counts == sorted(counts, reverse=True)
    assert len(body.levels) == 6
    fine = np.concatenate([s.positions for s in body.levels[2] if s.name not in SMALL])
    for level in body.levels[3:]:
        places = np.concatenate([surface.positions for surface in level])
        np.testing.assert_allclose(places.min(axis=0), fine.min(axis=0), atol=0.06)
        np.testing.assert_allclose(places.max(axis=0), fine.max(axis=0), atol=0.06)
        for surface in level:
            np.testing.assert_allclose(surface.weights.sum(axis=1), 1.0, atol=1e-6)
            assert surface.triangles.max() < len(surface.positions)
            assert set(np.unique(surface.triangles)) == set(range(len(surface.positions)))


def test_the_coarse_levels_that_ship_are_those_of_the_bodies_that_ship():
    """After bodies were baked anew: python -m stimuli.body_generator.crowd_levels"""
    made = coarse_levels("man", "cropped")
    for level, surfaces in zip(crowd_body("man", "cropped", "medium").levels[3:], made, strict=True):
        for shipped, surface in zip(level, surfaces, strict=True):
            for name in KEPT:
                np.testing.assert_allclose(getattr(shipped, name), getattr(surface, name), atol=2e-4)


def test_builds_differ_in_girth_and_not_in_height():
    widths = {}
    for build in GIRTHS:
        level = crowd_body("man", "short", build).levels[2]
        shirt = next(surface for surface in level if surface.name == "shirt").positions
        belly = shirt[np.abs(shirt[:, 1] - 1.1) < 0.06]
        widths[build] = np.ptp(belly[:, 2])
        assert max(s.positions[:, 1].max() for s in level) == pytest.approx(
            max(s.positions[:, 1].max() for s in load_body("man", "short").levels[2]), abs=0.005
        )
    assert widths["slim"] < widths["medium"] < widths["stout"]


@pytest.mark.parametrize(("name", "hair"), [(name, hair) for name in ("woman", "man") for hair in hair_names(name)])
def test_the_nearest_coarse_body_shows_no_skin_where_the_finer_one_shows_its_shirt(name, hair):
    """It did: a speck beside the collar, seen on every other shirt of a crowd."""
    body = crowd_body(name, hair, "medium")
    across, up = np.meshgrid(np.arange(-0.14, 0.141, 0.01), np.arange(0.6, 0.83, 0.006) * body.stature)
    chest = np.column_stack([across.ravel(), up.ravel()])
    finer, coarse = (
        {surface.name: nearest_in_front(surface, chest) for surface in body.levels[level]} for level in (2, 3)
    )
    clothed = finer["shirt"] > finer["skin"]
    assert clothed.sum() > 700
    bare = np.isfinite(coarse["shirt"]) & (coarse["skin"] > coarse["shirt"])
    assert not bare[clothed].any()


def nearest_in_front(surface, places):
    """z of a surface where somebody straight in front looks at places (P, 2) of x and y; -inf where it is not."""
    depth = np.full(len(places), -np.inf)
    for a, b, c in surface.positions[surface.triangles]:
        edges = np.column_stack([b - a, c - a])[:2]
        if abs(np.linalg.det(edges)) < 1e-12:
            continue
        u, v = np.linalg.solve(edges, (places - a[:2]).T)
        z = a[2] + u * (b - a)[2] + v * (c - a)[2]
        depth = np.where((u >= 0) & (v >= 0) & (u + v <= 1), np.maximum(depth, z), depth)
    return depth

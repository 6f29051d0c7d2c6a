"""The poulaine after Niay (2022), chapter 5: points, rebuilding, regression tables, editing, inverse kinematics."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from stimuli.actors import load_actor
from stimuli.cycle import cycle_pose, extract_cycle
from stimuli.methods.actor_walks import actor_walk
from stimuli.methods.delivery import joint_rmse
from stimuli.methods.making import MethodError, leg_length
from stimuli.motion_files.reading import read_clip
from stimuli.poulaine.curve import FIVE, FOUR, Poulaine, PoulaineError, characteristic_points, poulaine_of
from stimuli.poulaine.engine import poulaine_engine
from stimuli.poulaine.fitting import fitted_rows
from stimuli.poulaine.legs import bent
from stimuli.poulaine.rebuilding import INTERPOLATIONS, chosen_points, rebuilding_error, rebuilt
from stimuli.poulaine.regression import Change, regression_table
from stimuli.poulaine.walking import poulaine_to_speed, poulaine_to_walk_ratio, poulaine_walk, with_paths
from stimuli.rotations import angle_between, from_exponential, rotate

SHARED = Path(__file__).parents[2].parent / "shared"
LABORATORY = sorted((SHARED / "mocap" / "c3d" / "schreiber-moissenet").glob("*_C[45]_*.c3d"))
CMU = sorted((SHARED / "mocap" / "bvh" / "cmu").glob("*.bvh"))
needs_captures = pytest.mark.skipif(not CMU, reason="the shared captures are not beside the checkout")


@pytest.fixture(scope="module")
def walk():
    return actor_walk(load_actor("F2"), 1.06)


def test_figure_5_1_points_are_where_it_draws_them(walk):
    """E foremost, I hindmost, A highest behind the hip, V under it in stance, M low between A and E."""
    points = characteristic_points(poulaine_of(walk, "right"))
    x = {name: points.of(name)[0] for name in FIVE}
    z = {name: points.of(name)[1] for name in FIVE}
    assert x["I"] < x["A"] < x["V"] < x["M"] < x["E"]
    assert x["V"] == pytest.approx(0.0, abs=1e-4)
    assert z["A"] > z["I"] > z["V"]
    assert z["M"] < z["E"]
    after_strike = (points.phases - points.phases[0]) % 1.0
    assert list(after_strike) == sorted(after_strike)


@needs_captures
@pytest.mark.parametrize("path", (LABORATORY + CMU)[::4], ids=lambda path: path.stem)
def test_both_feet_of_captures_have_all_five_points_in_their_order(path):
    cycle = extract_cycle(read_clip(path))
    for side in ("left", "right"):
        points = characteristic_points(poulaine_of(cycle, side))
        order = (points.phases - points.phases[0]) % 1.0
        assert list(order) == sorted(order), side
        assert 0.5 < order[FIVE.index("I")] < 0.72
        assert points.of("I")[0] < -0.2 * leg_length(cycle) < 0.2 * leg_length(cycle) < points.of("E")[0]


@pytest.mark.parametrize("count", [4, 5])
@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
def test_every_interpolation_passes_through_its_points_and_closes(walk, count, interpolation):
    points = chosen_points(poulaine_of(walk, "left"), count)
    np.testing.assert_allclose(rebuilt(points, interpolation, points.phases), points.places, atol=1e-9)
    ends = rebuilt(points, interpolation, np.array([0.0, 1.0 - 1e-9]))
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-6)


def test_hermite_has_the_derivatives_of_the_original_at_the_points(walk):
    poulaine = poulaine_of(walk, "right")
    points = chosen_points(poulaine, 5)
    step = 1e-6
    slope = (rebuilt(points, "hermite", points.phases + step) - rebuilt(points, "hermite", points.phases - step)) / (
        2 * step
    )
    np.testing.assert_allclose(slope, poulaine.spline(points.phases, 1), atol=1e-3)


def test_the_periodic_spline_meets_itself_in_its_second_derivative(walk):
    points = chosen_points(poulaine_of(walk, "right"), 5)
    first, step = np.sort(points.phases)[0], 1e-4
    around = rebuilt(points, "cubic", (first + step * np.arange(-4, 5)) % 1.0)
    bend = np.diff(around, 2, axis=0) / step**2
    assert np.abs(np.diff(bend, axis=0)).max() < 0.01 * np.abs(bend).max() + 1.0


def test_table_5_4_five_points_are_better_than_four_and_hermite_is_best_on_a_drawn_walk(walk):
    error = {
        (count, way): rebuilding_error(poulaine_of(walk, "right"), count, way)
        for count in (4, 5)
        for way in INTERPOLATIONS
    }
    for way in INTERPOLATIONS:
        assert error[5, way] < error[4, way]
    for count in (4, 5):
        assert error[count, "hermite"] < error[count, "pchip"] < error[count, "cubic"]


@pytest.mark.parametrize(
    ("table", "point", "axis", "predictor", "value"),
    [
        ("raw", "E", 0, 4, 0.103),
        ("raw", "V", 1, 1, -0.623),
        ("raw", "A", 0, 3, -0.055),
        ("raw", "V", 0, 4, 0.0),
        ("normalised", "I", 0, 4, -0.287),
        ("normalised", "M", 1, 4, 0.042),
        ("normalised", "E", 0, 0, -9.40e-4),
    ],
)
def test_tables_5_2_and_5_3_are_as_published(table, point, axis, predictor, value):
    assert regression_table(table).coefficients[FIVE.index(point), axis, predictor] == value


@pytest.mark.skipif(not (SHARED / "studies" / "published").is_dir(), reason="no shared studies beside the checkout")
@pytest.mark.parametrize("name", ["raw", "normalised"])
def test_every_published_coefficient_is_in_our_table(name):
    import csv

    text = (SHARED / "studies" / "published" / f"poulaine_regression_{name}.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    assert len(rows) == 10
    table = regression_table(name)
    for row in rows:
        place = FIVE.index(row["point"]), "xz".index(row["axis"])
        assert table.intercepts[place] == float(row["intercept"])
        for column, predictor in enumerate(("age", "height", "weight", "gender", "speed")):
            printed = row.get(predictor, "NS")
            assert table.coefficients[(*place, column)] == (0.0 if printed == "NS" else float(printed))


@pytest.mark.skipif(not (SHARED / "gait-tables").is_dir(), reason="the shared gait tables are not beside the checkout")
def test_the_refitted_table_is_what_the_shared_adults_give():
    table = regression_table("refitted")
    for row in fitted_rows(SHARED / "gait-tables"):
        place = FIVE.index(row.point), "xz".index(row.axis)
        assert table.intercepts[place] == pytest.approx(row.intercept, rel=1e-4, abs=1e-6)
        assert table.coefficients[(*place, 4)] == pytest.approx(row.coefficients.get("speed", 0.0), rel=1e-4)


def test_a_faster_walk_is_further_out_in_every_table():
    for name in ("raw", "normalised", "refitted"):
        moved = regression_table(name).moved(Change(speed=0.3), 0.85)
        assert moved[FIVE.index("E"), 0] > 0 > moved[FIVE.index("I"), 0]
    normalised = regression_table("normalised").moved(Change(speed=0.3), 0.85)
    assert normalised[0, 0] == pytest.approx(0.336 * 0.3 / np.sqrt(9.81 * 0.85) * 0.85)


def test_the_ankle_comes_to_its_place_and_bones_keep_their_length():
    random = np.random.default_rng(2)
    thigh_bone, shank_bone = np.array([0.01, -0.43, 0.0]), np.array([0.0, -0.42, -0.01])
    thigh, shank = from_exponential(random.normal(0, 0.3, (50, 3))), from_exponential(random.normal(0, 0.3, (50, 3)))
    hip = random.normal(0, 0.05, (50, 3))
    ankle = hip + np.array([0.0, -0.7, 0.0]) + random.normal(0, 0.08, (50, 3))
    leg = bent(hip, ankle, thigh, shank, thigh_bone, shank_bone)
    found = hip + rotate(leg.thigh, thigh_bone) + rotate(leg.shank, shank_bone)
    np.testing.assert_allclose(found[leg.beyond == 0], ankle[leg.beyond == 0], atol=1e-9)
    assert np.mean(leg.beyond == 0) > 0.8
    far = bent(np.zeros(3), np.array([0.0, -2.0, 0.0]), thigh[0], shank[0], thigh_bone, shank_bone)
    assert far.beyond == pytest.approx(2.0 - 0.9996 * (np.linalg.norm(thigh_bone) + np.linalg.norm(shank_bone)))


def test_rebuilding_keeps_feet_upper_body_and_gait(walk):
    made = poulaine_walk(walk)
    before, after = cycle_pose(walk)[0], cycle_pose(made)[0]
    for joint in ("leftFoot", "rightFoot", "head", "leftHand"):
        place = walk.joints.index(joint)
        assert angle_between(before[:, place], after[:, place]).max() < 1e-6, joint
    assert made.gait == walk.gait
    assert made.provenance.format == "poulaine"
    assert joint_rmse(made, walk) < 6.0
    error = np.abs(poulaine_of(made, "right").xz - poulaine_of(walk, "right").xz)
    assert np.sqrt((error**2).sum(axis=1).mean()) == pytest.approx(
        rebuilding_error(poulaine_of(walk, "right"), 5, "hermite"), rel=0.1
    )


@pytest.mark.parametrize("table", ["raw", "normalised", "refitted"])
@pytest.mark.parametrize("factor", [0.7, 1.3])
def test_editing_delivers_the_speed_with_longer_steps_for_faster_walks(walk, table, factor):
    made = poulaine_to_speed(walk, factor * walk.gait.speed, table)
    assert made.gait.speed == pytest.approx(factor * walk.gait.speed)
    assert (made.stride_length > walk.stride_length) == (factor > 1)
    assert (made.gait.step_frequency > walk.gait.step_frequency) == (factor > 1)


def test_with_its_detail_kept_a_walk_edited_to_its_own_speed_is_itself(walk):
    same = poulaine_to_speed(walk, walk.gait.speed, detail=True)
    assert joint_rmse(same, walk) < 0.5
    assert joint_rmse(poulaine_to_speed(walk, walk.gait.speed), walk) > 1.0


def test_a_taller_walker_has_longer_legs_and_steps_and_a_sex_moves_the_points(walk):
    tall = poulaine_to_speed(walk, walk.gait.speed, "normalised", Change(height=0.15))
    assert leg_length(tall) > leg_length(walk)
    assert tall.stride_length > walk.stride_length
    other = poulaine_to_speed(walk, walk.gait.speed, "normalised", Change(gender=-1.0))
    shift = poulaine_of(other, "right").xz[:, 0].max() - poulaine_of(poulaine_walk(walk), "right").xz[:, 0].max()
    assert shift == pytest.approx(0.069 * leg_length(walk), abs=0.02)


@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_a_walk_ratio_is_delivered_at_constant_speed(walk, factor):
    made = poulaine_to_walk_ratio(walk, factor * walk.gait.walk_ratio)
    assert made.gait.walk_ratio == pytest.approx(factor * walk.gait.walk_ratio)
    assert made.gait.speed == pytest.approx(walk.gait.speed)
    extents = [np.ptp(poulaine_of(cycle, "right").xz[:, 0]) for cycle in (made, poulaine_walk(walk))]
    assert (extents[0] > extents[1]) == (factor > 1)


def test_walkers_in_a_batch_walk_as_one_by_one(walk):
    engine = poulaine_engine(walk)
    made = poulaine_to_speed(walk, engine.range[1])
    rotations, hips = engine.poses(np.full(128, engine.range[1]), walk.phases)
    assert angle_between(rotations, made.rotations).max() < 1e-6
    np.testing.assert_allclose(hips, made.hips, atol=1e-6)
    _, taller = engine.poses(np.ones(3), np.zeros(3), np.full(3, 1.1 * leg_length(walk)))
    assert taller[0, 1] > hips[0, 1]


def test_the_engine_stops_where_the_legs_do():
    fast = actor_walk(load_actor("F2"), 1.42)
    engine = poulaine_engine(fast, reach=1.5)
    assert engine.range[0] >= 0.4
    assert engine.range[1] < 1.42 * 2.5
    poulaine_to_speed(fast, engine.range[1])


def test_bad_input_is_a_sentence(walk):
    ellipse = np.stack([0.3 * np.cos(walk.phases * 2 * np.pi), -0.8 - 0.05 * np.sin(walk.phases * 2 * np.pi)], axis=1)
    with pytest.raises(PoulaineError, match=r"no clear local minimum.*rebuild it with 4 points"):
        characteristic_points(Poulaine(ellipse, "ellipse"))
    assert characteristic_points(Poulaine(ellipse, "ellipse"), FOUR).names == FOUR
    ahead = Poulaine(ellipse + np.array([1.0, 0.0]), "ahead")
    with pytest.raises(PoulaineError, match="never passes under the hip"):
        characteristic_points(ahead)
    with pytest.raises(PoulaineError, match="4 or 5 points, not 3"):
        poulaine_walk(walk, 3)
    with pytest.raises(PoulaineError, match="no interpolation 'linear'"):
        poulaine_walk(walk, 5, "linear")
    with pytest.raises(PoulaineError, match="no regression table"):
        poulaine_to_speed(walk, 1.0, "other")
    with pytest.raises(PoulaineError, match="no person's"):
        poulaine_to_speed(walk, 1.0, "raw", Change(height=3.0))
    with pytest.raises(MethodError, match=r"3\.9 m/s is no walk"):
        poulaine_to_speed(walk, 3.9)
    with pytest.raises(PoulaineError, match="cm out of the leg's reach"):
        with_paths(walk, np.stack([poulaine_of(walk, side).xz * [2.2, 1.0] for side in ("left", "right")]))
    with pytest.raises(PoulaineError, match="walk ratio"):
        poulaine_to_walk_ratio(walk, 0.5)
    with pytest.raises(PoulaineError, match="has no leftFoot"):
        poulaine_of(replace(walk, joints=tuple(j + "x" if j == "leftFoot" else j for j in walk.joints)), "left")

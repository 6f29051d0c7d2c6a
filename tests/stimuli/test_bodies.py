"""The woman and the man that come with gaitlab: what any experiment may rely on."""

import time
from importlib.resources import files

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from stimuli.actors import load_actor
from stimuli.bodies.builds import AVERAGE, girths_of
from stimuli.bodies.known import (
    SLIMMEST,
    BodyError,
    body_for,
    body_names,
    hair_names,
    haircut_names,
    in_the_build_of,
    load_body,
    scaled,
    shipped_names,
    variant_names,
    with_girths,
)
from stimuli.bodies.skinning import skin
from stimuli.body_files.baked import read_baked
from stimuli.measure import poses
from stimuli.skeleton import JOINTS, PARENTS

NAMES = shipped_names()
MIRROR = np.array(
    [
        JOINTS.index(_other)
        for _other in (
            n.replace("left", "right") if n.startswith("left") else n.replace("right", "left") for n in JOINTS
        )
    ]
)


def posed(body, **degrees):
    """Skinning matrices of a body whose named joints are turned about X by so many degrees (positive: leg back)."""
    rest = body.skeleton.positions
    turned, placed = [], []
    for joint, parent in enumerate(PARENTS):
        a = np.radians(degrees.get(JOINTS[joint], 0))
        local = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
        turned.append(local if parent < 0 else turned[parent] @ local)
        offset = body.skeleton.offsets[joint]
        placed.append(offset if parent < 0 else placed[parent] + turned[parent] @ offset)
    return np.stack([np.column_stack([r, p - r @ q]) for r, p, q in zip(turned, placed, rest, strict=True)])


def volume(positions, triangles):
    a, b, c = (positions[triangles[:, i]] for i in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6)


def reach(positions, triangles, start, direction):
    """How far from the start the outermost triangle is that a ray meets (Moeller & Trumbore 1997)."""
    a, b, c = (positions[triangles[:, i]] for i in range(3))
    across = np.cross(direction, c - a)
    area = np.sum((b - a) * across, axis=1)
    area = np.where(np.abs(area) > 1e-12, area, np.inf)
    u = np.sum((start - a) * across, axis=1) / area
    turned = np.cross(start - a, b - a)
    v = turned @ direction / area
    hit = (u >= 0) & (v >= 0) & (u + v <= 1) & np.isfinite(area)
    return float((np.sum((c - a) * turned, axis=1) / area)[hit].max())


def surface(body, name, level=0):
    return next(s for s in body.levels[level] if s.name == name)


def welded(positions, triangles):
    _, index = np.unique(np.round(positions, 6), axis=0, return_inverse=True)
    return index.ravel()[triangles]


def test_there_are_a_woman_and_a_man():
    assert set(NAMES) == {"woman", "man"}


def test_an_unknown_body_is_refused_with_the_known_names():
    with pytest.raises(BodyError, match=r"there is no body 'robot'; known bodies are woman, man"):
        load_body("robot")


@pytest.mark.parametrize("name", NAMES)
def test_a_body_is_loaded_once(name):
    assert load_body(name) is load_body(name)


@pytest.mark.parametrize("name", NAMES)
def test_a_body_file_is_at_most_one_megabyte_and_reads_quickly(name):
    data = files("stimuli").joinpath("data", "bodies", f"{name}.glb").read_bytes()
    assert len(data) <= 1_000_000
    start = time.perf_counter()
    read_baked(data, name)
    assert time.perf_counter() - start < 0.5  # 0.02 s on an idle core


@pytest.mark.parametrize("name", NAMES)
def test_the_levels_of_detail_keep_their_budgets(name):
    counts = [sum(len(s.triangles) for s in level) for level in load_body(name).levels]
    assert len(counts) == 3
    assert 18_000 <= counts[0] <= 26_500
    assert 5_000 <= counts[1] <= 8_600
    assert 1_200 <= counts[2] <= 2_400


@pytest.mark.parametrize(("name", "stature"), [("woman", 1.63), ("man", 1.75)])
def test_the_body_stands_on_the_ground_facing_forwards_at_its_height(name, stature):
    body = load_body(name)
    assert body.stature == pytest.approx(stature, abs=0.005)
    lowest = min(s.positions[:, 1].min() for s in body.levels[0])
    assert lowest == pytest.approx(0, abs=0.002)
    joints = dict(zip(JOINTS, body.skeleton.positions, strict=True))
    assert joints["leftToes"][2] > joints["leftFoot"][2] + 0.08
    assert joints["leftUpperArm"][0] > 0.1 > -0.1 > joints["rightUpperArm"][0]
    arm = joints["leftHand"] - joints["leftUpperArm"]
    assert np.degrees(np.arctan2(arm[0], -arm[1])) == pytest.approx(30, abs=0.5)


def test_segment_lengths_are_near_winters_fractions_of_stature():
    """Winter, Biomechanics and Motor Control of Human Movement: thigh .245, shank .246, forearm .146 of stature;
    the upper arm is measured here from the joint's centre, 1.5 % of stature below the acromion."""
    for name in NAMES:
        body = load_body(name)
        joints = dict(zip(JOINTS, body.skeleton.positions, strict=True))
        bones = {
            ("leftUpperLeg", "leftLowerLeg"): 0.245,
            ("leftLowerLeg", "leftFoot"): 0.246,
            ("leftUpperArm", "leftLowerArm"): 0.171,
            ("leftLowerArm", "leftHand"): 0.146,
        }
        for (start, end), fraction in bones.items():
            assert np.linalg.norm(joints[end] - joints[start]) / body.stature == pytest.approx(fraction, abs=0.018)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("level", [0, 1, 2])
def test_every_array_is_usable(name, level):
    for s in load_body(name).levels[level]:
        count = len(s.positions)
        assert s.normals.shape == (count, 3)
        assert s.joints.shape == s.weights.shape == (count, 4)
        assert s.triangles.min() >= 0
        assert s.triangles.max() < count
        assert np.allclose(s.weights.sum(axis=1), 1, atol=1e-9)
        assert s.weights.min() >= 0
        assert np.allclose(np.linalg.norm(s.normals, axis=1), 1, atol=1e-6)
        assert s.occlusion.min() >= 0
        assert s.occlusion.max() <= 1
        assert np.all((s.colour >= 0) & (s.colour <= 1))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("part", ["shirt", "trousers", "skin", "shoes", "soles"])
def test_garments_skin_and_shoes_are_closed_surfaces(name, part):
    s = surface(load_body(name), part)
    t = welded(s.positions, s.triangles)
    t = t[(t[:, 0] != t[:, 1]) & (t[:, 1] != t[:, 2]) & (t[:, 0] != t[:, 2])]
    edges = np.sort(np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]]), axis=1)
    _, times = np.unique(edges, axis=0, return_counts=True)
    assert np.mean(times % 2 == 0) == 1.0
    assert volume(s.positions, s.triangles) > 0


@pytest.mark.parametrize("name", NAMES)
def test_an_ankle_joins_foot_and_leg_whatever_shows_between_shoe_and_trousers(name):
    body = load_body(name)
    ankle = body.skeleton.positions[JOINTS.index("leftFoot")]
    skin_here = surface(body, "skin").positions
    skin_here = skin_here[np.linalg.norm((skin_here - ankle)[:, [0, 2]], axis=1) < 0.06]
    shoe, trousers = surface(body, "shoes").positions, surface(body, "trousers").positions
    inside_shoe = skin_here[:, 1].min() < shoe[:, 1].max() - 0.02
    inside_leg = trousers[:, 1].min() + 0.06 < skin_here[skin_here[:, 1] < 0.4, 1].max()
    assert inside_shoe
    assert inside_leg


@pytest.mark.parametrize("name", NAMES)
def test_a_shirts_hem_is_one_straight_edge(name):
    """The lowest vertices that face outwards lie at one height: an uneven hem reads as rubber, not as cloth."""
    shirt = surface(load_body(name), "shirt")
    hem = shirt.positions[:, 1] < np.percentile(shirt.positions[:, 1], 1) + 0.008
    outwards = hem & (np.abs(shirt.normals[:, 1]) < 0.5)
    heights = shirt.positions[outwards, 1]
    assert outwards.sum() > 30
    assert np.mean(np.abs(heights - np.median(heights)) < 0.001) > 0.9


@pytest.mark.parametrize("name", NAMES)
def test_left_and_right_have_mirrored_weights(name):
    s = surface(load_body(name), "shoes")
    dense = np.zeros((len(s.positions), len(JOINTS)))
    np.put_along_axis(dense, s.joints, s.weights, axis=1)
    for row in range(4):  # joints with zero weight may repeat joint 0
        dense[np.arange(len(dense)), s.joints[:, row]] = 0
    for row in range(4):
        np.add.at(dense, (np.arange(len(dense)), s.joints[:, row]), s.weights[:, row])
    half = len(dense) // 2
    assert np.allclose(s.positions[:half] * (-1, 1, 1), s.positions[half:], atol=1e-4)
    assert np.allclose(dense[:half][:, MIRROR], dense[half:], atol=0.012)


@pytest.mark.parametrize("name", NAMES)
def test_a_knee_bent_by_60_degrees_keeps_its_volume(name):
    body = load_body(name)
    s = surface(body, "trousers")
    bent, _ = skin(s, posed(body, leftLowerLeg=60))
    knee = body.skeleton.positions[JOINTS.index("leftLowerLeg")]
    ring = s.positions[(np.abs(s.positions[:, 1] - knee[1]) < 0.03) & (s.positions[:, 0] > 0)]
    around = np.ptp(ring[:, 0]) * np.ptp(ring[:, 2]) * np.pi / 4 * 0.20  # 20 cm of leg about the knee
    loss = (volume(s.positions, s.triangles) - volume(bent, s.triangles)) / around
    assert abs(loss) < 0.12


@pytest.mark.parametrize("name", NAMES)
def test_the_hollow_of_a_knee_bent_by_60_degrees_is_not_pinched(name):
    """Two straight legs of cloth of radius r that meet at 60 degrees have their crease r / cos(30) behind the knee."""
    body = load_body(name)
    s = surface(body, "trousers")
    bent, _ = skin(s, posed(body, leftLowerLeg=60))
    knee = body.skeleton.positions[JOINTS.index("leftLowerLeg")]
    straight = reach(s.positions, s.triangles, knee, np.array([0.0, 0, -1]))
    crease = reach(bent, s.triangles, knee, np.array([0, np.sin(np.radians(30)), -np.cos(np.radians(30))]))
    assert crease == pytest.approx(straight / np.cos(np.radians(30)), rel=0.12)


@pytest.mark.parametrize("name", NAMES)
def test_cheeks_ears_and_knuckles_are_redder_than_foreheads_and_forearms(name):
    body = load_body(name)
    s = surface(body, "skin")
    assert s.blush is not None
    high = s.positions[:, 1] > body.stature - 0.05
    cheek = (s.positions[:, 2] > 0.05) & (np.abs(s.positions[:, 1] - body.stature + 0.15) < 0.015)
    wrist = body.skeleton.positions[JOINTS.index("leftHand")]
    arm = wrist - body.skeleton.positions[JOINTS.index("leftLowerArm")]
    beyond = (s.positions - wrist) @ arm / np.linalg.norm(arm)
    left = s.positions[:, 0] > 0.2
    assert s.blush[cheek].max() > 0.12 > s.blush[high].max() + 0.08
    assert s.blush[left & (beyond > 0.08)].mean() > 0.06 > 0.02 > s.blush[left & (np.abs(beyond + 0.08) < 0.04)].max()
    assert surface(body, "shirt").blush is None


@pytest.mark.parametrize("name", NAMES)
def test_an_elbow_bent_by_90_degrees_keeps_its_volume(name):
    body = load_body(name)
    s = surface(body, "skin")
    bent, _ = skin(s, posed(body, leftLowerArm=-90))
    elbow = body.skeleton.positions[JOINTS.index("leftLowerArm")]
    ring = s.positions[np.linalg.norm(s.positions - elbow, axis=1) < 0.055]
    around = np.ptp(ring[:, 2]) ** 2 * np.pi / 4 * 0.16  # 16 cm of arm about the elbow
    loss = (volume(s.positions, s.triangles) - volume(bent, s.triangles)) / around
    assert abs(loss) < 0.15


@pytest.mark.parametrize("name", NAMES)
def test_a_wrist_turned_by_45_degrees_is_no_sweet_wrapper(name):
    """Linear blending thins a twisted joint by the cosine of half the angle at most: 8 % for 45 degrees."""
    body = load_body(name)
    s, joint = surface(body, "skin"), JOINTS.index("leftHand")
    wrist, elbow = (body.skeleton.positions[JOINTS.index(part)] for part in ("leftHand", "leftLowerArm"))
    along = (wrist - elbow) / np.linalg.norm(wrist - elbow)
    turn = Rotation.from_rotvec(np.radians(45) * along).as_matrix()
    matrices = np.tile(np.eye(3, 4), (len(JOINTS), 1, 1))
    matrices[joint] = np.column_stack([turn, wrist - turn @ wrist])
    near = np.abs((s.positions - wrist) @ along) < 0.02
    near &= np.linalg.norm(s.positions - wrist, axis=1) < 0.06

    def thickness(positions):
        off = positions[near] - wrist
        return np.linalg.norm(off - np.outer(off @ along, along), axis=1).mean()

    assert near.sum() > 20
    assert thickness(skin(s, matrices)[0]) > 0.92 * thickness(s.positions)


def test_wrists_hardly_twist_when_the_default_actors_walk():
    for name in ("F1", "M1"):
        actor = load_actor(name)
        along = actor.skeleton.offsets[JOINTS.index("leftHand")]
        turned = poses(actor, 1.1, 100.0, np.arange(12) / 12).rotations[:, JOINTS.index("leftHand")]
        twist = 2 * np.arctan2(turned[:, :3] @ along / np.linalg.norm(along), turned[:, 3])
        assert np.abs((np.degrees(twist) + 180) % 360 - 180).max() < 10


def test_a_haircut_is_part_of_a_bodys_name():
    assert {"woman_ponytail", "man_cropped"} <= set(body_names())
    for name, (body, cut) in haircut_names().items():
        worn, usual = load_body(name), load_body(body)
        assert worn is load_body(body, cut)
        assert len(surface(worn, "hair").positions) != len(surface(usual, "hair").positions)
        assert np.array_equal(surface(worn, "trousers").positions, surface(usual, "trousers").positions)


@pytest.mark.parametrize("name", NAMES)
def test_there_are_two_haircuts_and_they_differ(name):
    first, second = hair_names(name)
    assert surface(load_body(name), "hair").positions.shape == surface(load_body(name, first), "hair").positions.shape
    assert len(surface(load_body(name, first), "hair").positions) != len(
        surface(load_body(name, second), "hair").positions
    )
    with pytest.raises(BodyError, match="there is no haircut 'mohawk'; known are"):
        load_body(name, "mohawk")


@pytest.mark.parametrize("name", ["woman_ponytail", "man", "man_cropped"])
def test_hair_that_grows_at_the_nape_stays_on_a_thicker_neck(name):
    """The lowest hair is as far from the skin in a stout build as in the medium one."""
    medium, stout = load_body(name), load_body(f"{name}_stout")
    hair, thicker = surface(medium, "hair").positions, surface(stout, "hair").positions
    low = np.flatnonzero((hair[:, 1] < 0.905 * medium.stature) & (hair[:, 2] > -0.09))
    assert len(low) > 10
    skin_of = [cKDTree(surface(b, "skin").positions) for b in (medium, stout)]
    before, after = skin_of[0].query(hair[low])[0], skin_of[1].query(thicker[low])[0]
    assert np.abs(after - before).max() < 0.0015


def test_scaling_is_uniform_and_moves_the_joints_too():
    body = load_body("woman")
    tall = scaled(body, 1.80)
    factor = 1.80 / body.stature
    assert tall.stature == 1.80
    assert np.allclose(tall.skeleton.positions, factor * body.skeleton.positions)
    assert np.allclose(tall.levels[0][0].positions, factor * body.levels[0][0].positions)
    assert np.array_equal(tall.levels[0][0].normals, body.levels[0][0].normals)


@pytest.mark.parametrize("stature", [0.2, 4.0, 175.0, float("nan")])
def test_a_stature_that_is_no_persons_is_refused(stature):
    with pytest.raises(BodyError, match="is it in metres"):
        scaled(load_body("man"), stature)


def test_a_stouter_body_has_a_wider_waist_and_stands_on_the_same_feet():
    body = load_body("man")
    stout = with_girths(body, {"spine": 1.3, "hips": 1.2})
    spine = body.skeleton.positions[JOINTS.index("spine")]
    near = np.abs(surface(body, "shirt").positions[:, 1] - spine[1]) < 0.03
    before, after = (np.ptp(surface(b, "shirt").positions[near][:, 0]) for b in (body, stout))
    assert 1.12 < after / before < 1.32
    assert np.array_equal(stout.skeleton.positions, body.skeleton.positions)
    assert np.allclose(surface(stout, "soles").positions, surface(body, "soles").positions, atol=1e-9)


def test_girths_of_one_change_nothing():
    body = load_body("woman")
    same = with_girths(body, {"spine": 1.0, "leftUpperLeg": 1.0})
    assert np.allclose(same.levels[0][0].positions, body.levels[0][0].positions, atol=1e-12)


@pytest.mark.parametrize("girths", [{"tail": 1.1}, {"leftFoot": 1.2}, {"spine": 9.0}, {"spine": float("nan")}])
def test_girths_that_make_no_person_are_refused(girths):
    with pytest.raises(BodyError):
        with_girths(load_body("man"), girths)


@pytest.mark.parametrize(("sex", "matched", "mismatched"), [("F", "woman", "man"), ("M", "man", "woman")])
def test_matched_and_mismatched_bodies_follow_the_actors_sex(sex: str, matched: str, mismatched: str) -> None:
    assert (body_for(sex, "matched"), body_for(sex, "mismatched"), body_for(sex, "man")) == (matched, mismatched, "man")


def test_a_build_is_part_of_a_bodys_name_too():
    for name in ("man_slim", "man_stout", "woman_ponytail_stout"):
        assert name in variant_names()
        assert name in body_names()
    slim, usual, stout = (
        np.ptp(surface(load_body(n), "shirt").positions[:, 2]) for n in ("man_slim", "man", "man_stout")
    )
    assert slim < usual < stout
    assert len(surface(load_body("woman_ponytail_stout"), "hair").positions) == len(
        surface(load_body("woman_ponytail"), "hair").positions
    )


@pytest.mark.parametrize("sex", ["F", "M"])
def test_somebody_of_average_weight_and_height_has_the_shipped_build(sex):
    weight, height = AVERAGE[sex]
    body = load_body(body_for(sex, "own_build"))
    assert body.name == body_for(sex, "matched")
    same = in_the_build_of(body, sex, weight, height)
    assert np.allclose(surface(same, "shirt").positions, surface(body, "shirt").positions, atol=1e-12)


@pytest.mark.parametrize(("share", "widest"), [(0.81, 0.9), (1.21, 1.1)])
def test_a_body_of_one_height_gets_wider_with_the_root_of_its_weight(share, widest):
    weight, height = AVERAGE["M"]
    body = load_body("man")
    there = in_the_build_of(body, "M", share * weight, height)
    hip = body.skeleton.positions[JOINTS.index("leftUpperLeg")]
    knee = body.skeleton.positions[JOINTS.index("leftLowerLeg")]
    thigh = np.abs(surface(body, "trousers").positions - 0.5 * (hip + knee)) < (0.2, 0.02, 0.2)
    near = thigh.all(axis=1)
    before, after = (np.ptp(surface(b, "trousers").positions[near][:, 2]) for b in (body, there))
    assert after / before == pytest.approx(widest, abs=0.02)
    volumes = [volume(s.positions, s.triangles) for b in (body, there) for s in b.levels[0] if s.name == "trousers"]
    assert volumes[1] / volumes[0] == pytest.approx(share, abs=0.04)


def test_bodies_are_never_thinner_than_they_can_be_made():
    body = load_body("woman")
    there = in_the_build_of(body, "F", 5.0, 1.7)  # kg; by weight alone the girth would be 0.25
    thinnest = with_girths(body, dict.fromkeys(girths_of("F", 5.0, 1.7), SLIMMEST))
    assert np.allclose(surface(there, "trousers").positions, surface(thinnest, "trousers").positions, atol=1e-12)

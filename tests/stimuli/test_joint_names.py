"""Roles of joints by tables of names, and by the skeleton's shape when the names say nothing."""

from pathlib import Path

import pytest

from stimuli.clip import world_positions
from stimuli.motion_files.bvh import read_bvh
from stimuli.motion_files.errors import MotionFileError
from stimuli.motion_files.joint_names import TABLES, normalise, roles_from_names
from stimuli.motion_files.overrides import overrides_beside
from stimuli.motion_files.topology import roles_from_shape
from stimuli.skeleton import JOINTS

BVH = Path(__file__).parents[2].parent / "shared" / "mocap" / "bvh"
needs_captures = pytest.mark.skipif(not BVH.is_dir(), reason="the shared captures are not beside the checkout")


@pytest.mark.parametrize(
    ("name", "plain"),
    [
        ("mixamorig:LeftArm", "leftarm"),
        ("mixamorigLeftArm", "leftarm"),
        ("Bip01 L UpperArm", "lupperarm"),
        ("Bip02_L_Thigh", "lthigh"),
        ("Actor|Foot_L", "footl"),
        ("upperleg.r", "upperlegr"),
        ("AbcdeFghijk:Hips", "hips"),
    ],
)
def test_prefixes_case_and_punctuation_are_taken_off(name, plain):
    assert normalise(name) == plain


def test_every_table_maps_to_vrm_humanoid_joints():
    assert all(set(table) <= set(JOINTS) for table in TABLES.values())


def chain(names):
    return names, [-1, *range(len(names) - 1)]


def test_left_shoulder_is_a_collar_bone_only_where_the_table_says_so():
    _, motion_builder = roles_from_names(
        *chain(["Hips", "Spine", "LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand"])
    )
    _, max_release = roles_from_names(*chain(["Hips", "Chest", "LeftCollar", "LeftShoulder", "LeftElbow", "LeftWrist"]))
    assert motion_builder["leftShoulder"] == 2
    assert max_release["leftUpperArm"] == 3


def test_left_hip_is_the_thigh_and_the_joint_above_it_is_none():
    _, roles = roles_from_names(*chain(["Hips", "LHipJoint", "LeftHip", "LeftKnee", "LeftAnkle", "LeftToe"]))
    assert roles["leftUpperLeg"] == 2


ARMS = [f"{part}.{side}" for side in "lr" for part in ("upperarm", "lowerarm", "wrist", "hand", "handslot")]
LEGS = [f"{part}.{side}" for side in "lr" for part in ("upperleg", "lowerleg", "foot", "toes")]
KAYKIT = ["root", "hips", "spine", "chest", *ARMS, "head", *LEGS]
KAYKIT_PARENTS = [-1, 0, 1, 2, 3, 4, 5, 6, 7, 3, 9, 10, 11, 12, 3, 1, 15, 16, 17, 1, 19, 20, 21]


def test_of_two_tables_that_fit_as_well_the_one_that_lacks_no_joint_is_named():
    """The joints of KayKit's Knight (CC0): Bandai Namco's names, without the neck and shoulders of its captures."""
    names, roles = roles_from_names(KAYKIT, KAYKIT_PARENTS)
    assert names == "KayKit"
    assert len(roles) == 18
    assert KAYKIT[roles["leftHand"]] == "wrist.l"
    with_the_rest = [*KAYKIT, "neck", "shoulder_l", "shoulder_r"]
    assert roles_from_names(with_the_rest, [*KAYKIT_PARENTS, 3, 3, 3])[0] == "Bandai Namco"


@needs_captures
@pytest.mark.parametrize(
    ("file", "names", "thigh", "spine", "count"),
    [
        ("cmu/cmu_02_01.bvh", "CMU", "LeftUpLeg", "LowerBack", 21),
        ("cmu-cgspeed/cgspeed_max_131_01.bvh", "3ds Max BVH", "LeftHip", "lowerback", 21),
        ("bandai/dataset-1_walk_normal_001.bvh", "Bandai Namco", "UpperLeg_L", "Spine", 21),
        ("pymo/AV_8Walk_Meredith_HVHA_Rep1.bvh", "Vicon/MotionBuilder", "LeftUpLeg", "Spine", 19),
        ("../mvnx/xsens_upperbody_v4.bvh", "Xsens BVH", "LeftHip", "Chest", 21),
    ],
)
def test_real_files_find_their_table(file, names, thigh, spine, count):
    clip = read_bvh(BVH / file)
    assert clip.source.names == names
    assert clip.joints[clip.roles["leftUpperLeg"]] == thigh
    assert clip.joints[clip.roles["spine"]] == spine
    assert len(clip.roles) == count


@needs_captures
@pytest.mark.parametrize(
    "file",
    [
        "cmu/cmu_02_01.bvh",
        "cmu/cmu_32_02.bvh",
        "cmu-cgspeed/cgspeed_max_131_01.bvh",
        "bandai/dataset-1_walk_normal_001.bvh",
        "bandai/dataset-2_walk_normal_004.bvh",
        "pymo/AV_8Walk_Meredith_HVHA_Rep1.bvh",
    ],
)
def test_the_shape_alone_tells_the_same_roles_as_the_names(file):
    clip = read_bvh(BVH / file)
    ends = frozenset(i for i, joint in enumerate(clip.joints) if joint.endswith(" end"))
    assert roles_from_shape(clip.parents, world_positions(clip), ends) == dict(clip.roles)


def test_a_yaml_file_beside_the_motion_is_read(tmp_path):
    (tmp_path / "walk.bvh.yaml").write_text("unit_to_m: 0.01\nup: z\nskip_frames: 1\nroles:\n  leftFoot: LeftAnkle\n")
    given = overrides_beside(tmp_path / "walk.bvh")
    assert (given.unit_to_m, given.up, given.skip_frames, given.roles) == (0.01, "+Z", 1, {"leftFoot": "LeftAnkle"})


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("unit: 1", "the settings are"),
        ("unit_to_m: cm", "positive number"),
        ("unit_to_m: -1", "positive number"),
        ("skip_frames: 1.5", "whole number"),
        ("up: north", "none of"),
        ("roles: {foot: LeftAnkle}", "roles are"),
        ("roles: 3", "leftFoot: LeftAnkle"),
        ("- 1", "no list of settings"),
        ("a: [", "YAML"),
    ],
)
def test_a_wrong_setting_is_named_with_what_is_allowed(tmp_path, text, words):
    (tmp_path / "walk.yaml").write_text(text)
    with pytest.raises(MotionFileError, match=words):
        overrides_beside(tmp_path / "walk.bvh")

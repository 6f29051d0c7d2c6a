"""The BVH reader against an independent reader's positions and against every trap met in real files."""

import csv
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stimuli.clip import world_pose, world_positions
from stimuli.motion_files.bvh import read_bvh
from stimuli.motion_files.errors import MotionFileError
from stimuli.motion_files.rest_pose import rest_pose

MOCAP = Path(__file__).parents[2].parent / "shared" / "mocap"
needs_captures = pytest.mark.skipif(not MOCAP.is_dir(), reason="the shared captures are not beside the checkout")


def rows(name):
    with open(MOCAP / name, encoding="utf-8") as file:
        return list(csv.DictReader(file))


def bvh_files():
    return sorted({r["file"] for r in rows("REFERENCE_POSITIONS.csv")}) if MOCAP.is_dir() else []


LEGS = """
  JOINT {s}UpLeg
  {{
    OFFSET {x} -5 0
    CHANNELS 3 Zrotation Yrotation Xrotation
    JOINT {s}Leg
    {{
      OFFSET 0 -42 0
      CHANNELS 3 Zrotation Yrotation Xrotation
      JOINT {s}Foot
      {{
        OFFSET 0 -41 0
        CHANNELS 3 Zrotation Yrotation Xrotation
        End Site
        {{
          OFFSET 0 -3 14
        }}
      }}
    }}
  }}"""


def body(root_channels="6 Xposition Yposition Zposition Zrotation Yrotation Xrotation", offset="0 0 0"):
    legs = LEGS.format(s="Left", x=9) + LEGS.format(s="Right", x=-9)
    return f"HIERARCHY\nROOT Hips\n{{\n  OFFSET {offset}\n  CHANNELS {root_channels}{legs}\n}}\n"


def written(folder, *, header=None, frames=("0 92 0" + " 0" * 21,), count=None, frame_time="0.0083333", newline="\n"):
    text = (header or body()) + f"MOTION\nFrames: {count or len(frames)}\nFrame Time: {frame_time}\n"
    path = folder / "walk.bvh"
    path.write_bytes((text + "\n".join(frames) + "\n").replace("\n", newline).encode())
    return path


@needs_captures
@pytest.mark.parametrize("file", bvh_files())
def test_joints_are_where_an_independent_reader_puts_them(file):
    """REFERENCE_POSITIONS.csv has four decimals of a file unit."""
    clip = read_bvh(MOCAP / file)
    positions = world_positions(clip) / clip.source.unit_to_m
    for row in (r for r in rows("REFERENCE_POSITIONS.csv") if r["file"] == file):
        here = positions[int(row["frame0"]), clip.joints.index(row["joint"])]
        np.testing.assert_allclose(here, [float(row[axis]) for axis in "xyz"], atol=1e-4)


@needs_captures
@pytest.mark.parametrize("file", bvh_files())
def test_unit_frames_rate_and_axes_are_the_manifests(file):
    (row,) = [r for r in rows("MANIFEST.csv") if r["file"] == file]
    clip = read_bvh(MOCAP / file)
    assert clip.source.unit_to_m == pytest.approx(float(row["unit_to_m"]), rel=1e-5)
    assert clip.frame_count == int(row["frames"])
    assert clip.rate == round(float(row["frame_rate_hz"]))
    assert clip.source.up == "+" + row["up_axis"]
    if row["forward"] in ("+Z", "-Z"):
        assert clip.source.forward == row["forward"]
    assert {"hips", "leftFoot", "rightFoot", "leftUpperArm", "head"} <= set(clip.roles)


@needs_captures
def test_an_added_t_pose_is_reported_but_never_dropped_by_itself():
    path = MOCAP / "bvh/cmu-cgspeed/cgspeed_mb_02_01.bvh"
    clip = read_bvh(path)
    assert clip.frame_count == 344
    assert any("skip_frames 1" in warning for warning in clip.warnings)
    assert read_bvh(path, skip_frames=1).frame_count == 343
    assert not read_bvh(path, skip_frames=1).warnings


@needs_captures
def test_a_zero_pose_of_bones_along_one_axis_is_not_taken_for_standing():
    heap = rest_pose(read_bvh(MOCAP / "bvh/bandai/dataset-1_walk_normal_001.bvh"))
    t_pose = rest_pose(read_bvh(MOCAP / "bvh/cmu/cmu_02_01.bvh"))
    assert not heap.standing_zero
    assert t_pose.standing_zero


def test_position_channels_replace_the_offset_and_are_not_added(tmp_path):
    path = written(tmp_path, header=body(offset="11 92 -54"))
    np.testing.assert_allclose(world_positions(read_bvh(path))[0, 0], [0, 0.92, 0])


def test_a_coordinate_without_a_channel_keeps_its_offset(tmp_path):
    path = written(tmp_path, header=body("1 Yposition", offset="11 0 -54"), frames=["92" + " 0" * 18])
    np.testing.assert_allclose(world_positions(read_bvh(path))[0, 0], [0.11, 0.92, -0.54])


def test_rotation_order_is_the_joints_own(tmp_path):
    mixed = body().replace(
        "OFFSET 0 -42 0\n      CHANNELS 3 Zrotation Yrotation Xrotation",
        "OFFSET 0 -42 0\n      CHANNELS 3 Xrotation Zrotation Yrotation",
        1,
    )
    turn = "0 92 0 0 0 0 " + "0 0 0 " + "90 90 0 " + "0 0 0 " * 4
    clip = read_bvh(written(tmp_path, header=mixed, frames=[turn]))
    knee, ankle = (world_positions(clip)[0, clip.joints.index(name)] for name in ("LeftLeg", "LeftFoot"))
    # X then Z about moving axes: (0, -41, 0) is first turned to +X by Z, which X leaves alone
    np.testing.assert_allclose(ankle - knee, [0.41, 0, 0], atol=1e-12)


@pytest.mark.parametrize(
    ("text", "rate"),
    [
        (".0083333", 120),
        ("0.008333", 120),
        ("0.0333333", 30),
        ("0.033", 30),
        ("0.0416667", 24),
        ("0.016667", 60),
        ("0.0333667", 29.97),
        ("0.01", 100),
    ],
)
def test_the_rate_is_the_whole_one_meant_unless_it_is_a_broadcast_rate(tmp_path, text, rate):
    assert read_bvh(written(tmp_path, frame_time=text)).rate == pytest.approx(rate, abs=1e-4 if rate != 29.97 else 1e-3)


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r", " \n", "\t\n"])
def test_newlines_and_trailing_blanks_do_not_matter(tmp_path, newline):
    assert read_bvh(written(tmp_path, newline=newline)).frame_count == 1


def test_a_frame_in_which_a_joint_jumps_is_told(tmp_path):
    """From 100 to 400 cm ahead and back within a frame; walking on at 1 cm a frame is no jump."""
    ahead = [100, 101, 102, 400, 104, 105]
    clip = read_bvh(written(tmp_path, frames=[f"0 92 {z}" + " 0" * 21 for z in ahead]))
    told = [warning for warning in clip.warnings if "jumps" in warning]
    assert len(told) == 1
    assert told[0].startswith("from frame 3 to 4 ")
    assert "2.98 m" in told[0]
    steady = read_bvh(written(tmp_path, frames=[f"0 92 {100 + n}" + " 0" * 21 for n in range(6)]))
    assert not any("jumps" in warning for warning in steady.warnings)


def test_numbers_in_every_notation_are_read(tmp_path):
    frame = "5.1072e-06 92 -9.23872e-007 -0 0 -4.575" + " 0" * 18
    assert world_positions(read_bvh(written(tmp_path, frames=[frame])))[0, 0, 1] == pytest.approx(0.92)


@pytest.mark.parametrize(
    ("factor", "unit"), [(1, 0.01), (0.01, 1.0), (10, 0.001), (1 / 2.54, 0.0254), (0.01 / 0.0564444, 0.0564444)]
)
def test_the_unit_is_the_one_that_makes_legs_of_the_legs(tmp_path, factor, unit):
    scaled = "\n".join(
        " ".join([line[: line.index("OFFSET") + 6], *[str(float(v) * factor) for v in line.split()[1:]]])
        if "OFFSET" in line
        else line
        for line in body().split("\n")
    )
    clip = read_bvh(written(tmp_path, header=scaled + "\n"))
    assert clip.source.unit_to_m == pytest.approx(unit, rel=1e-4)


def test_z_up_data_stand_up(tmp_path):
    lying = "0 0 92 0 0 90" + " 0" * 18  # the whole body turned so that up is Z
    clip = read_bvh(written(tmp_path, frames=[lying]))
    hips, foot = (world_positions(clip)[0, clip.roles[role]] for role in ("hips", "leftFoot"))
    assert clip.source.up == "+Z"
    assert hips[1] - foot[1] == pytest.approx(0.88)


def test_overrides_win_over_what_is_found(tmp_path):
    path = written(tmp_path)
    clip = read_bvh(path, unit_to_m=0.005, up="+Y", rate=50, roles={"leftToes": "LeftFoot end"})
    assert clip.rate == 50
    assert world_positions(clip)[0, 0, 1] == pytest.approx(0.46)
    assert clip.joints[clip.roles["leftToes"]] == "LeftFoot end"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda t: t[:400], "cut off"),
        (lambda t: t[: t.index("MOTION") + 12], "Frames"),
        (lambda t: t.replace(" 92 ", " nan "), "frame 1"),
        (lambda t: t.replace(" 92 ", " 9,2 "), "9,2"),
        (lambda t: t + "1 2 3\n", "make"),
        (lambda t: t.replace("Frames: 1", "Frames: 0"), "Frames: 0"),
        (lambda t: t.replace("Frames: 1", "Frames: 7"), "cut off"),
        (lambda t: t.replace("0.0083333", "0"), "Frame Time"),
        (lambda t: t.replace("CHANNELS 3", "CHANNELS 4", 1), "CHANNELS"),
        (lambda t: t.replace("OFFSET 0 -42 0", "OFFSET 0 -42", 1), "OFFSET"),
        (lambda t: t.replace("Zrotation Yrotation", "Zrotation Wrotation", 1), "CHANNELS"),
        (lambda t: t.replace("MOTION", "ROOT Second\n{\nOFFSET 0 0 0\n}\nMOTION"), "second skeleton"),
        (lambda t: t.replace("}\nMOTION", "MOTION"), "open"),
        (lambda t: "", "HIERARCHY"),
        (lambda t: "PNG\x00\xff", "HIERARCHY"),
        (lambda t: t.replace("-42", "-4.2").replace("-41", "-4.1"), "unit_to_m"),
    ],
)
def test_bad_files_end_in_one_sentence_naming_the_file_and_the_place(tmp_path, change, words):
    path = written(tmp_path)
    path.write_text(change(path.read_text()))
    with pytest.raises(MotionFileError, match=words) as error:
        read_bvh(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


def test_a_missing_file_is_said_to_be_missing(tmp_path):
    with pytest.raises(MotionFileError, match="cannot be read"):
        read_bvh(tmp_path / "none.bvh")


@given(st.data())
@settings(max_examples=300, deadline=None)
def test_no_mutation_of_a_file_escapes_as_another_error(tmp_path_factory, data):
    good = bytearray(written(tmp_path_factory.mktemp("bvh"), frames=["0 92 0" + " 0" * 21] * 4).read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        place = data.draw(st.integers(0, len(good) - 1))
        match data.draw(st.sampled_from(["cut", "set", "drop", "put"])):
            case "cut":
                good = good[: place + 1]
            case "set":
                good[place] = data.draw(st.integers(0, 255))
            case "drop":
                del good[place : place + data.draw(st.integers(1, 40))]
                good = good or bytearray(b" ")
            case "put":
                good[place:place] = data.draw(
                    st.sampled_from([b"nan", b"{", b"}", b"-", b"1e999", b"JOINT", b" 0 ", b"\xff"])
                )
    path = tmp_path_factory.mktemp("bad") / "bad.bvh"
    path.write_bytes(bytes(good))
    try:
        rotations, positions = world_pose(read_bvh(path))
    except MotionFileError:
        return
    assert np.all(np.isfinite(positions))
    np.testing.assert_allclose(np.linalg.norm(rotations, axis=-1), 1)

"""The MVNX reader against the BVH export of the same take, and on a tiny file."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stimuli.clip import world_positions
from stimuli.motion_files.bvh import read_bvh
from stimuli.motion_files.errors import MotionFileError
from stimuli.motion_files.mvnx import read_mvnx
from stimuli.motion_files.reading import read_clip
from stimuli.motion_files.rest_pose import rest_pose

MVNX = Path(__file__).parents[2].parent / "shared" / "mocap" / "mvnx"
needs_captures = pytest.mark.skipif(not MVNX.is_dir(), reason="the shared captures are not beside the checkout")

SEGMENTS = {  # label: (parent, place of its upper joint in the parent's axes)
    "Pelvis": (None, (0, 0, 0.9)),
    "RightUpperLeg": ("Pelvis", (0, -0.1, 0)),
    "RightLowerLeg": ("RightUpperLeg", (0, 0, -0.42)),
    "RightFoot": ("RightLowerLeg", (0, 0, -0.41)),
    "LeftUpperLeg": ("Pelvis", (0, 0.1, 0)),
    "LeftLowerLeg": ("LeftUpperLeg", (0, 0, -0.42)),
    "LeftFoot": ("LeftLowerLeg", (0, 0, -0.41)),
}


def tiny():
    """Two frames of standing legs, 0.1 m apart along +X, in Xsens' axes (X forward, Z up)."""
    points: dict[str, list[str]] = {name: [] for name in SEGMENTS}
    joints = []
    for name, (parent, place) in SEGMENTS.items():
        if parent:
            pos = " ".join(map(str, place))
            points[parent].append(f'<point label="j{name}"><pos_b>{pos}</pos_b></point>')
            joints.append(
                f'<joint label="j{name}"><connector1>{parent}/j{name}</connector1>'
                f"<connector2>{name}/j{name}</connector2></joint>"
            )
    places: dict[str, np.ndarray] = {}
    for name, (parent, place) in SEGMENTS.items():
        places[name] = np.array(place) + (places[parent] if parent else 0)
    frames = [
        f'<frame type="{kind}" index="{k}"><orientation>{"1 0 0 0 " * 7}</orientation><position>'
        + " ".join(f"{p[0] + x} {p[1]} {p[2]}" for p in places.values())
        + "</position></frame>"
        for k, (kind, x) in enumerate([("tpose", 9), ("normal", 0), ("normal", 0.1)])
    ]
    segments = "".join(f'<segment label="{n}"><points>{"".join(points[n])}</points></segment>' for n in SEGMENTS)
    return (
        '<?xml version="1.0"?><mvnx xmlns="http://www.xsens.com/mvn/mvnx" version="4">'
        f'<subject label="x" frameRate="60"><segments>{segments}</segments><joints>{"".join(joints)}</joints>'
        f"<frames>{''.join(frames)}</frames></subject></mvnx>"
    )


def test_calibration_frames_are_no_motion_and_z_up_becomes_y_up(tmp_path):
    (tmp_path / "tiny.mvnx").write_text(tiny())
    clip = read_mvnx(tmp_path / "tiny.mvnx")
    assert (clip.frame_count, clip.rate, clip.source.up) == (2, 60, "+Z")
    positions = world_positions(clip)
    foot = positions[0, clip.roles["leftFoot"]]
    assert positions[0, 0, 1] == pytest.approx(0.9)
    assert foot[1] == pytest.approx(0.07)
    assert np.linalg.norm(positions[1, 0] - positions[0, 0]) == pytest.approx(0.1)


@needs_captures
def test_the_same_take_as_bvh_has_joints_in_the_same_places():
    """Xsens writes a T-pose as the BVH's first frame, its frame k + 1 being our frame k; all agrees to 2 mm."""
    mvnx, bvh = read_mvnx(MVNX / "xsens_upperbody_v4.mvnx"), read_bvh(MVNX / "xsens_upperbody_v4.bvh", skip_frames=1)
    assert (mvnx.frame_count, mvnx.rate, len(mvnx.roles)) == (112, 60, 21)
    ours, theirs = world_positions(mvnx), world_positions(bvh)
    for role in ("spine", "neck", "head", "leftUpperArm", "leftHand", "rightHand", "leftFoot"):
        first, second = (
            np.linalg.norm(places[:, clip.roles[role]] - places[:, clip.roles["hips"]], axis=1)
            for places, clip in ((ours, mvnx), (theirs, bvh))
        )
        assert (
            min(np.abs(first[: len(second)] - second).max(), np.abs(first[1 : len(second) + 1] - second).max()) < 0.002
        )
    assert rest_pose(mvnx).standing_zero


@needs_captures
def test_nothing_that_may_name_people_is_kept():
    clip = read_mvnx(MVNX / "xsens_upperbody_v4.mvnx")
    assert "removed.mvn" not in repr(clip)
    assert "2018" not in repr(clip.source)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda t: t[:-30], "whole XML"),
        (lambda t: t.replace('type="normal"', 'type="tpose"'), "no frame of type normal"),
        (lambda t: t.replace("1 0 0 0 ", "0 0 0 0 ", 9), "unit quaternion"),
        (lambda t: t.replace("0.42", "nan"), "finite"),
        (lambda t: t.replace('frameRate="60"', ""), "frameRate"),
        (lambda t: t.replace("<connector1>Pelvis/", "<connector1>Belt/", 1), "not listed"),
        (lambda t: t.replace("<connector1>Pelvis/", "<connector1>RightFoot/", 1), "tree"),
        (lambda t: t.replace("<mvnx", '<!DOCTYPE m [<!ENTITY a "b">]><mvnx'), "entities"),
        (lambda t: "", "whole XML"),
    ],
)
def test_bad_files_end_in_one_sentence_naming_the_file(tmp_path, change, words):
    path = tmp_path / "bad.mvnx"
    path.write_text(change(tiny()))
    with pytest.raises(MotionFileError, match=words) as error:
        read_mvnx(path)
    assert str(path) in str(error.value)


def test_a_file_without_a_frame_rate_is_read_with_the_rate_beside_it(tmp_path):
    (tmp_path / "tiny.mvnx").write_text(tiny().replace('frameRate="60"', ""))
    (tmp_path / "tiny.mvnx.yaml").write_text("rate: 120\n")
    assert read_clip(tmp_path / "tiny.mvnx").rate == 120.0


@given(st.data())
@settings(max_examples=200, deadline=None)
def test_no_mutation_of_a_file_escapes_as_another_error(tmp_path_factory, data):
    good = bytearray(tiny().encode())
    for _ in range(data.draw(st.integers(1, 3))):
        place = data.draw(st.integers(0, len(good) - 1))
        if data.draw(st.booleans()):
            good[place] = data.draw(st.integers(0, 255))
        else:
            good[place : place + data.draw(st.integers(0, 9))] = data.draw(
                st.sampled_from([b"", b"nan", b"-", b"1e999"])
            )
    path = tmp_path_factory.mktemp("bad") / "bad.mvnx"
    path.write_bytes(bytes(good))
    try:
        positions = world_positions(read_mvnx(path))
    except MotionFileError:
        return
    assert np.all(np.isfinite(positions))

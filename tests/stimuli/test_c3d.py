"""The C3D reader against ezc3d's own numbers, and markers turned into a skeleton against the markers."""

import csv
import shutil
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytest.importorskip("ezc3d", reason="ezc3d is not installed (extra mocap)")

import ezc3d

from stimuli.clip import Subject, world_positions
from stimuli.cycle import extract_cycle, seam_gaps
from stimuli.gait_measures import measure
from stimuli.motion_files.axes import to_y_up
from stimuli.motion_files.c3d import read_c3d
from stimuli.motion_files.errors import MotionFileError
from stimuli.motion_files.marker_names import places_of
from stimuli.motion_files.marker_skeleton import fit_markers
from stimuli.motion_files.reading import read_clip

MOCAP = Path(__file__).parents[2].parent / "shared" / "mocap"
needs_captures = pytest.mark.skipif(not MOCAP.is_dir(), reason="the shared captures are not beside the checkout")
REFUSED = ("sgi_int", "sgi_real", "badParameterOffset")


def rows(name):
    with open(MOCAP / name, encoding="utf-8") as file:
        return list(csv.DictReader(file))


def files(name, column="file", folder="c3d/"):
    found = sorted({r[column] for r in rows(name)}) if MOCAP.is_dir() else []
    return [f for f in found if f.startswith(folder) and not f.removesuffix(".c3d").endswith(REFUSED)]


@needs_captures
@pytest.mark.parametrize("file", files("REFERENCE_C3D_POINTS.csv"))
def test_markers_are_where_ezc3d_reads_them(file):
    """REFERENCE_C3D_POINTS.csv has four decimals of a file unit; (0, 0, 0) there is a marker not seen."""
    recording = read_c3d(MOCAP / file)
    points = recording.points / recording.source.unit_to_m @ to_y_up(recording.source.up)
    compared = 0
    for row in (r for r in rows("REFERENCE_C3D_POINTS.csv") if r["file"] == file):
        same = [i for i, label in enumerate(recording.labels) if label.split("#")[0] == row["label"]]
        expected = np.array([float(row[axis]) for axis in "xyz"])
        if np.all(expected == 0):
            expected = np.full(3, np.nan)
        if same:
            here = points[int(row["frame0"]), same]
            assert any(np.allclose(p, expected, atol=2e-4, equal_nan=True) for p in here), row
            compared += 1
        else:
            assert row["label"] in recording.left_out
    assert compared >= 3


@needs_captures
@pytest.mark.parametrize("file", files("REFERENCE_C3D_EVENTS.csv"))
def test_events_are_the_files_counted_from_its_first_frame(file):
    """Feet step on in [0, duration] though files cut out of recordings count from the recording's start."""
    recording = read_c3d(MOCAP / file)
    expected = sorted(
        (float(r["time_s"]), r["context"].lower(), "strike" if "Strike" in r["label"] else "off")
        for r in rows("REFERENCE_C3D_EVENTS.csv")
        if r["file"] == file
    )
    starts = {"FunctionalWalk": 479 / 120, "PiG_Motion3_FF": 7.24, "treadmill_events": 0.44, "exampleOverground": 0.01}
    start = starts.get(Path(file).stem, 0.0)
    assert [(e.side, e.kind) for e in recording.events] == [(side, kind) for _, side, kind in expected]
    np.testing.assert_allclose([e.time + start for e in recording.events], [t for t, _, _ in expected], atol=1e-3)
    assert 0 <= recording.events[0].time <= recording.events[-1].time <= recording.frame_count / recording.rate


@needs_captures
@pytest.mark.parametrize("file", files("MANIFEST.csv"))
def test_frames_rate_and_axes_are_the_manifests(file):
    (row,) = [r for r in rows("MANIFEST.csv") if r["file"] == file]
    recording = read_c3d(MOCAP / file)
    assert recording.frame_count == int(row["frames"])
    assert recording.rate == pytest.approx(float(row["frame_rate_hz"]))
    assert recording.source.up == "+" + row["up_axis"]
    if row["forward"]:
        assert recording.source.forward == row["forward"]


@needs_captures
def test_integer_and_real_files_of_intel_and_dec_hold_the_same_trial():
    trials = [
        read_c3d(MOCAP / f"c3d/c3d-org/sample02_{kind}.c3d") for kind in ("pc_int", "pc_real", "dec_int", "dec_real")
    ]
    for other in trials[1:]:
        np.testing.assert_allclose(other.points, trials[0].points, atol=3e-4)  # m; one integer is 0.28 mm


@needs_captures
@pytest.mark.parametrize("kind", ["sgi_int", "sgi_real"])
def test_mips_files_are_refused_with_the_way_out(kind):
    with pytest.raises(MotionFileError, match=r"MIPS.*save it as Intel"):
        read_c3d(MOCAP / f"c3d/c3d-org/sample02_{kind}.c3d")


@needs_captures
def test_broken_parameter_offsets_are_called_garbled():
    with pytest.raises(MotionFileError, match=r"badParameterOffset.*garbled"):
        read_c3d(MOCAP / "c3d/btk/badParameterOffset.c3d")


@needs_captures
def test_the_subject_is_read_and_names_are_not():
    """MANIFEST.csv: man of 1.66 m; leg 0.733 m. FunctionalWalk: 60 kg, 1.68 m in mm."""
    man = read_c3d(MOCAP / "c3d/schreiber-moissenet/2014001_C4_05.c3d").subject
    assert (man.sex, round(man.height, 2), round(man.leg_length, 3)) == ("male", 1.65, 0.733)
    vicon = read_c3d(MOCAP / "c3d/btk/FunctionalWalk.c3d").subject
    assert (vicon.height, vicon.mass) == (1.68, 60.0)
    named = read_c3d(MOCAP / "c3d/c3d-org/sample01_Eb015pi.c3d")
    assert "baum" not in repr(named).lower()


def test_a_subject_described_in_words_is_left_out_and_the_markers_are_read(tmp_path):
    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    file["parameters"]["POINT"]["LABELS"]["value"] = ["LASI", "RASI"]
    file["data"]["points"] = np.ones((4, 2, 5))
    file.add_parameter("SUBJECT", "LABELS", ["height", "weight"])
    file.add_parameter("SUBJECT", "VALUES", ["1,80 m", "unknown"])
    file.write(str(tmp_path / "words.c3d"))
    recording = read_c3d(tmp_path / "words.c3d")
    assert (recording.subject, recording.points.shape) == (Subject(), (5, 2, 3))


def test_labels_of_several_marker_sets_mean_the_same_places():
    for labels in (["LASI", "RHEE"], ["AbcdeFghijk:LASI", "Abc:RHEE"], ["L_IAS", "R_FCC"], ["LASIS", "RHEE"]):
        assert places_of(labels) == {"left_asis": 0, "right_heel": 1}


WALKS = [f for f in files("MANIFEST.csv", folder="c3d/schreiber") if "_ST" not in f] + [
    "c3d/btk/FunctionalWalk.c3d",
    "c3d/btk/PiG_Motion3_FF.c3d",
]


@needs_captures
@pytest.mark.parametrize("file", WALKS)
def test_the_fitted_skeletons_hips_and_ankles_are_within_15_mm_of_the_markers_centres(file):
    fit = fit_markers(read_c3d(MOCAP / file))
    for joint in ("hips", "leftUpperLeg", "rightUpperLeg", "leftFoot", "rightFoot"):
        assert fit.centre_distances[joint] < 0.015
    assert fit.residual < 0.006


@needs_captures
@pytest.mark.parametrize("file", WALKS[::5])
def test_a_fitted_skeleton_walks_as_the_markers_do_with_bones_of_one_length(file):
    (row,) = [r for r in rows("MANIFEST.csv") if r["file"] == file]
    clip = read_clip(MOCAP / file)
    measures = measure(clip)
    assert measures.speed == pytest.approx(float(row["speed_m_s"]), rel=0.02)
    assert measures.gait.step_frequency == pytest.approx(float(row["step_freq_steps_min"]), rel=0.005)
    positions = world_positions(clip)
    for joint, parent in enumerate(clip.parents):
        if parent >= 0:
            lengths = np.linalg.norm(positions[:, joint] - positions[:, parent], axis=1)
            assert np.ptp(lengths) < 1e-9
    assert max(seam_gaps(extract_cycle(clip, phases=1024))) < 0.001


@needs_captures
@pytest.mark.parametrize("file", ["btk/PiG_Motion3_FF.c3d", "btk/FunctionalWalk.c3d"])
def test_joint_centres_are_near_those_of_plug_in_gait(file):
    """The files hold Vicon's own centres: knee (FEO) and ankle (TIO). Its hip (FEP) is Davis', ours Harrington's."""
    recording = read_c3d(MOCAP / "c3d" / file)
    clip = read_clip(MOCAP / "c3d" / file)
    positions = world_positions(clip)
    for label, joint, limit in (("FEP", "UpperLeg", 0.025), ("FEO", "LowerLeg", 0.010), ("TIO", "Foot", 0.006)):
        for side in ("left", "right"):
            theirs = recording.points[:, recording.labels.index(side[0].upper() + label)]
            distance = np.linalg.norm(positions[:, clip.roles[side + joint]] - theirs, axis=-1)
            assert np.nanmean(distance) < limit


@needs_captures
def test_markers_that_are_no_whole_body_say_which_places_are_missing():
    with pytest.raises(MotionFileError, match="left_heel"):
        read_clip(MOCAP / "c3d/btk/shd01_label_prefix.c3d")


def test_files_that_are_no_c3d_are_told_by_their_first_bytes(tmp_path):
    for content in (b"", b"HIERARCHY", bytes(2000)):
        (tmp_path / "x.c3d").write_bytes(content)
        with pytest.raises(MotionFileError, match="is no C3D file"):
            read_c3d(tmp_path / "x.c3d")


@needs_captures
@given(st.data())
@settings(max_examples=150, deadline=None)
def test_no_mutation_of_a_file_escapes_as_another_error(tmp_path_factory, data):
    name = data.draw(
        st.sampled_from(["schreiber-moissenet/2014001_ST", "c3d-org/sample02_dec_int", "btk/PiG_Motion3_FF"])
    )
    good = bytearray((MOCAP / f"c3d/{name}.c3d").read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        place = data.draw(st.integers(0, min(len(good) - 1, 9000)))
        match data.draw(st.sampled_from(["cut", "set", "drop"])):
            case "cut":
                good = good[: place + 1]
            case "set":
                good[place] = data.draw(st.integers(0, 255))
            case "drop":
                del good[place : place + data.draw(st.integers(1, 40))]
                good = good or bytearray(b" ")
    path = tmp_path_factory.mktemp("bad") / "bad.c3d"
    path.write_bytes(bytes(good))
    try:
        recording = read_c3d(path)
    except MotionFileError:
        return
    finally:
        shutil.rmtree(path.parent)
    assert recording.points.shape == (recording.frame_count, len(recording.labels), 3)

"""From a folder of captures to an actor: what is found, what is refused in one sentence, and nothing left behind."""

import csv
import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stimuli.actor_library import actor_of, imported_names
from stimuli.events import events_of
from stimuli.importing.clip_report import clip_lines, clip_report
from stimuli.importing.description import read_description
from stimuli.importing.errors import ImportingError
from stimuli.importing.folder import import_folder
from stimuli.importing.walks import read_walk, read_walks
from stimuli.measure import delivered_gait
from stimuli.motion_files.errors import MotionFileError
from stimuli.motion_files.reading import read_clip

MOCAP = Path(__file__).parents[2].parent / "shared" / "mocap"
CMU = MOCAP / "bvh" / "cmu"
needs_captures = pytest.mark.skipif(not CMU.exists(), reason="the shared captures are not beside the checkout")

ABOUT = {"sex": "male", "height": 1.65, "weight": 65, "age": 30, "licence": "CMU terms", "source": "mocap.cs.cmu.edu"}


def described(folder: Path, **changes) -> Path:
    """actor.yaml of CMU subject 07 (height from the leg's length), with changes; None takes a line out."""
    folder.mkdir(exist_ok=True)
    about = {**ABOUT, **changes}
    lines = [f"{key}: {json.dumps(value)}" for key, value in about.items() if value is not None]
    (folder / "actor.yaml").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return folder


def captured(folder: Path, *names: str, **changes) -> Path:
    described(folder, **changes)
    for name in names:
        shutil.copyfile(CMU / f"cmu_{name}.bvh", folder / f"cmu_{name}.bvh")
    return folder


def manifest() -> list[dict[str, str]]:
    if not CMU.exists():
        return []
    with (MOCAP / "MANIFEST.csv").open(newline="", encoding="utf-8") as stream:
        return [
            row for row in csv.DictReader(stream) if row["file"].startswith("bvh/cmu/") and "32_02" not in row["file"]
        ]


@needs_captures
@pytest.mark.parametrize("row", manifest()[::3], ids=lambda row: Path(row["file"]).stem)
def test_the_clip_report_has_the_manifests_figures(row):
    report = clip_report(MOCAP / row["file"])
    tolerance = 0.06 if int(row["n_steps_used"]) <= 2 else 0.02
    assert report["format"] == "BVH"
    assert report["frames"] == int(row["frames"])
    assert report["rate"] == pytest.approx(float(row["frame_rate_hz"]))
    assert report["unit_to_m"] == float(row["unit_to_m"])
    assert report["up"] == "+Y"
    assert report["speed_m_s"] == pytest.approx(float(row["speed_m_s"]), rel=tolerance)
    assert report["step_frequency_steps_min"] == pytest.approx(float(row["step_freq_steps_min"]), rel=tolerance)
    assert report["walk_ratio_m_min"] == pytest.approx(
        report["step_length_m"] / report["step_frequency_steps_min"], rel=1e-4
    )
    json.dumps(report, allow_nan=False)


@needs_captures
def test_a_clip_of_a_single_step_has_the_manifests_speed_and_no_step_frequency():
    report = clip_report(MOCAP / "bvh" / "bandai" / "dataset-1_walk_normal_002.bvh")
    assert report["speed_m_s"] == pytest.approx(1.578, rel=0.02)
    assert (report["steps_used"], report["step_frequency_steps_min"], report["step_length_m"]) == (0, None, None)
    assert "  speed         1.578 m/s over all frames" in clip_lines(report)


@needs_captures
def test_a_single_step_on_the_spot_has_no_speed():
    assert clip_report(MOCAP.parent / "gltf" / "CesiumMan.glb")["speed_m_s"] is None


@needs_captures
def test_a_standing_trial_is_described_and_has_no_gait():
    pytest.importorskip("ezc3d")
    report = clip_report(MOCAP / "c3d" / "schreiber-moissenet" / "2014019_ST.c3d")
    assert report["speed_m_s"] is None
    assert report["steps_used"] == 0
    assert any("whole stride" in warning for warning in report["warnings"])
    assert any("Note" in line for line in clip_lines(report))


@needs_captures
@pytest.mark.parametrize(("told", "noted"), [("left", True), ("", False), ("left right", False)])
def test_a_clip_whose_file_marks_one_foot_only_is_noted_as_found_in_the_motion(monkeypatch, told, noted):
    clip = read_clip(MOCAP / next(row["file"] for row in manifest() if int(row["n_steps_used"]) > 2))
    events = tuple(event for event in events_of(clip) if event.side in told.split())
    monkeypatch.setattr("stimuli.importing.clip_report.read_clip", lambda _: replace(clip, events=events))
    report = clip_report(Path("walk.c3d"))
    assert any("found in the motion" in warning for warning in report["warnings"]) == noted
    assert report["steps_used"] > 2


@needs_captures
def test_a_clip_of_markers_tells_its_steps_its_gait_without_units_and_its_residual():
    """Normalised by hand from the subject's height of 1.755 m (Hof 1996): v / sqrt(g H), L / H, f sqrt(H / g)."""
    pytest.importorskip("ezc3d")
    report = clip_report(MOCAP / "c3d" / "schreiber-moissenet" / "2014019_C4_05.c3d")
    over = report["normalised"]["height"]
    height = over["length_m"]
    assert over["speed"] == pytest.approx(report["speed_m_s"] / (9.81 * height) ** 0.5, rel=1e-4)
    assert over["step_length"] == pytest.approx(report["step_length_m"] / height, rel=1e-4)
    assert over["step_frequency"] == pytest.approx(
        report["step_frequency_steps_min"] / 60 * (height / 9.81) ** 0.5, rel=1e-4
    )
    assert report["normalised"]["leg_length"]["length_m"] == pytest.approx(0.82, abs=0.01)
    assert report["step_length_left_m"] + report["step_length_right_m"] == pytest.approx(
        2 * report["step_length_m"], rel=0.05
    )
    assert 0.0 < report["marker_residual_mm"] < 15.0


@needs_captures
def test_frames_without_markers_of_the_feet_are_told_and_times_count_from_the_files_first_frame():
    """Gait.c3d holds 487 frames (manifest); its heel marker stands still between strike and toe-off as told."""
    pytest.importorskip("ezc3d")
    from stimuli.motion_files.c3d import read_c3d

    path = MOCAP / "c3d" / "bmclab" / "Gait.c3d"
    recording = read_c3d(path)
    heel = recording.path_of("right_heel")
    report = clip_report(path)
    strike, off = report["heel_strikes"]["right"][0], report["toe_offs"]["right"][1]
    standing = heel[round((strike + 0.15) * 100) : round((off - 0.25) * 100)]
    assert report["frames"] == 487
    assert report["duration_s"] == pytest.approx(4.86)
    assert len(standing) > 10
    assert np.ptp(standing[:, [0, 2]], axis=0).max() < 0.010  # m: there the foot stands
    assert any("the first 133 and the last 160 of 487 frames are left out" in note for note in report["warnings"])


@needs_captures
@given(st.data())
@settings(max_examples=20, deadline=None)
def test_no_mutation_of_a_clip_leaves_half_an_actor_or_escapes_as_another_error(tmp_path_factory, data):
    """Single numbers and words of a walk changed: it becomes an actor, or one sentence and an empty library."""
    folder = described(tmp_path_factory.mktemp("mutant"))
    lines = (CMU / "cmu_07_10.bvh").read_text().splitlines()
    for _ in range(data.draw(st.integers(1, 4))):
        line = data.draw(st.integers(0, len(lines) - 1))
        words = lines[line].split(" ")
        word = data.draw(st.integers(0, len(words) - 1))
        words[word] = data.draw(st.sampled_from(["0", "nan", "inf", "1e9", "-180", "90", "3", "", "JOINT", "}"]))
        lines[line] = " ".join(words)
    (folder / "walk.bvh").write_text("\n".join(lines))
    library = folder / "library"
    refusal = ""
    try:
        import_folder(folder, "mutant", library)
    except MotionFileError as error:
        refusal = str(error)
    left = [path.name for path in library.iterdir()] if library.exists() else []
    assert left == ([] if refusal else ["mutant.npz"])
    assert "\n" not in refusal


@needs_captures
def test_self_chosen_speeds_make_a_path_on_which_step_frequency_follows(tmp_path):
    actor = import_folder(captured(tmp_path / "in", "07_01", "07_03", "07_10"), "anna", tmp_path / "library")
    assert actor.follows
    assert [bool(cycle.files) for cycle in actor.cycles] == [True, True, True]
    speeds = [cycle.speed for cycle in actor.cycles]
    assert speeds == pytest.approx([1.030, 1.372, 1.596], rel=0.02)  # MANIFEST.csv
    drawn = actor_of(actor)
    middle = actor.cycles[1]
    delivered = delivered_gait(drawn, middle.speed, middle.step_frequency)
    assert delivered.speed == pytest.approx(middle.speed, rel=1e-3)
    assert delivered.step_frequency == pytest.approx(middle.step_frequency, rel=1e-3)
    with pytest.raises(ValueError, match="complete"):
        delivered_gait(drawn, middle.speed, middle.step_frequency - 15.0)


@needs_captures
def test_complete_fills_the_metronomes_grid_around_the_captured_walks(tmp_path, monkeypatch):
    from stimuli.actors import actor_names, load_actor

    monkeypatch.setenv("GAITLAB_ACTORS", str(tmp_path / "library"))
    actor = import_folder(captured(tmp_path / "in", "07_01", "07_03", "07_08", "07_10", complete=True), "anna")
    assert sum(bool(cycle.files) for cycle in actor.cycles) == 4
    assert actor.provenance == "4 cycles captured, 34 modelled; licence: CMU terms; source: mocap.cs.cmu.edu"
    assert "anna" in actor_names()
    drawn = load_actor("anna")
    assert drawn.provenance == actor.provenance
    for speed in (0.8, 1.0, 1.2):
        for step_frequency in (80.0, 97.0, 120.0):
            delivered = delivered_gait(drawn, speed, step_frequency)
            assert delivered.speed == pytest.approx(speed, rel=1e-3)
            assert delivered.step_frequency == pytest.approx(step_frequency, rel=1e-3)
            assert delivered.slide_mean < 5.0
            assert delivered.slide_peak < 10.0
            assert delivered.sole_lowest > -3.0
            assert delivered.knee_least > 0.0


@needs_captures
def test_a_marker_actor_takes_what_the_markers_do_not_hold_from_the_model_and_says_so(tmp_path):
    pytest.importorskip("ezc3d")
    folder = described(tmp_path / "in", sex="female", height=1.755, complete=True)
    for name in ("2014019_C4_05", "2014019_C5_03"):
        shutil.copyfile(MOCAP / "c3d" / "schreiber-moissenet" / f"{name}.c3d", folder / f"{name}.c3d")
    actor = import_folder(folder, "lea", tmp_path / "library")
    gaits = [gait for cycle in actor.cycles for gait in cycle.captured]
    assert [gait.speed for gait in gaits] == pytest.approx([1.277, 1.742], rel=0.02)  # MANIFEST.csv
    assert any(note.startswith("head: not in the captures") for note in actor.notes)


@needs_captures
def test_walks_to_a_metronome_are_grouped_by_its_beat(tmp_path):
    """Two beats of two speeds each, made by playing CMU walks a little faster or slower."""
    folder = described(tmp_path / "in", height=1.70)
    text = (CMU / "cmu_16_15.bvh").read_text()
    head, motion = text.split("MOTION")
    lines = motion.strip().splitlines()
    rows = np.array([[float(value) for value in line.split()] for line in lines[2:]])
    for index, (tempo, stride) in enumerate(((0.9, 0.85), (0.9, 1.2), (1.1, 0.85), (1.1, 1.2))):
        moved = rows.copy()
        moved[:, [0, 2]] *= stride
        body = "\n".join(" ".join(f"{value:.5f}" for value in row) for row in moved)
        frame = f"Frames: {len(moved)}\nFrame Time: {1 / (120 * tempo):.8f}\n"
        (folder / f"w{index}.bvh").write_text(f"{head}MOTION\n{frame}{body}\n")
    actor = import_folder(folder, "grid", tmp_path / "library")
    assert not actor.follows
    assert [frequency for frequency, _ in actor.rows] == pytest.approx([0.9 * 102.5, 1.1 * 102.5], rel=0.02)
    assert [len(row) for _, row in actor.rows] == [2, 2]


@needs_captures
def test_walks_at_freely_chosen_step_frequencies_stay_where_they_were_walked_in_a_completed_grid():
    """Fourteen from 94 to 117 steps/min, each within 2 of the next, are no beat of a metronome: none is moved by 3."""
    from stimuli.actors import Person
    from stimuli.gait import Gait
    from stimuli.importing.arrangement import arrange

    walk = read_walk(CMU / "cmu_16_15.bvh")
    gaits = [Gait(0.0065 * frequency, frequency) for frequency in np.linspace(94.0, 117.0, 14)]
    walks = [replace(walk, file=f"w{index}.bvh", gait=gait) for index, gait in enumerate(gaits)]
    person = Person("x", "M", 30.0, 1.70, 65.0, 1.2, 0.0065, "", ())
    arrangement = arrange(walks, person, walk.leg_length, complete=True)
    placed = {file: cycle.step_frequency for cycle in arrangement.cycles for file in cycle.files}
    for captured_walk in walks:
        assert abs(placed[captured_walk.file] - captured_walk.gait.step_frequency) < 3.0
    frequencies = [frequency for frequency, _ in arrangement.rows]
    assert frequencies == sorted(set(frequencies))


@needs_captures
def test_files_that_a_mac_hides_beside_a_clip_are_no_clips(tmp_path):
    folder = captured(tmp_path / "in", "07_01")
    (folder / "._cmu_07_01.bvh").write_bytes(b"\x00\x05\x16\x07" * 30)
    assert [walk.file for walk in read_walks(folder)] == ["cmu_07_01.bvh"]


def rewritten(folder: Path, change) -> Path:
    """CMU 07_03 with its header lines and frames (rows of numbers) changed."""
    captured(folder)
    lines = (CMU / "cmu_07_03.bvh").read_text().splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("Frames:"))
    head, rows = change(lines[:start], [line.split() for line in lines[start + 2 :] if line.strip()])
    body = [" ".join(row) for row in rows]
    (folder / "walk.bvh").write_text("\n".join([*head, f"Frames: {len(rows)}", lines[start + 1], *body]) + "\n")
    return folder


def still(head, rows):
    return head, [rows[0]] * 300


def one_frame(head, rows):
    return head, rows[:1]


def not_a_number(head, rows):
    rows[50][4] = "nan"
    return head, rows


def ten_minutes(head, rows):
    return head, rows * (72_000 // len(rows) + 1)


def a_step(head, rows):
    return head, rows[:40]


def in_kilometres(head, rows):
    changed = []
    for line in head:
        words = line.split()
        if words and words[0] == "OFFSET":
            line = "OFFSET " + " ".join(f"{float(word) * 1e-5:.9f}" for word in words[1:])
        changed.append(line)
    return changed, [[f"{float(v) * 1e-5:.9f}" for v in row[:3]] + row[3:] for row in rows]


@needs_captures
@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (still, "whole stride"),
        (one_frame, "one frame|1 frame"),
        (not_a_number, "number|nan"),
        (ten_minutes, "cut it to one straight walk"),
        (a_step, "whole stride"),
        (in_kilometres, "no leg"),
    ],
    ids=lambda value: value.__name__ if callable(value) else "",
)
def test_a_clip_that_makes_no_walk_is_one_sentence_and_leaves_nothing(tmp_path, change, reason):
    refused(rewritten(tmp_path / "in", change), tmp_path / "library", "walk.bvh", reason)


def test_missing_feet_are_named(tmp_path):
    """A skeleton whose legs end below the knee."""
    turns = "CHANNELS 3 Zrotation Yrotation Xrotation"
    legs = "".join(
        f" JOINT {side}UpLeg {{ OFFSET {x} -5 0 {turns}"
        f" JOINT {side}Leg {{ OFFSET 0 -42 0 {turns} End Site {{ OFFSET 0 -41 0 }} }} }}"
        for side, x in (("Left", 9), ("Right", -9))
    )
    places = "CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation"
    head = f"HIERARCHY ROOT Hips {{ OFFSET 0 0 0 {places}{legs} }}"
    head = re.sub(r" (?=ROOT|JOINT|OFFSET|CHANNELS|End|[{}])", "\n", head)
    rows = [f"0 95 {frame} " + " ".join(["0"] * 15) for frame in range(200)]
    folder = described(tmp_path / "in")
    (folder / "walk.bvh").write_text("\n".join([head, "MOTION", "Frames: 200", "Frame Time: .01", *rows]) + "\n")
    refused(folder, tmp_path / "library", "walk.bvh", "Foot|leg")


@needs_captures
def test_a_truncated_file_is_one_sentence(tmp_path):
    folder = captured(tmp_path / "in")
    text = (CMU / "cmu_07_03.bvh").read_text()
    (folder / "walk.bvh").write_text(text[: len(text) // 2])
    refused(folder, tmp_path / "library", "walk.bvh", ".")


@needs_captures
def test_a_walk_that_turns_is_refused(tmp_path):
    folder = described(tmp_path / "in")
    eight = next((MOCAP / "bvh" / "pymo").glob("AV_8Walk*.bvh"))
    shutil.copyfile(eight, folder / "eight.bvh")
    refused(folder, tmp_path / "library", "eight.bvh", "turns by")


@needs_captures
def test_two_peoples_clips_in_one_folder_are_told_apart(tmp_path):
    refused(captured(tmp_path / "in", "07_01", "08_01"), tmp_path / "library", "cmu_08_01.bvh", "two people")


@needs_captures
def test_a_height_that_does_not_fit_the_legs_is_refused(tmp_path):
    refused(captured(tmp_path / "in", "07_01", height=1.15), tmp_path / "library", "actor.yaml", "no leg")


@needs_captures
def test_a_folder_without_clips_and_a_folder_without_yaml_are_refused(tmp_path):
    refused(described(tmp_path / "in"), tmp_path / "library", "in", "no motion file")
    folder = captured(tmp_path / "other", "07_01")
    (folder / "actor.yaml").unlink()
    refused(folder, tmp_path / "library", "actor.yaml", "missing")


def refused(folder: Path, library: Path, names: str, reason: str) -> None:
    with pytest.raises(MotionFileError, match=reason) as error:
        import_folder(folder, "nobody", library)
    assert names in str(error.value)
    assert "\n" not in str(error.value)
    assert not library.exists() or not list(library.iterdir())


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"sex": "other"}, "neither female nor male"),
        ({"height": 172}, "1 to 2.3 m"),
        ({"height": True}, "1 to 2.3 m"),
        ({"weight": None}, "weight is missing"),
        ({"age": "old"}, "5 to 110 years"),
        ({"licence": ""}, "licence is empty"),
        ({"complete": "maybe"}, "neither true nor false"),
        ({"hight": 1.7}, "hight is no setting"),
    ],
)
def test_a_mistake_in_actor_yaml_is_one_sentence(tmp_path, changes, reason):
    with pytest.raises(ImportingError, match=reason):
        read_description(described(tmp_path / "in", **changes))


def test_sex_height_weight_and_age_are_enough_for_an_actor(tmp_path):
    read = read_description(described(tmp_path / "in", licence=None, source=None))
    assert (read.licence, read.source) == ("not stated", "not stated")


@needs_captures
@pytest.mark.parametrize("height", [1.75, 1.85])
def test_a_tall_persons_shortest_steps_are_measured_from_the_heel_they_stand_on(tmp_path, height):
    """At 0.70 m/s and 120 steps/min the foot still stands on its heel, toes up, when the other one strikes."""
    folder = captured(tmp_path / "in", "07_01", "07_03", "07_08", "07_10", complete=True, height=height)
    actor = import_folder(folder, "tall", tmp_path / "library")
    delivered = delivered_gait(actor_of(actor), 0.7, 120.0)
    assert delivered.speed == pytest.approx(0.7, rel=1e-4)


def test_an_import_never_writes_over_an_actor_unless_told(tmp_path):
    from stimuli.actor_library import ActorError, check_name

    for name, reason in (("F1", "default actor"), ("../x", "no name"), ("a b", "no name")):
        with pytest.raises(ActorError, match=reason):
            check_name(name, tmp_path)
    (tmp_path / "anna.npz").write_bytes(b"x")
    assert imported_names(tmp_path) == ("anna",)
    with pytest.raises(ActorError, match="already"):
        check_name("anna", tmp_path)
    check_name("anna", tmp_path, replace=True)


@needs_captures
@pytest.mark.slow
def test_the_bias_of_cmus_skeletons_is_the_laboratory_term_of_the_gait_models_regression():
    pytest.importorskip("ezc3d")
    from stimuli.fitting.gait_model import RIDGE, _mixed_fit, read_all
    from stimuli.gait_model import SIGNALS, Step, load_gait_model
    from stimuli.importing.skeleton_bias import skeleton_bias

    walks, _ = read_all(MOCAP.parent)
    steps = [Step.of(walk.speed, walk.step_frequency, walk.leg_length) for walk in walks]
    model = load_gait_model()
    design = np.array(
        [
            [*model.predictors(step, walk.sex), float(walk.laboratory == "CMU")]
            for step, walk in zip(steps, walks, strict=True)
        ]
    )
    for name, share in (("thigh", 1.0), ("shank", 1.0), ("foot_yaw", 1.0), ("knee_yaw", 0.6)):
        index = SIGNALS.index(name)
        values = np.array([walk.coefficients[index] for walk in walks])
        effects, _ = _mixed_fit(design, values, [walk.person for walk in walks], RIDGE)
        np.testing.assert_allclose(skeleton_bias("CMU")[index], share * effects[4], atol=2e-4)
    assert not skeleton_bias("Xsens").any()


@needs_captures
@pytest.mark.parametrize("path", sorted(CMU.glob("*.bvh"))[::4], ids=lambda path: path.stem)
def test_a_captured_cycle_slides_until_its_feet_are_placed(path):
    """Mean slide <= 5 mm, peak <= 10 mm, sole not 3 mm below ground, knees not overstretched."""
    from stimuli.actor_library import StoredActor, StoredCycle
    from stimuli.actors import Person
    from stimuli.cycle import extract_cycle
    from stimuli.importing.arrangement import arrange
    from stimuli.motion_files.reading import read_clip
    from stimuli.quality.cycle_contact import cycle_contact

    raw = cycle_contact(extract_cycle(read_clip(path)))
    assert raw.bones < 1e-9
    assert raw.slide_peak < 30.0  # mm: what is taken away
    walk = read_walk(path)
    person = Person("x", "M", 30.0, walk.leg_length / 0.491, 65.0, 1.2, 0.006, "", ())
    ((_, (cycle,)),) = arrange([walk], person, walk.leg_length, complete=False).rows
    stored = StoredCycle(cycle.speed, cycle.step_frequency, cycle.walk)
    drawn = actor_of(StoredActor(person, "", "", ((0.0, (stored,)),), True))
    gait = delivered_gait(drawn, cycle.speed, cycle.step_frequency)
    assert gait.slide_mean <= 5.0
    assert gait.slide_peak <= 10.0
    assert gait.sole_lowest >= -3.0
    assert gait.knee_least > 0.0


@needs_captures
def test_an_unlikely_height_is_noted_and_a_likely_one_is_not(tmp_path):
    """CMU 07's legs are 0.805 m: those of 1.64 m (Winter 2009: 0.491 of the stature). 1.52 m is 8 % less."""
    likely = import_folder(captured(tmp_path / "a", "07_10"), "likely", tmp_path / "library")
    assert not any("tall" in note for note in likely.notes)
    unlikely = import_folder(captured(tmp_path / "b", "07_10", height=1.52), "unlikely", tmp_path / "library")
    assert any("rather those of somebody 1.64 m tall than 1.52 m" in note for note in unlikely.notes)


@needs_captures
def test_clips_read_several_at_once_are_the_same_in_the_same_order(tmp_path):
    pytest.importorskip("ezc3d")
    folder = described(tmp_path / "in", height=1.76)
    for copy in range(6):
        for name in ("2014019_C4_05", "2014019_C5_03"):
            shutil.copyfile(MOCAP / "c3d/schreiber-moissenet" / f"{name}.c3d", folder / f"{name}_{copy}.c3d")
    told: list[int] = []
    alone, together = read_walks(folder), read_walks(folder, lambda done, of: told.append(done), at_once=2)
    assert [walk.file for walk in together] == [walk.file for walk in alone]
    assert told == list(range(1, len(alone) + 1))
    for one, other in zip(alone, together, strict=True):
        np.testing.assert_array_equal(one.curves.sides, other.curves.sides)
    (folder / "2014019_C5_03_2.c3d").write_text("no motion", encoding="utf-8")
    with pytest.raises(MotionFileError, match=r"2014019_C5_03_2\.c3d"):
        read_walks(folder, at_once=2)


@needs_captures
def test_of_two_clips_equally_near_to_the_comfortable_speed_the_slower_gives_the_walk_ratio(tmp_path):
    """Two clips lie equally far from their median: the last digit of a measure must not choose the walk ratio."""
    for names in (("07_01", "07_10"), ("07_03", "07_10"), ("16_15", "16_21")):
        folder = tmp_path / "-".join(names)
        actor = import_folder(captured(folder, *names, height=1.68), "two", tmp_path / "library", replace=True)
        assert actor.person.walk_ratio_source == f"captured, cmu_{names[0]}.bvh"


@needs_captures
def test_of_two_clips_equally_near_the_more_usual_walk_gives_the_walk_ratio(tmp_path):
    """Subject 07 at 1.36 m/s took steps of 0.86 m (0.0089 m·min), at 1.38 m/s his usual ones (0.0068); MANIFEST.csv."""
    folder = captured(tmp_path / "in", "07_01", "07_03", "07_08", "07_10")
    person = import_folder(folder, "seven", tmp_path / "library").person
    assert person.walk_ratio_source == "captured, cmu_07_01.bvh"
    assert person.walk_ratio == pytest.approx(0.0068, abs=0.0002)

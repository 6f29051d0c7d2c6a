"""`gaitlab clip` and `gaitlab actor`: help, JSON, files written, one sentence and status 2 for every mistake."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from experiment_app.command import run
from stimuli.skeleton import JOINTS, PARENTS

MOCAP = Path(__file__).parents[2].parent / "shared" / "mocap"
CLIP = MOCAP / "bvh" / "cmu" / "cmu_07_03.bvh"
needs_captures = pytest.mark.skipif(not CLIP.exists(), reason="the shared captures are not beside the checkout")
KEYS = {
    "format", "frames", "rate", "joints", "unit_to_m", "up", "forward", "heel_strikes", "toe_offs", "steps_used",
    "speed_m_s", "step_frequency_steps_min", "step_length_m", "walk_ratio_m_min", "warnings",
}  # fmt: skip


@pytest.fixture(autouse=True)
def own_library(tmp_path, monkeypatch):
    monkeypatch.setenv("GAITLAB_ACTORS", str(tmp_path / "library"))
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def folder(tmp_path) -> Path:
    folder = tmp_path / "captures"
    folder.mkdir()
    shutil.copyfile(CLIP, folder / "walk.bvh")
    (folder / "actor.yaml").write_text(
        "sex: male\nheight: 1.65\nweight: 65\nage: 30\nlicence: CMU terms\nsource: mocap.cs.cmu.edu\ncomplete: true\n"
    )
    return folder


@pytest.mark.parametrize("command", ["list", "pose", "check", "table", "show", "import"])
def test_every_actor_command_has_help(command, capfd):
    assert run(["actor", command, "--help"]) == 0
    assert len(capfd.readouterr().out) > 200


@needs_captures
def test_clip_as_json_has_the_promised_names(capfd):
    assert run(["clip", str(CLIP), "--json"]) == 0
    report = json.loads(capfd.readouterr().out)
    assert set(report) >= KEYS
    assert report["speed_m_s"] == pytest.approx(1.030, rel=0.02)  # MANIFEST.csv
    assert report["step_frequency_steps_min"] == pytest.approx(98.0, rel=0.02)


@needs_captures
def test_clip_for_people_says_the_same(capfd):
    assert run(["clip", str(CLIP)]) == 0
    text = capfd.readouterr().out
    assert "BVH, 406 frames at 120 Hz" in text
    assert "1.029 m/s over 4 steps" in text


@pytest.mark.parametrize(
    "arguments",
    [
        ["clip", "nothing.bvh"],
        ["actor", "pose", "F99"],
        ["actor", "check", "F99"],
        ["actor", "show", "nobody"],
        ["actor", "pose", "F1", "--seconds", "-1"],
        ["actor", "pose", "F1", "--rate", "0"],
        ["actor", "import", "no_such_folder", "--name", "anna"],
        ["actor", "import", ".", "--name", "F1"],
        ["actor", "import", ".", "--name", "../anna"],
        ["actor", "check", "F1", "--speeds", "0"],
    ],
)
def test_a_mistake_is_one_sentence_and_status_2(arguments, capfd):
    assert run(arguments) == 2
    text = capfd.readouterr().err
    assert "Traceback" not in text
    assert len(text.strip().splitlines()) == 1


@pytest.mark.parametrize("asked", [["--speed", "3.0"], ["--step-frequency", "300"]], ids=lambda asked: asked[0])
def test_outside_the_coverage_is_one_sentence_and_a_drawing(asked, capfd):
    assert run(["actor", "pose", "F1", *asked]) == 2
    sentence, *drawing = capfd.readouterr().err.strip().splitlines()
    assert "is outside the cycles there are" in sentence
    assert len(drawing) == 12
    assert "Traceback" not in "".join(drawing)


def test_a_garbled_motion_file_is_one_sentence(tmp_path, capfd):
    (tmp_path / "bad.bvh").write_bytes(bytes(range(256)))
    assert run(["clip", "bad.bvh"]) == 2
    assert "bad.bvh" in capfd.readouterr().err


def test_pose_writes_the_travelling_walker(tmp_path):
    words = ["--speed", "1.0", "--step-frequency", "85", "--seconds", "3", "--rate", "120", "--out", "poses.npz"]
    assert run(["actor", "pose", "F1", *words]) == 0
    with np.load(tmp_path / "poses.npz") as poses:
        assert tuple(poses["joints"]) == JOINTS
        assert tuple(poses["parents"]) == PARENTS
        assert poses["positions"].shape == (360, 21, 3)
        assert float(poses["speed"]) == 1.0
        assert float(poses["step_frequency"]) == 85.0
        travelled = poses["positions"][-1, 0, 2] - poses["positions"][0, 0, 2]
    assert travelled == pytest.approx(359 / 120, abs=0.05)


def test_check_writes_a_table_and_a_page(tmp_path, capfd):
    from PIL import Image

    assert run(["actor", "check", "M2", "--speeds", "2", "--step-frequencies", "2", "--picture", "page.png"]) == 0
    assert "worst: speed 0.0" in capfd.readouterr().out
    assert Image.open(tmp_path / "page.png").size == (1500, 920)


@needs_captures
def test_an_imported_actor_is_listed_posed_and_accepted_in_a_study(folder, tmp_path, capfd):
    from tests.protocols.studies import changed

    assert run(["actor", "import", str(folder), "--name", "anna"]) == 0
    assert "1 cycle captured" in capfd.readouterr().out
    assert run(["actor", "list"]) == 0
    assert "anna" in capfd.readouterr().out
    words = ["--speed", "1.0", "--step-frequency", "100", "--seconds", "1", "--out", "p.npz"]
    assert run(["actor", "pose", "anna", *words]) == 0
    with np.load(tmp_path / "p.npz") as poses:
        assert "CMU terms" in str(poses["provenance"])
    text = changed(("actor: [F1, F2, M1, M2] ", "actor: [F1, F2, M1, anna] ")).replace("M2: 0.00700}", "anna: 0.00700}")
    (tmp_path / "mine.yaml").write_text(text.replace("M2: {mean", "anna: {mean"), encoding="utf-8")
    assert run(["check", "mine.yaml"]) == 0
    assert run(["actor", "import", str(folder), "--name", "anna"]) == 2
    assert run(["actor", "import", str(folder), "--name", "anna", "--replace"]) == 0


def test_show_writes_a_film_strip(tmp_path):
    pytest.importorskip("moderngl")
    from PIL import Image

    from experiment_app.errors import UsageError
    from experiment_app.windows.offscreen import offscreen_context

    try:
        offscreen_context().release()
    except UsageError:
        pytest.skip("no OpenGL 3.3 here")
    assert run(["actor", "show", "F1", "--picture", "strip.png"]) == 0
    assert np.asarray(Image.open(tmp_path / "strip.png")).std() > 5.0


def test_check_draws_what_an_actor_covers_where_a_study_asks_for_more(tmp_path, capsys):
    from protocols.study_file import find_study

    text = find_study("walk_ratio")[1].decode("utf-8").replace("speed: [0.8, 1.0, 1.2]", "speed: [0.8, 1.0, 1.9]")
    study = tmp_path / "fast.yaml"
    study.write_text(text, encoding="utf-8")
    assert run(["check", str(study)]) == 2
    said = "".join(capsys.readouterr())
    assert "speed 1.9 m/s is outside the cycles there are: 0.7 to 1.42 m/s" in said
    assert "X asked for" in said
    assert "actor F1" in said


@needs_captures
@pytest.mark.parametrize("body", ["", "woman"])
def test_what_remains_of_the_slide_is_measured_on_the_drawn_body_for_the_trials_record(folder, body):
    """Of an imported actor on his own body and on the other sex's, as the journal takes it down at the response."""
    from experiment_app.scene import Camera, Scene, Walker
    from experiment_app.walkers import measured_gait

    assert run(["actor", "import", str(folder), "--name", "anna"]) == 0
    walker = Walker("anna", 1.0, 97.0, 0.0, body=body)
    measured = measured_gait(Scene((walker,), Camera(view="side")))
    assert measured["speed"] == pytest.approx(1.0, rel=1e-3)
    assert measured["step_frequency"] == pytest.approx(97.0, rel=1e-3)
    assert 0.0 <= measured["slide_mean_mm"] <= 5.0
    assert measured["slide_mean_mm"] <= measured["slide_peak_mm"] <= 10.0

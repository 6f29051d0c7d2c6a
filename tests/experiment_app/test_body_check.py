"""The pictures of `gaitlab body check`: every model is drawn where its vertices are, also one that cannot walk."""

import csv
import json
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from experiment_app.command import run
from experiment_app.pictures.body_check import SIZE, file_views
from experiment_app.render.cameras import place_camera
from experiment_app.render.renderer import Renderer
from experiment_app.windows.offscreen import offscreen_context
from stimuli.body_files.container import read_container, write_container
from stimuli.body_files.shown import fitted, looked_at, read_shown
from tests.protocols.studies import changed

MAN = files("stimuli").joinpath("data", "bodies", "man.glb").read_bytes()
MODELS = Path(__file__).parents[2].parent / "shared" / "gltf"
WALKERS = ("CesiumMan.glb", "cesium_man_embedded.gltf", "RiggedFigure.glb", "KayKit_Knight.glb")
OTHERS = ("RiggedSimple.glb", "rigged_simple_embedded.gltf", "interpolation_test.gltf")

shared = pytest.mark.skipif(not MODELS.exists(), reason="the shared reference models are not here")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("GAITLAB_BODIES", str(tmp_path / "bodies"))
    monkeypatch.chdir(tmp_path)


@pytest.fixture(scope="module")
def drawing():
    context = offscreen_context()
    renderer = Renderer(context, SIZE, 1.0, 4)
    yield renderer, context.simple_framebuffer(SIZE)
    renderer.release()
    context.release()


def said(capfd):
    captured = capfd.readouterr()
    return captured.out, captured.err


@shared
def test_these_are_all_the_models():
    with (MODELS / "MANIFEST.csv").open() as file:
        named = {row["file"] for row in csv.DictReader(file) if not row["file"].endswith(".bin")}
    assert named == {*WALKERS, *OTHERS}


@shared
@pytest.mark.parametrize("model", [*WALKERS, *OTHERS])
def test_every_model_is_drawn_by_the_command(capfd, model):
    walks = model in WALKERS
    assert run(["body", "check", str(MODELS / model), "--picture", "seen.png"]) == (0 if walks else 2)
    words, refusal = said(capfd)
    assert "Picture: seen.png" in words
    assert ("a person" in words) == walks
    if not walks:
        assert "a model that cannot walk" in words
        assert "no joint plays hips" in refusal or "no mesh hangs on a skeleton" in refusal
    with Image.open("seen.png") as picture:
        assert picture.size == (4 * SIZE[0], SIZE[1] * (2 if walks else 1))


@shared
@pytest.mark.parametrize("model", [*WALKERS, *OTHERS])
def test_what_is_drawn_fills_the_pixels_between_the_corners_of_its_vertices(drawing, model):
    """The vertices fill the reference's box to a millimetre (test_shown_files.py); here they go through the camera."""
    renderer, target = drawing
    shown = read_shown(MODELS / model)
    moments = (None, None, looked_at(shown), looked_at(shown))
    for (scene, walker), moment in zip(file_views(MODELS / model), moments, strict=True):
        renderer.draw(scene, (walker,), target)
        seen, codes = renderer.read_pixels(target), renderer.draw_parts().codes[..., 0]
        renderer.draw(scene, (shrunk(walker),), target)
        assert np.mean(np.any(seen != renderer.read_pixels(target), axis=2)[codes > 0]) > 0.95
        rows, columns = (np.flatnonzero(codes.any(axis=axis)) for axis in (1, 0))
        points = np.concatenate([s.positions for s in fitted(shown, moment).body.levels[0]])
        camera = place_camera(scene.camera, SIZE[0] / SIZE[1], walker.body.stature, (0.0, 0.0, 0.0))
        clip = np.column_stack([points, np.ones(len(points))]) @ camera.matrix.T
        x, y = (clip[:, :2] / clip[:, 3:]).T
        across, down = 0.5 * (1.0 + x) * SIZE[0], 0.5 * (1.0 - y) * SIZE[1]
        assert columns[0] == pytest.approx(across.min(), abs=1.5)
        assert columns[-1] + 1 == pytest.approx(across.max(), abs=1.5)
        assert rows[0] == pytest.approx(down.min(), abs=1.5)
        assert rows[-1] + 1 == pytest.approx(down.max(), abs=1.5)


def shrunk(walker):
    """The same walker, too small to be seen."""
    level = tuple(replace(s, positions=1e-6 * s.positions) for s in walker.body.levels[0])
    return replace(walker, body=replace(walker.body, levels=(level,)))


def without_legs() -> bytes:
    """The man with legs whose joints' names say nothing, hung on one joint: a ghost."""
    container = read_container(MAN, "man")
    for node in container.document["nodes"]:
        if "Leg" in node.get("name", "") or "Foot" in node.get("name", ""):
            node["name"] = "tail"
    joints = container.document["skins"][0]["joints"]
    del container.document["skins"][0]["inverseBindMatrices"]
    container.document["skins"][0]["joints"] = [joints[0]] * len(joints)
    return write_container(container)


def test_a_model_that_cannot_walk_is_drawn_and_the_reason_comes_last(capfd):
    Path("ghost.glb").write_bytes(without_legs())
    assert run(["body", "check", "ghost.glb"]) == 2
    words, refusal = said(capfd)
    assert "ghost.glb: a model that cannot walk" in words
    assert "Animations: none" in words
    assert "ghost.glb: " in refusal
    with Image.open("ghost-check.png") as picture:
        assert picture.size == (4 * SIZE[0], SIZE[1])
        assert np.asarray(picture).std() > 10


def test_a_model_that_cannot_walk_has_its_reason_in_the_json(capfd):
    Path("ghost.glb").write_bytes(without_legs())
    assert run(["body", "check", "ghost.glb", "--json"]) == 2
    words, _ = said(capfd)
    report = json.loads(words)
    assert report["walks"] is False
    assert report["why_not"].startswith("ghost.glb: ")
    assert not Path("ghost-check.png").exists()


def test_a_model_that_cannot_walk_is_not_imported(capfd):
    Path("ghost.glb").write_bytes(without_legs())
    assert run(["body", "import", "ghost.glb", "--name", "ghost"]) == 2
    assert not Path("bodies").exists()


def test_a_file_of_which_nothing_can_be_seen_is_refused_without_a_picture(capfd):
    Path("cut.glb").write_bytes(MAN[:5000])
    assert run(["body", "check", "cut.glb"]) == 2
    words, refusal = said(capfd)
    assert words == ""
    assert "cut short" in refusal
    assert not Path("cut-check.png").exists()


@shared
def test_a_study_is_told_when_the_legs_of_its_body_are_too_short_for_its_steps(capfd):
    """F2's longest steps at 1.2 m/s and 80 steps/min are 0.9 m, three times the knight's legs."""
    assert run(["body", "import", str(MODELS / "KayKit_Knight.glb"), "--name", "knight"]) == 0
    assert run(["body", "import", str(MODELS / "CesiumMan.glb"), "--name", "cesium"]) == 0
    for body, told in (("knight", True), ("cesium", False)):
        study = changed(("  speed: $speed\n", f"  speed: $speed\n  body: {body}\n"))
        Path("mine.yaml").write_text(study, encoding="utf-8")
        assert run(["check", "mine.yaml"]) == 0
        words = " ".join(said(capfd)[1].split())
        assert ("actor F2, 1.2 m/s, 80 steps/min): its legs are too short for these steps" in words) == told

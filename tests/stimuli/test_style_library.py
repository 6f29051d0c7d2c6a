"""Captured styles: taken from clips, kept in the library, worn by any actor."""

from dataclasses import replace
from pathlib import Path
from random import Random

import numpy as np
import pytest

from experiment_app.command import run
from stimuli.actors import load_actor
from stimuli.gait_model import COEFFICIENTS, SIGNALS
from stimuli.importing.styles import captured_style
from stimuli.methods.errors import MethodError
from stimuli.methods.made import made_walk
from stimuli.methods.recipe import Making
from stimuli.methods.styles import Style, imported_styles, read_style, store_style, style_names, styled

MOCAP = Path(__file__).parents[2].parent / "shared" / "mocap" / "bvh"
needs_captures = pytest.mark.skipif(not MOCAP.exists(), reason="the shared captures are not beside the checkout")
SAD, NORMAL = (MOCAP / "bandai" / f"dataset-1_walk_{name}_001.bvh" for name in ("sad", "normal"))


@pytest.fixture(autouse=True)
def _library(tmp_path, monkeypatch):
    monkeypatch.setenv("GAITLAB_ACTORS", str(tmp_path))


def style(name="lab7_calm"):
    shift = np.zeros((2, len(SIGNALS), COEFFICIENTS))
    shift[:, SIGNALS.index("head_x"), 0] = 0.25
    return Style(name, np.ones(len(SIGNALS)), shift, 0.9, 0.02, "captured in a.bvh; licence: CC BY 4.0; source: lab 7")


def test_what_is_stored_is_read_back_and_worn():
    store_style(style())
    read = read_style("lab7_calm")
    np.testing.assert_array_equal(read.shift, style().shift)
    assert (read.step_frequency, read.left_strike, read.provenance) == (0.9, 0.02, style().provenance)
    assert style_names()[-1] == "lab7_calm"
    actor = load_actor("F2")
    assert "licence: CC BY 4.0" in styled(actor, "lab7_calm").provenance
    own = made_walk(actor, Making(), 1.06).step_frequency
    assert made_walk(actor, Making(style="lab7_calm"), 1.06).step_frequency == pytest.approx(0.9 * own)


def test_a_style_is_replaced_only_when_asked():
    store_style(style())
    with pytest.raises(MethodError, match="there is a style lab7_calm already; choose another name, or say --replace"):
        store_style(style())
    store_style(style(), replace_old=True)


def test_a_name_that_differs_in_case_only_is_taken_because_it_is_the_same_file_on_windows_and_macos():
    store_style(style())
    with pytest.raises(MethodError, match="there is a style lab7_calm already; choose another name, or say --replace"):
        store_style(replace(style(), name="Lab7_Calm"))


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("sad", "sad is a style that comes with gaitlab; choose another name"),
        ("../sad", "is no name for a new style"),
        ("", "is no name for a new style"),
        ("1st", "is no name for a new style"),
        ("con", "con is what Windows calls a device, so no file there can have this name; choose another"),
    ],
)
def test_a_name_it_cannot_have_is_refused(name, reason):
    with pytest.raises(MethodError, match=reason):
        store_style(style(name))
    assert imported_styles() == ()


def test_a_style_of_which_a_few_bytes_have_changed_is_read_or_refused_in_a_sentence():
    path, rng, refused = store_style(style()), Random(1), 0
    whole = path.read_bytes()
    for _ in range(300):
        spoiled = bytearray(whole)
        spoiled[rng.randrange(len(whole))] ^= 1 << rng.randrange(8)
        path.write_bytes(spoiled)
        try:
            read_style("lab7_calm")
        except MethodError:
            refused += 1
    assert refused > 200


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04rubbish", b"no archive at all"])
def test_a_damaged_file_is_one_sentence(tmp_path, content):
    store_style(style()).write_bytes(content)
    with pytest.raises(MethodError, match=r"lab7_calm\.npz is damaged or of another version of gaitlab"):
        read_style("lab7_calm")


@needs_captures
def test_a_normal_walk_has_no_style_against_itself():
    own = captured_style("none", NORMAL, NORMAL, "CC BY-NC 4.0", "Bandai Namco Research")
    np.testing.assert_allclose(own.shift, 0.0, atol=1e-12)
    assert (own.step_frequency, own.left_strike) == (1.0, 0.0)


@needs_captures
def test_without_a_normal_walk_tempo_and_posture_are_left_alone():
    alone = captured_style("alone", SAD, None, "CC BY-NC 4.0", "Bandai Namco Research")
    assert alone.step_frequency == 1.0
    assert alone.provenance.startswith("captured in dataset-1_walk_sad_001.bvh;")


@needs_captures
def test_a_normal_walk_on_another_skeleton_is_refused():
    other = MOCAP / "cmu" / "cmu_07_01.bvh"
    if not other.exists():
        pytest.skip("that capture is not beside the checkout")
    with pytest.raises(ValueError, match="are on different skeletons"):
        captured_style("mixed", other, NORMAL, "", "")


@needs_captures
def test_the_sad_performer_looks_down_steps_seldom_and_so_does_whoever_walks_like_them(capfd):
    words = ["--name", "bandai_sad", "--licence", "CC BY-NC 4.0", "--source", "Bandai Namco Research"]
    assert run(["style", "import", str(SAD), "--normal", str(NORMAL), *words]) == 0
    assert "captured in dataset-1_walk_sad_001.bvh against dataset-1_walk_normal_001.bvh" in capfd.readouterr().out
    assert run(["style", "import", str(SAD), *words]) == 2
    assert "say --replace" in capfd.readouterr().err
    assert run(["style", "list"]) == 0
    assert "licence: CC BY-NC 4.0; source: Bandai Namco Research" in capfd.readouterr().out
    sad = read_style("bandai_sad")
    assert sad.shift[1, SIGNALS.index("head_x"), 0] > 0.3  # rad, looking down
    assert sad.step_frequency < 1.0


def test_a_clip_that_is_none_is_refused(tmp_path, capfd):
    words = ["--name", "calm", "--licence", "CC0", "--source", "lab 7"]
    assert run(["style", "import", str(tmp_path / "none.bvh"), *words]) == 2
    assert "none.bvh" in capfd.readouterr().err

"""The commands body, film, doctor and gallery: words, files, and what they refuse."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from experiment_app.command import run
from experiment_app.timing.certificate import histogram

MAN = files("stimuli").joinpath("data", "bodies", "man.glb").read_bytes()


@pytest.fixture(autouse=True)
def library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GAITLAB_BODIES", str(tmp_path / "bodies"))
    monkeypatch.chdir(tmp_path)


def said(capfd) -> str:
    captured = capfd.readouterr()
    return captured.out + captured.err


def test_body_check_tells_and_draws(tmp_path, capfd):
    (tmp_path / "anna.glb").write_bytes(MAN)
    assert run(["body", "check", "anna.glb", "--picture", "anna.png"]) == 0
    words = said(capfd)
    for part in ("21 of 21 roles", "leftUpperLeg", "triangles", "Materials:", "mm from the ground"):
        assert part in words
    with Image.open(tmp_path / "anna.png") as picture:
        assert np.asarray(picture).std() > 10


def test_body_check_speaks_json(tmp_path, capfd):
    (tmp_path / "anna.glb").write_bytes(MAN)
    assert run(["body", "check", "anna.glb", "--json"]) == 0
    report = json.loads(said(capfd))
    assert report["joints"]["leftFoot"] == "leftFoot"
    assert 1.7 < report["height_m"] < 1.8
    assert len(report["box_m"]["low"]) == 3


def test_an_imported_body_can_be_listed_and_is_kept(tmp_path, capfd):
    (tmp_path / "anna.glb").write_bytes(MAN)
    assert run(["body", "import", "anna.glb", "--name", "lab7_anna"]) == 0
    assert run(["body", "list"]) == 0
    words = said(capfd)
    assert "lab7_anna" in words
    assert "point_light" in words
    assert (tmp_path / "bodies" / "lab7_anna.glb").exists()


def test_fbx_is_refused_with_the_command_that_converts_it(tmp_path, capfd):
    (tmp_path / "anna.fbx").write_bytes(b"Kaydara FBX Binary  " + bytes(100))
    assert run(["body", "import", "anna.fbx", "--name", "anna"]) == 2
    assert "FBX2glTF --binary anna.fbx" in said(capfd)
    assert not (tmp_path / "bodies").exists()


def test_a_body_that_is_not_there_is_a_sentence(capfd):
    assert run(["body", "check", "nobody.glb"]) == 2
    assert "does not exist" in said(capfd)


@pytest.mark.parametrize("rate", ["50", "60000/1001"])
def test_a_video_has_exactly_the_frame_times_asked_for(tmp_path, capfd, rate):
    from fractions import Fraction

    av = pytest.importorskip("av")
    status = run(
        ["film", "walk_ratio", "--condition", "actor=F1", "speed=1.0", "start=80", "--seconds", "0.2",
         "--rate", rate, "--size", "320x200", "--out", "clip.mp4"]
    )  # fmt: skip
    assert status == 0, said(capfd)
    with av.open("clip.mp4") as file:
        times = [frame.pts * frame.time_base for frame in file.decode(video=0)]
    exact = Fraction(rate)
    assert len(times) == round(0.2 * exact)
    assert all(time == number / exact for number, time in enumerate(times))


def test_without_an_ending_a_film_is_a_folder_of_pictures_with_their_times(tmp_path, capfd):
    arguments = ["film", "walk_ratio", "--seconds", "0.1", "--rate", "30", "--size", "320x200", "--out", "frames"]
    assert run(arguments) == 0
    rows = (tmp_path / "frames" / "frames.csv").read_text().splitlines()
    assert rows[0] == "file,time_s"
    assert [row.split(",")[0] for row in rows[1:]] == [p.name for p in sorted((tmp_path / "frames").glob("*.png"))]
    assert run(arguments) == 2
    assert "not empty" in said(capfd)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--condition", "actor=F9"], "the levels of actor are"),
        (["--condition", "hat=red"], "the factors are"),
        (["--rate", "fast"], "--rate fast"),
        (["--out", "clip.avi"], "clip.avi"),
        (["--size", "321x201"], "even width"),
    ],
)
def test_a_film_that_cannot_be_made_is_a_sentence(capfd, arguments, says):
    assert run(["film", "walk_ratio", "--seconds", "0.1", *arguments]) == 2
    assert says in said(capfd)


def test_doctor_says_off_screen_that_it_is_not_synchronised(capfd):
    assert run(["doctor", "--off-screen"]) == 0
    words = said(capfd)
    for part in ("Renderer", "Samples", "Histogram", "Not synchronised", "Verdict: not publishable"):
        assert part in words


def test_the_histogram_is_one_line_and_holds_every_interval():
    line = histogram([0.016, 0.0161, 0.0162, 0.033])
    assert "\n" not in line
    assert "█" in line


@pytest.mark.slow
def test_the_gallery_page_shows_every_picture_the_command_makes(tmp_path, capfd):
    assert run(["gallery", "--out", "pictures"]) == 0
    page = (Path(__file__).parents[2] / "docs" / "gallery.md").read_text(encoding="utf-8")
    made = {path.name for path in (tmp_path / "pictures").glob("*.png")}
    assert made
    assert all(f"images/{name}" in page for name in made)
    assert page.count("](images/") == len(made)


@pytest.mark.parametrize("ending", ["mp4", "webm"])
def test_a_video_keeps_colours_and_says_how_they_are_coded(tmp_path, ending):
    """BT.709 in the file's own words; read as another matrix, this red would be off by ten codes and more."""
    from fractions import Fraction

    import numpy as np

    from experiment_app.pictures.film import write_film

    av = pytest.importorskip("av")
    colours = [(200, 40, 45), (40, 90, 200), (128, 128, 128), (60, 160, 70)]
    frame = np.zeros((128, 256, 3), np.uint8)
    for i, colour in enumerate(colours):
        frame[:, 64 * i : 64 * (i + 1)] = colour
    path = tmp_path / f"colours.{ending}"
    write_film(iter([frame] * 6), Fraction(30), path)
    with av.open(str(path)) as file:
        about = file.streams.video[0].codec_context
        assert (int(about.colorspace), int(about.color_range)) == (1, 1)
        (*_, last) = file.decode(video=0)
        read = last.to_ndarray(format="rgb24")
    for i, colour in enumerate(colours):
        assert np.abs(read[32:96, 64 * i + 16 : 64 * i + 48].astype(int) - colour).max() <= 4


def test_pictures_of_an_odd_size_are_no_video_and_leave_no_file(tmp_path):
    from fractions import Fraction

    import numpy as np

    from experiment_app.errors import UsageError
    from experiment_app.pictures.film import write_film

    pytest.importorskip("av")
    with pytest.raises(UsageError, match="pictures of 63x48 pixels are no video, which needs even numbers"):
        write_film(iter([np.zeros((48, 63, 3), np.uint8)] * 3), Fraction(30), tmp_path / "clip.mp4")
    assert list(tmp_path.iterdir()) == []


def test_an_animated_picture_has_the_length_asked_for(tmp_path):
    from fractions import Fraction

    import numpy as np
    from PIL import Image

    from experiment_app.pictures.film import write_film

    frames = [np.full((40, 60, 3), 5 * i, np.uint8) for i in range(31)]
    said_of_it = write_film(iter(frames), Fraction(60000, 1001), tmp_path / "clip.webp")
    assert "read back: every frame within 0.5 ms" in said_of_it
    with Image.open(tmp_path / "clip.webp") as film:
        assert film.n_frames == 31

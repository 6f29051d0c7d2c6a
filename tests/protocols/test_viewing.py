"""Camera, display, marks and level of detail in the study file: true angles, and what does not go together."""

from __future__ import annotations

import pytest

from protocols.mistakes.consistency import inconsistencies
from protocols.study_file import StudyFileError, parse_study
from protocols.viewing import CameraView, Display, field_of_view
from tests.protocols.studies import changed

CAMERA = "camera: {view: three_quarter, distance: 5.5, height: 1.5, field_of_view: 24}"
GROUND = "ground: open_ground"


def test_a_picture_as_high_as_twice_the_distance_fills_ninety_degrees() -> None:
    assert Display(viewing_distance=0.5, screen_height=1.0).angle == pytest.approx(90.0)


def test_a_24_inch_16_to_9_screen_is_0_299_m_high() -> None:
    """24 inches are 0.6096 m; 9 / sqrt(16² + 9²) of that is 0.2989 m."""
    by_diagonal = Display(viewing_distance=0.6, diagonal=0.6096)
    by_height = Display(viewing_distance=0.6, screen_height=0.2989)
    assert by_diagonal.angle == pytest.approx(by_height.angle, abs=0.01)
    assert by_diagonal.angle == pytest.approx(27.97, abs=0.01)


def test_the_perspective_is_true_unless_the_camera_says_otherwise() -> None:
    display = Display(viewing_distance=0.6, screen_height=0.3)
    assert field_of_view(CameraView(), display) == display.angle
    assert field_of_view(CameraView(field_of_view=24.0), display) == 24.0
    assert field_of_view(CameraView(), None) == 30.0


def mistakes(*replacements: tuple[str, str]) -> list[str]:
    try:
        study = parse_study("s.yaml", changed(*replacements)).study
    except StudyFileError as error:
        return str(error).splitlines()
    return [f"{'.'.join(map(str, m.where))}: {m.message}" for m in inconsistencies(study)]


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (CAMERA, "camera: {view: side, place: [0.0, 3.0]}", "side follows the walker and has no place"),
        (CAMERA, "camera: {view: side, place: [0.0]}", "at least 2 items"),
        (CAMERA, "camera: {view: above}", "'above' is not allowed; allowed: "),
        (CAMERA, "camera: {view: elevated, height: 0}", "must be at least 0.1"),
        (GROUND, "ground: treadmill\n  level_of_detail: 3", "3 is not allowed"),
        (GROUND, "marks: {dot_size: 0}", "must be more than 0"),
        (GROUND, "marks: {dotsize: 0.1}", "did you mean dot_size?"),
        ("interval: 0.7", "display: {viewing_distance: 0.6}\ninterval: 0.7", "give either screen_height or diagonal"),
        (
            "interval: 0.7",
            "display: {viewing_distance: 0.6, screen_height: 0.3, diagonal: 0.6}\ninterval: 0.7",
            "give either screen_height or diagonal",
        ),
    ],
)
def test_what_does_not_go_together_is_named(old: str, new: str, says: str) -> None:
    found = mistakes((old, new))
    assert len(found) == 1
    assert says in found[0]


def test_a_camera_at_a_place_and_a_treadmill_exclude_each_other() -> None:
    found = mistakes((GROUND, "ground: treadmill"), (CAMERA, "camera: {view: first_person, place: [0.0, 8.0]}"))
    assert found == [
        "stimulus.ground: first_person needs a ground that is walked along; choose open_ground, street or plain"
    ]


@pytest.mark.parametrize("view", ["elevated", "first_person"])
def test_every_placed_camera_is_accepted(view: str) -> None:
    assert not mistakes(
        (GROUND, "ground: street"),
        (CAMERA, f"camera: {{view: {view}, height: 9.0, distance: 16.0, heading: 165.0, place: [0.0, 4.0]}}"),
    )

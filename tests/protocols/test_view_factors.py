"""Camera and ground by the levels of factors: what a trial has, and every mistake before a participant sits down."""

from __future__ import annotations

import re

import pytest

from protocols.mistakes.consistency import inconsistencies
from protocols.study_file import StudyFileError, parse_study, read_study
from protocols.viewing import CameraPart, CameraView
from tests.protocols.studies import changed

CAMERA = "camera: {view: three_quarter, distance: 5.5, height: 1.5, field_of_view: 24}"
GROUND = "ground: open_ground"


def viewed(levels: str, camera: str, ground: str = "open_ground", training: str = "side") -> str:
    """walk_ratio.yaml with a factor `view` of these levels, and this camera and ground."""
    text = changed(
        ("speed: [0.8, 1.0, 1.2]", f"speed: [0.8, 1.0, 1.2]\n  view: {levels}"),
        (CAMERA, f"camera: {camera}"),
        (GROUND, f"ground: {ground}"),
    )
    return re.sub(r"(  - \{actor: T\d[^}]*)\}", rf"\1, view: {training}}}", text)


def told(text: str) -> list[str]:
    """Every mistake of a study as the checker tells it."""
    try:
        file = parse_study("s.yaml", text)
    except StudyFileError as error:
        return str(error).splitlines()
    found = inconsistencies(file.study)
    return str(file.error(found)).splitlines() if found else []


def test_every_value_of_a_camera_can_be_a_factors_level_or_stand_in_a_table():
    camera = CameraPart.model_validate(
        {
            "view": "$view",
            "distance": {"$nearness": {"near": 3, "far": {"$view": {"side": 9, "first_person": 12.0}}}},
            "height": "$height",
            "field_of_view": {"$view": {"side": None, "first_person": 40}},
            "heading": {"$view": {"side": 90, "first_person": None}},
            "place": {"$view": {"side": None, "first_person": [0, 8]}},
        }
    )
    seen = camera.resolved({"view": "first_person", "nearness": "far", "height": 2})
    assert seen == CameraView("first_person", 12.0, 2.0, 40.0, None, (0.0, 8.0))
    assert all(isinstance(value, float) for value in (seen.distance, seen.height, seen.field_of_view))
    assert camera.resolved({"view": "side", "nearness": "near", "height": 1.6}) == CameraView("side", 3.0, heading=90.0)


def test_views_that_follow_and_views_that_stand_may_be_compared_where_only_these_have_a_place():
    place = "{$view: {side: null, first_person: [0.0, 8.0]}}"
    assert told(viewed("[side, first_person]", f"{{view: $view, place: {place}}}")) == []
    ground = "{$view: {side: treadmill, first_person: street}}"
    assert told(viewed("[side, first_person]", f"{{view: $view, place: {place}}}", ground)) == []


@pytest.mark.parametrize(
    ("levels", "camera", "ground", "at", "says"),
    [
        ("[side, above]", "{view: $view}", "street", "factors.view[1]", "above is not allowed for stimulus.camera"),
        ("[side, 2.5]", "{view: $view}", "street", "factors.view[1]", "2.5 is not allowed for stimulus.camera.view"),
        ("[side, front]", "{view: {$view: {side: side, front: ahead}}}", "street",
         "stimulus.camera.view.$view.front", "ahead is not allowed for stimulus.camera.view; allowed: "),
        ("[side, front]", "{distance: {$view: {side: 5, front: 500}}}", "street",
         "stimulus.camera.distance.$view.front", "500 is out of range; for stimulus.camera.distance it must be at"),
        ("[side, front]", "{distance: {$view: {side: 5}}}", "street",
         "stimulus.camera.distance.$view", "a value for front is missing"),
        ("[side, front]", "{height: $vew}", "street", "stimulus.camera.height", "$vew is no factor; did you mean"),
        ("[side, front]", "{field_of_view: {$view: {side: null, front: wide}}}", "street",
         "stimulus.camera.field_of_view.$view.front", "'wide' is not a number"),
        ("[side, front]", "{place: {$view: {side: null, front: 8}}}", "street",
         "stimulus.camera.place.$view.front", "8 must be a list, as [a, b]"),
        ("[side, front]", "{view: side}", "{$view: {side: street, front: stret}}",
         "stimulus.ground.$view.front", "stret is not allowed for stimulus.ground; allowed: "),
        ("[side, first_person]", "{view: $view, place: [0.0, 8.0]}", "street", "stimulus.camera.place",
         "side follows the walker and has no place; make it a table by a factor with null here, or choose elevated or "
         "first_person (in trials with view side)"),
        ("[side, first_person]", "{view: $view, place: {$view: {side: [0, 0], first_person: [0, 8]}}}", "street",
         "stimulus.camera.place.$view.side", "side follows the walker and has no place"),
        ("[side, first_person]", "{view: $view}", "treadmill", "stimulus.ground",
         "first_person needs a ground that is walked along; choose open_ground, street or plain "
         "(in trials with view first_person)"),
        ("[side, close]", "{view: {$view: {side: side, close: first_person}}}",
         "{$view: {side: street, close: treadmill}}", "stimulus.ground.$view.close", "first_person needs a ground"),
    ],
)  # fmt: skip
def test_a_camera_that_cannot_be_at_some_level_is_named_with_its_place(levels, camera, ground, at, says):
    (mistake,) = told(viewed(levels, camera, ground))
    assert f": {at}: " in mistake
    assert says in mistake


def test_a_view_that_only_a_training_trial_has_is_checked_too():
    found = told(viewed("[side, front]", "{view: $view}", "treadmill", training="elevated"))
    assert found == [
        "s.yaml:55:11: stimulus.ground: elevated needs a ground that is walked along; choose open_ground, street or "
        "plain (in trials with view elevated)"
    ]
    found = told(viewed("[side, front]", "{view: $view}", training="above"))
    assert ["practice[0].view: above is not allowed for stimulus.camera.view" in line for line in found] == [
        True,
        False,
    ]


@pytest.mark.parametrize(
    ("old", "new", "at", "says"),
    [
        ("view: elevated", "view: {$size: {250: elevated, 500: elevated, 1000: front}}",
         "stimulus.camera.view.$size[1000]", "front follows one walker; a crowd is seen by elevated or first_person"),
        ("ground: street", "ground: {$size: {250: street, 500: treadmill, 1000: street}}",
         "stimulus.ground.$size[500]", "a crowd needs a ground that is walked along; choose street"),
    ],
)  # fmt: skip
def test_a_crowd_on_a_treadmill_or_followed_at_any_level_is_named(old, new, at, says):
    text = read_study("crowd_variety").text
    assert old in text
    (mistake,) = told(text.replace(old, new, 1))
    assert f": {at}: {says}" in mistake


def test_the_levels_of_a_group_that_the_program_assigns_are_checked():
    text = read_study("walk_ratio_actors").text
    assert "view: side" in text
    text = text.replace("view: side", "view: {$viewing: {screen: side, headset: first_person}}")
    (mistake,) = told(text)
    assert "stimulus.ground: first_person needs a ground" in mistake
    assert "(in trials with viewing headset)" in mistake

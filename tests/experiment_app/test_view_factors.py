"""Trials that are seen differently: the scene of each, films, replay, the screen's preparation, and the report."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

from analysis.exports.dictionary import of_study
from experiment_app.checking.check import checked_study, notes_on
from experiment_app.command import run
from experiment_app.loop import run_session
from experiment_app.opening import open_new, recorded_plan
from experiment_app.pictures.film import condition_of, walking
from experiment_app.replay.frames import replayed_frames
from experiment_app.replay.recorded import recorded_trials
from experiment_app.run_folder import run_at
from experiment_app.scene import Camera
from experiment_app.staging import differing_scenes, stage
from protocols.events import Shown
from protocols.plan import TrialStep, make_plan
from protocols.session import begin, handle
from protocols.study_file import StudyFile, parse_study
from tests.experiment_app.test_replay import Scripted
from tests.protocols.studies import short

SEEN = {
    "side": (Camera("side", 5.0, 1.5, 24.0), "treadmill"),
    "near": (Camera("first_person", 5.0, 1.5, 40.0, 180.0, (0.0, 8.0)), "street"),
}


def viewed() -> StudyFile:
    """The short study seen from the side on a treadmill, and by somebody in the street: 8 trials after 2."""
    text = short().text
    for old, new in (
        ("  speed: [1.0]", "  speed: [1.0]\n  seen: [side, near]\n"),
        ("start: 120}", "start: 120, seen: side}"),
        ("start: 80}", "start: 80, seen: near}"),
        ("ground: open_ground", "ground: {$seen: {side: treadmill, near: street}}"),
        ("camera: {view: three_quarter, distance: 5.5, height: 1.5, field_of_view: 24}",
         "camera:\n    view: {$seen: {side: side, near: first_person}}\n    height: 1.5\n"
         "    field_of_view: {$seen: {side: 24, near: 40}}\n    heading: {$seen: {side: null, near: 180}}\n"
         "    place: {$seen: {side: null, near: [0, 8]}}"),
        ("within: [actor, start]", "within: [actor, start, seen]"),
    ):  # fmt: skip
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return parse_study("viewed.yaml", text)


def test_every_trial_is_seen_from_its_own_camera_on_its_own_ground() -> None:
    plan = make_plan(viewed().study, 1, 1)
    trials = [step for step in plan.steps if isinstance(step, TrialStep)]
    assert len(trials) == 10
    for step in trials:
        scene = stage(handle(begin(replace(plan, steps=(step,))), Shown(0.0)))
        assert (scene.camera, scene.ground) == SEEN[str(step.trial.levels["seen"])]


def test_a_film_of_a_condition_has_its_camera() -> None:
    study = viewed().study
    for level, seen in SEEN.items():
        scene = walking(study, condition_of(study, [f"seen={level}"]), 1.0)
        assert (scene.camera, scene.ground) == seen


def test_a_replay_shows_every_trial_from_its_own_camera(tmp_path: Path) -> None:
    opened = open_new(viewed(), "P01", tmp_path, display={}, simulated=True)
    trials = [step for step in opened.plan.steps if isinstance(step, TrialStep) and not step.trial.practice]
    chosen = {step.trial.levels["seen"]: step for step in trials}
    with opened.journal as journal:
        window = Scripted(3, journal.wait)
        run_session(begin(replace(opened.plan, steps=tuple(chosen.values()))), window, journal)
    again = run_at(opened.run.folder)
    frames = [f for trial in recorded_trials(again.lines) for f in replayed_frames(recorded_plan(again), trial)]
    assert [frame.scene for frame in frames] == window.scenes
    assert all(frame.same for frame in frames)
    assert {frame.scene.camera for frame in frames} == {camera for camera, _ in SEEN.values()}


def test_a_window_prepares_one_picture_of_every_camera_and_ground_and_none_where_all_trials_share_them() -> None:
    scenes = differing_scenes(make_plan(viewed().study, 1, 1))
    assert [(scene.camera, scene.ground) for scene in scenes] == list(SEEN.values())
    assert all(scene.walkers for scene in scenes)
    assert differing_scenes(make_plan(short().study, 1, 1)) == []


def test_an_untrue_perspective_is_noted_for_the_levels_that_have_it(tmp_path: Path) -> None:
    path = tmp_path / "viewed.yaml"
    display = "display: {viewing_distance: 0.6, screen_height: 0.255}\ninterval:"
    path.write_text(viewed().text.replace("interval:", display), encoding="utf-8")
    (note,) = (note for note in notes_on(checked_study(str(path))) if "perspective" in note)
    assert note.startswith("the camera sees 40 degrees but the screen fills 24.0 for the viewer")


def test_a_study_with_a_factor_of_views_goes_from_simulation_to_a_report_that_names_it(tmp_path: Path) -> None:
    path = tmp_path / "viewed.yaml"
    path.write_text(viewed().text, encoding="utf-8")
    assert run(["check", str(path)]) == 0
    assert run(["simulate", str(path), "--participants", "6", "--data", str(tmp_path / "data")]) == 0
    assert run(["analyse", str(tmp_path / "data" / "walk_ratio"), "--out", str(tmp_path / "report")]) == 0
    report = (tmp_path / "report" / "report.html").read_text(encoding="utf-8")
    assert "actor × start × seen" in report
    header = (tmp_path / "report" / "trials.csv").read_text(encoding="utf-8").splitlines()[0]
    assert "seen" in header.split(",")
    described = of_study(json.loads(viewed().study.model_dump_json()))["seen"].description
    assert "it decides stimulus.ground and stimulus.camera.view and stimulus.camera.field_of_view" in described

"""A study of one's own actors and styles at another computer, where their names may mean others, or nobody."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.recorded.journal import read_study as read_recorded
from experiment_app.command import run
from experiment_app.errors import UsageError
from experiment_app.imports import imported, other_imports
from experiment_app.live import ScreenOptions, run_live
from experiment_app.opening import open_new
from experiment_app.run_folder import participant_runs
from protocols.study_file import StudyFile, parse_study
from stimuli.actor_library import StoredActor, StoredCycle, path_of, stored
from stimuli.actors import Person
from stimuli.gait_model import Step, WalkCurves, load_gait_model
from tests.experiment_app.sessions import play
from tests.protocols.studies import changed


def grid(height: float) -> StoredActor:
    """Anna, who covers what the study shows; of another height she is another person."""
    model = load_gait_model()

    def cycle(speed: float, frequency: float) -> StoredCycle:
        coefficients = model.coefficients(Step.of(speed, frequency, 0.5 * height), 0.5)
        return StoredCycle(speed, frequency, WalkCurves.symmetric(coefficients, 0.62))

    rows = tuple((sf, tuple(cycle(v, sf) for v in (0.7, 1.06, 1.42))) for sf in (80.0, 120.0))
    return StoredActor(Person("anna", "F", 30.0, height, 60.0, 1.1, 0.006, "captured", ()), "CC0", "us", rows, False)


@pytest.fixture
def computer(tmp_path, monkeypatch):
    """Sits down at a computer of this name, where Anna has this height (m), or is not known."""

    def sit(name: str, height: float | None) -> None:
        monkeypatch.setenv("GAITLAB_ACTORS", str(tmp_path / name))
        if height is not None:
            stored(grid(height))

    return sit


def study() -> StudyFile:
    """One actor, Anna, who is imported, at one speed."""
    return parse_study(
        "s.yaml",
        changed(
            ("actor: [F1, F2, M1, M2]  ", "actor: [anna]"), ("speed: [0.8, 1.0, 1.2]  ", "speed: [1.0]"),
            ("repetitions: 4  ", "repetitions: 1"), ("within: [actor, speed, start]", "within: [start]"),
            ("{factor: speed, bound: 0.0003}", "{factor: start, bound: 0.0003}"),
            ("F1: {mean: 0.00573", "anna: {mean: 0.00573"),
            ("F1: 0.00690, F2: 0.00560, M1: 0.00700, M2: 0.00700", "anna: 0.00690"),
            ("{kind: interaction, x: actor, lines: speed}", "{kind: interaction, x: actor, lines: start}"),
        ),
    )  # fmt: skip


def took_part(participant: str, data: Path) -> None:
    play(open_new(study(), participant, data, display={}, simulated=False))


def test_what_is_imported_is_named_and_what_comes_with_gaitlab_is_not(computer):
    computer("first", 1.7)
    assert list(imported(study().study)) == ["actor anna"]


def test_the_same_file_at_another_computer_is_the_same_actor(computer):
    computer("first", 1.7)
    then, file = imported(study().study), path_of("anna").read_bytes()
    computer("second", None)
    assert other_imports(then, study().study) == ["actor anna, which was imported then, is not on this computer"]
    path_of("anna").parent.mkdir()
    path_of("anna").write_bytes(file)
    assert other_imports(then, study().study) == []


def test_the_analysis_says_who_saw_another_actor_of_the_same_name(computer, tmp_path):
    computer("first", 1.7)
    took_part("P01", tmp_path)
    took_part("P02", tmp_path)
    assert not any("another actor" in warning for warning in read_recorded(tmp_path / "walk_ratio").warnings)
    computer("second", 1.6)
    took_part("P03", tmp_path)
    told = "P03 saw another actor anna than P01: a file of that name, but of other content."
    assert told in read_recorded(tmp_path / "walk_ratio").warnings


def sits_down(participant: str, tmp_path: Path) -> list[str]:
    """What the experimenter is told until the window would open, which here has no display of this number."""
    said: list[str] = []
    (tmp_path / "s.yaml").write_text(study().text, encoding="utf-8")
    with pytest.raises(UsageError) as refused:
        run_live(
            str(tmp_path / "s.yaml"), participant, tmp_path, screen=ScreenOptions(display=99), seed=None,
            new_run=False, resume="yes", ask=lambda _: True, say=said.append,
        )  # fmt: skip
    return [*said, str(refused.value)]


def test_a_run_does_not_go_on_with_another_actor_of_the_same_name(computer, tmp_path):
    computer("first", 1.7)
    open_new(study(), "P01", tmp_path, display={}, simulated=False).journal.close()
    assert not any("anna" in sentence for sentence in sits_down("P01", tmp_path))
    computer("second", 1.6)
    assert "P01 saw another actor anna than this computer has" in sits_down("P02", tmp_path)[0]
    told = sits_down("P01", tmp_path)
    assert "P01's run cannot go on here: actor anna is another here" in told[-1]
    assert "--new-run" in told[-1]
    assert participant_runs(tmp_path, "walk_ratio", "P01")[0].sittings == 1


def test_a_name_that_only_another_computer_knows_is_refused_with_where_its_file_goes(computer, tmp_path, capfd):
    computer("empty", None)
    (tmp_path / "s.yaml").write_text(study().text, encoding="utf-8")
    assert run(["check", str(tmp_path / "s.yaml")]) == 2
    assert f"copy its file from there to {tmp_path / 'empty'}" in " ".join(capfd.readouterr().err.split())

"""The command: help everywhere, one sentence for every mistake, exit statuses 0, 1 and 2, never a traceback."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from experiment_app.checking.balance import likely_seed
from experiment_app.checking.check import expected_minutes
from experiment_app.checking.design_picture import design_picture
from experiment_app.command import app, run
from protocols.orders.design import make_trials
from protocols.plan import make_plan
from protocols.study_file import read_study
from tests.experiment_app.sessions import opened, play
from tests.protocols.studies import changed, short

COMMANDS = tuple(name for name in app if not name.startswith("-"))


def said(capfd) -> str:
    captured = capfd.readouterr()
    return captured.out + captured.err


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_help(name, capfd):
    assert run([name, "--help"]) == 0
    assert len(said(capfd)) > 200


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_is_in_the_documentation(name):
    root = Path(__file__).parents[2]
    pages = [root / "README.md", *(root / "docs").glob("*.md")]
    assert any(f"gaitlab {name}" in page.read_text(encoding="utf-8") for page in pages)


def test_signs_that_the_output_cannot_hold_end_no_command(tmp_path):
    """Windows writes to files and pipes in cp1252, which has no Japanese."""
    study = tmp_path / "s.yaml"
    study.write_text(changed(("title: ", "title: 歩く, ")), encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "experiment_app", "check", str(study)],
        capture_output=True, env={**os.environ, "PYTHONIOENCODING": "cp1252"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert b"s.yaml: ??, " in done.stdout


def test_the_version_is_the_projects():
    import tomllib

    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    done = subprocess.run([sys.executable, "-m", "experiment_app", "--version"], capture_output=True, text=True)
    assert done.stdout.strip() == project["version"]


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("actor: [F1, F2, M1, M2]  ", "colour: [red, blue]\n  actor: [F1, F2, M1, M2]", "colour changes nothing"),
        ("keys: {lower: left, raise: right,", "keys: {lower: f, raise: j,", ""),
        ("Hold {lower} for", "Hold ← for", ""),
        (
            "Hold {lower} for",
            "Hold {lwer} for",
            "{lwer} is shown to participants as it is written; did you mean {lower}?",
        ),
        ("Hold {raise} for", "Hold {raise for", "did you mean {raise}?"),
        ("language: en", "language: fr", "the buttons and hints are English"),
        (
            "There is no right or wrong answer",
            "There is no right or wrong answer " + "so take your time " * 400,
            "two pages",
        ),
    ],
)
def test_check_notes_what_is_allowed_but_hardly_meant(tmp_path, capfd, old, new, says):
    path = tmp_path / "mine.yaml"
    path.write_text(changed((old, new)), encoding="utf-8")
    assert run(["check", str(path)]) == 0
    assert says in said(capfd).replace("\n", " ")


def test_check_notes_arrows_in_the_instructions_that_are_not_the_keys(tmp_path, capfd):
    path = tmp_path / "mine.yaml"
    path.write_text(changed(("keys: {lower: left,", "keys: {lower: f,"), ("Hold {lower} for", "Hold ← for")), "utf-8")
    assert run(["check", str(path)]) == 0
    assert "the instructions name ←, which is no key of the task" in said(capfd)


def test_check_accepts_the_shipped_study_and_counts_its_trials(capfd):
    assert run(["check", "walk_ratio"]) == 0
    text = said(capfd)
    assert "96 trials" in text
    assert "minutes" in text


def test_the_minutes_count_a_break_as_often_as_the_session_has_one():
    study = read_study("walk_ratio").study
    breaks = sum(step.id.startswith("break-") for step in make_plan(study, 1, 1).steps)
    without = study.model_copy(update={"breaks": None})
    assert expected_minutes(study) - expected_minutes(without) == pytest.approx(breaks)


def test_check_draws_the_balance(tmp_path, capfd):
    from PIL import Image

    assert run(["check", "walk_ratio", "--picture", str(tmp_path / "balance.png")]) == 0
    assert Image.open(tmp_path / "balance.png").size[0] > 1000


def test_the_picture_of_the_balance_numbers_trials_and_participants_from_1():
    study = short().study
    drawn = design_picture(study).axes[0]
    (image,) = drawn.get_images()
    assert image.get_extent() == [0.5, 4.5, 12.5, 0.5]  # trial n of participant m stands around (n, m)
    low, high = drawn.get_xlim()
    assert [tick for tick in drawn.get_xticks() if low <= tick <= high] == [1, 2, 3, 4]
    assert list(drawn.get_yticks()) == list(range(1, 13))
    first = [study.factors["actor"].index(t.levels["actor"]) for t in make_trials(study, likely_seed(study, 1))]
    assert list(image.get_array()[0]) == first


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("actor: [F1, F2, M1, M2] ", "actor: [F1, F2, M1, M99] ", "there is no actor M99"),
        ("{actor: T2,", "{actor: T9,", "there is no actor T9"),
        ("study: walk_ratio", "study: Con", "study: Con is what Windows calls a device, so no file there"),
        ("ground: open_ground", "ground: open_ground\n  body: womn", "did you mean woman?"),
        ("[0.8, 1.0, 1.2]", "[0.2, 1.0, 2.9]", "2.9"),
        ("rate: 10 ", "rte: 10 ", "did you mean rate?"),
    ],
)
def test_check_refuses_a_wrong_study_with_its_place_and_status_2(tmp_path, capfd, old, new, says):
    path = tmp_path / "mine.yaml"
    text = changed((old, new)).replace("M2: 0.00700}", "M99: 0.00700}" if "M99" in new else "M2: 0.00700}")
    path.write_text(text.replace("M2: {mean", "M99: {mean") if "M99" in new else text, encoding="utf-8")
    assert run(["check", str(path)]) == 2
    text = said(capfd)
    assert says in text
    assert "mine.yaml:" in text
    assert "Traceback" not in text


@pytest.mark.parametrize(
    "arguments",
    [
        ["check", "no_such_study"],
        ["check"],
        ["nonsense"],
        ["run", "walk_ratio", "--participant", "../P1"],
        ["run", "walk_ratio", "--participant", "P 1"],
        ["run", "walk_ratio", "--participant", ""],
        ["run", "walk_ratio"],
        ["run", "walk_ratio", "--participant", "P01", "--refresh", "-3"],
        ["run", "walk_ratio", "--participant", "P01", "--refresh", "nan"],
        ["simulate", "walk_ratio", "--participants", "0"],
        ["simulate", "walk_ratio", "--participants", "many"],
        ["check", "walk_ratio", "--picture", "balance.xyz"],
        ["check", "walk_ratio", "--picture", "."],
    ],
)
def test_wrong_usage_is_status_2_and_a_sentence(arguments, capfd):
    assert run(arguments) == 2
    text = said(capfd)
    assert text.strip()
    assert "Traceback" not in text


@pytest.mark.parametrize(
    "command",
    [
        ["certificate", "data/walk_ratio/sourcedata/sub-P01/run-1", "--out"],
        ["schema", "--out"],
        ["check", "walk_ratio", "--picture"],
        ["power", "walk_ratio", "--experiments", "1", "--workers", "1", "--out"],
        ["power", "walk_ratio", "--experiments", "1", "--workers", "1", "--plot"],
        ["actor", "pose", "F1", "--out"],
        ["actor", "check", "F1", "--picture"],
        ["actor", "show", "F1", "--picture"],
        ["body", "check", "anna.glb", "--picture"],
        ["film", "walk_ratio", "--out"],
        ["replay", "data/walk_ratio/sourcedata/sub-P01/run-1", "--film"],
    ],
)
@pytest.mark.parametrize("name", ["journal.jsonl", "my_study.yaml"])
def test_nothing_that_is_written_by_name_can_replace_a_journal_or_a_study_file(
    tmp_path, monkeypatch, capfd, command, name
):
    monkeypatch.chdir(tmp_path)
    Path(name).write_text("worth keeping")
    play(opened(tmp_path / "data"))
    assert run([*command, name]) == 2
    assert "Traceback" not in said(capfd)
    assert Path(name).read_text() == "worth keeping"


def test_no_display_is_a_sentence_with_the_way_out(tmp_path):
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    done = subprocess.run(
        [sys.executable, "-m", "experiment_app", "run", "walk_ratio", "--participant", "P01", "--data", str(tmp_path)],
        env=environment, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 2
    assert "no display was found" in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(tmp_path.rglob("journal.jsonl"))


def test_copy_makes_a_file_that_checks_and_never_overwrites(tmp_path, capfd):
    path = tmp_path / "mine.yaml"
    assert run(["copy", "walk_ratio", str(path)]) == 0
    assert (tmp_path / "study.schema.json").exists()
    assert run(["check", str(path)]) == 0
    assert run(["copy", "walk_ratio", str(path)]) == 2


def test_the_schema_in_the_repository_is_fresh(tmp_path, capfd):
    assert run(["schema", "--out", str(tmp_path / "s.json")]) == 0
    shipped = Path(__file__).parents[2] / "protocols" / "studies" / "study.schema.json"
    assert json.loads((tmp_path / "s.json").read_text()) == json.loads(shipped.read_text())


def test_simulate_then_analyse_writes_tables_figures_and_report(tmp_path, capfd):
    assert run(["simulate", "walk_ratio", "--participants", "6", "--data", str(tmp_path / "data")]) == 0
    assert run(["analyse", str(tmp_path / "data" / "walk_ratio"), "--out", str(tmp_path / "report")]) == 0
    names = {p.name for p in (tmp_path / "report").iterdir()}
    assert {"trials.csv", "anova.csv", "posthoc.csv", "ttests.csv", "normality.csv", "report.html"} <= names


def test_analysing_nothing_is_a_sentence(tmp_path, capfd):
    assert run(["analyse", str(tmp_path), "--out", str(tmp_path / "report")]) in (1, 2)
    assert "Traceback" not in said(capfd)


def test_help_does_not_import_the_heavy_rooms():
    heavy = "('pandas', 'moderngl', 'scipy', 'numpy')"
    code = f"import sys, experiment_app.command; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.strip() == "[]"


def test_a_mistake_in_line_100_is_told_with_that_number_and_not_as_a_picture(tmp_path, capfd):
    text = read_study("walk_ratio").text
    (tmp_path / "s.yaml").write_text("#\n" * 99 + "stdy: x\n" + text, encoding="utf-8")
    assert run(["check", str(tmp_path / "s.yaml")]) == 2
    assert "s.yaml:100:1: " in capfd.readouterr().err

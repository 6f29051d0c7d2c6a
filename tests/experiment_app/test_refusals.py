"""What a careless hand gets: one sentence with the place and the way out, the right status, nothing overwritten."""

import shlex
import shutil
import subprocess
import sys
from fractions import Fraction

import pytest

from analysis.recorded.journal import read_study
from experiment_app.command import run
from experiment_app.errors import UsageError
from experiment_app.opening import open_new
from experiment_app.pictures.film import write_film
from experiment_app.run_folder import participant_runs
from experiment_app.terminal import typed
from stimuli.methods.errors import MethodError
from stimuli.methods.styles import default_styles, store_style
from tests.experiment_app.sessions import opened, play
from tests.protocols.studies import short

DESCRIPTION = "sex: male\nheight: 1.65\nweight: 65\nage: 30\n"


def refused(arguments, status, capfd) -> str:
    assert run([str(word) for word in arguments]) == status
    return " ".join(capfd.readouterr().err.split())


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("hello", "the file is one value without keys"),
        ("- a\n- b\n", "the file is a list"),
    ],
)
def test_a_study_file_that_holds_no_keys_is_told_without_the_words_of_a_program(tmp_path, capfd, text, says):
    (tmp_path / "study.yaml").write_text(text)
    assert f"study.yaml:1:1: {says}; a study file holds keys such as" in refused(
        ["check", tmp_path / "study.yaml"], 2, capfd
    )


def test_a_mistyped_variation_of_a_crowd_is_told_what_to_write(tmp_path, capfd):
    assert run(["copy", "crowd_variety", str(tmp_path / "mine.yaml")]) == 0
    text = (tmp_path / "mine.yaml").read_text(encoding="utf-8")
    (tmp_path / "mine.yaml").write_text(text.replace('variation: "1:1"', 'variation: "1:x"', 1), encoding="utf-8")
    assert "'1:x' does not fit; write 1:1 to 1:1000" in refused(["check", tmp_path / "mine.yaml"], 2, capfd)


def test_a_folder_in_place_of_a_clip_is_called_a_folder(tmp_path, capfd):
    assert f"{tmp_path} is a folder; name a motion file in it." in refused(["clip", tmp_path], 2, capfd)


@pytest.mark.parametrize(
    ("description", "says"),
    [
        (DESCRIPTION + "age: 31\n", "actor.yaml, line 5: age is there twice; keep one of the two"),
        ("\t" + DESCRIPTION, "actor.yaml, line 1: a tab cannot indent or begin a value in YAML; use spaces"),
        (DESCRIPTION + "licence: [CC\n", "actor.yaml, line 6: not valid YAML"),
    ],
)
def test_a_description_that_is_no_yaml_is_told_with_its_line(tmp_path, capfd, description, says):
    (tmp_path / "actor.yaml").write_text(description)
    assert says in refused(["actor", "import", tmp_path, "--name", "A9"], 2, capfd)


def test_a_folder_of_captures_that_is_not_there_or_a_file_is_told_as_such(tmp_path, capfd):
    (tmp_path / "walk.bvh").write_text("HIERARCHY")
    assert "walk.bvh is a file; name the folder" in refused(
        ["actor", "import", tmp_path / "walk.bvh", "--name", "A9"], 2, capfd
    )
    assert "none does not exist; name the folder" in refused(
        ["actor", "import", tmp_path / "none", "--name", "A9"], 2, capfd
    )


def test_the_name_of_a_default_style_is_refused_as_such():
    with pytest.raises(MethodError, match="sad is a style that comes with gaitlab; choose another name"):
        store_style(default_styles()["sad"])


def test_a_report_is_never_written_among_the_journals(tmp_path, capfd):
    study = tmp_path / "walk_ratio"
    play(opened(tmp_path))
    before = sorted(study.rglob("*"))
    for place in ("sourcedata", "sourcedata/sub-P02", "sourcedata/sub-P01/run-1"):
        assert "never among the journals" in refused(["analyse", study, "--out", study / place], 1, capfd)
    assert sorted(study.rglob("*")) == before


def test_a_run_that_has_ended_is_asked_nothing(tmp_path, capfd):
    play(opened(tmp_path))
    (finished,) = participant_runs(tmp_path, "walk_ratio", "P01")
    said = refused(["console", tmp_path / "walk_ratio", "--ask", "stop"], 2, capfd)
    assert "participant P01's run is not going on (finished); nothing was asked of it" in said
    assert not (finished.folder / "console.txt").exists()


def test_bytes_that_are_no_text_are_told_as_an_altered_line(tmp_path, capfd):
    play(opened(tmp_path))
    (finished,) = participant_runs(tmp_path, "walk_ratio", "P01")
    lines = finished.journal.read_bytes().split(b"\n")
    finished.journal.write_bytes(b"\n".join([lines[0], b"\xaf" + lines[1], *lines[2:]]))
    study = tmp_path / "walk_ratio"
    for arguments, status in ((["analyse", study], 1), (["console", study, "--once"], 2)):
        said = refused(arguments, status, capfd)
        assert "line 2" in said
        assert "the line is not UTF-8; it was altered" in said


def test_a_journal_without_its_header_is_told_with_the_way_out(tmp_path, capfd):
    play(opened(tmp_path))
    (finished,) = participant_runs(tmp_path, "walk_ratio", "P01")
    finished.journal.write_bytes(b"")
    assert "move its run folder out of sourcedata" in refused(["analyse", tmp_path / "walk_ratio"], 1, capfd)


def test_what_the_system_refuses_is_the_file_and_the_reason_without_a_number(tmp_path, capfd):
    play(opened(tmp_path))
    (finished,) = participant_runs(tmp_path, "walk_ratio", "P01")
    finished.journal.unlink()
    finished.journal.mkdir()
    said = refused(["analyse", tmp_path / "walk_ratio"], 1, capfd)
    assert said == f"gaitlab: {finished.journal}: is a directory."


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("there.mp4", "there.mp4 is a folder; name a film in it"),
        ("none/clip.mp4", "none is not there; make it, or name another"),
        ("clip.xyz", "clip.xyz: films end in .mp4"),
    ],
)
def test_a_film_that_cannot_be_written_is_refused_before_anything_is_drawn(tmp_path, name, says):
    (tmp_path / "there.mp4").mkdir()
    with pytest.raises(UsageError, match=says):
        write_film(iter(()), Fraction(60), tmp_path / name)


@pytest.mark.parametrize(
    "folder", ["my studies", "$HOME", "`date`", "it's", 'a "b"', "däta & more; #2 (old)", "~", "a!b*"]
)
def test_commands_that_are_told_can_be_typed_whatever_is_in_their_paths(tmp_path, capfd, folder):
    study = tmp_path / folder / "my study.yaml"
    study.parent.mkdir()
    assert run(["copy", "walk_ratio", str(study)]) == 0
    told = capfd.readouterr().out.split("then: gaitlab check ")[1].rstrip("\n")
    heard = subprocess.run(["sh", "-c", f"printf %s {told}"], capture_output=True, text=True, cwd=tmp_path, check=True)
    assert heard.stdout == str(study)


def test_on_windows_a_told_path_is_in_double_quotes_where_a_blank_would_part_it(monkeypatch):
    monkeypatch.setattr(sys, "platform", "win32")
    assert typed(r"C:\Users\anna\study.yaml") == r"C:\Users\anna\study.yaml"
    assert typed(r"C:\my studies\study.yaml") == r'"C:\my studies\study.yaml"'


def test_the_command_that_analyses_simulated_participants_can_be_typed_whatever_the_folder(tmp_path, capfd):
    data = tmp_path / "my $data"
    assert run(["simulate", "walk_ratio", "--participants", "1", "--data", str(data)]) == 0
    told = " ".join(capfd.readouterr().out.split()).split("Analyse them with: gaitlab ")[1]
    assert shlex.split(told)[1] == str(data / "walk_ratio")


def test_a_told_command_with_a_folder_that_begins_with_a_dash_can_be_typed(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    assert run(["simulate", "walk_ratio", "--participants", "1", "--data=-sim"]) == 0
    (told,) = [line for line in capfd.readouterr().out.splitlines() if "gaitlab analyse" in line]
    command = told.split("gaitlab ")[1].split()
    assert command[1] == "./-sim/walk_ratio"
    assert run(command) == 0


def test_a_file_where_a_folder_for_results_should_be_is_told(tmp_path, capfd):
    play(opened(tmp_path))
    (tmp_path / "out").write_text("mine")
    for command in (["analyse"], ["export", "--to", "csv"]):
        said = refused([command[0], tmp_path / "walk_ratio", *command[1:], "--out", tmp_path / "out"], 1, capfd)
        assert f"{tmp_path / 'out'} is a file; name a folder with --out" in said
    assert (tmp_path / "out").read_text() == "mine"


def test_a_study_file_is_not_suggested_for_its_ending(tmp_path, capfd):
    (tmp_path / "45_single.yaml").write_text("")
    assert "Did you mean" not in refused(["check", tmp_path / "nofile.yaml"], 2, capfd)
    (tmp_path / "my_study.yaml").write_text("")
    assert f"Did you mean {tmp_path / 'my_study.yaml'}?" in refused(["check", tmp_path / "mystudy.yml"], 2, capfd)


@pytest.mark.parametrize("copy", ["sub-P09", "sub-P01/run-1 copy", "sub-A01"])
def test_a_copied_participant_counts_once_and_the_copy_is_named(tmp_path, capfd, copy):
    play(opened(tmp_path))
    study = tmp_path / "walk_ratio"
    there = study / "sourcedata" / ("sub-P01" if "/" not in copy else "sub-P01/run-1")
    shutil.copytree(there, study / "sourcedata" / copy)
    once = f"P01: a copy of run 1 in {copy if '/' in copy else copy + '/run-1'}"
    assert run(["export", str(study), "--to", "csv", "--out", str(tmp_path / "csv")]) == 0
    told = " ".join(capfd.readouterr())
    assert f"{once}; left out." in told
    assert "Participants: 1, runs: 1" in told
    recorded = read_study(study)
    assert [one.participant for one in recorded.runs] == ["P01"]
    assert [f"{who}: {why}" for who, why in recorded.left_out] == [once]


@pytest.mark.parametrize(
    ("folder", "counts"),
    [("sub-P1b", "as its folder says, it counts as run 1 of participant P1b"), ("sub-P01 old", "it counts as that")],
)
def test_a_renamed_participant_counts_as_the_folder_says_where_its_name_is_an_id(tmp_path, folder, counts):
    play(opened(tmp_path))
    there = tmp_path / "walk_ratio" / "sourcedata"
    (there / "sub-P01").rename(there / folder)
    recorded = read_study(tmp_path / "walk_ratio")
    assert [one.participant for one in recorded.runs] == ["P1b" if folder == "sub-P1b" else "P01"]
    assert f"{folder}/run-1 holds run 1 of participant P01; {counts}." in recorded.warnings


def merged_from_two_computers(tmp_path, second: str):
    """The folder of the first computer, with the run of the second one's P01 in it as `second`."""
    play(opened(tmp_path / "one"))
    play(open_new(short(), "P01", tmp_path / "two", display={"room": 2}, simulated=True, seed=7))
    there = tmp_path / "one" / "walk_ratio" / "sourcedata" / second
    there.parent.mkdir(exist_ok=True)
    shutil.copytree(tmp_path / "two" / "walk_ratio" / "sourcedata" / "sub-P01" / "run-1", there)
    return tmp_path / "one" / "walk_ratio"


def test_two_people_whom_two_computers_gave_one_id_are_told_apart_by_the_names_of_their_folders(tmp_path, capfd):
    study = merged_from_two_computers(tmp_path, "sub-P01B/run-1")
    recorded = read_study(study)
    assert [(one.participant, one.header["seed"] == 7) for one in recorded.runs] == [("P01", False), ("P01B", True)]
    assert not recorded.left_out
    told = "sub-P01B/run-1 holds run 1 of participant P01; as its folder says, it counts as run 1 of participant P01B."
    assert told in recorded.warnings
    assert run(["export", str(study), "--to", "csv", "--out", str(tmp_path / "csv")]) == 0
    said = " ".join(capfd.readouterr())
    assert told in said
    assert "Participants: 2, runs: 2" in said


def test_somebody_who_came_back_at_another_computer_has_two_runs(tmp_path):
    recorded = read_study(merged_from_two_computers(tmp_path, "sub-P01/run-2"))
    assert [(one.participant, one.number) for one in recorded.runs] == [("P01", 1)]
    assert recorded.left_out == (("P01", "run 2 (a later run; run 1 counts)"),)


def test_two_recordings_that_no_folder_tells_apart_are_refused_with_the_way_out(tmp_path, capfd):
    study = merged_from_two_computers(tmp_path, "sub-P01 (1)/run-1")
    for command in (["analyse"], ["export", "--to", "csv"]):
        said = refused([command[0], study, *command[1:], "--out", tmp_path / "out"], 1, capfd)
        assert "sub-P01 (1)/run-1 and sub-P01/run-1 hold two recordings" in said
        assert "Rename the folder of one of them, sub-P01B if" in said


def test_of_a_run_that_went_on_after_it_was_copied_the_longer_journal_counts(tmp_path):
    play(opened(tmp_path))
    study = tmp_path / "walk_ratio"
    home = study / "sourcedata" / "sub-P01"
    shutil.copytree(home, study / "sourcedata" / "sub-backup")
    whole = (home / "run-1" / "journal.jsonl").read_text(encoding="utf-8").splitlines(keepends=True)
    (home / "run-1" / "journal.jsonl").write_text("".join(whole[:-9]), encoding="utf-8")
    recorded = read_study(study)
    assert [(one.participant, one.path.parts[-3]) for one in recorded.runs] == [("P01", "sub-backup")]
    assert recorded.left_out == (("P01", "a copy of run 1 in sub-P01/run-1"),)


@pytest.mark.parametrize(
    "name",
    [
        "sub-P01/run-1/journal (Lab 2's conflicted copy 2026-11-24).jsonl",
        "sub-P01/run-1/journal.sync-conflict-20261124-101500-ABCDEFG.jsonl",
        "sub-P02/sub-P02/run-1/journal.jsonl",
        "second computer/sub-P02/run-1/journal.jsonl",
    ],
)
def test_a_recording_that_lies_where_none_is_looked_for_is_named(tmp_path, capfd, name):
    play(opened(tmp_path))
    study = tmp_path / "walk_ratio"
    assert not any("Not read" in warning for warning in read_study(study).warnings)
    there = study / "sourcedata" / name
    there.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(study / "sourcedata" / "sub-P01" / "run-1" / "journal.jsonl", there)
    assert any(f"Not read: sourcedata/{name}. A recording" in warning for warning in read_study(study).warnings)
    assert run(["export", str(study), "--to", "csv", "--out", str(tmp_path / "csv")]) == 0
    assert f"Not read: sourcedata/{name}." in " ".join(capfd.readouterr().err.split())

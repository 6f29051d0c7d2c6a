"""Who withdraws is gone from journals, exports and reports; only a free place in the order of arrival stays."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from experiment_app.command import run
from experiment_app.errors import UsageError
from experiment_app.participants import withdrawal
from experiment_app.participants.arrivals import WITHDRAWN, places_given_back
from experiment_app.participants.withdrawal import plan_withdrawal
from experiment_app.run_folder import participant_runs
from protocols.record import decode_line
from tests.experiment_app.sessions import opened, play
from tests.protocols.studies import short


@pytest.fixture
def data(tmp_path) -> Path:
    for participant in ("P01", "WITHDRAWN77", "P03"):
        play(opened(tmp_path / "data", participant))
    return tmp_path / "data" / "walk_ratio"


def holding(folder: Path, text: bytes) -> list[str]:
    """Files under a folder whose name or content holds a text."""
    return [str(p) for p in folder.rglob("*") if text.decode() in str(p) or (p.is_file() and text in p.read_bytes())]


def test_a_withdrawal_reaches_journals_exports_and_reports_and_keeps_only_a_place(data, tmp_path, capfd):
    for to in ("bids", "psych-ds", "csv"):
        assert run(["export", str(data), "--to", to, "--out", str(tmp_path / to)]) == 0
    assert run(["analyse", str(data), "--out", str(tmp_path / "report")]) == 0
    assert len(holding(tmp_path, b"WITHDRAWN77")) > 10
    assert run(["withdraw", str(data), "--participant", "WITHDRAWN77", "--yes"]) == 0
    assert holding(tmp_path, b"WITHDRAWN77") == []
    assert len(holding(tmp_path, b"P03")) > 10
    (line,) = (data / "withdrawn.jsonl").read_text(encoding="utf-8").splitlines()
    assert decode_line(line) == {"kind": "withdrawn", "participant_number": 2}
    said = capfd.readouterr().out
    assert "Place 2 in the order of arrival is free again" in said
    assert said.count("Made again without participant WITHDRAWN77") == 4
    assert "backups" in said


def test_the_next_new_participant_takes_the_place_given_back_and_the_one_after_a_new_one(data):
    assert run(["withdraw", str(data), "--participant", "WITHDRAWN77", "--yes"]) == 0
    numbers = []
    for participant in ("P08", "P09"):
        play(opened(data.parent, participant))
        numbers.append(participant_runs(data.parent, "walk_ratio", participant)[0].header["participant_number"])
    assert numbers == [2, 4]
    assert run(["withdraw", str(data), "--participant", "P08", "--yes"]) == 0
    assert places_given_back(data) == [2]
    play(opened(data.parent, "P10"))
    assert participant_runs(data.parent, "walk_ratio", "P10")[0].header["participant_number"] == 2


def test_a_withdrawal_that_was_killed_half_way_is_finished_by_the_same_command(data, tmp_path, monkeypatch):
    run(["export", str(data), "--to", "csv", "--out", str(tmp_path / "csv")])

    def killed(path: Path) -> None:
        next(p for p in Path(path).rglob("*") if p.is_file()).unlink()
        raise OSError(5, "the power failed")

    monkeypatch.setattr(withdrawal.shutil, "rmtree", killed)
    assert run(["withdraw", str(data), "--participant", "WITHDRAWN77", "--yes"]) == 1
    monkeypatch.setattr(withdrawal.shutil, "rmtree", shutil.rmtree)
    monkeypatch.undo()
    assert run(["withdraw", str(data), "--participant", "WITHDRAWN77", "--yes"]) == 0
    assert holding(tmp_path, b"WITHDRAWN77") == []
    assert places_given_back(data) == [2]


def test_when_the_last_one_withdraws_the_export_and_the_report_go_too_but_no_file_of_the_experimenters(tmp_path, capfd):
    play(opened(tmp_path / "data", "P01"))
    data, report, shared = tmp_path / "data" / "walk_ratio", tmp_path / "report", tmp_path / "shared"
    assert run(["export", str(data), "--to", "bids", "--out", str(tmp_path / "bids")]) == 0
    assert run(["analyse", str(data), "--out", str(report)]) == 0
    assert run(["analyse", str(data), "--out", str(shared)]) == 0
    (shared / "notes.txt").write_text("mine", encoding="utf-8")
    assert run(["withdraw", str(data), "--participant", "P01", "--yes"]) == 0
    assert not (tmp_path / "bids").exists()
    assert not report.exists()
    assert [path.name for path in shared.iterdir()] == ["notes.txt"]
    assert capfd.readouterr().out.count("Removed, since nobody is left in it") == 3


def test_what_cannot_be_made_again_is_named_and_the_command_fails(data, tmp_path, capfd):
    run(["export", str(data), "--to", "csv", "--out", str(tmp_path / "csv")])
    (tmp_path / "csv" / ".gaitlab-export.json").unlink()
    assert run(["withdraw", str(data), "--participant", "WITHDRAWN77", "--yes"]) == 1
    assert "NOT made again: csv export" in capfd.readouterr().out
    assert not (data / "sourcedata" / "sub-WITHDRAWN77").exists()


def test_a_participant_who_is_not_there_and_one_who_is_sitting_at_the_screen_are_refused(data):
    with pytest.raises(UsageError, match=r"no participant P99 .*there are: P01, P03, WITHDRAWN77"):
        plan_withdrawal(data, "P99")
    sitting = opened(data.parent, "P50")
    with pytest.raises(UsageError, match="in use by another gaitlab"):
        plan_withdrawal(data, "P50")
    sitting.journal.close()


def test_without_an_answer_nothing_is_deleted(data, monkeypatch, capfd):
    assert run(["withdraw", str(data), "--participant", "WITHDRAWN77"]) == 2
    assert "say --yes" in capfd.readouterr().err
    assert (data / "sourcedata" / "sub-WITHDRAWN77").exists()


def test_exports_and_reports_are_noted_once_however_often_they_are_made(data, tmp_path):
    for _ in range(2):
        run(["export", str(data), "--to", "csv", "--out", str(tmp_path / "csv")])
    (line,) = (data / "derived.jsonl").read_text(encoding="utf-8").splitlines()
    assert json.loads(line) == {"what": "export", "to": "csv", "out": str(tmp_path / "csv"), "near": "../../csv"}


def test_a_withdrawal_finds_exports_and_reports_that_were_moved_together_with_the_data(data, tmp_path, capfd):
    for command in (["export", str(data), "--to", "csv"], ["analyse", str(data)]):
        assert run([*command, "--out", str(tmp_path / command[0])]) == 0
    moved = tmp_path / "another computer"
    moved.mkdir()
    for name in ("data", "export", "analyse"):
        (tmp_path / name).rename(moved / name)
    assert run(["withdraw", str(moved / "data" / "walk_ratio"), "--participant", "WITHDRAWN77", "--yes"]) == 0
    assert holding(tmp_path, b"WITHDRAWN77") == []
    assert capfd.readouterr().out.count("Made again without participant WITHDRAWN77") == 2


def test_a_withdrawal_in_a_copy_of_everything_leaves_the_original_alone(data, tmp_path):
    assert run(["export", str(data), "--to", "csv", "--out", str(tmp_path / "csv")]) == 0
    copy = tmp_path / "copy"
    shutil.copytree(tmp_path / "data", copy / "data")
    shutil.copytree(tmp_path / "csv", copy / "csv")
    assert run(["withdraw", str(copy / "data" / "walk_ratio"), "--participant", "WITHDRAWN77", "--yes"]) == 0
    assert holding(copy, b"WITHDRAWN77") == []
    assert holding(tmp_path / "csv", b"WITHDRAWN77") != []


def test_an_export_in_a_folder_with_any_letter_in_its_name_is_found_again(data, tmp_path):
    out = tmp_path / "for\u2028the \u0085 reviewers"
    assert run(["export", str(data), "--to", "csv", "--out", str(out)]) == 0
    assert run(["withdraw", str(data), "--participant", "WITHDRAWN77", "--yes"]) == 0
    assert holding(out, b"WITHDRAWN77") == []


def test_a_line_that_a_power_cut_left_torn_takes_no_place_with_it(data):
    (data / WITHDRAWN).write_bytes(b'{"kind":"withdr')
    for participant in ("WITHDRAWN77", "P01"):
        assert run(["withdraw", str(data), "--participant", participant, "--yes"]) == 0
    assert len(places_given_back(data)) == 2


def test_an_export_that_is_no_longer_where_it_was_made_is_named(data, tmp_path, capfd):
    assert run(["export", str(data), "--to", "csv", "--out", str(tmp_path / "csv")]) == 0
    (tmp_path / "csv").rename(tmp_path / "for the reviewers")
    assert run(["withdraw", str(data), "--participant", "WITHDRAWN77", "--yes"]) == 0
    said = " ".join(capfd.readouterr().out.split())
    assert f"No longer there: csv export in {tmp_path / 'csv'}. If it was moved, it still holds WITHDRAWN77" in said


@pytest.mark.parametrize("copy", ["sub-WITHDRAWN77 copy/run-1", "sub-P09/run-1", "sub-WITHDRAWN77/run-1 (1)"])
def test_copies_inside_the_folder_of_data_go_too(data, tmp_path, copy):
    shutil.copytree(data / "sourcedata" / "sub-WITHDRAWN77" / "run-1", data / "sourcedata" / copy)
    assert run(["analyse", str(data), "--out", str(tmp_path / "report")]) == 0
    assert run(["withdraw", str(data), "--participant", "WITHDRAWN77", "--yes"]) == 0
    assert holding(tmp_path, b"WITHDRAWN77") == []
    assert sorted(path.name for path in (data / "sourcedata").iterdir()) == ["sub-P01", "sub-P03"]


def test_a_report_by_another_plan_is_made_again_by_that_plan(data, tmp_path):
    text = short().text.replace("  normality: shapiro_wilk", "  aligned_rank_transform: {within: [actor, start]}")
    (tmp_path / "later.yaml").write_text(text, encoding="utf-8")
    report = tmp_path / "report"
    assert run(["analyse", str(data), "--out", str(report), "--plan", str(tmp_path / "later.yaml")]) == 0
    assert run(["withdraw", str(data), "--participant", "WITHDRAWN77", "--yes"]) == 0
    assert (report / "aligned_rank_transform.csv").exists()
    assert (report / "plan.yaml").read_text(encoding="utf-8") == text
    assert "that of plan.yaml beside this report" in (report / "report.html").read_text(encoding="utf-8")


def test_a_place_that_somebody_of_another_computer_has_too_is_not_called_free(data, tmp_path, capfd):
    play(opened(tmp_path / "second", "X01"))
    play(opened(tmp_path / "second", "X02"))
    shutil.copytree(tmp_path / "second/walk_ratio/sourcedata/sub-X02", data / "sourcedata" / "sub-X02")
    assert run(["withdraw", str(data), "--participant", "WITHDRAWN77", "--yes"]) == 0
    said = capfd.readouterr().out
    assert "Place 2 in the order of arrival stays taken, by X02." in said
    assert "free again" not in said

"""The journal: nothing acknowledged is lost, nothing is overwritten, a torn line is set aside and the run goes on."""

from __future__ import annotations

import io
import os
from collections import Counter

import pytest

from analysis.recorded.journal import read_study
from experiment_app.command import run as command
from experiment_app.errors import RunError, UsageError
from experiment_app.journal import append_line
from experiment_app.opening import open_new, open_unfinished, unfinished_run
from experiment_app.run_folder import journal_lines, journal_text, participant_runs
from protocols.record import Answered, encode_line, sealed
from tests.experiment_app.sessions import opened, play
from tests.journals import rewrite
from tests.protocols.studies import short


def trials(lines) -> list[int]:
    return [line["number"] for line in lines if line["kind"] == "trial" and not line["practice"]]


def test_a_run_leaves_a_header_every_answer_every_key_and_every_trial(tmp_path):
    run = opened(tmp_path)
    play(run)
    lines, torn = journal_lines(run.run.journal)
    kinds = Counter(line["kind"] for line in lines)
    assert torn == 0
    assert lines[0]["kind"] == "header"
    assert lines[0]["study_text"] == short().text
    assert lines[0]["walkers"] == {"F1": "modelled", "M1": "modelled", "T1": "modelled", "T2": "modelled"}
    assert lines[0]["keys"] == {"lower": "left", "raise": "right", "confirm": "enter", "break": "b"}
    assert (kinds["answer"], kinds["trial"], kinds["begin"]) == (3, 6, 6)
    assert kinds["key"] >= 6 * 3
    assert trials(lines) == [1, 2, 3, 4]


def test_a_finished_participant_is_refused_and_a_second_run_stands_beside_the_first(tmp_path):
    play(opened(tmp_path))
    with pytest.raises(UsageError, match="P01 has already finished"):
        opened(tmp_path)


def test_a_second_process_on_the_same_run_is_refused(tmp_path):
    first = opened(tmp_path)
    with pytest.raises(UsageError, match="in use by another gaitlab"):
        opened(tmp_path)
    first.journal.close()


def test_a_torn_last_line_is_set_aside_and_the_run_goes_on(tmp_path):
    run = opened(tmp_path)
    run.journal.close()
    whole = run.run.journal.read_bytes()
    run.run.journal.write_bytes(whole + b'{"kind":"consent","ti')
    play(opened(tmp_path))
    assert (run.run.folder / "journal.torn-1").read_bytes() == b'{"kind":"consent","ti'
    lines, torn = journal_lines(run.run.journal)
    assert torn == 0
    assert [line["torn_bytes"] for line in lines if line["kind"] == "continue"] == [21]
    assert trials(lines) == [1, 2, 3, 4]


@pytest.mark.parametrize("cut", range(1, 60, 7))
def test_a_journal_cut_anywhere_in_its_last_line_keeps_all_lines_before(tmp_path, cut):
    run = opened(tmp_path)
    play(run)
    raw = run.run.journal.read_bytes()
    before = journal_lines(run.run.journal)[0]
    run.run.journal.write_bytes(raw[:-cut])
    lines, torn = journal_lines(run.run.journal)
    assert lines == before[: len(lines)]
    assert len(lines) >= len(before) - 2
    assert torn > 0 or raw[:-cut].endswith(b"\n")


def test_a_damaged_line_in_the_middle_is_named(tmp_path):
    run = opened(tmp_path)
    play(run)
    lines = run.run.journal.read_bytes().split(b"\n")
    lines[4] = lines[4].replace(b'"time":', b'"time":1', 1)
    run.run.journal.write_bytes(b"\n".join(lines))
    with pytest.raises(UsageError, match=r"journal.jsonl: line 5: the line does not match its checksum"):
        journal_lines(run.run.journal)


def test_a_line_removed_doubled_or_moved_is_named_by_all_who_read_the_run(tmp_path, capfd):
    run = opened(tmp_path)
    play(run)
    lines = run.run.journal.read_bytes().split(b"\n")
    spoiled = {
        "line 8: the line before it is missing": [*lines[:7], *lines[8:]],
        "line 9: the line is line 8 once more": [*lines[:8], *lines[7:]],
        "line 8: the line was written after what is now line 9": [*lines[:7], lines[8], lines[7], *lines[9:]],
    }
    for said, changed in spoiled.items():
        run.run.journal.write_bytes(b"\n".join(changed))
        with pytest.raises(UsageError, match=f"journal.jsonl: {said}"):
            participant_runs(tmp_path, "walk_ratio", "P01")
        assert command(["analyse", str(tmp_path / "walk_ratio"), "--out", str(tmp_path / "out")]) == 1
        assert command(["export", str(tmp_path / "walk_ratio"), "--to", "csv", "--out", str(tmp_path / "csv")]) == 1
        place, why = said.split(": ")
        assert capfd.readouterr().err.replace("\n", " ").count(f"{place} of {len(changed) - 1}: {why}") == 2


def test_after_each_kill_the_lines_go_on_naming_the_one_before(tmp_path):
    for torn in (b'{"kind":"page","time":1.5,"pa', b"", b"\x00" * 40):
        run = opened(tmp_path)
        run.journal.close()
        run.run.journal.write_bytes(run.run.journal.read_bytes() + torn)
    play(opened(tmp_path))
    text = journal_text(run.run.journal)
    assert (text.chained, text.torn) == (True, 0)
    assert [one["torn_bytes"] for one in text.records if one["kind"] == "continue"] == [29, 0, 40]
    assert trials(text.records) == [1, 2, 3, 4]


def test_a_journal_of_the_earlier_form_is_gone_on_with_and_said_to_be_one(tmp_path):
    run = opened(tmp_path)
    run.journal.close()
    records = [{**one, "format": 1} if "format" in one else one for one in journal_lines(run.run.journal)[0]]
    run.run.journal.write_text("".join(f"{sealed(one)}\n" for one in records), encoding="utf-8")
    play(opened(tmp_path))
    assert trials(journal_lines(run.run.journal)[0]) == [1, 2, 3, 4]
    (said,) = [w for w in read_study(tmp_path / "walk_ratio").warnings if "earlier" in w]
    assert said.startswith("P01: recorded by an earlier gaitlab (journal format 1)")
    lines = run.run.journal.read_bytes().split(b"\n")
    run.run.journal.write_bytes(b"\n".join([*lines[:-5], *lines[-4:]]))  # what was added names the line before
    with pytest.raises(UsageError, match="a whole line was removed"):
        journal_lines(run.run.journal)


def test_a_journal_of_a_later_form_is_not_gone_on_with(tmp_path):
    run = opened(tmp_path)
    run.journal.close()
    rewrite(run.run.journal, lambda records: [{**records[0], "format": 3}, *records[1:]])
    with pytest.raises(UsageError, match="written in format 3 by a later gaitlab"):
        opened(tmp_path)


def test_a_full_disk_ends_the_run_with_a_sentence_and_keeps_what_was_written(tmp_path, monkeypatch):
    run = opened(tmp_path)
    real, left = os.fsync, [4]

    def fsync(descriptor: int) -> None:
        left[0] -= 1
        if left[0] < 0:
            raise OSError(28, "No space left on device")
        real(descriptor)

    monkeypatch.setattr(os, "fsync", fsync)
    with pytest.raises(RunError, match="No space left on device"):
        play(run)
    monkeypatch.undo()
    assert journal_lines(run.run.journal)[0][0]["kind"] == "header"
    play(opened(tmp_path))
    runs = participant_runs(tmp_path, "walk_ratio", "P01")
    assert runs[-1].end == "finished"


def test_a_disk_that_takes_half_a_line_keeps_whole_lines_only(tmp_path, monkeypatch):
    """A nearly full disk accepts part of a write without an error, and refuses the rest."""

    class Disk(io.FileIO):
        room = 1500

        def write(self, data):  # type: ignore[no-untyped-def]
            if not self.room:
                raise OSError(28, "No space left on device")
            taken = super().write(bytes(data)[: self.room])
            self.room -= taken
            return taken

    with Disk(tmp_path / "journal", "xb") as disk:
        for number in range(100):
            try:
                append_line(disk, "x" * 100 + str(number))
            except OSError:
                break
    lines = (tmp_path / "journal").read_text().split("\n")
    assert lines[-1] == ""
    assert all(len(line) >= 101 for line in lines[:-1])
    assert len(lines) == 15


def test_whatever_goes_wrong_while_writing_reaches_the_loop(tmp_path):
    run = opened(tmp_path)
    run.journal.write([Answered(float("nan"), "age", 30)])
    with pytest.raises(RunError, match="can no longer be written"):
        run.journal.wait()


def test_a_run_that_was_finished_elsewhere_meanwhile_is_not_gone_on_with(tmp_path):
    first = opened(tmp_path)
    first.journal.close()
    seen = unfinished_run(tmp_path, "walk_ratio", "P01")
    assert seen is not None
    play(opened(tmp_path))
    with pytest.raises(UsageError, match="has finished meanwhile"):
        open_unfinished(seen, display={})


def test_a_participant_keeps_the_number_of_arrival_in_a_second_run_and_nobody_else_gets_it(tmp_path):
    for participant in ("P01", "P02"):
        play(opened(tmp_path, participant))
    again = open_new(short(), "P01", tmp_path, display={}, simulated=True, again=True)
    third = opened(tmp_path, "P03")
    assert (again.participant_number, again.run.number) == (1, 2)
    assert third.participant_number == 3
    again.journal.close()
    third.journal.close()


def test_one_damaged_journal_does_not_stop_other_participants_nor_a_new_run(tmp_path):
    run = opened(tmp_path)
    play(run)
    lines = run.run.journal.read_bytes().split(b"\n")
    lines[3] = b"garbage"
    run.run.journal.write_bytes(b"\n".join(lines))
    play(opened(tmp_path, "P02"))
    again = open_new(short(), "P01", tmp_path, display={}, simulated=True, again=True)
    again.journal.close()
    assert again.run.number == 2


def test_a_data_folder_that_cannot_be_made_is_said_before_anything_starts(tmp_path):
    (tmp_path / "walk_ratio").write_text("a file where a folder should be")
    with pytest.raises(UsageError, match="cannot be made"):
        opened(tmp_path)


@pytest.mark.parametrize("left", [b"", b'{"kind":"header","st'])
def test_a_run_killed_before_its_header_was_whole_begins_anew_and_keeps_the_scrap(tmp_path, left):
    folder = tmp_path / "walk_ratio" / "sourcedata" / "sub-P01" / "run-1"
    folder.mkdir(parents=True)
    (folder / "journal.jsonl").write_bytes(left)
    run = opened(tmp_path)
    play(run)
    assert run.run.number == 1
    assert (folder / "journal.torn-1").read_bytes() == left
    assert journal_lines(run.run.journal)[0][-2]["reason"] == "finished"


def test_an_open_journal_is_never_renamed_or_removed_as_windows_would_refuse_that(tmp_path, monkeypatch):
    folder = tmp_path / "walk_ratio" / "sourcedata" / "sub-P01" / "run-1"
    folder.mkdir(parents=True)
    (folder / "journal.jsonl").write_bytes(b"torn")

    def refused(*_: object) -> None:
        raise PermissionError(13, "The process cannot access the file because it is being used by another process")

    for name in ("rename", "replace", "unlink", "remove"):
        monkeypatch.setattr(os, name, refused)
    play(opened(tmp_path))
    monkeypatch.undo()
    assert participant_runs(tmp_path, "walk_ratio", "P01")[0].end == "finished"
    assert (folder / "journal.torn-1").read_bytes() == b"torn"


def test_a_disk_with_room_for_a_few_words_but_no_header_leaves_nothing_in_the_way_of_the_next_run(
    tmp_path, monkeypatch
):
    def refused(file, line: str) -> None:  # type: ignore[no-untyped-def]
        if len(line) > 1000:
            raise OSError(28, "No space left on device")
        append_line(file, line)

    monkeypatch.setattr("experiment_app.journal.append_line", refused)
    with pytest.raises(UsageError, match="No space left on device"):
        opened(tmp_path)
    monkeypatch.undo()
    play(opened(tmp_path))
    assert participant_runs(tmp_path, "walk_ratio", "P01")[0].end == "finished"


@pytest.mark.parametrize("reader", ["replay", "console"])
def test_a_journal_that_lost_its_header_is_refused_in_a_sentence(tmp_path, reader, capsys):
    folder = tmp_path / "walk_ratio" / "sourcedata" / "sub-P01" / "run-1"
    folder.mkdir(parents=True)
    (folder / "journal.jsonl").write_text(encode_line(Answered(1.0, "age", 30)) + "\n", encoding="utf-8")
    words = ["replay", str(folder)] if reader == "replay" else ["console", str(tmp_path / "walk_ratio"), "--once"]
    assert command(words) == 2
    with pytest.raises(UsageError, match="restore it from a copy"):
        participant_runs(tmp_path, "walk_ratio", "P01")
    assert "does not begin with its header" in capsys.readouterr().err

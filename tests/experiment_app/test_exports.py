"""Exports: what was recorded comes out whole, described, valid for others' programs, and the same to the byte."""

from __future__ import annotations

import csv
import gzip
import io
import json
import shutil
import subprocess
import sys
from pathlib import Path
from random import Random

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.errors import AnalysisError
from analysis.exports.exporting import export
from analysis.exports.psych_ds_rules import psych_ds_problems
from analysis.exports.runs import read_runs
from analysis.exports.table import Table, csv_bytes, table_of, tsv_bytes
from analysis.exports.trace import courses
from experiment_app.loop import run_session
from experiment_app.simulated.observer import SimulatedParticipant, draw_observer
from experiment_app.windows.undrawn import UndrawnWindow
from protocols.events import Closed, FocusLost, KeyDown
from protocols.record import Answered, decode_line, encode_line
from protocols.session import begin
from tests.experiment_app.sessions import opened, play
from tests.journals import rewrite

NASTY = 'a\tb "quoted", line\r\nbreak; <script>alert(1)</script> =1+1 ñ 漢 😀'


class Restless(UndrawnWindow):
    """Somebody who pauses, looks away and comes back in the middle of adjustments; ends after `patience` trials."""

    def __init__(self, run, seed: int, patience: int) -> None:  # type: ignore[no-untyped-def]
        person = SimulatedParticipant(run.plan.study, draw_observer(run.plan.study, 1, run.seed), run.seed)
        super().__init__(person, run.journal.wait)
        self._path, self._rng, self._patience = run.journal.path, Random(seed), patience

    def poll(self, session):  # type: ignore[no-untyped-def]
        now, events = super().poll(session)
        if session.trial is None or session.shown is None:
            return now, events
        if self._path.read_bytes().count(b'"kind":"trial"') >= self._patience:
            return now, [Closed(now, "SIGHUP")]
        following = self._participant.next_time()
        if following is None:
            return now, events
        what, soon = self._rng.random(), now + (following - now) / 2
        if what < 0.2:
            return now, [*events, FocusLost(soon)]
        if what < 0.5:
            return now, [*events, KeyDown(now + (soon - now) / 2, "escape"), KeyDown(soon, "escape")]
        return now, events


@pytest.fixture(scope="module")
def data(tmp_path_factory) -> Path:
    """P01 restless and interrupted, P02 with a nasty answer, P03 declined; the study's folder."""
    folder = tmp_path_factory.mktemp("exports")
    run = opened(folder, "P01")
    with run.journal as journal:
        run_session(begin(run.plan), Restless(run, 3, 3), journal)
    run = opened(folder, "P01")
    with run.journal as journal:
        run_session(begin(run.plan), Restless(run, 4, 99), journal)
    run = opened(folder, "P02")
    play(run)
    said = [decode_line(encode_line(Answered(1.0, *words))) for words in (("remarks", NASTY), ("sex", "not_said"))]
    rewrite(run.journal.path, lambda records: [*records[:2], *said, *records[2:]])
    run = opened(folder, "P03")
    with run.journal as journal:
        session = begin(run.plan)
        run_session(session, _Declining(run), journal)
    return folder / "walk_ratio"


class _Declining(UndrawnWindow):
    def __init__(self, run) -> None:  # type: ignore[no-untyped-def]
        person = SimulatedParticipant(run.plan.study, draw_observer(run.plan.study, 1, 1), 1)
        super().__init__(person, run.journal.wait)
        self._now = 0.0

    def poll(self, session):  # type: ignore[no-untyped-def]
        from protocols.events import Clicked

        self._now += 1.0
        return self._now, [Clicked(self._now, "decline"), KeyDown(self._now + 0.5, "enter")]


def contents(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def rows_of(path: Path) -> list[dict[str, str]]:
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("to", ["bids", "psych-ds", "csv", "parquet"])
def test_the_same_journals_give_the_same_bytes(data, tmp_path, to):
    if to == "parquet":
        pytest.importorskip("pyarrow", reason="Parquet needs pyarrow (pip install 'gaitlab[parquet]')")
    export(data, to, tmp_path / "a")
    export(data, to, tmp_path / "b")
    export(data, to, tmp_path / "a")
    assert contents(tmp_path / "a") == contents(tmp_path / "b")


def test_the_course_rebuilt_from_keys_ends_at_every_response_through_pauses_and_lost_focus(data):
    """The responses are the journal's own; the course is played again from key events alone."""
    runs, _ = read_runs(data)
    finished = [course for run in runs for course in courses(run) if course.end is not None]
    assert len(finished) == 12
    assert any(len(course.stretches) > 1 for course in finished), "nobody paused, so nothing was tested"
    for course in finished:
        assert list(course.corners)[-1][1] == pytest.approx(course.end, abs=2e-5)  # times are kept to 1 µs, 10 /min/s


def test_the_course_between_two_corners_is_the_tasks_own_law(data):
    """Against the task played frame by frame at 60 Hz, where no pause interferes."""
    from protocols.events import KeyUp, Shown
    from protocols.stimulus import Walk
    from protocols.tasks import adjustment

    task = adjustment.AdjustmentTask(80.0, 120.0, 10.0, 0.0)
    run = next(run for run in read_runs(data)[0] if run.participant == "P02")
    course = courses(run)[0]
    onset = next(course.corners)[0]
    keys = [t for t in run.of("key") if t.record["practice"] and t.record["trial"] == course.number]
    trial = adjustment.begin(task, Walk("T1", "", 1.0), next(course.corners)[1]).handle(Shown(onset))
    for timed in keys:
        while trial.time + 1 / 60 < timed.onset:
            trial = trial.advance(trial.time + 1 / 60)
            assert course.at(trial.time) == pytest.approx(trial.setting, abs=2e-5)
        event = KeyDown if timed.record["down"] else KeyUp
        trial = trial.handle(event(timed.onset, timed.record["key"]))


def test_an_interrupted_run_has_one_clock_and_only_the_last_attempt_of_a_trial_counts(data, tmp_path):
    export(data, "csv", tmp_path / "out")
    trials = [row for row in rows_of(tmp_path / "out/trials.csv") if row["participant"] == "P01"]
    assert [row["attempt"] for row in trials] == ["1", "1", "1", "2", "1", "1"]
    assert all(row["counts"] == "true" for row in trials)
    times = [float(row["onset"]) for row in trials]
    assert times == sorted(times)
    assert [row["sitting"] for row in trials] == ["1", "1", "1", "2", "2", "2"]
    events = [row for row in rows_of(tmp_path / "out/events.csv") if row["participant"] == "P01"]
    assert [row["why"] for row in events if row["event"] in ("end", "continued")][:2] == ["SIGHUP", "SIGHUP"]
    assert sum(row["event"] == "trial_interrupted" for row in events) == 1


def test_who_declined_is_left_out_and_said(data, tmp_path):
    done = export(data, "csv", tmp_path / "out")
    assert any("P03: did not consent" in note for note in done.notes)
    assert {row["participant"] for row in rows_of(tmp_path / "out/participants.csv")} == {"P01", "P02"}


def test_a_participants_text_comes_back_as_it_was_from_csv_and_cannot_break_a_table(data, tmp_path):
    export(data, "csv", tmp_path / "out")
    (row,) = [row for row in rows_of(tmp_path / "out/participants.csv") if row["participant"] == "P02"]
    assert row["remarks"] == NASTY
    assert pd.read_csv(tmp_path / "out/participants.csv").set_index("participant").remarks["P02"] == NASTY
    export(data, "bids", tmp_path / "bids")
    table = (tmp_path / "bids/participants.tsv").read_text(encoding="utf-8")
    assert {line.count("\t") for line in table.rstrip("\n").split("\n")} == {6}


@given(st.lists(st.lists(st.text(), min_size=3, max_size=3), min_size=1, max_size=6))
def test_any_text_survives_csv_as_rfc_4180_has_it(rows):
    table = Table("t", ("a", "b", "c"), tuple(dict(zip("abc", row, strict=True)) for row in rows))
    content = csv_bytes(table)
    back = list(csv.reader(io.StringIO(content.decode("utf-8", "surrogatepass"), newline=""), strict=True))
    assert back[1:] == rows
    assert content.endswith(b"\r\n")


@given(st.lists(st.text(), min_size=1, max_size=4))
def test_no_text_breaks_a_line_or_a_column_of_a_tsv(texts):
    lines = tsv_bytes(table_of("t", [{f"c{i}": text for i, text in enumerate(texts)}])).decode().split("\n")
    assert len(lines) == 3
    assert lines[1].count("\t") == len(texts) - 1


@pytest.mark.parametrize("to", ["bids", "psych-ds", "csv"])
def test_every_column_of_every_table_is_described(data, tmp_path, to):
    export(data, to, tmp_path / "out")
    if to == "csv":
        known = {row["column"]: row["description"] for row in rows_of(tmp_path / "out/data_dictionary.csv")}
        for path in tmp_path.glob("out/*.csv"):
            if path.name != "data_dictionary.csv":
                assert set(rows_of(path)[0]) <= known.keys()
        assert known["speed"] == "Factor speed of the design; it is stimulus.speed."
        assert known["age"] == "Answer to: How old are you (years)?"
    elif to == "psych-ds":
        assert psych_ds_problems(tmp_path / "out") == []
    else:
        for path in (tmp_path / "out").rglob("*.tsv"):
            beside = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))
            columns = path.read_text(encoding="utf-8").split("\n")[0].split("\t")
            assert set(columns) - {"participant_id"} <= beside.keys()


def test_the_sampled_course_of_bids_agrees_with_the_responses(data, tmp_path):
    export(data, "bids", tmp_path / "out")
    beh = tmp_path / "out/sub-P02/beh"
    about = json.loads((beh / "sub-P02_task-walkratio_run-1_recording-adjustment_stim.json").read_text())
    raw = gzip.decompress((beh / "sub-P02_task-walkratio_run-1_recording-adjustment_stim.tsv.gz").read_bytes())
    course = pd.read_csv(io.BytesIO(raw), sep="\t", names=about["Columns"], na_values="n/a")
    trials = pd.read_csv(beh / "sub-P02_task-walkratio_run-1_beh.tsv", sep="\t")
    for trial in trials.to_dict("records"):
        place = int((trial["confirmed"] - about["StartTime"]) * about["SamplingFrequency"])
        assert course.trial[place] == trial["trial"]
        assert course.step_frequency[place] == pytest.approx(trial["step_frequency"], abs=10 / 60 + 1e-4)


def validator() -> str | None:
    return shutil.which("bids-validator-deno", path=str(Path(sys.executable).parent)) or shutil.which(
        "bids-validator-deno"
    )


@pytest.mark.slow
@pytest.mark.skipif(validator() is None, reason="it needs the BIDS validator; pip install 'gaitlab[validate]'")
def test_the_official_validator_finds_no_error_in_a_bids_export(data, tmp_path):
    export(data, "bids", tmp_path / "out")
    command = [str(validator()), str(tmp_path / "out"), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    issues = json.loads(done.stdout)["issues"]["issues"]
    assert [issue for issue in issues if issue["severity"] == "error"] == []
    assert done.returncode == 0
    # without the column it knows to be required it does complain, so it did look
    events = tmp_path / "out/sub-P01/beh/sub-P01_task-walkratio_run-1_events.tsv"
    events.write_text(events.read_text().replace("duration", "length", 1))
    assert subprocess.run(command, capture_output=True, timeout=300).returncode != 0


def _describe(out: Path, change) -> None:  # type: ignore[no-untyped-def]
    path = out / "dataset_description.json"
    description = json.loads(path.read_text(encoding="utf-8"))
    change(description)
    path.write_text(json.dumps(description), encoding="utf-8")


BROKEN = {
    "dataset_description.json is missing": lambda out: (out / "dataset_description.json").unlink(),
    "name is missing": lambda out: _describe(out, lambda d: d.pop("name")),
    "@type must be Dataset": lambda out: _describe(out, lambda d: d.update({"@type": "Thing"})),
    "walk_ratio is not in variableMeasured": lambda out: _describe(
        out, lambda d: d.update(variableMeasured=[v for v in d["variableMeasured"] if v["name"] != "walk_ratio"])
    ),
    "there is no folder data": lambda out: (out / "data").rename(out / "dati"),
    "the name is no keyword-value": lambda out: (out / "data/Trials.csv").write_text("participant\r\nP01\r\n"),
    "cells, the header": lambda out: (out / "data/study-x_data.csv").write_text("participant,run\r\nP01\r\n"),
    "stands twice": lambda out: (out / "data/study-x_data.csv").write_text("run,run\r\n1,1\r\n"),
    "the file is empty": lambda out: (out / "data/study-x_data.csv").write_text(""),
}


@pytest.mark.parametrize("problem", BROKEN)
def test_each_rule_of_psych_ds_is_noticed_when_broken(data, tmp_path, problem):
    export(data, "psych-ds", tmp_path / "out")
    BROKEN[problem](tmp_path / "out")
    assert any(problem in found for found in psych_ds_problems(tmp_path / "out"))


def test_parquet_keeps_types_and_says_what_columns_are(data, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet", reason="Parquet needs pyarrow (pip install 'gaitlab[parquet]')")
    export(data, "parquet", tmp_path / "out")
    table = parquet.read_table(tmp_path / "out/trials.parquet")
    assert str(table.schema.field("walk_ratio").type) == "double"
    assert str(table.schema.field("counts").type) == "bool"
    assert table.schema.field("walk_ratio").metadata[b"unit"].decode() == "m·min"
    frame = pd.read_parquet(tmp_path / "out/participants.parquet").set_index("participant")
    assert frame.remarks["P02"] == NASTY


def test_an_export_never_touches_files_it_did_not_write_and_removes_its_own_stale_ones(data, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "thesis.tex").write_text("precious")
    with pytest.raises(AnalysisError, match="holds files that no export wrote"):
        export(data, "csv", out)
    (out / "thesis.tex").unlink()
    export(data, "bids", out)
    (out / "notes.txt").write_text("mine")
    export(data, "csv", out)
    assert not (out / "sub-P01").exists()
    assert (out / "notes.txt").read_text() == "mine"
    (out / "README.md").write_text("edited by hand")
    with pytest.raises(AnalysisError, match=r"README\.md was changed since the export was made"):
        export(data, "csv", out)
    with pytest.raises(AnalysisError, match="never among the journals"):
        export(data, "csv", data)


def test_responses_of_any_task_and_records_of_later_versions_are_exported_as_they_are(data, tmp_path):
    """Journals of choices and ratings have other responses; a device may add records this version does not know."""
    later = tmp_path / "data/walk_ratio"
    shutil.copytree(data, later)
    journal = later / "sourcedata/sub-P02/run-1/journal.jsonl"
    pulse = {"kind": "pulse", "time": 5.0, "part": "ear", "samples": [1, 2, 3]}
    chosen = {"response": {"chosen": "second", "correct": 1, "original": "first"}}
    rewrite(journal, lambda all_: [{**one, **(chosen if one["kind"] == "trial" else {})} for one in all_] + [pulse])
    export(later, "csv", tmp_path / "out")
    rows = [row for row in rows_of(tmp_path / "out/trials.csv") if row["participant"] == "P02"]
    assert {(row["chosen"], row["correct"], row["step_frequency"]) for row in rows} == {("second", "1", "")}
    (pulse,) = [row for row in rows_of(tmp_path / "out/events.csv") if row["event"] == "pulse"]
    assert json.loads(pulse["details"]) == {"part": "ear"}
    assert all(psych_ds_problems(p) == [] for p in [_exported(later, tmp_path / "psych")])


def _exported(folder: Path, out: Path) -> Path:
    export(folder, "psych-ds", out)
    return out


def test_frames_and_gaze_come_out_frame_by_frame_with_late_ones_marked(data, tmp_path):
    """Three frames at 60 Hz, the last 40 ms after the second; the gaze of two of them."""
    drawn = tmp_path / "data/walk_ratio"
    shutil.copytree(data, drawn)
    journal = drawn / "sourcedata/sub-P02/run-1/journal.jsonl"
    trial = {"time": 9.0, "number": 1, "practice": False, "attempt": 1}
    frames = {
        "kind": "frames", **trial, "period": 1 / 60, "flips": [8.0, 8.0167, 8.0567], "predicted": [8.0, 8.0167, 8.0333],
        "cpu_ms": [0.5, 0.6, 0.7], "poses": ["00000000", "00000001", "00000002"], "stretches": [0], "late": [2],
    }  # fmt: skip
    gaze = {
        "kind": "gaze", **trial, "flips": [8.0, 8.0167], "x": [0.5, None], "y": [0.25, None],
        "regions": ["legs", "unknown"], "joints": ["leftFoot", ""], "walkers": [0, -1],
    }  # fmt: skip
    rewrite(journal, lambda records: [*records, frames, gaze])
    export(drawn, "csv", tmp_path / "out")
    rows = rows_of(tmp_path / "out/frames.csv")
    assert [(row["time"], row["late"], row["pose"]) for row in rows] == [
        ("8.0", "false", "00000000"), ("8.0167", "false", "00000001"), ("8.0567", "true", "00000002"),
    ]  # fmt: skip
    looked = rows_of(tmp_path / "out/gaze.csv")
    assert [(row["x"], row["region"]) for row in looked] == [
        ("0.5", "legs"),
        ("", "unknown"),
    ]
    export(drawn, "bids", tmp_path / "bids")
    beside = json.loads(next((tmp_path / "bids").rglob("*recording-frames_stim.json")).read_text())
    assert beside["SamplingFrequency"] == pytest.approx(60.0)
    assert beside["StartTime"] == 8.0
    assert psych_ds_problems(_exported(drawn, tmp_path / "psych")) == []


@pytest.mark.parametrize("study", ["fourier_naturalness", "speed_editing", "crowd_variety"])
def test_data_of_ratings_and_choices_are_described_and_follow_the_rules_of_psych_ds(tmp_path, study):
    """`speed` is looked up for each `pair`, so that a pair is no number of m/s."""
    from analysis.exports.dictionary import of_study
    from experiment_app.simulated.simulate import simulate
    from protocols.study_file import read_study

    for _ in simulate(read_study(study), 1, tmp_path):
        pass
    export(tmp_path / study, "psych-ds", tmp_path / "out")
    (run,) = read_runs(tmp_path / study)[0]
    columns = of_study(run.study)
    assert set(run.study["factors"]) <= columns.keys()
    if study == "fourier_naturalness":
        assert columns["pair"].unit == ""
        assert "it decides stimulus.actor" in columns["pair"].description
    trials = rows_of(next((tmp_path / "out").rglob("*description-trials_data.csv")))
    assert {"rating", "chosen"} & set(trials[0])

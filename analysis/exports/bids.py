"""The Brain Imaging Data Structure, behavioural: a folder a participant, TSV tables, JSON beside each.

Layout after the BIDS specification 1.10: `beh.tsv` has a row a trial, `events.tsv` everything that happened, and
`recording-*_stim.tsv.gz` what is continuous. Raw journals go to sourcedata/, the study file to code/.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from importlib.metadata import version
from typing import Any

from analysis.exports import tables
from analysis.exports.dictionary import Column, dictionary
from analysis.exports.runs import ExportedRun
from analysis.exports.table import Row, Table, gzipped, json_bytes, table_of, tsv_bytes
from analysis.exports.trace import courses, sampled
from analysis.exports.words import readme, study_files

BIDS_VERSION = "1.10.0"

SAMPLING = 60.0
"""Hz of the step frequency's course; it is exact at any time, and straight lines between key presses."""

RENAMED = {"participant": "participant_id", "event": "trial_type"}


def bids_files(runs: Sequence[ExportedRun]) -> Iterator[tuple[str, bytes]]:
    """Every file of the data set, by path."""
    for run in runs:
        yield from _run_files(run)
        yield f"sourcedata/sub-{run.participant}/run-{run.number}/journal.jsonl", run.path.read_bytes()
    people = _as_bids(tables.participants(runs))
    yield "participants.tsv", tsv_bytes(people)
    yield "participants.json", json_bytes(_sidecar(people, runs, leave_out=("participant_id",)))
    for name, text in study_files(runs):
        yield f"code/{name}", text
    study = runs[0].study
    yield (
        "dataset_description.json",
        json_bytes(
            {
                "Name": str(study.get("title", study.get("study", ""))),
                "BIDSVersion": BIDS_VERSION,
                "DatasetType": "raw",
                "GeneratedBy": [{"Name": "gaitlab", "Version": version("gaitlab")}],
                "SourceDatasets": [{"URL": "bids::sourcedata/"}],
            }
        ),
    )
    yield "README.md", readme(runs, "bids")


def task_label(study: Mapping[str, Any]) -> str:
    """The study's name as a label of letters and digits, as walkratio."""
    return re.sub(r"[^A-Za-z0-9]", "", str(study.get("study", ""))) or "task"


def _run_files(run: ExportedRun) -> Iterator[tuple[str, bytes]]:
    stem = f"sub-{run.participant}/beh/sub-{run.participant}_task-{task_label(run.study)}_run-{run.number}"
    about = {
        "TaskName": task_label(run.study),
        "TaskDescription": " ".join(str(run.study.get("about", "")).split()),
        "Instructions": _instructions(run),
    }
    session = {k: v for k, v in tables.run_row(run).items() if k not in ("participant", "run")}
    done = _as_bids(tables.trials(run), ("participant", "run"))
    if done.rows:
        yield f"{stem}_beh.tsv", tsv_bytes(done)
        yield f"{stem}_beh.json", json_bytes({**about, "Run": session, **_sidecar(done, [run])})
    happened = _as_bids(tables.events(run), ("participant", "run"))
    if happened.rows:
        display = {"Display": run.header["display"], "SoftwareVersions": run.header["versions"]}
        yield f"{stem}_events.tsv", tsv_bytes(happened)
        yield f"{stem}_events.json", json_bytes({**about, **_presentation(run), **display, **_sidecar(happened, [run])})
    found = courses(run)
    if found:
        start, samples = sampled(found, SAMPLING)
        course = table_of("course", (_sample(sample) for sample in samples))
        yield f"{stem}_recording-adjustment_stim.tsv.gz", gzipped(tsv_bytes(course, header=False))
        yield (
            f"{stem}_recording-adjustment_stim.json",
            json_bytes(_continuous(course, run, SAMPLING, start, "Step frequency as adjusted; n/a between trials.")),
        )
    for recording, table in (("frames", tables.frames(run)), ("gaze", tables.gaze(run))):
        if "time" in table.columns:
            yield from _frame_files(run, recording, table, stem)


def _frame_files(run: ExportedRun, recording: str, table: Table, stem: str) -> Iterator[tuple[str, bytes]]:
    """A table with a row a frame, as a continuous recording."""
    drawn = run.of("frames")
    period = float(drawn[0].record["period"]) if drawn else float(run.header["display"].get("period_s") or 1.0 / 60.0)
    text = "One row a frame, seen at `time`: SamplingFrequency is the display's refresh rate, and frames may be late."
    start = float(table.rows[0]["time"])
    plain = _as_bids(table, ("participant", "run"))
    yield f"{stem}_recording-{recording}_stim.tsv.gz", gzipped(tsv_bytes(plain, header=False))
    about = _continuous(plain, run, round(1.0 / period, 6), start, text)
    yield f"{stem}_recording-{recording}_stim.json", json_bytes(about)


def _sample(sample: tuple[Any, float] | None) -> Row:
    if sample is None:
        return {"trial": None, "practice": None, "step_frequency": None}
    course, frequency = sample
    return {"trial": course.number, "practice": course.practice, "step_frequency": round(frequency, 6)}


def _continuous(table: Table, run: ExportedRun, rate: float, start: float, text: str) -> dict[str, Any]:
    """The JSON beside a continuous recording, whose table has no header line."""
    return {
        "TaskName": task_label(run.study),
        "SamplingFrequency": rate, "StartTime": start, "Columns": list(table.columns), "Description": text,
        **_sidecar(table, [run]),
    }  # fmt: skip


def _as_bids(table: Table, without: Sequence[str] = ()) -> Table:
    """The table with BIDS's names of columns, and `sub-` before a participant's code."""
    columns = [c for c in table.columns if c not in without]
    rows = tuple({RENAMED.get(c, c): _value(c, row.get(c)) for c in columns} for row in table.rows)
    return Table(table.name, tuple(RENAMED.get(c, c) for c in columns), rows)


def _value(column: str, value: Any) -> Any:
    return f"sub-{value}" if column == "participant" else value


def _sidecar(table: Table, runs: Sequence[ExportedRun], leave_out: Sequence[str] = ()) -> dict[str, Any]:
    back = {new: old for old, new in RENAMED.items() if old != "participant"}
    rows = tuple({back.get(c, c): value for c, value in row.items()} for row in table.rows)
    plain = Table(table.name, tuple(back.get(c, c) for c in table.columns), rows)
    meant = dictionary([plain], runs)
    named = {RENAMED.get(c, c) if c in back.values() else c: column for c, column in meant.items()}
    return {name: _described(column) for name, column in named.items() if name not in leave_out}


def _described(column: Column) -> dict[str, Any]:
    described: dict[str, Any] = {"Description": column.description}
    if column.unit:
        described["Units"] = column.unit
    if column.levels:
        described["Levels"] = {value: text or value for value, text in column.levels.items()}
    return described


def _instructions(run: ExportedRun) -> str:
    """The pages of instructions as this participant read them, with their own keys."""
    pages = (run.study.get("pages") or {}).get("instructions") or ()
    text = "\n\n".join(f"{page['title']}\n{page['text'].strip()}" for page in pages)
    for name, key in run.header["keys"].items():
        text = text.replace(f"{{{name}}}", str(key))
    return text


def _presentation(run: ExportedRun) -> dict[str, Any]:
    versions = run.header["versions"]
    return {
        "StimulusPresentation": {
            "OperatingSystem": str(versions.get("system", "unknown")),
            "SoftwareName": "gaitlab",
            "SoftwareVersion": str(versions.get("gaitlab", "unknown")),
        }
    }

"""Psych-DS: CSV files named by keywords under data/, described by one JSON-LD file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from importlib.metadata import version
from typing import Any

from analysis.exports import tables
from analysis.exports.bids import task_label
from analysis.exports.dictionary import Column, dictionary, dictionary_table
from analysis.exports.plain import BY_RUN
from analysis.exports.runs import ExportedRun
from analysis.exports.table import csv_bytes, json_bytes
from analysis.exports.words import readme, study_files


def psych_ds_files(runs: Sequence[ExportedRun]) -> Iterator[tuple[str, bytes]]:
    """Every file of the data set, by path; names use Psych-DS's own keywords, a run is a session."""
    meant: dict[str, Column] = {}
    task = task_label(runs[0].study)
    for table in (tables.participants(runs), tables.runs_table(runs)):
        _add(meant, dictionary([table], runs))
        yield f"data/study-{task}_description-{table.name}_data.csv", csv_bytes(table)
    for run in runs:
        stem = f"subject-{run.participant}_session-{run.number}_task-{task_label(run.study)}"
        for make in BY_RUN:
            table = make(run)
            if table.columns:
                _add(meant, dictionary([table], [run]))
                name = f"{stem}_description-{table.name}_data.csv"
                yield f"data/subject-{run.participant}/{name}", csv_bytes(table)
        yield f"data/raw/subject-{run.participant}/session-{run.number}/journal.jsonl", run.path.read_bytes()
    for name, text in study_files(runs):
        yield f"materials/{name}", text
    yield "documentation/data_dictionary.csv", csv_bytes(dictionary_table(meant))
    yield "dataset_description.json", json_bytes(_description(runs, meant))
    yield "README.md", readme(runs, "psych-ds")
    yield (
        "CHANGES.md",
        b"# Changes\n\nMade from the recorded runs by `gaitlab export`; make it again after any change.\n",
    )


def _add(meant: dict[str, Column], more: Mapping[str, Column]) -> None:
    for name, column in more.items():
        old = meant.get(name, column)
        meant[name] = Column(old.description, old.unit, {**old.levels, **column.levels})


def _description(runs: Sequence[ExportedRun], meant: Mapping[str, Column]) -> dict[str, Any]:
    study = runs[0].study
    about = " ".join(str(study.get("about", "")).split())
    return {
        "@context": "https://schema.org/",
        "@type": "Dataset",
        "name": str(study.get("title", study.get("study", ""))),
        "description": about or "Recorded with gaitlab.",
        "schemaVersion": "Psych-DS 0.4.0",
        "creator": {"@type": "SoftwareApplication", "name": "gaitlab", "softwareVersion": version("gaitlab")},
        "variableMeasured": [_variable(name, column) for name, column in meant.items()],
    }


def _variable(name: str, column: Column) -> dict[str, Any]:
    variable: dict[str, Any] = {"@type": "PropertyValue", "name": name, "description": column.description}
    if column.unit:
        variable["unitText"] = column.unit
    if column.levels:
        variable["valueReference"] = [
            {"@type": "PropertyValue", "value": value, **({"description": text} if text else {})}
            for value, text in column.levels.items()
        ]
    return variable

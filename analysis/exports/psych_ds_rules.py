"""The rules of Psych-DS that make a data set valid, checked without the official validator.

After the schema and its errors (github.com/psych-ds/psych-DS, schema_model, version 1.5): what is required of the
root, the names and the contents of data files. What the schema only recommends is not checked.
"""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

DATA_FILE = re.compile(r"([a-z]+-[a-zA-Z0-9]+)(_[a-z]+-[a-zA-Z0-9]+)*_data\.csv")
REQUIRED = ("@context", "@type", "name", "description", "variableMeasured")


def psych_ds_problems(folder: Path) -> list[str]:
    """What keeps a folder from being a valid Psych-DS data set, one sentence each; empty when nothing does."""
    return list(_problems(folder))


def _problems(folder: Path) -> Iterator[str]:
    description, why = _json(folder / "dataset_description.json")
    if why:
        yield why
        return
    for key in REQUIRED:
        if not description.get(key):
            yield f"dataset_description.json: {key} is missing"
    if description.get("@type") not in ("Dataset", "http://schema.org/Dataset", "https://schema.org/Dataset"):
        yield "dataset_description.json: @type must be Dataset"
    if "schema.org" not in json.dumps(description.get("@context", "")):
        yield "dataset_description.json: @context must name schema.org"
    data = folder / "data"
    if not data.is_dir():
        yield "there is no folder data"
        return
    files = sorted(path for path in data.rglob("*.csv") if "raw" not in path.relative_to(data).parts)
    if not any(DATA_FILE.fullmatch(path.name) for path in files):
        yield "data holds no data file (keyword-value_..._data.csv)"
    for path in folder.rglob("*"):
        if path.is_file() and not path.stat().st_size:
            yield f"{path.relative_to(folder)}: the file is empty"
    known = _variables(description.get("variableMeasured"))
    for path in files:
        if not DATA_FILE.fullmatch(path.name):
            yield f"{path.relative_to(folder)}: the name is no keyword-value_..._data.csv"
        for problem in _table_problems(path, known | _variables_beside(path)):
            yield f"{path.relative_to(folder)}: {problem}"


def _json(path: Path) -> tuple[dict[str, Any], str]:
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
    except OSError:
        return {}, f"{path.name} is missing"
    except ValueError as error:
        return {}, f"{path.name} is not JSON in UTF-8: {error}"
    return (value, "") if isinstance(value, dict) else ({}, f"{path.name} must be a JSON object")


def _variables(measured: Any) -> set[str]:
    """Names in a variableMeasured list, whose items are names or PropertyValue objects."""
    items = measured if isinstance(measured, list) else []
    return {str(item.get("name", "")) if isinstance(item, dict) else str(item) for item in items}


def _variables_beside(path: Path) -> set[str]:
    """Variables that a sidecar (the data file's name with .json) adds for this file."""
    sidecar = path.with_name(path.name.removesuffix(".csv") + ".json")
    return _variables(_json(sidecar)[0].get("variableMeasured")) if sidecar.exists() else set()


def _table_problems(path: Path, known: set[str]) -> Iterator[str]:
    try:
        with open(path, encoding="utf-8", newline="") as file:
            rows = list(csv.reader(file, strict=True))
    except (UnicodeDecodeError, csv.Error) as error:
        yield f"not a CSV file in UTF-8 ({error})"
        return
    if not rows or not any(rows[0]):
        yield "there is no header line"
        return
    header = rows[0]
    twice = sorted({name for name in header if header.count(name) > 1})
    if twice:
        yield f"the column {', '.join(twice)} stands twice"
    unknown = sorted(set(header) - known)
    if unknown:
        yield f"the column {', '.join(unknown)} is not in variableMeasured"
    for number, row in enumerate(rows[1:], start=2):
        if len(row) != len(header):
            yield f"row {number} has {len(row)} cells, the header {len(header)}"
            return
    if "row_id" in header:
        ids = [row[header.index("row_id")] for row in rows[1:]]
        if len(set(ids)) != len(ids):
            yield "row_id must be different in every row"

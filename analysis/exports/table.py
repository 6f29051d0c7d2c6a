"""A table and its text: RFC 4180 CSV for people and programs, BIDS's TSV; knows no study."""

from __future__ import annotations

import csv
import gzip
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

Row = Mapping[str, Any]


@dataclass(frozen=True)
class Table:
    """Rows under named columns; what a row lacks is missing. name: as trials."""

    name: str
    columns: tuple[str, ...]
    rows: tuple[Row, ...]


def table_of(name: str, rows: Iterable[Row], first: Sequence[str] = ()) -> Table:
    """A table of rows: columns `first` in their order where any row has them, then all others as they come."""
    kept = tuple(rows)
    seen = dict.fromkeys(column for row in kept for column in row)
    return Table(name, tuple(dict.fromkeys([*(c for c in first if c in seen), *seen])), kept)


def cell(value: Any) -> str:
    """A value as text: numbers at full precision, truth as true or false, lists and maps as JSON, nothing as ''."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple, Mapping)):
        return json.dumps(value, ensure_ascii=False, default=dict)
    return repr(value) if isinstance(value, float) else str(value)


def csv_bytes(table: Table, header: bool = True) -> bytes:
    """RFC 4180: commas, CRLF, quotes doubled inside quotes; UTF-8. Any text comes back as it was."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\r\n")
    if header:
        writer.writerow(table.columns)
    writer.writerows([cell(row.get(column)) for column in table.columns] for row in table.rows)
    return text.getvalue().encode("utf-8")


def tsv_bytes(table: Table, header: bool = True) -> bytes:
    """BIDS's tables: tabs, LF, n/a for what is missing. TSV cannot hold tabs and line breaks: they become spaces."""
    lines = ["\t".join(table.columns)] if header else []
    lines += ["\t".join(_tsv_cell(row.get(column)) for column in table.columns) for row in table.rows]
    return ("\n".join(lines) + "\n").encode("utf-8")


def _tsv_cell(value: Any) -> str:
    return " ".join(cell(value).split()) or "n/a"


def gzipped(content: bytes) -> bytes:
    """Compressed, without name or time, so that the same content gives the same bytes."""
    return gzip.compress(content, compresslevel=9, mtime=0)


def json_bytes(value: Any) -> bytes:
    """JSON for people to read, in the order given."""
    return (json.dumps(value, ensure_ascii=False, indent=2, default=dict) + "\n").encode("utf-8")

"""One table a file, over all participants: CSV for anything, Parquet (typed columns) for pandas, R and DuckDB."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any

from analysis.errors import AnalysisError
from analysis.exports import tables
from analysis.exports.dictionary import Column, dictionary, dictionary_table
from analysis.exports.runs import ExportedRun
from analysis.exports.table import Table, cell, csv_bytes
from analysis.exports.words import readme, study_files

Parts = Callable[[], Iterator[Table]]

BY_RUN: tuple[Callable[[ExportedRun], Table], ...] = (
    tables.trials,
    tables.events,
    tables.trace,
    tables.frames,
    tables.gaze,
)


def csv_files(runs: Sequence[ExportedRun]) -> Iterator[tuple[str, bytes]]:
    """Every table as CSV, the data dictionary, the study file and a README."""
    meant: dict[str, Column] = {}
    for name, columns, parts in _tables(runs, meant):
        chunks = [csv_bytes(Table(name, columns, part.rows), header=not i) for i, part in enumerate(parts())]
        yield f"{name}.csv", b"".join(chunks)
    yield from _about(runs, meant, "csv")


def parquet_files(runs: Sequence[ExportedRun]) -> Iterator[tuple[str, bytes]]:
    """The same as Parquet; every column carries its description and unit. Raises AnalysisError without pyarrow."""
    try:
        import pyarrow as arrow
        import pyarrow.parquet as parquet
    except ImportError:
        raise AnalysisError("Parquet needs pyarrow; install it with: pip install 'gaitlab[parquet]'") from None
    meant: dict[str, Column] = {}
    for name, columns, parts in _tables(runs, meant):
        values = {c: [row.get(c) for part in parts() for row in part.rows] for c in columns}
        arrays = {column: arrow.array(_of_one_type(inner)) for column, inner in values.items()}
        fields = [
            arrow.field(c, arrays[c].type, metadata={"description": meant[c].description, "unit": meant[c].unit})
            for c in columns
        ]
        file = arrow.BufferOutputStream()
        parquet.write_table(arrow.table(list(arrays.values()), schema=arrow.schema(fields)), file, compression="zstd")
        yield f"{name}.parquet", file.getvalue().to_pybytes()
    yield from _about(runs, meant, "parquet")


def _tables(runs: Sequence[ExportedRun], meant: dict[str, Column]) -> Iterator[tuple[str, tuple[str, ...], Parts]]:
    """Name, columns and parts of each table that has rows; adds what the columns mean to `meant`.

    The parts are made twice, once for the columns and once for the rows, so that only one run's frames are held.
    """
    whole: list[Parts] = [lambda: iter([tables.participants(runs)]), lambda: iter([tables.runs_table(runs)])]
    by_run: list[Parts] = [partial(map, make, runs) for make in BY_RUN]
    for parts in (*whole, *by_run):
        what = dictionary(parts(), runs)
        if what:
            meant.update((name, column) for name, column in what.items() if name not in meant)
            yield next(parts()).name, tuple(what), parts


def _about(runs: Sequence[ExportedRun], meant: dict[str, Column], to: str) -> Iterator[tuple[str, bytes]]:
    yield "data_dictionary.csv", csv_bytes(dictionary_table(meant))
    yield from study_files(runs)
    yield "README.md", readme(runs, to)


def _of_one_type(values: list[Any]) -> list[Any]:
    """A column's values as they are when all are numbers, truths or words; as text when they are mixed."""
    there = [value for value in values if value is not None]
    if all(isinstance(value, bool) for value in there):
        return values
    if all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in there):
        whole = all(isinstance(value, int) for value in there)
        return values if whole else [None if value is None else float(value) for value in values]
    return [None if value is None else cell(value) for value in values]

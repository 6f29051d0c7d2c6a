"""`gaitlab export`: the recorded runs of a study to a data set on disk, checked before it is called done."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from analysis.derived_files import export_of, write_derived
from analysis.errors import AnalysisError
from analysis.exports.runs import ExportedRun, read_runs
from analysis.recorded.journal import earlier_form

Files = Iterator[tuple[str, bytes]]
FORMATS = ("bids", "psych-ds", "parquet", "csv")


@dataclass(frozen=True)
class Exported:
    """What an export wrote, and a sentence for every run that has nothing in it."""

    paths: tuple[Path, ...]
    participants: int
    runs: int
    notes: tuple[str, ...]


def export(folder: Path, to: str, out: Path, over_edits: bool = False) -> Exported:
    """Writes DATA/<study> as a data set of format `to` into `out`; the same journals give the same bytes.

    Files an earlier export wrote are replaced or removed, others never. Raises AnalysisError for what a person must
    put right: no runs, damaged journals, a folder with other files in it.
    """
    out = Path(out)
    if out.resolve() == Path(folder).resolve() or (Path(folder) / "sourcedata").resolve() in out.resolve().parents:
        raise AnalysisError(f"--out {out}: an export goes into a folder of its own, never among the journals.")
    runs, left_out = read_runs(Path(folder))
    paths = write_derived(out, export_of(runs[0].header), _files(to)(runs), over_edits)
    if to == "psych-ds":
        from analysis.exports.psych_ds_rules import psych_ds_problems

        problems = psych_ds_problems(out)
        if problems:
            raise AnalysisError(f"{out} breaks rules of Psych-DS: {'; '.join(problems[:5])}.")
    people = len({run.participant for run in runs})
    torn = [f"{run.participant}: the journal's last line was cut off and is left out." for run in runs if run.torn]
    earlier = earlier_form([run.participant for run in runs if not run.chained])
    return Exported(tuple(paths), people, len(runs), (*left_out, *torn, *earlier))


def _files(to: str) -> Callable[[Sequence[ExportedRun]], Files]:
    from analysis.exports.bids import bids_files
    from analysis.exports.plain import csv_files, parquet_files
    from analysis.exports.psych_ds import psych_ds_files

    known: dict[str, Callable[[Sequence[ExportedRun]], Files]] = {
        "bids": bids_files, "psych-ds": psych_ds_files, "parquet": parquet_files, "csv": csv_files,
    }  # fmt: skip
    if to not in known:
        raise AnalysisError(f"--to {to}: there are {', '.join(FORMATS)}.")
    return known[to]

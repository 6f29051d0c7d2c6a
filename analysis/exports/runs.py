"""The journals of a study as runs with one clock each, whatever interrupted them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from io import StringIO
from pathlib import Path
from typing import Any

from analysis.errors import AnalysisError
from analysis.recorded.copies import not_read, without_copies
from analysis.recorded.journal import journals_of, read_records
from protocols.resuming import over

SAFETY = 1.0
"""s at least between two sittings of a run, where the computer's clock does not tell how long it was."""


@dataclass(frozen=True)
class Timed:
    """A record on the run's clock.

    sitting: from 1; a run that was continued has several, and each begins its own times at 0.
    offset:  s from the beginning of the run to the beginning of the sitting, by the computer's wall clock.
    """

    sitting: int
    offset: float
    record: Mapping[str, Any]

    def on_run_clock(self, time: float) -> float:
        """s since the run began, of a time (s) of this sitting, to the microsecond."""
        return round(self.offset + time, 6)

    @property
    def onset(self) -> float:
        """s since the run began at which the record was made."""
        return self.on_run_clock(float(self.record.get("time", 0.0)))


@dataclass(frozen=True)
class ExportedRun:
    """One run: its header, the study file it holds, and everything else that was recorded, in order."""

    path: Path
    participant: str
    number: int
    header: Mapping[str, Any]
    study: Mapping[str, Any]
    records: tuple[Timed, ...]
    torn: bool
    chained: bool

    def of(self, *kinds: str) -> list[Timed]:
        """The records of these kinds, in order."""
        return [timed for timed in self.records if timed.record["kind"] in kinds]

    @property
    def answers(self) -> dict[str, Any]:
        """Question to answer, a later one replacing an earlier; and the groups the participant was assigned to."""
        groups = dict(self.header.get("group") or {})
        return groups | {str(t.record["question"]): t.record["value"] for t in self.of("answer")}

    @property
    def ended(self) -> str:
        """Why the run is over, else why its last sitting ended; "" when no end was recorded."""
        ends = self.of("end")
        last = str(ends[-1].record["reason"]) if ends and ends[-1].sitting == self.sittings else ""
        return over(str(end.record["reason"]) for end in ends) or last

    @property
    def sittings(self) -> int:
        """How often the run was opened."""
        return self.records[-1].sitting if self.records else 1

    @property
    def kind(self) -> str:
        """real, pilot or simulated."""
        return "simulated" if self.header.get("simulated") else "pilot" if self.header.get("pilot") else "real"


def read_runs(folder: Path) -> tuple[list[ExportedRun], list[str]]:
    """Every run of a study's folder in which something was done, and a sentence for each that was left out.

    Raises AnalysisError when there is none, when a journal is damaged, or when runs of different kinds are mixed.
    """
    paths = journals_of(folder)
    every = [_read(path, path.relative_to(folder).as_posix()) for path in paths]
    every, copies, left_out = without_copies(every)
    left_out += not_read(folder, paths)
    left_out += [f"{run.participant}: {why}; left out." for run, why in copies]
    runs = []
    for run in every:
        declined = any(t.record.get("agreed") is False for t in run.of("consent"))
        if declined:
            left_out.append(f"{run.participant}: did not consent; nothing was exported.")
        elif not run.records:
            left_out.append(f"{run.participant}: run {run.number} holds nothing but its header.")
        else:
            runs.append(run)
    if not runs:
        raise AnalysisError(f"{folder} holds no run with anything to export ({' '.join(left_out)}).")
    kinds = sorted({run.kind for run in runs})
    if len(kinds) > 1:
        raise AnalysisError(f"{folder} mixes {' and '.join(kinds)} runs; move them into data folders of their own.")
    return runs, left_out


def _read(path: Path, name: str) -> ExportedRun:
    text = read_records(path, name)
    header = text.records[0]
    if not re.fullmatch(r"[A-Za-z0-9]+", str(header["participant"])):
        raise AnalysisError(f"{name}: {header['participant']!r} is no participant's code (letters and digits only).")
    try:
        timed = tuple(_timed(text.records))
        return ExportedRun(
            path, str(header["participant"]), int(header["run"]), header, _study(str(header["study_text"]), name),
            timed, bool(text.torn), text.chained,
        )  # fmt: skip
    except (KeyError, TypeError, ValueError) as error:
        raise AnalysisError(f"{name}: a record without a usable {error}; the journal cannot be exported.") from None


def _timed(records: Sequence[dict[str, Any]]) -> list[Timed]:
    """The records after the header with their sitting, and its offset by wall clock, never running backwards."""
    sitting, offset, latest = 1, 0.0, 0.0
    timed = []
    begun = datetime.fromisoformat(records[0]["started"])
    for record in records[1:]:
        if record["kind"] == "continue":
            sitting += 1
            elapsed = (datetime.fromisoformat(record["started"]) - begun).total_seconds()
            offset = max(elapsed, latest + SAFETY)
        latest = max(latest, offset + float(record.get("time", 0.0)))
        timed.append(Timed(sitting, offset, record))
    return timed


def _study(text: str, name: str) -> dict[str, Any]:
    from ruamel.yaml import YAML
    from ruamel.yaml.error import YAMLError

    try:
        study = YAML(typ="safe", pure=True).load(StringIO(text))
    except YAMLError as error:
        raise AnalysisError(f"{name}: the study file stored in it is not YAML: {error}") from None
    if not isinstance(study, dict):
        raise AnalysisError(f"{name}: the study file stored in it is empty.")
    return study

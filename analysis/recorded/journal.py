"""Recorded runs: the journals of a study folder, read without changing anything.

`protocols.record` knows the lines; this module knows where the files lie and which runs count.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from analysis.errors import AnalysisError, listed
from analysis.recorded.copies import not_read, without_copies

if TYPE_CHECKING:
    from protocols.journal_text import JournalText


@dataclass(frozen=True)
class RecordedRun:
    """One journal. Trials are the last complete record of each, practice left out."""

    path: Path
    name: str  # of the journal inside the study folder, with forward slashes
    participant: str
    number: int
    header: dict[str, Any]
    answers: dict[str, Any]
    trials: tuple[dict[str, Any], ...]  # by trial number
    ended: str  # why the run is over, else the reason of its last end; "" when there is none
    repeated: tuple[int, ...]  # trial numbers recorded more than once
    torn: bool  # the last line was cut off
    chained: bool  # each line names the one before, so none can be missing

    @property
    def finished(self) -> bool:
        """Whether the participant reached the end."""
        return self.ended == "finished"


@dataclass(frozen=True)
class RecordedStudy:
    """The runs of a study folder that are analysed, and what is said about the others."""

    runs: tuple[RecordedRun, ...]
    data_hash: str  # SHA-256 over the names and bytes of all journals
    journals: int
    warnings: tuple[str, ...]
    left_out: tuple[tuple[str, str], ...] = field(default=())  # participant, reason


def read_records(path: Path, name: str = "") -> JournalText:
    """Every record of a journal, the header first, and whether its last line was cut off.

    Raises AnalysisError naming the file and line where an inner line is damaged or out of its place.
    """
    from protocols.journal_text import DamagedJournalError, read_text
    from protocols.record import FORMAT

    name = name or path.name
    try:
        text = read_text(path.read_bytes())
    except DamagedJournalError as error:
        raise AnalysisError(
            f"{name}, line {error.line} of {error.lines}: {error}. Restore the file from a copy."
        ) from None
    if not text.records or text.records[0]["kind"] != "header":
        raise AnalysisError(
            f"{name}: the file does not begin with a complete header line, so it is not a usable run. "
            "Restore it from a copy, or move its run folder out of sourcedata."
        )
    if text.records[0].get("format", 1) not in range(1, FORMAT + 1):
        raise AnalysisError(
            f"{name}: written in format {text.records[0]['format']!r}; this version reads formats 1 to {FORMAT}. "
            "Update it."
        )
    return text


def read_journal(path: Path, name: str = "") -> RecordedRun:
    """One journal; raises AnalysisError naming the file and line where an inner line is damaged."""
    from protocols.resuming import over

    name = name or path.name
    text = read_records(path, name)
    header = text.records[0]
    answers, trials, repeated = dict(header.get("group") or {}), {}, []
    ends: list[str] = []
    for place, record in enumerate(text.records, start=1):
        kind = record.get("kind")
        try:
            if kind == "answer":
                answers[str(record["question"])] = record["value"]
            elif kind == "trial" and not record.get("practice", False):
                number = int(record["number"])
                if number in trials:
                    repeated.append(number)
                trials[number] = record
            elif kind == "end":
                ends.append(str(record["reason"]))
        except (KeyError, TypeError, ValueError) as error:
            raise AnalysisError(f"{name}, line {place}: a {kind} record without a usable {error}.") from None
    ended = over(ends) or "".join(ends[-1:])
    return RecordedRun(
        path, name, str(header.get("participant", "")), int(header.get("run", 1)), header, answers,
        tuple(trials[n] for n in sorted(trials)), ended, tuple(dict.fromkeys(repeated)), bool(text.torn), text.chained,
    )  # fmt: skip


def journals_of(folder: Path) -> list[Path]:
    """The journals of a study's folder, by participant and run; raises AnalysisError when there are none."""
    if folder.is_file():
        raise AnalysisError(f"{folder} is a file; name the study's folder of data, as data/walk_ratio.")
    if not folder.is_dir():
        raise AnalysisError(f"There is no folder {folder}; name the study's folder inside the data folder.")
    paths = sorted(folder.glob("sourcedata/sub-*/run-*/journal.jsonl"), key=_natural)
    if not paths:
        raise AnalysisError(
            f"{folder} holds no recorded run (sourcedata/sub-ID/run-N/journal.jsonl); {_way_out(folder)}."
        )
    return paths


def _way_out(folder: Path) -> str:
    """What to name instead: a study's folder inside this one, or the one around it."""
    around = [path.parent for path in (folder, *folder.parents) if path.name == "sourcedata"]
    meant = [*around, *sorted(path.parent for path in folder.glob("*/sourcedata"))]
    return f"name the study's folder, as {meant[0]}" if meant else "record or simulate one first"


def read_study(folder: Path, unfinished: bool = False) -> RecordedStudy:
    """Every run under `folder`/sourcedata, with those that do not count left out and named.

    unfinished: also take runs that were begun but not finished.
    """
    paths = journals_of(folder)
    digest, every = hashlib.sha256(), []
    for path in paths:
        name = path.relative_to(folder).as_posix()
        digest.update(f"{name}\n{path.stat().st_size}\n".encode())
        digest.update(path.read_bytes())
        every.append(read_journal(path, name))
    every, copies, warnings = without_copies(every)
    warnings += not_read(folder, paths)
    left_out, runs = [(run.participant, why) for run, why in copies], []
    for run in every:
        if run.torn:
            warnings.append(f"{run.name}: the last line was cut off while being written and was skipped.")
        if run.repeated:
            warnings.append(
                f"{run.participant}: trial(s) {listed(run.repeated)} were recorded more than once; "
                f"the last record counts."
            )
        if run.ended == "declined":
            left_out.append((run.participant, "did not consent"))
        elif run.ended == "withdrawn":
            left_out.append((run.participant, "withdrew"))
        elif not run.finished and not unfinished:
            how = f"ended: {run.ended}" if run.ended else "no end recorded"
            left_out.append((run.participant, f"unfinished run ({len(run.trials)} trials; {how})"))
        else:
            runs.append(run)
    runs, again = _first_of_each(runs)
    left_out += again
    warnings += earlier_form([run.participant for run in runs if not run.chained])
    warnings += _disagreements(runs)
    return RecordedStudy(tuple(runs), digest.hexdigest(), len(paths), tuple(warnings), tuple(left_out))


def earlier_form(participants: Sequence[str]) -> list[str]:
    """What is to be said of the participants whose journals are of format 1: a sentence, or none."""
    if not participants:
        return []
    return [
        f"{listed(participants)}: recorded by an earlier gaitlab (journal format 1): an altered line would be noticed, "
        "a whole line removed, doubled or moved would not."
    ]


def _natural(path: Path) -> list[tuple[int, str]]:
    """Sorts run-10 after run-2; the parts of the path that matter are the last three."""
    text = "/".join(path.parts[-3:])
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", text)]


def _first_of_each(runs: list[RecordedRun]) -> tuple[list[RecordedRun], list[tuple[str, str]]]:
    kept: dict[str, RecordedRun] = {}
    extra = []
    for run in runs:
        if run.participant in kept:
            extra.append(
                (
                    run.participant,
                    f"run {run.number} (a later run; run {kept[run.participant].number} counts)",
                )
            )
        else:
            kept[run.participant] = run
    return list(kept.values()), extra


def _disagreements(runs: list[RecordedRun]) -> list[str]:
    found = []
    versions: dict[str, list[RecordedRun]] = {}
    for run in runs:
        versions.setdefault(str(run.header.get("study_hash")), []).append(run)
    if len(versions) > 1:
        found.append(
            f"The runs were recorded with {len(versions)} versions of the study file. "
            + " ".join(_version(same, runs[0]) for same in list(versions.values())[1:])
        )
    found += _other_imports(runs)
    pilot = [run.participant for run in runs if run.header.get("pilot")]
    if pilot:
        found.append(f"These are pilot runs ({listed(pilot)}), recorded to try the study out; they are no results.")
    simulated = [run.participant for run in runs if run.header.get("simulated")]
    if simulated and len(simulated) < len(runs):
        found.append(
            f"Simulated and real participants are mixed: {listed(simulated)} "
            f"{'is' if len(simulated) == 1 else 'are'} simulated. Keep them in separate data folders."
        )
    return found


def _version(runs: Sequence[RecordedRun], first: RecordedRun) -> str:
    """Who had a version of the study file other than the first run's, and in what it differs."""
    from protocols.versions import what_differs

    places = what_differs(str(first.header.get("study_text", "")), str(runs[0].header.get("study_text", "")))
    who = listed([run.participant for run in runs])
    return f"That of {who} differs from {first.participant}'s in {places}."


def _other_imports(runs: Sequence[RecordedRun]) -> list[str]:
    """A sentence for every imported actor, body or style that was not the same in all runs."""
    known: dict[str, tuple[str, str]] = {}
    others: dict[str, list[str]] = {}
    for run in runs:
        for name, sha256 in run.header.get("imported", {}).items():
            if known.setdefault(name, (run.participant, sha256))[1] != sha256:
                others.setdefault(name, []).append(run.participant)
    return [
        f"{listed(who)} saw another {name} than {known[name][0]}: a file of that name, but of other content."
        for name, who in others.items()
    ]

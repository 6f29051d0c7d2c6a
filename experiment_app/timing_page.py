"""The certificate of a run as a file beside its journal, made from the journal alone and so at any time."""

from __future__ import annotations

import os
from pathlib import Path

from experiment_app.certificate import markdown, verdict
from experiment_app.errors import UsageError
from experiment_app.run_folder import Run, journal_lines
from experiment_app.timing import timing_of_run

NAME = "timing.md"


def write_certificate(run: Run) -> str:
    """Writes the certificate of a run and says in a few words what it says and where it is.

    A run without trials has no timing; then nothing is written.
    """
    lines, _ = journal_lines(run.journal)
    if not any(line["kind"] == "frames" for line in lines):
        return "no trial was shown, so there is no certificate"
    timing = timing_of_run(lines)
    path = run.folder / NAME
    beside = path.with_suffix(".tmp")
    beside.write_text(markdown(timing), encoding="utf-8")
    os.replace(beside, path)
    return f"{verdict(timing).level}, see {path}"


def certificate_of(folder: Path) -> str:
    """The certificate (Markdown) of the run in a folder that holds a journal; raises UsageError."""
    journal = folder / "journal.jsonl" if folder.is_dir() else folder
    if not journal.is_file():
        raise UsageError(f"{folder} holds no journal; name a run, as data/walk_ratio/sourcedata/sub-P01/run-1.")
    lines, _ = journal_lines(journal)
    if not lines or lines[0]["kind"] != "header":
        raise UsageError(f"{journal} has no whole first line, so nothing is known of the run.")
    return markdown(timing_of_run(lines))

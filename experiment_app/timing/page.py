"""The certificate of a run as a file beside its journal, made from the journal alone and so at any time."""

from __future__ import annotations

import os
from pathlib import Path

from experiment_app.run_folder import Run, journal_lines, run_at
from experiment_app.timing.certificate import markdown, verdict
from experiment_app.timing.facts import timing_of_run

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


def certificate_of(place: Path) -> str:
    """The certificate (Markdown) of the run at a path (its folder or journal); raises UsageError when there is none."""
    return markdown(timing_of_run(run_at(place).lines))

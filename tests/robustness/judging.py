"""Accepted or refused: what happens to a spoiled file, and nothing else may."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random

from analysis.errors import AnalysisError
from experiment_app.errors import RunError, UsageError
from protocols.study_file import StudyFileError
from tests.robustness.mutation import spoiled_bytes, spoiled_text

PLACED = re.compile(r"^.+?:[1-9]\d*:[1-9]\d*: .+", re.S)
"""A sentence about a study file: file:line:column: what is wrong."""


def study_verdict(path: Path) -> str:
    """What becomes of a study file, from reading to the plan of a session: "accepted" or "refused".

    Raises AssertionError when a refusal does not name file, line and column, and whatever else goes wrong.
    """
    from experiment_app.checking.check import checked_study, summary
    from protocols.plan import make_plan

    try:
        file = checked_study(str(path))
    except StudyFileError as error:
        placed = [line for line in str(error).split("\n") if line.startswith(str(path)) and PLACED.match(line)]
        if not error.mistakes or len(placed) != len(error.mistakes):  # some mistakes come with a picture below
            raise AssertionError(f"a refusal without its place: {error}") from error
        return "refused"
    make_plan(file.study, 1, 1, _group(file.study))
    summary(file)
    return "accepted"


def _group(study):  # type: ignore[no-untyped-def]
    from protocols.orders.assignment import group_of

    return group_of(study, 1)


def spoiled_studies(text: str, folder: Path, count: int, seed: int = 0) -> Iterator[tuple[int, str, str]]:
    """Number, text and verdict of spoiled copies of a study; number i of a seed is always the same one."""
    path = folder / "mutant.yaml"
    for number in range(count):
        mutant = spoiled_text(text, Random(f"{seed}/{number}"))
        path.write_bytes(mutant.encode("utf-8", "surrogatepass"))
        yield number, mutant, study_verdict(path)


def journal_verdict(data: Path, study: str, participant: str, out: Path) -> str:
    """What becomes of a journal for whoever reads one: going on with the run, the analysis, an export."""
    from analysis.exports.exporting import export
    from analysis.recorded.journal import read_study
    from experiment_app.opening import unfinished_run
    from experiment_app.participants.arrivals import participant_number
    from experiment_app.run_folder import progress

    verdicts = []
    for read in (
        lambda: [progress(run) for run in [unfinished_run(data, study, participant)] if run is not None],
        lambda: participant_number(data, study, "NEW"),
        lambda: read_study(data / study, unfinished=True),
        lambda: export(data / study, "csv", out, over_edits=True),
    ):
        try:
            read()  # type: ignore[no-untyped-call]
            verdicts.append("accepted")
        except (UsageError, RunError, AnalysisError, StudyFileError) as error:
            if "\n" in str(error).strip() and not isinstance(error, StudyFileError):
                raise AssertionError(f"more than a sentence: {error}") from error
            verdicts.append("refused")
    return "/".join(verdicts)


def spoiled_files(
    path: Path, read: Callable[[Path], object], refusals: tuple[type[Exception], ...], count: int, seed: int = 0
) -> Iterator[tuple[int, str]]:
    """Number and verdict of spoiled copies of a file, written beside it, for its reader."""
    content = path.read_bytes()
    copy = path.with_name(f"mutant{path.suffix}")
    for number in range(count):
        copy.write_bytes(spoiled_bytes(content, Random(f"{seed}/{number}")))
        try:
            read(copy)
        except refusals:
            yield number, "refused"
        else:
            yield number, "accepted"

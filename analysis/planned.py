"""From a study's recorded runs to the files of its planned analysis."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import pandas as pd

from analysis.apa import anova_sentence
from analysis.errors import AnalysisError
from analysis.figures import DrawnFigure, draw
from analysis.journal import read_study
from analysis.latex import latex_tables
from analysis.plan import read_plan
from analysis.report import report
from analysis.results import PlannedResults, compute, headlines
from analysis.trials import trials_table
from analysis.writing import write_bytes, write_table


@dataclass(frozen=True)
class AnalysisOutcome:
    """What `analyse` did: files written, sentences of warning, and the results in short."""

    paths: tuple[Path, ...]
    warnings: tuple[str, ...]
    headlines: tuple[str, ...]
    participants: int
    simulated: bool

    @property
    def report(self) -> Path:
        return next(path for path in self.paths if path.name == "report.html")


def analyse(study_folder: Path, out: Path, unfinished: bool = False) -> AnalysisOutcome:
    """Run the analysis planned in the study file of the recorded runs, and write its results into `out`.

    study_folder: DATA/<study>, with one journal a run under sourcedata; unfinished: include runs that
    were not finished. Writes trials.csv, cell_means.csv, descriptives.csv, anova.csv, posthoc.csv,
    ttests.csv, normality.csv, assumptions.csv, tables.tex, the planned figures (PNG and SVG) and
    report.html. What cannot be
    computed (too few participants, say) is a warning; the tables of what was recorded are still
    written. The same journals give the same bytes. Raises AnalysisError for what a person must put right.
    """
    study_folder, out = Path(study_folder), Path(out)
    recorded = read_study(study_folder, unfinished)
    if not recorded.runs:
        reasons = "; ".join(f"{who}: {why}" for who, why in recorded.left_out)
        raise AnalysisError(
            f"{study_folder}: none of the {recorded.journals} recorded runs can be analysed ({reasons})."
        )
    first = recorded.runs[0]
    plan = read_plan(str(first.header.get("study_text", "")), first.name)
    results = compute(recorded, plan, trials_table(recorded, plan))
    drawn, complaints = _figures(results)
    results = replace(results, warnings=(*results.warnings, *complaints))
    tables = _tables(results)
    names = [
        *tables,
        *(f"{figure.name}.{kind}" for figure in drawn for kind in ("png", "svg")),
        "report.html",
    ]
    names.insert(len(tables), "tables.tex")
    paths = [write_table(out / name, table) for name, table in tables.items()]
    paths.append(write_bytes(out / "tables.tex", latex_tables(results).encode("utf-8")))
    for figure in drawn:
        paths.append(write_bytes(out / f"{figure.name}.png", figure.png))
        paths.append(write_bytes(out / f"{figure.name}.svg", figure.svg))
    paths.append(write_bytes(out / "report.html", report(results, drawn, names).encode("utf-8")))
    return AnalysisOutcome(
        tuple(paths),
        (*results.warnings, *(f"{who}: {why}; left out." for who, why in recorded.left_out)),
        tuple(headlines(results)),
        len(recorded.runs),
        results.simulated > 0,
    )


def _tables(results: PlannedResults) -> dict[str, pd.DataFrame]:
    anova = results.anova.assign(sentence=[anova_sentence(row) for row in results.anova.to_dict("records")])
    trials = results.trials if results.plan.exclusions else results.trials.drop(columns="excluded")
    return {
        "trials.csv": trials,
        "cell_means.csv": results.cells,
        "descriptives.csv": results.descriptives,
        "anova.csv": anova,
        "posthoc.csv": results.posthoc,
        "ttests.csv": results.ttests,
        "normality.csv": results.normality,
        "assumptions.csv": results.assumptions,
    }


def _figures(results: PlannedResults) -> tuple[list[DrawnFigure], list[str]]:
    drawn: list[DrawnFigure] = []
    complaints: list[str] = []
    if results.means is None:
        return drawn, complaints
    for figure in results.plan.figures:
        try:
            drawn.append(draw(figure, results.means, results.plan))
        except AnalysisError as error:
            complaints.append(f"A figure was not drawn: {error}")
    return drawn, complaints

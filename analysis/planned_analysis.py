"""From a study's recorded runs to the files of its planned analysis."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import pandas as pd

from analysis.apa import anova_sentence
from analysis.derived_files import report_of, write_derived
from analysis.errors import AnalysisError
from analysis.figures.check_plots import check_plots, check_quantiles, quantiles_table
from analysis.figures.checks import session_course
from analysis.figures.drawing import DrawnFigure
from analysis.figures.planned import draw
from analysis.planned.computing import compute
from analysis.planned.plan import AnalysisPlan, read_plan
from analysis.planned.results import PlannedResults
from analysis.recorded.journal import RecordedRun, read_study
from analysis.recorded.trials import trials_table
from analysis.report.headlines import headlines
from analysis.report.latex import latex_tables
from analysis.report.page import Drawn, report
from analysis.statistics.marginal_means import emmeans_of, marginal_means
from analysis.writing import table_bytes

PLAN = "plan.yaml"
"""Copy of the study file whose plan was followed, beside a report that follows another than the recorded one."""


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
        """Where the page for a browser was written."""
        return next(path for path in self.paths if path.name == "report.html")


def analyse(
    study_folder: Path, out: Path, unfinished: bool = False, over_edits: bool = False, plan_text: str | None = None
) -> AnalysisOutcome:
    """Run the analysis planned in the study file of the recorded runs, and write its results into `out`.

    study_folder: DATA/<study>, with one journal a run under sourcedata; unfinished: include runs that
    were not finished; over_edits: replace also files of an earlier report that a person has changed; plan_text: a
    study file whose plan is followed instead of that of the first run. A copy is kept beside the report, which says so.
    Writes trials.csv, cell_means.csv, descriptives.csv, anova.csv, posthoc.csv, ttests.csv, normality.csv,
    assumptions.csv, qq.csv, a table for each further planned test, tables.tex, the planned figures (PNG and
    SVG) and report.html; further measures get a folder each. Files of an earlier report of the same data are
    replaced or removed, others never. What cannot be
    computed (too few participants, say) is a warning; the tables of what was recorded are still written. The
    same journals give the same bytes. Raises AnalysisError for what a person must put right.
    """
    study_folder, out = Path(study_folder), Path(out)
    if (study_folder / "sourcedata").resolve() in [out.resolve(), *out.resolve().parents]:
        raise AnalysisError(f"--out {out}: a report goes into a folder of its own, never among the journals.")
    recorded = read_study(study_folder, unfinished)
    if not recorded.runs:
        reasons = "; ".join(f"{who}: {why}" for who, why in recorded.left_out)
        raise AnalysisError(
            f"{study_folder}: none of the {recorded.journals} recorded runs can be analysed ({reasons})."
        )
    first = recorded.runs[0]
    files: dict[str, bytes] = {}
    stored = str(first.header.get("study_text", ""))
    plan = read_plan(plan_text or stored, first.name if plan_text is None else PLAN)
    if plan_text is not None and plan_text != stored:
        files[PLAN] = plan_text.encode("utf-8")
        recorded = replace(recorded, warnings=(_other_plan(first, plan, plan_text), *recorded.warnings))
    elif len({run.header.get("study_hash") for run in recorded.runs}) > 1:
        recorded = replace(recorded, warnings=(*recorded.warnings, _plan_of(first)))
    results = compute(recorded, plan, trials_table(recorded, plan))
    files["trials.csv"] = table_bytes(_trials(results))
    drawn: dict[str, Drawn] = {}
    results = _of_one_measure(results, "", files, drawn)
    also = [_of_one_measure(other, f"{other.plan.measure}/", files, drawn) for other in results.also]
    results = replace(results, also=tuple(also))
    files["report.html"] = report(results, drawn, [*files, "report.html"]).encode("utf-8")
    paths = write_derived(out, report_of(first.header), files.items(), over_edits)
    return AnalysisOutcome(
        tuple(paths),
        (
            *results.warnings,
            *(w for other in also for w in other.warnings),
            *(f"{who}: {why}; left out." for who, why in recorded.left_out),
        ),
        tuple(headlines(results)),
        len(recorded.runs),
        results.simulated > 0,
    )


def _other_plan(first: RecordedRun, plan: AnalysisPlan, plan_text: str) -> str:
    """The warning that a plan is followed which is not the recorded one; AnalysisError where it is of another study."""
    from protocols.versions import what_differs

    if plan.study != first.header.get("study"):
        raise AnalysisError(
            f"--plan: that is the study {plan.study}, and these are runs of {first.header.get('study')}; name a "
            "version of the study file that they were recorded with."
        )
    places = what_differs(str(first.header.get("study_text", "")), plan_text)
    return (
        f"The plan followed is not the one that was recorded with {first.participant}'s run, but that of {PLAN} beside "
        f"this report, which differs in {places}."
    )


def _plan_of(first: RecordedRun) -> str:
    return (
        f"The plan recorded with {first.participant}'s run is followed; gaitlab analyse --plan FILE follows that of "
        "another version of the study file, and says so."
    )


def _of_one_measure(
    results: PlannedResults, folder: str, files: dict[str, bytes], drawn: dict[str, Drawn]
) -> PlannedResults:
    """Adds the files and pictures of one measure; returns the results with what could not be drawn as a warning."""
    figures, complaints = _figures(results)
    points = check_quantiles(results)
    drawn[results.plan.measure] = Drawn(figures, check_plots(points, results.plan.label))
    tables = {**_tables(results), "qq.csv": quantiles_table(points)}
    if results.means is not None and any(figure.kind == "order" for figure in results.plan.figures):
        tables["order.csv"] = session_course(results.means, results.used)
    files |= {f"{folder}{name}": table_bytes(table) for name, table in tables.items()}
    files[f"{folder}tables.tex"] = latex_tables(results).encode("utf-8")
    for figure in figures:
        files |= {f"{folder}{figure.name}.png": figure.png, f"{folder}{figure.name}.svg": figure.svg}
    return replace(results, warnings=(*results.warnings, *complaints))


def _trials(results: PlannedResults) -> pd.DataFrame:
    return results.trials if results.plan.exclusions else results.trials.drop(columns="excluded")


def _tables(results: PlannedResults) -> dict[str, pd.DataFrame]:
    anova = results.anova.assign(sentence=[anova_sentence(row) for row in results.anova.to_dict("records")])
    tables = {
        "cell_means.csv": results.cells,
        "descriptives.csv": results.descriptives,
        "anova.csv": anova,
        "marginal_means.csv": _marginal_means(results),
        "posthoc.csv": results.posthoc,
        "ttests.csv": results.ttests,
        "normality.csv": results.normality,
        "assumptions.csv": results.assumptions,
    }
    second = {
        "regression": "regression_cases.csv", "aligned_rank_transform": "aligned_rank_contrasts.csv",
        "proportions": "proportions_participants.csv", "d_prime": "d_prime_participants.csv",
        "psychometric": "psychometric_fits.csv", "adaptive": "adaptive_tracks.csv",
    }  # fmt: skip
    for test in results.further:
        tables[f"{test.kind}.csv"] = test.table
        if test.kind in second:
            tables[second[test.kind]] = test.more
    return tables


def _marginal_means(results: PlannedResults) -> pd.DataFrame:
    """Estimated marginal means of every effect of the ANOVA: effect, level, emmean, se, df, 95 % limits."""
    columns = ["effect", "level", "emmean", "se", "df", "ci_low", "ci_high"]
    parts = []
    if results.means is not None:
        for effect in results.anova["effect"]:
            marginal = marginal_means(results.means, effect.split(":"))
            level = [" × ".join(cell) for cell in marginal.cells]
            table = emmeans_of(marginal, results.plan.model)
            parts.append(table.assign(effect=effect, level=level)[columns])
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame(columns=columns)


def _figures(results: PlannedResults) -> tuple[list[DrawnFigure], list[str]]:
    drawn: list[DrawnFigure] = []
    complaints: list[str] = []
    for figure in results.plan.figures:
        if results.means is None and figure.kind not in ("t_tests", "regression"):
            continue  # why there are no means is a warning already
        try:
            drawn.append(draw(figure, results))
        except AnalysisError as error:
            complaints.append(f"A figure was not drawn: {error}")
    return drawn, complaints

"""One self-contained page with everything a reader needs to judge the planned analysis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version

from analysis import apa
from analysis.figures.drawing import DrawnFigure
from analysis.planned.results import PlannedResults
from analysis.recorded.trials import exclusion_counts
from analysis.report import paragraphs
from analysis.report.descriptives import assumptions_section, descriptives_section, normality_section
from analysis.report.further import further_sections
from analysis.report.headlines import headlines
from analysis.report.markup import Cell, Markup, bullets, element, image, join, table, text
from analysis.report.sections import anova_section, posthoc_section, t_tests_section
from analysis.report.style import STYLE
from analysis.report.values import str_right

PACKAGES = ("numpy", "scipy", "pandas", "statsmodels", "matplotlib")


@dataclass(frozen=True)
class Drawn:
    """The pictures of one measure: the planned figures, and the Q-Q plots by test."""

    figures: Sequence[DrawnFigure]
    checks: Mapping[str, DrawnFigure]


def report(results: PlannedResults, drawn: Mapping[str, Drawn], files: Sequence[str]) -> str:
    """The page as HTML text. drawn: by measure; files: names of the tables written beside it."""
    plan = results.plan
    further = [part for one in results.also for part in (_further_title(one), _warnings(one), *_tests(one, drawn))]
    body = [
        element("h1", plan.title),
        element("p", "Report of the planned analysis of the study ", element("code", plan.study), class_="kind"),
        _simulated(results),
        _facts(results),
        _headlines(results),
        _warnings(results),
        _participants(results),
        element("h2", "Method"),
        *(element("p", paragraph) for paragraph in paragraphs.methods_paragraphs(results)),
        element("p", plan.about, class_="note") if plan.about else "",
        *_tests(results, drawn),
        *further,
        _provenance(results, files),
    ]
    head = [
        Markup('<meta charset="utf-8">'),
        Markup('<meta name="viewport" content="width=device-width, initial-scale=1">'),
        element("title", f"{plan.title} – report"),
        Markup(f"<style>{STYLE}</style>"),
    ]
    page = join([element("head", join(head)), element("body", element("main", join(filter(None, body))))])
    return f'<!DOCTYPE html>\n<html lang="en">\n{page}\n</html>\n'


def _tests(results: PlannedResults, drawn: Mapping[str, Drawn]) -> list[Markup]:
    """Every section of one measure."""
    pictures = drawn[results.plan.measure]
    return [
        anova_section(results, pictures.checks.get("anova")),
        _figures(pictures.figures),
        t_tests_section(results, pictures.checks),
        posthoc_section(results),
        further_sections(results, pictures.checks),
        normality_section(results),
        assumptions_section(results),
        descriptives_section(results),
    ]


def _further_title(results: PlannedResults) -> Markup:
    return join(
        [
            element("h1", f"Also: {results.plan.label}", class_="measure"),
            *(element("p", paragraph) for paragraph in paragraphs.methods_paragraphs(results)),
        ]
    )


def _simulated(results: PlannedResults) -> Markup:
    sentence = paragraphs.simulated_sentence(results)
    return element("p", sentence, class_="simulated") if sentence else Markup("")


def _facts(results: PlannedResults) -> Markup:
    trials = results.trials
    facts = {
        "participants": len(results.recorded.runs),
        "trials": f"{len(trials):,}".replace(",", " "),
        "trials left out": int((trials["excluded"] != "").sum()),
        "median response time": f"{apa.figures(float(trials['response_time'].median()))} s"
        if trials["response_time"].notna().any()
        else "–",
    }
    return element(
        "dl",
        *(element("div", element("dt", name), element("dd", value)) for name, value in facts.items()),
        class_="facts",
    )


def _headlines(results: PlannedResults) -> Markup:
    found = headlines(results)
    return join([element("h2", "Results in short"), bullets(found, class_="headlines")]) if found else Markup("")


def _warnings(results: PlannedResults) -> Markup:
    if not results.warnings:
        return Markup("")
    return element("div", element("b", "Please note"), bullets(results.warnings), class_="warnings")


def _participants(results: PlannedResults) -> Markup:
    parts: list[object] = [element("h2", "Participants and exclusions")]
    parts.append(element("p", paragraphs.participants_paragraph(results)))
    left_out = results.recorded.left_out
    if left_out:
        parts.append(element("p", "Runs left out: ", "; ".join(f"{who}, {why}" for who, why in left_out), "."))
    else:
        parts.append(element("p", "No run was left out."))
    counts = exclusion_counts(results.trials, results.plan)
    if len(counts):
        columns: dict[str, tuple[object, Cell]] = {
            "where": ("condition", text),
            "reason": ("reason", text),
            "trials": ("trials left out", str_right),
            "participants": ("participants", str_right),
        }
        parts.append(table(counts, columns))
    else:
        parts.append(element("p", "The study file declares no exclusion of trials."))
    return join(parts)


def _figures(figures: Sequence[DrawnFigure]) -> Markup:
    if not figures:
        return Markup("")
    drawn = [
        element(
            "figure",
            image(figure.svg, "image/svg+xml", figure.caption),
            element("figcaption", element("b", f"Figure {place}. "), figure.caption),
        )
        for place, figure in enumerate(figures, start=1)
    ]
    return join([element("h2", "Figures"), *drawn])


def software() -> list[str]:
    """This program and what it computes with, with their versions."""
    names = ["gaitlab", *PACKAGES]
    found = []
    for name in names:
        try:
            found.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            found.append(name)
    return found


def walks_shown(results: PlannedResults) -> list[str]:
    """Where the walks came from, as the journals say, each with the actors (or styles) it holds for."""
    sources: dict[str, list[str]] = {}
    for run in results.recorded.runs:
        for actor, source in sorted(run.header.get("walkers", {}).items()):
            of = sources.setdefault(str(source), [])
            if actor not in of:
                of.append(str(actor))
    return [f"{', '.join(of)}: {source}" for source, of in sources.items()]


def _provenance(results: PlannedResults, files: Sequence[str]) -> Markup:
    recorded = dict.fromkeys(
        f"{name} {number}"
        for run in results.recorded.runs
        for name, number in sorted(run.header.get("versions", {}).items())
    )
    study = dict.fromkeys(str(run.header.get("study_hash", "")) for run in results.recorded.runs)
    rows: list[tuple[str, object]] = [
        ("Data", f"{results.recorded.journals} journal(s), SHA-256"),
        ("", element("span", results.recorded.data_hash, class_="hash")),
        ("Study file", element("span", ", ".join(study), class_="hash")),
        ("Walks shown", "; ".join(walks_shown(results)) or "not recorded"),
        ("Analysed with", ", ".join(software())),
        ("Recorded with", ", ".join(recorded) or "not recorded"),
        ("Files", ", ".join(files)),
    ]
    body = [
        element("tr", element("td", name, class_="left"), element("td", value, class_="left wrap"))
        for name, value in rows
    ]
    return join(
        [
            element("h2", "Where these numbers come from"),
            element("div", element("table", element("tbody", *body)), class_="scroll provenance"),
            element("p", "The same journals give the same files, byte for byte.", class_="note"),
        ]
    )

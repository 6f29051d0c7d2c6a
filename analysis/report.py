"""One self-contained page with everything a reader needs to judge the planned analysis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version

import pandas as pd

from analysis import apa, report_text
from analysis.figures import DrawnFigure
from analysis.markup import Cell, Markup, bullets, element, image, join, table, text
from analysis.report_style import STYLE
from analysis.results import ALPHA, PlannedResults, headlines, unit_decimals
from analysis.trials import exclusion_counts

PACKAGES = ("numpy", "scipy", "pandas", "matplotlib")
P_UNCORRECTED = Markup("<i>p</i> uncorrected")
LONGEST_TABLE = 70  # pairs shown in the page; longer families are in posthoc.csv


def report(results: PlannedResults, figures: Sequence[DrawnFigure], files: Sequence[str]) -> str:
    """The page as HTML text. files: names of the tables written beside it."""
    plan = results.plan
    body = [
        element("h1", plan.title),
        element("p", "Report of the planned analysis of the study ", element("code", plan.study), class_="kind"),
        _simulated(results),
        _facts(results),
        _headlines(results),
        _warnings(results),
        _participants(results),
        element("h2", "Method"),
        element("p", report_text.methods_paragraph(results)),
        element("p", plan.about, class_="note") if plan.about else "",
        _anova(results),
        _figures(figures),
        _t_tests(results),
        _posthoc(results),
        _normality(results),
        _descriptives(results),
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


def _simulated(results: PlannedResults) -> Markup:
    sentence = report_text.simulated_sentence(results)
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
    parts.append(element("p", report_text.participants_paragraph(results)))
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


def str_right(value: object) -> str:
    return str(value)


def _p(value: float) -> str:
    if not math.isfinite(value):
        return "–"
    return "< .001" if value < 0.001 else apa.share(value, 3)


def _share(value: float) -> str:
    return apa.share(value) if math.isfinite(value) else "–"


def _name(value: object) -> Markup:
    return text(apa.effect_name(str(value)))


def _anova(results: PlannedResults) -> Markup:
    data = results.anova
    if not len(data):
        return Markup("")
    shown = data.assign(
        effect=data["effect"].map(apa.effect_name),
        df=[f"{apa.degrees(a)}, {apa.degrees(b)}" for a, b in zip(data["df1_gg"], data["df2_gg"], strict=True)],
        limits=[f"[{_share(a)}, {_share(b)}]" for a, b in zip(data["eta_p2_low"], data["eta_p2_high"], strict=True)],
        uncorrected=[f"{a}, {b}" for a, b in zip(data["df1"], data["df2"], strict=True)],
        mauchly=[_p(p) for p in data["mauchly_p"]],
    )
    columns: dict[str, tuple[object, Cell]] = {
        "effect": ("Effect", text),
        "df": ("df", str_right),
        "F": (element("i", "F"), apa.number),
        "p_gg": (element("i", "p"), _p),
        "eta_p2": (Markup("η<sub>p</sub>²"), _share),
        "limits": ("90 % limits", str_right),
        "eta_g2": (Markup("η<sub>G</sub>²"), _share),
        "epsilon_gg": ("ε (GG)", _epsilon),
        "uncorrected": ("df uncorrected", str_right),
        "p": (P_UNCORRECTED, _p),
        "mauchly": (element("span", "Mauchly ", element("i", "p")), str_right),
    }
    notes = [
        f"Dependent variable: {results.plan.label.lower()}"
        + (f" ({results.plan.unit})" if results.plan.unit else "")
        + f"; n = {len(results.means.subjects) if results.means else 0}. Bold: p < .05. df and p are "
        "Greenhouse–Geisser "
        "corrected where the within-participant part has more than one df; F is the same either way.",
        report_text.sphericity_sentence(results),
        report_text.normality_sentence(results),
        *report_text.other_checks(results),
        *results.notes,
    ]
    return join(
        [
            element("h2", "Analysis of variance"),
            table(shown, columns, list(data["p_gg"] < ALPHA)),
            *(element("p", note, class_="note") for note in notes if note),
            element(
                "details",
                element("summary", "The same as sentences"),
                bullets(
                    [f"{apa.effect_name(row['effect'])}: {apa.anova_sentence(row)}" for row in data.to_dict("records")]
                ),
            ),
        ]
    )


def _epsilon(value: float) -> str:
    return "–" if not math.isfinite(value) else apa.share(value) if value < 0.995 else "1"


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


def _unit(results: PlannedResults) -> tuple[Cell, int]:
    """How values in the unit of the measure are written, and with how many decimals."""
    decimals = unit_decimals(results)
    return (lambda value: apa.number(value, decimals)), decimals


def _t_tests(results: PlannedResults) -> Markup:
    data = results.ttests
    if not len(data):
        return Markup("")
    unit, decimals = _unit(results)
    parts: list[object] = [element("h2", "Comparison with reference values")]
    for (factor, reference), part in data.groupby(["factor", "reference"], sort=False):
        shown = part.assign(
            limits=[_interval(a, b, decimals) for a, b in zip(part["ci_low"], part["ci_high"], strict=True)],
        )
        columns: dict[str, tuple[object, Cell]] = {
            "level": (factor, text),
            "mean": ("mean", unit),
            "sd": ("SD", unit),
            "against": (reference, unit),
            "estimate": ("difference", unit),
            "limits": ("95 % limits", str_right),
            "t": (element("i", "t"), apa.number),
            "df": ("df", _degrees),
            "p": (element("i", "p"), _p),
            "d": (element("i", "d"), apa.number),
            "bf10": ("BF₁₀", _bayes),
            "shapiro_p": (element("span", "Shapiro–Wilk ", element("i", "p")), _p),
        }
        parts.append(table(shown, columns, list(part["p"] < ALPHA)))
    measured_in = f" Means and differences in {results.plan.unit}." if results.plan.unit else ""
    parts.append(
        element(
            "p",
            "One-sample t tests of participants' means, two-sided, not corrected for their number. d "
            "is Cohen's; BF₁₀ is the JZS Bayes factor (Cauchy scale .707). "
            "Limits of d and Hedges' g are in ttests.csv." + measured_in,
            class_="note",
        )
    )
    return join(parts)


def _degrees(value: float) -> str:
    return apa.degrees(value) if math.isfinite(value) else "–"


def _bayes(value: float) -> str:
    return "–" if not math.isfinite(value) else "> 10 000" if value > 1e4 else apa.figures(value)


def _interval(low: float, high: float, decimals: int) -> str:
    return f"[{apa.number(low, decimals)}, {apa.number(high, decimals)}]"


def _posthoc(results: PlannedResults) -> Markup:
    plan = results.plan
    if results.means is None or plan.adjust is None:
        return Markup("")
    parts: list[object] = [element("h2", "Pairwise comparisons")]
    if not len(results.posthoc):
        parts.append(element("p", "No effect was significant, so none was followed up."))
    for effect, part in results.posthoc.groupby("effect", sort=False):
        parts.append(_family(str(effect), part, results))
    if len(results.posthoc):
        kind = "pairs that differ are bold. " if len(results.posthoc) else ""
        parts.append(
            element(
                "p",
                f"p: {plan.adjust}, over all pairs of one effect; {kind}d is the difference over the "
                f"root mean of the two "
                "variances between participants. All pairs, with standard errors and limits, are in "
                "posthoc.csv.",
                class_="note",
            )
        )
    return join(parts)


def _family(effect: str, part: pd.DataFrame, results: PlannedResults) -> Markup:
    unit, decimals = _unit(results)
    low = part[part["p"] < ALPHA]
    title = element("h3", apa.effect_name(effect))
    columns: dict[str, tuple[object, Cell]] = {
        "a": ("a", text),
        "b": ("b", text),
        "estimate": ("a − b", unit),
        "limits": ("95 % limits", str_right),
        "t": (element("i", "t"), apa.number),
        "df": ("df", _degrees),
        "p": (element("i", "p"), _p),
        "d_av": (element("i", "d"), apa.number),
    }
    words = f"{len(low)} of {len(part)} pairs differ."

    def shown(rows: pd.DataFrame) -> Markup:
        limits = [_interval(a, b, decimals) for a, b in zip(rows["ci_low"], rows["ci_high"], strict=True)]
        return table(rows.assign(limits=limits), columns, list(rows["p"] < ALPHA))

    if len(part) <= 15:
        return join([title, element("p", words), shown(part)])
    if len(part) <= LONGEST_TABLE:
        return join([title, element("details", element("summary", words), shown(part))])
    listed = low.reindex(low["p_unadjusted"].sort_values(kind="stable").index)[:LONGEST_TABLE]
    if not len(listed):
        return join([title, element("p", words)])
    summary = f"{words} Those that do" + (f" (the {LONGEST_TABLE} clearest):" if len(low) > LONGEST_TABLE else ":")
    return join([title, element("details", element("summary", summary), shown(listed))])


def _normality(results: PlannedResults) -> Markup:
    data = results.normality
    if not len(data):
        return Markup("")
    unit, _ = _unit(results)
    factors = [name for name in (*results.plan.within, *results.plan.between) if name in data]
    columns: dict[str, tuple[object, Cell]] = {
        **{name: (name, text) for name in factors},
        "n": (element("i", "n"), str_right),
        "mean": ("mean", unit),
        "sd": ("SD", unit),
        "w": (element("i", "W"), lambda w: apa.share(w, 3)),
        "p": (element("i", "p"), _p),
    }
    cells = data[data["scope"] == "cell"]
    return join(
        [
            element("h2", "Normality"),
            element("p", report_text.normality_sentence(results)),
            element(
                "details",
                element("summary", f"Shapiro–Wilk test of each of the {len(cells)} cells"),
                table(cells, columns, list(cells["p"] < ALPHA)),
            ),
        ]
    )


def _descriptives(results: PlannedResults) -> Markup:
    data = results.descriptives
    unit, decimals = _unit(results)
    factors = [name for name in (*results.plan.within, *results.plan.between) if name in data]
    columns: dict[str, tuple[object, Cell]] = {
        **{name: (name, text) for name in factors},
        "n": (element("i", "n"), str_right),
        "mean": ("mean", unit),
        "sd": ("SD", unit),
        "se": ("SE", unit),
        "limits": ("95 % limits", str_right),
    }
    shown = data.assign(
        limits=[_interval(a, b, decimals) for a, b in zip(data["ci_low"], data["ci_high"], strict=True)]
    )
    return join(
        [
            element("h2", "Cell means"),
            element(
                "details",
                element("summary", f"Means of the {len(data)} cells over participants"),
                table(shown, columns),
            ),
        ]
    )


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

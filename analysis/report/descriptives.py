"""The last sections of the report: normality cell by cell, and the cell means."""

from __future__ import annotations

from analysis import apa
from analysis.errors import listed
from analysis.planned.results import ALPHA, PlannedResults
from analysis.report import paragraphs
from analysis.report.markup import Cell, Markup, element, join, table, text
from analysis.report.values import degrees_cell, interval, p_cell, str_right, unit_cell


def normality_section(results: PlannedResults) -> Markup:
    """Shapiro–Wilk tests of the residuals and of every cell; nothing where none was planned."""
    data = results.normality
    if not len(data):
        return Markup("")
    unit, _ = unit_cell(results)
    factors = [name for name in (*results.plan.within, *results.plan.between) if name in data]
    columns: dict[str, tuple[object, Cell]] = {
        **{name: (name, text) for name in factors},
        "n": (element("i", "n"), str_right),
        "mean": ("mean", unit),
        "sd": ("SD", unit),
        "w": (element("i", "W"), lambda w: apa.share(w, 3)),
        "p": (element("i", "p"), p_cell),
    }
    cells = data[data["scope"] == "cell"]
    return join(
        [
            element("h2", "Normality"),
            element("p", paragraphs.normality_sentence(results)),
            element(
                "details",
                element("summary", f"Shapiro–Wilk test of each of the {len(cells)} cells"),
                table(cells, columns, list(cells["p"] < ALPHA)),
            ),
        ]
    )


def assumptions_section(results: PlannedResults) -> Markup:
    """Every check in one table to unfold; the sentences that matter stand beside the tests."""
    data = results.assumptions
    if not len(data):
        return Markup("")
    columns: dict[str, tuple[object, Cell]] = {
        "check": ("Check", text),
        "where": ("of", text),
        "statistic": ("statistic", apa.figures),
        "df1": ("df or n", degrees_cell),
        "df2": ("df", degrees_cell),
        "p": (element("i", "p"), p_cell),
        "note": ("", text),
    }
    kinds = listed(dict.fromkeys(data["check"]), 12)
    return join(
        [
            element("h2", "All checks of assumptions"),
            element("p", f"{kinds}; bold: p < .05. None of them decides which test is reported.", class_="note"),
            element(
                "details",
                element("summary", f"The {len(data)} checks"),
                table(data, columns, list(data["p"] < ALPHA)),
            ),
        ]
    )


def descriptives_section(results: PlannedResults) -> Markup:
    """Mean, standard deviation and limits of every cell, in the unit of the measure."""
    data = results.descriptives
    if not len(data):
        return Markup("")
    unit, decimals = unit_cell(results)
    factors = [name for name in (*results.plan.within, *results.plan.between) if name in data]
    columns: dict[str, tuple[object, Cell]] = {
        **{name: (name, text) for name in factors},
        "n": (element("i", "n"), str_right),
        "mean": ("mean", unit),
        "sd": ("SD", unit),
        "se": ("SE", unit),
        "limits": ("95 % limits", str_right),
    }
    shown = data.assign(limits=[interval(a, b, decimals) for a, b in zip(data["ci_low"], data["ci_high"], strict=True)])
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

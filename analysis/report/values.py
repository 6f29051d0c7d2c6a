"""How the report writes single values in its tables."""

from __future__ import annotations

import math
from collections.abc import Sequence

from analysis import apa
from analysis.figures.drawing import DrawnFigure
from analysis.planned.results import PlannedResults, unit_decimals
from analysis.report.markup import Cell, Markup, bullets, element, image, join

Columns = dict[str, tuple[object, Cell]]
D, F, P, T, BF = element("i", "d"), element("i", "F"), element("i", "p"), element("i", "t"), "BF₁₀"
ADJUSTED = {"tukey": "Tukey", "bonferroni": "Bonferroni", "holm": "Holm"}
D_AV = Markup("<i>d</i><sub>av</sub>")
D_AV_IS = "d_av is the difference over the root mean of the two variances between participants."
HOLM_LIMITS = "With Holm the limits are Bonferroni's, wider than its p."


def str_right(value: object) -> str:
    """Text that stands at the right of its column."""
    return str(value)


def p_cell(value: float) -> str:
    """A p value as < .001 or .045; a dash for none."""
    if not math.isfinite(value):
        return "–"
    return "< .001" if value < 0.001 else apa.share(value, 3)


def share_cell(value: float) -> str:
    """A number between 0 and 1 without its leading zero, to two decimals; a dash for none."""
    return apa.share(value) if math.isfinite(value) else "–"


def share_interval(low: float, high: float) -> str:
    """Limits between 0 and 1, as [.38, .78]; a dash for none."""
    return f"[{share_cell(low)}, {share_cell(high)}]" if math.isfinite(high) else "–"


def epsilon_cell(value: float) -> str:
    """A correction of degrees of freedom, 1 where there is none to make; a dash where it does not apply."""
    return "–" if not math.isfinite(value) else apa.share(value) if value < 0.995 else "1"


def unit_cell(results: PlannedResults) -> tuple[Cell, int]:
    """How values in the unit of the measure are written, and with how many decimals."""
    decimals = unit_decimals(results)
    return (lambda value: apa.number(value, decimals)), decimals


def degrees_cell(value: float) -> str:
    """Degrees of freedom; a dash for none."""
    return apa.degrees(value) if math.isfinite(value) else "–"


def bayes_cell(value: float) -> str:
    """A Bayes factor in three figures, above 10 000 as such; a dash for none."""
    return "–" if not math.isfinite(value) else "> 10 000" if value > 1e4 else apa.figures(value)


def interval(low: float, high: float, decimals: int) -> str:
    """An interval by its limits; an en dash where there is none."""
    if not (math.isfinite(low) or math.isfinite(high)):
        return "–"
    return f"[{apa.number(low, decimals)}, {apa.number(high, decimals)}]"


def check_plot(plot: DrawnFigure | None) -> Markup:
    """A small picture beside a test, folded away until asked for; nothing where there is none."""
    if plot is None:
        return Markup("")
    picture = image(plot.svg, "image/svg+xml", plot.caption)
    figure = element("figure", picture, element("figcaption", plot.caption), class_="check")
    return element("details", element("summary", "Q–Q plot"), figure)


def section(title: str, tables: Sequence[object], notes: Sequence[str], sentences: Sequence[str]) -> Markup:
    """A test's part of the page: tables, notes, and its sentences to unfold."""
    return join(
        [
            element("h2", title),
            *tables,
            *(element("p", note, class_="note") for note in notes if note),
            element("details", element("summary", "The same as sentences"), bullets(sentences)),
        ]
    )

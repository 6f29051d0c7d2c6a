"""The tables of the planned analysis for LaTeX (booktabs), in the style of the APA."""

from __future__ import annotations

import math
from collections.abc import Sequence

from analysis import apa
from analysis.planned.results import ALPHA, PlannedResults, unit_decimals
from analysis.report.latex_further import further_rows, p_text

_SPECIAL = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}",
    "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "−": "$-$", "×": r"$\times$", "<": "$<$", ">": "$>$",
    "·": r"$\cdot$", "–": "--", "±": r"$\pm$", "≤": r"$\le$", "≥": r"$\ge$", "≠": r"$\ne$", "′": "$'$",
}  # fmt: skip

WIDEST = 72
"""Characters of a row, beyond which its label is broken into lines, so that a page of 12 cm holds the table."""


LONGEST = 42
"""Rows of a table that a page holds; a longer one goes on over the next (longtable)."""


def escaped(text: object) -> str:
    """Text that LaTeX prints as it is."""
    return "".join(_SPECIAL.get(character, character) for character in " ".join(str(text).split()))


def latex_tables(results: PlannedResults) -> str:
    r"""ANOVA, t tests, significant pairs, every further test as tables.

    The first line says which packages they need: booktabs, and longtable where one is longer than a page.
    """
    parts: list[str] = []
    plan, decimals = results.plan, unit_decimals(results)
    if len(results.anova):
        rows = [
            [
                apa.effect_name(r["effect"]), apa.both_degrees(r["df1_gg"], r["df2_gg"]),
                apa.number(r["F"]), p_text(r["p_gg"]), _share(r["eta_p2"]),
            ]
            for r in results.anova.to_dict("records")
        ]  # fmt: skip
        caption = f"Analysis of variance of {apa.mid_sentence(plan.label)}, Greenhouse–Geisser corrected"
        parts.append(_table(caption, ["Effect", "df", "$F$", "$p$", r"$\eta_p^2$"], rows))
    if len(results.ttests):
        rows = [
            [
                f"{r['factor']} {r['level']}", *(apa.number(r[c], decimals) for c in ("mean", "sd", "against")),
                apa.number(r["t"]), apa.degrees(r["df"]) if math.isfinite(r["df"]) else "–", p_text(r["p"]),
                apa.number(r["d"]),
            ]
            for r in results.ttests.to_dict("records")
        ]  # fmt: skip
        head = ["", "Mean", "SD", "Reference", "$t$", "df", "$p$", "$d$"]
        parts.append(_table(f"{plan.label}: one-sample t tests", head, rows))
    pairs = results.posthoc[results.posthoc["p"] < ALPHA]
    if len(pairs):
        rows = [
            [
                apa.effect_name(r["effect"]), r["a"], r["b"], apa.number(r["estimate"], decimals),
                apa.number(r["t"]), apa.degrees(r["df"]), p_text(r["p"]),
            ]
            for r in pairs.to_dict("records")
        ]  # fmt: skip
        head = ["Effect", "a", "b", "a $-$ b", "$t$", "df", "$p$"]
        parts.append(_table(f"Pairs that differ (p adjusted: {(plan.adjust or 'none').capitalize()})", head, rows))
    for test in results.further:
        if (written := further_rows(test)) is not None:
            caption, head, body = written
            parts.append(_table(f"{plan.label}: {caption[:1].lower()}{caption[1:]}", head, body))
    packages = "booktabs,longtable" if any("longtable" in part for part in parts) else "booktabs"
    return "\n\n".join([f"% \\usepackage{{{packages}}}; written by gaitlab", *parts]) + "\n"


def _share(value: float) -> str:
    return apa.share(value) if math.isfinite(value) else "–"


def _table(caption: str, head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    body = [[escaped(cell) for cell in row] for row in rows]
    label = "l"
    if sum(max(len(str(row[column])) for row in rows) for column in range(len(head))) > WIDEST:
        label = r"p{0.27\linewidth}"
        body = [[rf"\raggedright {first}", *others] for first, *others in body]
    columns = label + "r" * (len(head) - 1)
    if len(rows) > LONGEST:
        return "\n".join([
            r"\begingroup\small\setlength{\tabcolsep}{4pt}", rf"\begin{{longtable}}{{@{{}}{columns}@{{}}}}",
            rf"\caption{{{escaped(caption)}}}\\", r"\toprule", " & ".join(head) + r" \\", r"\midrule", r"\endfirsthead",
            r"\toprule", " & ".join(head) + r" \\", r"\midrule", r"\endhead", r"\bottomrule", r"\endfoot",
            *(" & ".join(row) + r" \\" for row in body), r"\end{longtable}", r"\endgroup",
        ])  # fmt: skip
    return "\n".join([
        r"\begin{table}", r"\centering\small\setlength{\tabcolsep}{4pt}", rf"\caption{{{escaped(caption)}}}",
        rf"\begin{{tabular}}{{@{{}}{columns}@{{}}}}", r"\toprule", " & ".join(head) + r" \\", r"\midrule",
        *(" & ".join(row) + r" \\" for row in body), r"\bottomrule", r"\end{tabular}", r"\end{table}",
    ])  # fmt: skip

"""The tables of the planned analysis for LaTeX (booktabs), in the style of the APA."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from analysis import apa
from analysis.planned.results import ALPHA, PlannedResults, unit_decimals
from analysis.report.latex_further import further_rows, p_text

_SPECIAL = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_\allowbreak{}",
    "{": r"\{", "}": r"\}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "−": "$-$", "×": r"$\times$",
    "<": "$<$", ">": "$>$", "·": r"$\cdot$", "–": "--", "±": r"$\pm$", "≤": r"$\le$", "≥": r"$\ge$",
    "≠": r"$\ne$", "′": "$'$",
}  # fmt: skip

PAGE = 345.0
"""Points of a line of LaTeX's article, the narrowest page that people use."""

SMALL, SMALLER = r"\small\setlength{\tabcolsep}{4pt}", r"\footnotesize\setlength{\tabcolsep}{3pt}"

LONGEST = 42
"""Lines of a table that a page holds; a longer one goes on over the next (longtable)."""


def escaped(text: object) -> str:
    """Text that LaTeX prints as it is."""
    return "".join(_SPECIAL.get(character, character) for character in " ".join(str(text).split()))


def latex_tables(results: PlannedResults) -> str:
    r"""ANOVA, t tests, significant pairs, every further test as tables.

    The first line says which packages they need: booktabs; array and longtable where one is wider or longer
    than a page.
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
        parts.append(
            _table(f"Pairs that differ (p adjusted: {(plan.adjust or 'none').capitalize()})", head, rows, texts=3)
        )
    for test in results.further:
        if (written := further_rows(test)) is not None:
            caption, head, body = written
            parts.append(_table(f"{plan.label}: {caption[:1].lower()}{caption[1:]}", head, body))
    packages = "booktabs"
    for package, command in (("array", r"\arraybackslash"), ("longtable", r"\begin{longtable}")):
        packages += f",{package}" if any(command in part for part in parts) else ""
    return "\n\n".join([f"% \\usepackage{{{packages}}}; written by gaitlab", *parts]) + "\n"


def _share(value: float) -> str:
    return apa.share(value) if math.isfinite(value) else "–"


@dataclass(frozen=True)
class _Form:
    """How a table is set: its size, the columns, and how many lines of the page its rows take."""

    size: str
    columns: str
    lines: int


def _points(text: object) -> float:
    """About how wide a text is in Computer Modern of 9 points, as `small` in an article is."""
    return sum(2.6 if c in " .,:;()[]il" else 7.4 if c in "−×<>±≤≥≠" else 4.7 for c in str(text))


def _form(head: Sequence[str], rows: Sequence[Sequence[object]], texts: int) -> _Form:
    """As wide as its cells where the page holds them; else its first `texts` columns are broken into lines."""
    plain = [re.sub(r"\\[a-z]+|[$\\{}^_]", "", title) for title in head]
    widths = [max(_points(row[column]) for row in [plain, *rows]) for column in range(len(head))]
    gaps = len(head) - 1
    if sum(widths) + 8 * gaps <= PAGE:
        return _Form(SMALL, "l" * texts + "r" * (len(head) - texts), len(rows))
    size, scale, share = SMALL, 1.0, (PAGE - sum(widths[texts:]) - 8 * gaps) / texts
    if share < 0.2 * PAGE:
        size, scale, share = SMALLER, 8 / 9, (PAGE - 8 / 9 * sum(widths[texts:]) - 6 * gaps) / texts
    share = min(max(share, 0.12 * PAGE), scale * max(widths[:texts]))
    lines = sum(max(math.ceil(scale * _points(cell) / share) for cell in row[:texts]) for row in rows)
    broken = rf">{{\raggedright\arraybackslash}}p{{{share / PAGE:.2f}\linewidth}}" * texts
    return _Form(size, broken + "r" * (len(head) - texts), lines)


def _table(caption: str, head: Sequence[str], rows: Sequence[Sequence[object]], texts: int = 1) -> str:
    """texts: how many columns, from the left, hold words."""
    form = _form(head, rows, texts)
    titles = " & ".join(head) + r" \\"
    body = [" & ".join(escaped(cell) for cell in row) + r" \\" for row in rows]
    if form.lines > LONGEST:
        return "\n".join([
            rf"\begingroup{form.size}", rf"\begin{{longtable}}{{@{{}}{form.columns}@{{}}}}",
            rf"\caption{{{escaped(caption)}}}\\", r"\toprule", titles, r"\midrule", r"\endfirsthead",
            r"\toprule", titles, r"\midrule", r"\endhead", r"\bottomrule", r"\endfoot", *body,
            r"\end{longtable}", r"\endgroup",
        ])  # fmt: skip
    return "\n".join([
        r"\begin{table}", rf"\centering{form.size}", rf"\caption{{{escaped(caption)}}}",
        rf"\begin{{tabular}}{{@{{}}{form.columns}@{{}}}}", r"\toprule", titles, r"\midrule", *body, r"\bottomrule",
        r"\end{tabular}", r"\end{table}",
    ])  # fmt: skip

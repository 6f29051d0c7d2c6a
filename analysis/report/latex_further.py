"""The tables of the tests beside the ANOVA for LaTeX: which columns, and how their values are written."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import pandas as pd

from analysis import apa
from analysis.planned.further_test import FurtherTest

Row = Mapping[str, Any]
Writer = Callable[[Row], str]


@dataclass(frozen=True)
class TableForm:
    """A caption, and a heading (LaTeX) with what writes the cell of a row; rows: which of the test's rows to show."""

    caption: str
    columns: Mapping[str, Writer]
    rows: Callable[[pd.DataFrame], pd.DataFrame] = lambda table: table


def p_text(value: float) -> str:
    """A p value as in the tables: < .001, .045, or a dash."""
    return "–" if not math.isfinite(value) else "< .001" if value < 0.001 else apa.share(value, 3)


def _number(name: str, decimals: int = 2) -> Writer:
    return lambda row: apa.number(row[name], decimals)


def _figures(name: str) -> Writer:
    return lambda row: apa.figures(row[name])


def _percent(name: str) -> Writer:
    return lambda row: apa.number(100 * row[name], 1)


def _limits(low: str, high: str, scale: float = 1.0) -> Writer:
    return lambda row: apa.limits(scale * row[low], scale * row[high])


def _difference(row: Row) -> str:
    """With the decimals of its limits, which stand beside it."""
    estimate, *_ = apa.together(row["estimate"], row["ci_low"], row["ci_high"])
    return estimate


def _limits_of_difference(row: Row) -> str:
    _, low, high = apa.together(row["estimate"], row["ci_low"], row["ci_high"])
    return f"[{low}, {high}]"


def _p(name: str = "p") -> Writer:
    return lambda row: p_text(row[name])


def _df(*names: str) -> Writer:
    return lambda row: ", ".join(apa.degrees(row[name]) for name in names)


def _inside(row: Row, of: str) -> str:
    pair = f"{row['a']} − {row['b']}" if row["a"] else f"mean − {row['reference']}"
    return f"{row[of]} {row['level']}: {pair}" if row[of] else pair


T = {"$t$": _number("t"), "df": _df("df"), "$p$": _p()}
FORMS: Mapping[str, TableForm] = {
    "comparisons": TableForm("t tests", {
        "": lambda r: f"{_inside(r, 'each')}{' (Welch)' if r['test'] == 'Welch' else ''}",
        "Difference": _difference, r"95 \% CI": _limits_of_difference, **T, "$d$": _number("d"),
    }),
    "pairs": TableForm("Planned pairs of marginal means", {
        "": lambda r: _inside(r, "by"), "Difference": _difference, r"95 \% CI": _limits_of_difference,
        **T, "$d$": _number("d_av"),
    }),
    "proportions": TableForm("Proportions against chance, with Wilson limits", {
        "": lambda r: ", ".join(filter(None, [r["label"], r["level"]])), "Trials": lambda r: f"{r['k']}/{r['trials']}",
        r"\%": _percent("proportion"), r"95 \% CI": _limits("wilson_low", "wilson_high", 100.0),
        "exact $p$": _p("p_exact"), **T,
    }),
    "d_prime": TableForm("Sensitivity", {
        "": lambda r: r["level"], "$d'$": _number("mean"), "SD": _number("sd"), **T, "Criterion": _number("criterion"),
    }),
    "psychometric": TableForm("Thresholds of the psychometric functions", {
        "": lambda r: r["level"], "$n$": lambda r: f"{r['n']:.0f}", "Threshold": _figures("mean"), "SD": _figures("sd"),
        r"95 \% CI": _limits("ci_low", "ci_high"), "JND": _figures("jnd"),
    }, lambda table: table[table["part"] == "threshold"]),
    "adaptive": TableForm("Thresholds of the adaptive tracks", {
        "": lambda r: r["level"], "$n$": lambda r: f"{r['n']:.0f}", "Threshold": _figures("mean"), "SD": _figures("sd"),
        r"95 \% CI": _limits("ci_low", "ci_high"),
    }),
    "equivalence": TableForm("Equivalence tests (TOST)", {
        "Pair": lambda r: _inside({**r, "reference": ""}, "by"), "Difference": _difference,
        r"90 \% CI": _limits_of_difference, "Bounds": lambda r: f"±{apa.figures(r['upper_bound'])}",
        "df": _df("df"), "$p$": _p(), "Verdict": lambda r: "equivalent" if r["equivalent"] else "not shown",
    }),
    "regression": TableForm("Regression", {
        "": lambda r: r["term"], "$b$": _figures("estimate"), "SE": _figures("se"), r"$\beta$": _number("beta"),
        "$t$": _number("t"), "$p$": _p(), "VIF": _number("vif"),
    }),
    "aligned_rank_transform": TableForm("Aligned rank transform", {
        "Effect": lambda r: apa.effect_name(r["effect"]), "df": _df("df1", "df2"), "$F$": _number("F"), "$p$": _p(),
    }),
    "mixed_model": TableForm("Mixed model, fixed effects", {
        "Effect": lambda r: apa.effect_name(r["term"]), "df": _df("df1", "df2"), "$F$": _number("statistic"),
        "$p$": _p(),
    }, lambda table: table[table["part"] == "effect"]),
}  # fmt: skip
"""How the table of each kind of test is written."""


def further_rows(test: FurtherTest) -> tuple[str, list[str], list[list[str]]] | None:
    """Caption, headings and rows of a test's table; None when there is nothing to show."""
    form = FORMS[test.kind]
    rows = form.rows(test.table).to_dict("records")
    if not rows:
        return None
    return form.caption, list(form.columns), [[write(row) for write in form.columns.values()] for row in rows]

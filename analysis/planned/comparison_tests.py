"""Planned t tests between levels or groups, one-sample tests over everything, and planned pairs of marginal means."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pandas as pd

from analysis import apa
from analysis.errors import AnalysisError
from analysis.planned.further_test import FurtherTest, worth_saying
from analysis.planned.plan import AnalysisPlan
from analysis.planned.plan_parts import ComparisonPlan
from analysis.recorded.exclusions import selected
from analysis.statistics.comparisons import pairwise
from analysis.statistics.student import t_tests


def comparison_tests(used: pd.DataFrame, plan: AnalysisPlan) -> FurtherTest:
    """Paired, independent and overall one-sample t tests: factor, each, where, reference, as `t_tests`, sentence.

    One that cannot be run is a complaint beside the others; AnalysisError if none can.
    """
    parts: list[pd.DataFrame] = []
    notes: list[str] = []
    complaints: list[str] = []
    for asked in plan.comparisons:
        try:
            table = _compared(used, plan, asked)
        except AnalysisError as error:
            complaints.append(f"The t tests of {asked.factor or asked.label} cannot be run: {error}")
            continue
        notes += table.attrs["notes"]
        parts.append(table)
    if not parts:
        raise AnalysisError(" ".join(complaint.split(": ", 1)[1] for complaint in dict.fromkeys(complaints)))
    table = _one_table(parts, ["factor", "each", "where", "reference"], _sentence)
    return FurtherTest("comparisons", table, notes=worth_saying(notes), complaints=tuple(complaints))


def _compared(used: pd.DataFrame, plan: AnalysisPlan, asked: ComparisonPlan) -> pd.DataFrame:
    named = [name for name in (asked.each, asked.factor) if name is not None]
    table = t_tests(
        selected(used, asked.where), plan.measure, "participant", each=asked.each, against=asked.against,
        levels={name: plan.levels[name] for name in named}, paired=asked.factor if asked.kind == "paired" else None,
        independent=asked.factor if asked.kind == "independent" else None,
    )  # fmt: skip
    return table.assign(factor=asked.factor or "", each=asked.each or "", where=asked.where or "",
                        reference=asked.label if asked.kind == "against" else "")  # fmt: skip


def _one_table(parts: list[pd.DataFrame], first: list[str], sentence: Callable[[dict[str, Any]], str]) -> pd.DataFrame:
    """The tables below one another, the columns that say what was tested first, a sentence for each row last."""
    table = pd.concat(parts, ignore_index=True)
    table = table[[*first, *(name for name in table if name not in first)]]
    table["sentence"] = [sentence(row) for row in table.to_dict("records")]
    return table


def _sentence(row: dict[str, Any]) -> str:
    where = f"{row['each']} {row['level']}: " if row["each"] else ""
    what = f"{row['a']} − {row['b']}" if row["a"] else f"mean − {row['reference']}"
    welch = "Welch's " if row["test"] == "Welch" else ""
    return f"{where}{what} = {apa.figures(row['estimate'])}, {welch}{apa.t_sentence(row)}"


def pair_tests(used: pd.DataFrame, plan: AnalysisPlan) -> FurtherTest:
    """Planned pairs of marginal means and simple effects: factors, by, level, the columns of `pairwise`, sentence."""
    parts: list[pd.DataFrame] = []
    notes: list[str] = []
    for asked in plan.pairs:
        table = pairwise(
            used, plan.measure, "participant", plan.within, plan.between, factors=list(asked.factors),
            by=list(asked.by), model=asked.model, adjust=asked.adjust,
            levels={name: plan.levels[name] for name in (*plan.within, *plan.between)},
        )  # fmt: skip
        notes += table.attrs["notes"]
        level = [" × ".join(str(row[name]) for name in asked.by) for row in table.to_dict("records")]
        table = table.drop(columns=list(asked.by)).assign(level=level)
        parts.append(table.assign(factors=" × ".join(asked.factors), by=" × ".join(asked.by), adjust=asked.adjust))
    table = _one_table(parts, ["factors", "by", "level", "adjust"], _pair_sentence)
    return FurtherTest("pairs", table, notes=worth_saying(notes))


def _pair_sentence(row: dict[str, Any]) -> str:
    inside = zip(row["by"].split(" × "), row["level"].split(" × "), strict=False)
    where = ", ".join(f"{name} {level}" for name, level in inside) + ": " if row["by"] else ""
    pair = f"{where}{row['a']} − {row['b']} = {apa.figures(row['estimate'])}"
    test = apa.t_sentence({**row, "d": math.nan})
    if not math.isfinite(row["t"]):
        return f"{pair}, {test}"
    adjusted = "" if row["adjust"] == "none" else f" ({row['adjust'].capitalize()})"
    return f"{pair}, {test}{adjusted}, d_av = {apa.number(row['d_av'])}"

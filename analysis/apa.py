"""Test results as sentences in the style of the American Psychological Association."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

MINUS = "−"


def number(value: float, decimals: int = 2) -> str:
    """Fixed decimals, with a real minus sign; an en dash where there is no value."""
    if value is None or not math.isfinite(value):
        return "–"
    text = f"{value:.{decimals}f}"
    return text.replace("-", MINUS) if float(text) else text.lstrip("-")


def figures(value: float, significant: int = 3) -> str:
    """Significant figures, never in powers of ten: 0.00573, 36.2."""
    if value is None or not math.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    decimals = max(0, significant - 1 - math.floor(math.log10(abs(value))))
    return number(value, min(decimals, 12))


def together(*values: float, significant: int = 3) -> list[str]:
    """Values written side by side: all with the decimals that give the largest of them its significant figures."""
    largest = max((abs(value) for value in values if math.isfinite(value)), default=0.0)
    decimals = max(0, significant - 1 - math.floor(math.log10(largest))) if largest else 0
    return [number(value, min(decimals, 12)) for value in values]


def limits(low: float, high: float) -> str:
    """An interval by its limits: [−0.0391, 0.0415]; an en dash where there is none."""
    if not (math.isfinite(low) or math.isfinite(high)):
        return "–"
    return f"[{', '.join(together(low, high))}]"


def degrees(df: float) -> str:
    """Whole degrees of freedom as they are, corrected ones with three figures: 3, 1.80, 36.2; a dash for none."""
    if not math.isfinite(df):
        return "–"
    return f"{df:.0f}" if abs(df - round(df)) < 1e-9 else figures(df)


def both_degrees(df1: float, df2: float) -> str:
    """The two degrees of freedom of an F: '1.80, 36.2'; one dash for none."""
    return f"{degrees(df1)}, {degrees(df2)}" if math.isfinite(df1) else "–"


def p_value(p: float) -> str:
    """'p < .001', 'p = .045', or that there is none."""
    if p is None or not math.isfinite(p):
        return "no p value"
    return "p < .001" if p < 0.001 else f"p = {share(p, 3)}"


def share(value: float, decimals: int = 2) -> str:
    """A number that cannot exceed one, without its leading zero: .72."""
    text = number(value, decimals)
    return text.replace("0.", ".", 1) if text.startswith(("0.", MINUS + "0.")) else text


def mid_sentence(label: str) -> str:
    """A measure's label inside a sentence: 'Walk ratio' as 'walk ratio', 'RT' as it is."""
    return label if label[1:2].isupper() else label[:1].lower() + label[1:]


def follows_numbers(unit: str) -> bool:
    """Whether a measure has a unit to write after its values; the range of a rating scale ('0-4') is none."""
    return unit != "" and not unit[0].isdigit()


def with_unit(value: str, unit: str) -> str:
    """A value with its unit, '0.5 s', if it has one that follows numbers."""
    return f"{value} {unit}" if follows_numbers(unit) else value


def anova_sentence(row: Mapping[str, Any]) -> str:
    """'F(1.80, 36.2) = 51.37, p < .001, ηp² = .72', Greenhouse-Geisser corrected, from a row of `anova`."""
    if not math.isfinite(row["F"]):
        return "not testable: no variance"
    return (
        f"F({degrees(row['df1_gg'])}, {degrees(row['df2_gg'])}) = {number(row['F'])}, "
        f"{p_value(row['p_gg'])}, ηp² = {share(row['eta_p2'])}"
    )


def t_sentence(row: Mapping[str, Any]) -> str:
    """'t(21) = −8.43, p < .001, d = −1.80' from a row of `t_tests`."""
    if not math.isfinite(row["t"]):
        return "not testable: no variance"
    text = f"t({degrees(row['df'])}) = {number(row['t'])}, {p_value(row['p'])}"
    return f"{text}, d = {number(row['d'])}" if math.isfinite(row.get("d", math.nan)) else text


def effect_name(effect: str) -> str:
    """'actor:speed' as 'actor × speed'."""
    return effect.replace(":", " × ")


def equivalence_sentence(row: Mapping[str, Any]) -> str:
    """'0.8 − 1.0: −0.00002, 90 % limits [−0.00006, 0.00002], TOST t(20) = 12.4, p < .001'."""
    where = f"{row['by']} {row['level']}, " if row.get("by") else ""
    if not math.isfinite(row["p"]):
        return f"{where}{row['a']} {MINUS} {row['b']}: not testable: no variance"
    t = min(row["t_lower"], -row["t_upper"])
    bound = figures(row["upper_bound"])
    verdict = f"equivalent within ±{bound}" if row["equivalent"] else f"not shown to be equivalent within ±{bound}"
    estimate, low, high = together(row["estimate"], row["ci_low"], row["ci_high"])
    return (
        f"{where}{row['a']} {MINUS} {row['b']}: {estimate}, 90 % limits [{low}, {high}], "
        f"TOST t({degrees(row['df'])}) = {number(t)}, {p_value(row['p'])}, {verdict}"
    )


def regression_sentence(fit: Mapping[str, float]) -> str:
    """'R² = .81, adjusted R² = .76, F(3, 12) = 16.9, p < .001' from `regression(...).attrs["fit"]`."""
    return (
        f"R² = {share(fit['r2'])}, adjusted R² = {share(fit['r2_adjusted'])}, "
        f"F({fit['df1']}, {fit['df2']}) = {number(fit['F'])}, {p_value(fit['p'])}"
    )


def coefficient_sentence(row: Mapping[str, Any], df: float) -> str:
    """'height: b = 0.00431, β = 0.62, t(12) = 3.10, p = .009' from a row of `regression`."""
    return (
        f"{row['term']}: b = {figures(row['estimate'])}, β = {number(row['beta'])}, "
        f"t({degrees(df)}) = {number(row['t'])}, {p_value(row['p'])}"
    )


def mixed_sentence(row: Mapping[str, Any]) -> str:
    """'F(2, 484) = 3.10, p = .046', 'b = ..., t(...)' or 'SD = ... (31 % of the variance)' from `mixed_model`."""
    if row["part"] == "deviation":
        return f"SD = {figures(row['estimate'])} ({number(100 * row['share'], 0)} % of the variance)"
    if row["part"] == "effect":
        return f"F({degrees(row['df1'])}, {degrees(row['df2'])}) = {number(row['statistic'])}, {p_value(row['p'])}"
    return f"b = {figures(row['estimate'])}, t({degrees(row['df2'])}) = {number(row['statistic'])}, {p_value(row['p'])}"

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


def degrees(df: float) -> str:
    """Whole degrees of freedom as they are, corrected ones with three figures: 3, 1.80, 36.2."""
    return f"{df:.0f}" if abs(df - round(df)) < 1e-9 else figures(df)


def p_value(p: float) -> str:
    """'p < .001', 'p = .045', or that there is none."""
    if p is None or not math.isfinite(p):
        return "no p value"
    return "p < .001" if p < 0.0005 or p < 0.001 else f"p = {share(p, 3)}"


def share(value: float, decimals: int = 2) -> str:
    """A number that cannot exceed one, without its leading zero: .72."""
    text = number(value, decimals)
    return text.replace("0.", ".", 1) if text.startswith(("0.", MINUS + "0.")) else text


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

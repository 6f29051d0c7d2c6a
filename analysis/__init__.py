"""Recorded runs to tidy tables, tests, figures and a report.

The functions below are imported when first used, so that `import analysis` itself costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

_HOME = {
    "analyse": "planned_analysis",
    "AnalysisError": "errors",
    "AnalysisOutcome": "planned_analysis",
    "AnalysisWarning": "errors",
    "anova": "statistics.repeated_measures",
    "art_anova": "statistics.aligned_ranks",
    "art_contrasts": "statistics.aligned_ranks",
    "assumptions": "statistics.assumption_checks",
    "combine_power": "power.simulation",
    "confusion_rate": "recorded.gait_measures",
    "d_prime": "statistics.forced_choice",
    "d_prime_forced_choice": "statistics.forced_choice",
    "emmeans": "statistics.marginal_means",
    "equivalence": "statistics.equivalence_tests",
    "equivalence_of_effects": "statistics.equivalence_tests",
    "gaze_shares": "recorded.gait_measures",
    "mixed_model": "statistics.crossed_effects",
    "normalised_gait": "recorded.gait_measures",
    "normality": "statistics.shapiro_wilk",
    "pairwise": "statistics.comparisons",
    "partial_eta_squared": "statistics.effect_size",
    "power_by_simulation": "power.simulation",
    "power_regression": "power.formulas",
    "power_rm_anova": "power.formulas",
    "power_t_test": "power.formulas",
    "proportions": "statistics.forced_choice",
    "psychometric": "statistics.psychometric_functions",
    "quantiles": "statistics.assumption_checks",
    "regression": "statistics.linear_regression",
    "regression_diagnostics": "statistics.linear_regression",
    "t_tests": "statistics.student",
    "t_tests_from_summary": "statistics.student",
    "walk_ratio": "recorded.gait_measures",
}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'analysis' has no attribute {name!r}")
    return getattr(import_module(f"analysis.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return [*globals(), *_HOME]

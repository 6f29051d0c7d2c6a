"""Recorded runs to tidy tables, tests, figures and a report.

The functions below are imported when first used, so that `import analysis` itself costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

_HOME = {
    "analyse": "planned",
    "AnalysisError": "errors",
    "AnalysisOutcome": "planned",
    "AnalysisWarning": "errors",
    "anova": "repeated_measures",
    "art_anova": "aligned_ranks",
    "art_contrasts": "aligned_ranks",
    "assumptions": "assumption_checks",
    "combine_power": "simulation_power",
    "confusion_rate": "gait_measures",
    "d_prime": "forced_choice",
    "d_prime_forced_choice": "forced_choice",
    "emmeans": "marginal_means",
    "equivalence": "equivalence_tests",
    "equivalence_of_effects": "equivalence_tests",
    "gaze_shares": "gait_measures",
    "mixed_model": "crossed_effects",
    "normalised_gait": "gait_measures",
    "normality": "shapiro_wilk",
    "pairwise": "comparisons",
    "partial_eta_squared": "effect_size",
    "power_by_simulation": "simulation_power",
    "power_regression": "power",
    "power_rm_anova": "power",
    "power_t_test": "power",
    "proportions": "forced_choice",
    "psychometric": "psychometric_functions",
    "quantiles": "assumption_checks",
    "regression": "linear_regression",
    "regression_diagnostics": "linear_regression",
    "t_tests": "student",
    "t_tests_from_summary": "student",
    "walk_ratio": "gait_measures",
}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'analysis' has no attribute {name!r}")
    return getattr(import_module(f"analysis.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return [*globals(), *_HOME]

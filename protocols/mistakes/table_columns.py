"""Names of columns that the tables of a study fill by themselves, so that no factor or question may have them."""

from __future__ import annotations

from protocols.study import Study

OF_TRIALS = frozenset({"study", "participant", "run", "trial", "block", "repetition", "track", "excluded"})
"""Columns that a table of trials has whatever the task."""

COUNTS = ("response_time", "late_frames", "key_presses", "reversals")
"""Numbers that every trial is recorded with."""

DERIVED = frozenset({"confusion_rate", "normalised_walk_ratio", "gaze_share"})
OF_RESULTS = frozenset({"trials", "n", "mean", "sd", "se", "ci_low", "ci_high", "scope", "w", "p"})
"""Columns that stand beside the factors in cell_means.csv, descriptives.csv and normality.csv."""


def taken_columns(study: Study) -> frozenset[str]:
    """Every name that would be overwritten, or would overwrite a recorded answer."""
    task = {*study.task.responses, *study.task.recorded}
    return OF_TRIALS | set(COUNTS) | DERIVED | OF_RESULTS | task

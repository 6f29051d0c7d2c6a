"""The tidy table of trials: one row per trial of every run that counts."""

from __future__ import annotations

from typing import Any

import pandas as pd

from analysis.errors import AnalysisError, listed
from analysis.planned.plan import GAZE_SHARE, AnalysisPlan
from analysis.recorded.exclusions import matching
from analysis.recorded.gait_measures import gaze_rows, normalised_gait
from analysis.recorded.journal import RecordedRun, RecordedStudy
from analysis.statistics.columns import label, numeric_label
from protocols.gaze import REGIONS

COUNTS = ("response_time", "key_presses", "reversals", "late_frames")


def trials_table(recorded: RecordedStudy, plan: AnalysisPlan) -> pd.DataFrame:
    """One row per trial with columns study, participant, run, the answers that are not free text, trial,
    block, repetition, the factors, those made of groups of levels, the response's values, response_time (s),
    key_presses, reversals, late_frames, measured_* (from the walker as drawn) and excluded (the reason, or empty).
    """
    rows = [_row(run, trial, plan) for run in recorded.runs for trial in run.trials]
    if not rows:
        raise AnalysisError("The recorded runs hold no trial (practice does not count).")
    table = pd.DataFrame(rows, columns=_columns(rows, plan, recorded))
    for name, groups in plan.groups.items():
        if groups.of in table:
            place = table.columns.get_loc(plan.factors[-1]) + 1 if plan.factors[-1] in table else len(table.columns)
            table.insert(place, name, table[groups.of].map(numeric_label).map(groups.group_of))
    for one in (plan, *plan.also):
        _add_derived(table, one)
        if one.measure not in table.columns and one.measure != GAZE_SHARE:
            raise AnalysisError(
                f"The planned measure {one.measure!r} is no column of the trials; "
                f"they have {listed(table.columns, 40)}."
            )
    table["excluded"] = ""
    for exclusion in plan.exclusions:
        chosen = matching(table, exclusion.where) & (table["excluded"] == "")
        table.loc[chosen, "excluded"] = exclusion.reason
    return table


def used_trials(trials: pd.DataFrame, plan: AnalysisPlan) -> pd.DataFrame:
    """The rows a plan's tests rest on: trials that are not excluded; of gaze shares, a row per trial and region."""
    used = trials[trials["excluded"] == ""] if "excluded" in trials else trials
    return gaze_rows(used, REGIONS) if plan.measure == GAZE_SHARE and has_gaze(used) else used


def has_gaze(trials: pd.DataFrame) -> bool:
    """Whether gaze was recorded, as shares of looking time on regions."""
    return any(f"{before}gaze_{REGIONS[0]}" in trials for before in ("", "measured_"))


def _row(run: RecordedRun, trial: dict[str, Any], plan: AnalysisPlan) -> dict[str, Any]:
    row: dict[str, Any] = {"study": plan.study, "participant": run.participant, "run": run.number}
    row |= {name: value for name, value in run.answers.items() if name not in plan.free_text}
    row |= {"trial": trial["number"], "block": trial.get("block"), "repetition": trial.get("repetition")}
    row |= {"track": trial["track"]} if trial.get("track") else {}
    row |= {**trial.get("factors", {}), **trial.get("response", {})}
    row |= {name: trial.get(name) for name in COUNTS}
    return row | {f"measured_{name}": value for name, value in trial.get("measured", {}).items()}


def _add_derived(table: pd.DataFrame, plan: AnalysisPlan) -> None:
    """Adds the planned measure where it follows from what was recorded.

    normalised_walk_ratio: dimensionless (Hof 1996), with the heights in the plan. confusion_rate: 100 (%)
    where the copy was `chosen` instead of the `original`, 0 where not.
    """
    if plan.measure == "normalised_walk_ratio" and {"step_length", "step_frequency"} <= set(table.columns):
        named = plan.actor[1:] if plan.actor.startswith("$") else None
        actors = table[named].map(label) if named in table else pd.Series(plan.actor, index=table.index)
        heights = actors.map(plan.heights or {})
        if heights.isna().any():
            missing = sorted(set(actors[heights.isna()]))
            raise AnalysisError(
                f"The plan gives no height for {listed(missing)}, which normalised_walk_ratio needs; "
                "add it under `heights:`, in metres."
            )
        table[plan.measure] = normalised_gait(table.assign(_height=heights), "_height")["walk_ratio_n"]
    elif plan.measure == "confusion_rate" and {"chosen", "original"} <= set(table.columns):
        wrong = table["chosen"].map(label) != table["original"].map(label)
        table[plan.measure] = wrong.astype(float) * 100


def _columns(rows: list[dict[str, Any]], plan: AnalysisPlan, recorded: RecordedStudy) -> list[str]:
    """The same order whatever the first run happens to hold."""
    answered = list(dict.fromkeys(name for run in recorded.runs for name in run.answers))
    answers = [name for name in (*plan.questions, *answered) if name in answered and name not in plan.free_text]
    seen = dict.fromkeys(name for row in rows for name in row)
    first = ["study", "participant", "run", *answers, "trial", "block", "repetition", "track", *plan.factors]
    ordered = list(dict.fromkeys(name for name in first if name in seen))
    response = [n for n in seen if n not in ordered and n not in COUNTS and not n.startswith("measured_")]
    measured = [n for n in seen if n.startswith("measured_") and n not in ordered]
    return [*ordered, *response, *COUNTS, *measured]


def exclusion_counts(trials: pd.DataFrame, plan: AnalysisPlan) -> pd.DataFrame:
    """How many trials of how many participants each declared exclusion took out."""
    rows = []
    for exclusion in plan.exclusions:
        out = trials[trials["excluded"] == exclusion.reason]
        rows.append((exclusion.where, exclusion.reason, len(out), out["participant"].nunique()))
    return pd.DataFrame(rows, columns=["where", "reason", "trials", "participants"])

"""Measures derived from what a trial recorded: walk ratios, confusion, gaze shares."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from analysis.errors import AnalysisError
from analysis.statistics.cells import names_of
from analysis.statistics.columns import numbers, numeric_label, require, require_filled, require_other_names

GRAVITY = 9.81  # m/s²


def walk_ratio(
    data: pd.DataFrame, step_length: str = "step_length", step_frequency: str = "step_frequency"
) -> pd.Series:
    """Step length (m) over step frequency (steps/min), in m·min (Sekiya, Nagasaki, Ito & Furuna 1996)."""
    require(data, [step_length, step_frequency])
    frequency = numbers(data, step_frequency)
    _positive(frequency, step_frequency)
    return pd.Series(numbers(data, step_length) / frequency, index=data.index, name="walk_ratio")


def normalised_gait(
    data: pd.DataFrame,
    height: str,
    step_length: str = "step_length",
    step_frequency: str = "step_frequency",
) -> pd.DataFrame:
    """Dimensionless step length, step frequency, speed and walk ratio (Hof 1996), scaled by body height.

    height: column in m; step_length in m; step_frequency in steps/min. Returns columns
    step_length_n = SL / H, step_frequency_n = (SF / 60) / sqrt(g / H), speed_n = v / sqrt(g H) and
    walk_ratio_n = step_length_n / step_frequency_n, with the index of `data`.
    """
    require(data, [height, step_length, step_frequency])
    H, SL, SF = (numbers(data, name) for name in (height, step_length, step_frequency))
    for values, name in ((H, height), (SF, step_frequency)):
        _positive(values, name)
    if (H > 3).any():
        raise AnalysisError(f"{height!r} must be in metres; it holds {H.max():g}.")
    length, frequency = SL / H, SF / 60 / (GRAVITY / H) ** 0.5
    return pd.DataFrame(
        {
            "step_length_n": length, "step_frequency_n": frequency, "speed_n": length * frequency,
            "walk_ratio_n": length / frequency,
        },
        index=data.index,
    )  # fmt: skip


def confusion_rate(data: pd.DataFrame, chosen: str, original: str, by: str | list[str]) -> pd.DataFrame:
    """Percentage of trials in which the copy was taken for the original, per combination of `by`.

    chosen, original: columns holding what was chosen and what was captured. 50 is chance: the copy
    cannot be told from the original. Trials without an answer are left out. Returns the columns of `by`,
    trials and confusion_rate (%).
    """
    require(data, [chosen, original, *names_of(by)])
    require_other_names(names_of(by), ("trials", "confusion_rate"))
    require_filled(data, names_of(by))
    differ = data[chosen].map(numeric_label) != data[original].map(numeric_label)
    answered = data[chosen].notna() & data[original].notna()
    wrong = data.assign(_wrong=100.0 * differ).loc[answered]
    grouped = wrong.groupby(list(names_of(by)), sort=True, observed=True)["_wrong"]
    return grouped.agg(trials="count", confusion_rate="mean").reset_index()


def gaze_shares(data: pd.DataFrame, subject: str, part: str, duration: str | None = None) -> pd.DataFrame:
    """Share of looking time on each body part, per participant; parts never looked at count as 0.

    data: one row per frame or fixation; part: what was looked at; duration: its length in s (equal
    lengths when left out). Returns columns subject, part, share (%), summing to 100 per participant.
    """
    require(data, [subject, part, *([duration] if duration else [])])
    require_other_names((subject, part), ("share",))
    time = pd.Series(numbers(data, duration), index=data.index) if duration else pd.Series(1.0, index=data.index)
    seen = pd.DataFrame({subject: data[subject], part: data[part], "_time": time})
    totals = seen.pivot_table(index=subject, columns=part, values="_time", aggfunc="sum", fill_value=0.0)
    shares = totals.div(totals.sum(axis=1), axis=0) * 100
    return shares.stack().rename("share").reset_index()


def gaze_rows(trials: pd.DataFrame, regions: Sequence[str]) -> pd.DataFrame:
    """A row per trial and region, with the columns region and gaze_share (%), from trials with a column per region.

    The columns are gaze_legs, ... or measured_gaze_legs, ...; trials in which no gaze was recorded are left out.
    """
    names = {region: next((c for c in (f"gaze_{region}", f"measured_gaze_{region}") if c in trials), None)
             for region in regions}  # fmt: skip
    missing = [region for region, name in names.items() if name is None]
    if missing:
        raise AnalysisError(
            f"No gaze was recorded in these trials: there is no column gaze_{missing[0]}. Record with an eye tracker "
            "(`gaze:` in the study file), or take gaze_share out of the analysis."
        )
    parts = [trials.assign(region=region, gaze_share=numbers(trials, str(name))) for region, name in names.items()]
    rows = pd.concat(parts)
    rows["region"] = pd.Categorical(rows["region"], categories=list(regions))
    return rows[rows["gaze_share"].notna()].sort_index(kind="stable").reset_index(drop=True)


def _positive(values, name: str) -> None:  # type: ignore[no-untyped-def]
    if (values <= 0).any():
        raise AnalysisError(f"{name!r} must be above zero in every row.")
